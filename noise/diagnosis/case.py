"""Reader of a case: the recordings of one rig in a folder, and their usable channels.

Speed, interference and support that a recording does not state, taken from angle and torque.

The speed is the angle's. The interference is that of the rig's fits whose kinetic torque the mean
torque is near to, where it is near to no other. A support is taken only where the rig has one.

What a user is asked to write where a condition is not stated and nothing tells it.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePath

import numpy as np

from models.condition import FIXED, Condition, known_condition, same_support
from models.errors import BushingNoiseError, ParameterError, RecordingError
from models.recording import Recording
from models.rig import Rig
from noise.diagnosis.bench.channels import length_unit, misplaced_torque
from noise.diagnosis.bench.check import clipped_channels, refuse_unusable, without_dead_channels
from noise.diagnosis.gap import KINDS
from noise.diagnosis.preparation.prepare import measured_speed, prepared
from noise.diagnosis.preparation.settled_part import shortest
from noise.diagnosis.text.words import joined
from noise.recordings import find_recordings, read_recording
from noise.recordings.rotation import as_logged
from noise.recordings.sidecar import sidecar_text


def sidecar_request(
    recording: Recording, interferences: Sequence[float], supports: Sequence[float]
) -> str:
    """Return a one-line request for the missing sidecar, with its possible content.

    Parameters
    ----------
    recording : Recording
        Named as its file; its condition as far as it is known.
    interferences : sequence of float
        Of the rig's fits [m].
    supports : sequence of float
        Of the rig [Nm/rad] or `models.condition.FIXED`.

    Returns
    -------
    str

    Examples
    --------
    >>> import numpy as np
    >>> from models.recording import Channel
    >>> from models.recording import Recording
    >>> run = Recording(np.zeros((1, 8)), 48e3, (Channel("pressure"),), name="run03.wav")
    >>> print(sidecar_request(run, [0.000178, 0.000279], [2214.0, FIXED]))
    write run03.json with your own numbers: {"channels": [{"name": "pressure", "unit": "Pa"}],
      "conditions": {"speed_rad_s": 1.0, "interference_mm": 0.178,
      "support_stiffness_Nm_rad": 2214.0}, "calibrated": true}; interference_mm is 0.178 or 0.279,
      support_stiffness_Nm_rad 2214 or null (clamp bolted to the baseplate)
    """
    at = recording.condition
    filled = Condition(
        1.0 if not at.speed else at.speed,
        at.interference or interferences[0],
        at.support_stiffness or supports[0],
        at.material,
        at.temperature,
    )
    full = sidecar_text(replace(recording, condition=filled, calibrated=True, notes=()))
    name = PurePath(recording.name).with_suffix(".json").name if recording.name else "its sidecar"
    choices = [
        f"interference_mm is {joined([f'{1e3 * x:.4g}' for x in interferences], 'or')}",
        f"support_stiffness_Nm_rad {joined([_support(x) for x in supports], 'or')}",
    ]
    return (
        f"write {name} with your own numbers: {json.dumps(json.loads(full))}; {', '.join(choices)}"
    )


def _support(stiffness: float) -> str:
    return "null (clamp bolted to the baseplate)" if stiffness == FIXED else f"{stiffness:g}"


_NEAR, _FAR = (-0.2, 0.3), (-0.35, 0.5)
"""Logarithm of mean over kinetic torque [-]: of a fit that it can be, and of all that it can be;
assumed."""


def with_inferred_conditions(recording: Recording, rig: Rig) -> Recording:
    """Return a recording whose missing conditions are inferred from its signals.

    Parameters
    ----------
    recording : Recording
        Calibrated, named as its file.
    rig : Rig

    Returns
    -------
    Recording
        With speed, interference and support stiffness, and a note on each that was taken.

    Raises
    ------
    ParameterError
        Something is not stated, and nothing tells it; the message holds the sidecar to write.

    Examples
    --------
    >>> from models.condition import Condition
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> at = {"interference": 0.279e-3, "support_stiffness": 3745.0}
    >>> run = simulate(rig, 1.0, **at, seconds=0.4).recording
    >>> stated = Condition(speed=1.0, support_stiffness=3745.0)
    >>> told = with_inferred_conditions(replace(run, condition=stated), rig)
    >>> told.condition.interference
    0.000279
    >>> told.notes[0]
    'interference taken as 0.279 mm: the mean torque of ... N m fits none of the others'
    """
    at, notes, unclear = recording.condition, list(recording.notes), ""
    supports = supports_of(rig)
    if at.support_stiffness is None and len(supports) == 1:
        at = replace(at, support_stiffness=supports[0])
    if at.interference is None and len(rig.fits) == 1:
        at = replace(at, interference=rig.fits[0].interference)
    angle, torque = recording.first("angle"), recording.first("torque")
    if not at.speed and angle is not None:
        late = recording.samples[angle][recording.samples.shape[1] // 2 :]  # a start lies before
        if speed := as_logged(measured_speed(late, recording.rate), None):
            at = replace(at, speed=speed)
            notes.append(f"speed taken as {speed:g} rad/s: the angle's")
    if at.interference is None and torque is not None:
        mean = abs(float(recording.samples[torque].mean()))
        near, unclear = _fit_of_torque(mean, rig)
        if not unclear:
            at = replace(at, interference=near)
            notes.append(
                f"interference taken as {_mm(near)}: the mean torque of {mean:.3g} N m fits none "
                "of the others"
            )
    lacking = [
        name
        for name, value in (
            ("speed_rad_s", at.speed), ("interference_mm", at.interference),
            ("support_stiffness_Nm_rad", at.support_stiffness),
        )
        if not value
    ]  # fmt: skip
    if lacking:
        request = sidecar_request(
            replace(recording, condition=at), [fit.interference for fit in rig.fits], supports
        )
        why = unclear or "neither angle nor torque tells it"
        raise ParameterError(f"states no {', '.join(lacking)}, and {why}; {request}")
    return replace(recording, condition=at, notes=tuple(notes))


def supports_of(rig: Rig) -> list[float]:
    """Return the supports in a rig file.

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    list of float
        Stiffnesses [Nm/rad] or `models.condition.FIXED`: those whose responses were measured, or
        else those at which damping is given.
    """
    known = [entry.support_stiffness for entry in rig.measured]
    return sorted(set(known) or {support for fit in rig.fits for support in fit.damping})


def _fit_of_torque(mean: float, rig: Rig) -> tuple[float, str]:
    """Return the interference whose kinetic torque alone a mean torque is near, or why none is."""
    away = {
        fit.interference: float(np.log((mean + 1e-12) / fit.kinetic_torque)) for fit in rig.fits
    }
    near = [fit for fit, by in away.items() if _NEAR[0] < by < _NEAR[1]]
    possible = [fit for fit, by in away.items() if _FAR[0] < by < _FAR[1]]
    if len(near) == len(possible) == 1:
        return near[0], ""
    each = ", ".join(f"{_mm(f.interference)} {f.kinetic_torque:.3g}" for f in rig.fits)
    fits = "several fits" if len(possible) > 1 else "no fit clearly"
    return 0.0, f"the mean torque of {mean:.3g} N m fits {fits} ({each} N m)"


def _mm(interference: float) -> str:
    return f"{1e3 * interference:.4g} mm"


_SAME = 1e-3
"""Relative difference up to which two fits or supports are the same; rounding of what files state;
assumed."""


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
    estimated_noise : tuple of str
        Kinds of channel whose noise the rig file does not state and the recordings show.
    """

    rig: Rig
    names: tuple[str, ...]
    recordings: tuple[Recording, ...]
    refused: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()
    misplaced: str = ""
    estimated_noise: tuple[str, ...] = ()


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
            recording = usable(read_recording(path), rig)
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
    alive, dead = without_dead_channels(names, recordings)
    if any(left is not None for left in alive):  # else the check says it
        faults = [*dead, *faults]
        pairs = list(zip(names, alive, strict=True))
        refused += [(name, "all its channels are dead") for name, left in pairs if left is None]
        names = [name for name, left in pairs if left is not None]
        recordings = [left for _, left in pairs if left is not None]
    misplaced = misplaced_torque(recordings, rig)
    known, ready, notes, left_out = prepared(rig, recordings)
    refused += [(names[i], reason) for i, reason in left_out.items()]
    retained = tuple(name for i, name in enumerate(names) if i not in left_out)
    estimated = tuple(
        kind
        for kind, sensor in known.sensors.by_kind.items()
        if rig.sensors.of(kind).noise is None and sensor.noise is not None
    )
    return Case(known, retained, ready, tuple(refused), notes, tuple(faults), misplaced, estimated)


def usable(recording: Recording, rig: Rig) -> Recording:
    """Return the part of a recording that the diagnosis can use.

    What its condition does not state is taken from angle and torque, where these tell it, and
    interference and support where the rig has only one.

    Raises
    ------
    ParameterError
        What it lacks.
    """
    refuse_unusable(recording, shortest(recording.rate))
    if all(recording.first(kind) is None for kind in KINDS):
        raise ParameterError(f"has no channel of {', '.join(KINDS)}")
    recording = with_inferred_conditions(recording, rig)
    condition = known_condition(recording.condition)
    interference, support = condition.interference, condition.support_stiffness
    low, high = rig.interference_range
    if not low * (1.0 - _SAME) <= interference <= high * (1.0 + _SAME):
        unit = length_unit(interference, low, high)
        wanted = f"; is it in {unit}?" if unit else ""
        raise ParameterError(
            f"interference_mm = {1e3 * interference:g} lies outside the fits of the rig file, "
            f"{1e3 * low:g} to {1e3 * high:g}{wanted}"
        )
    known = [m.support_stiffness for m in rig.measured]
    if known and not any(same_support(support, k) for k in known):
        raise ParameterError(
            f"support_stiffness_Nm_rad = {support:g} has no measured_response in the rig file; "
            f"it has {', '.join(f'{k:g}' for k in known)}"
        )
    return replace(recording, condition=condition)
