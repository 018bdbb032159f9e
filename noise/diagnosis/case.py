"""A case: the recordings of one rig, as a folder holds them, and what in it cannot be used."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from models.condition import known_condition, same_support
from models.errors import BushingNoiseError, ParameterError, RecordingError
from models.recording import Recording
from models.rig import Rig
from noise.diagnosis.bench.channels import misplaced_torque
from noise.diagnosis.bench.faults import clipped_channels, without_dead_channels
from noise.diagnosis.bench.units import length_unit
from noise.diagnosis.preparation.prepare import prepared
from noise.diagnosis.preparation.settled_part import shortest
from noise.diagnosis.unstated.conditions import with_told_conditions
from noise.recordings import find_recordings, read_recording

LEAST_RATE = 8e3
"""Least sampling rate [Hz]: the cycle's harmonics to 3 kHz are in it; assumed."""

_SAME = 1e-3
"""Relative difference up to which two fits or supports are the same; rounding of what files state;
assumed."""

KINDS = ("torque", "acceleration", "pressure")
"""Kinds of channel of which a recording must have one."""


@dataclass(frozen=True, eq=False)
class Case:
    """Recordings of one rig.

    Parameters
    ----------
    rig : Rig
        With its sensors as the recordings show them, where its file does not state them.
    names : tuple of str
        Of the files.
    recordings : tuple of Recording
        As `noise.diagnosis.preparation.prepare.prepared` gives them.
    refused : tuple of (str, str)
        Name and reason of what was left out.
    notes : tuple of str
        What was done to the recordings, a line each.
    faults : tuple of str
        Channels that are dead, and left out, or clip, one line each.
    misplaced : str
        Which channel holds the torque in its place, told before anything was cut; empty if none.
    """

    rig: Rig
    names: tuple[str, ...]
    recordings: tuple[Recording, ...]
    refused: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()
    misplaced: str = ""


def read_case(paths: Sequence[Path], rig: Rig) -> Case:
    """Read the recordings in files and folders.

    Parameters
    ----------
    paths : sequence of Path
    rig : Rig

    Returns
    -------
    Case
        What cannot be read or used is among ``refused``.

    Raises
    ------
    ParameterError
        There is no recording.
    RecordingError
        There is none that can be used; the message says what would be right.
    """
    names, recordings, refused = [], [], []
    for path, name in find_recordings(paths):
        try:
            recording = usable(read_recording(path, calibrations=rig.sensors.calibrations), rig)
        except BushingNoiseError as error:
            refused.append((name, str(error)))
        else:
            names.append(name)
            recordings.append(recording)
    if not recordings:
        what = f"{', '.join(map(str, paths))}: no recording that can be diagnosed"
        if not refused:
            raise ParameterError(what)
        raise RecordingError("; ".join([what, *(f"{name}: {why}" for name, why in refused)]))
    faults = clipped_channels(recordings, rig)
    sounding = without_dead_channels(names, recordings)
    if any(recording is not None for recording in sounding.recordings):  # else the check says it
        faults = [*sounding.findings, *faults]
        pairs = list(zip(names, sounding.recordings, strict=True))
        refused += [(name, "all its channels are dead") for name, left in pairs if left is None]
        names = [name for name, left in pairs if left is not None]
        recordings = [left for _, left in pairs if left is not None]
    misplaced = misplaced_torque(recordings, rig)
    ready = prepared(rig, recordings)
    refused += [(names[i], reason) for i, reason in ready.left_out.items()]
    kept = tuple(name for i, name in enumerate(names) if i not in ready.left_out)
    return Case(
        ready.rig, kept, ready.recordings, tuple(refused), ready.notes, tuple(faults), misplaced
    )


def usable(recording: Recording, rig: Rig) -> Recording:
    """Return a recording as the diagnosis can use it.

    What its condition does not state is taken from angle and torque, where these tell it, and
    interference and support where the rig has only one.

    Raises
    ------
    ParameterError
        What it lacks.
    """
    if not recording.calibrated:
        raise ParameterError(
            'is not in physical units; state units in a sidecar, with "calibrated": true, or '
            "calibration under [sensors] of the rig file"
        )
    if all(recording.first(kind) is None for kind in KINDS):
        raise ParameterError(f"has no channel of {', '.join(KINDS)}")
    if recording.rate < LEAST_RATE:
        raise ParameterError(f"is sampled at {recording.rate:g} Hz; {LEAST_RATE:g} at least")
    least = shortest(recording.rate)
    if recording.duration < least:
        raise ParameterError(f"lasts {recording.duration:.3g} s; {least:.3g} s at least")
    recording = with_told_conditions(recording, rig)
    condition = known_condition(recording.condition)
    interference, support = condition.interference, condition.support_stiffness
    low, high = rig.interference_range
    if not low * (1.0 - _SAME) <= interference <= high * (1.0 + _SAME):
        unit = length_unit(interference, low, high)
        asked = f"; is it in {unit}?" if unit else ""
        raise ParameterError(
            f"interference_mm = {1e3 * interference:g} lies outside the fits of the rig file, "
            f"{1e3 * low:g} to {1e3 * high:g}{asked}"
        )
    known = [m.support_stiffness for m in rig.measured]
    if known and not any(same_support(support, k) for k in known):
        raise ParameterError(
            f"support_stiffness_Nm_rad = {support:g} has no measured_response in the rig file; "
            f"it has {', '.join(f'{k:g}' for k in known)}"
        )
    return replace(recording, condition=condition)
