"""Reader of a case: the recordings of one rig in a folder, and their usable channels.

A speed that a recording does not state is the angle's; an interference or support is taken where
the rig has only one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePath

from models.condition import FIXED, known_condition, same_support
from models.errors import BushingNoiseError, ParameterError, RecordingError
from models.recording import Recording
from models.rig import Rig
from noise.diagnosis.bench.channels import misplaced_torque
from noise.diagnosis.bench.check import refuse_unusable
from noise.diagnosis.bench.faults import clipped_channels, without_dead_channels
from noise.diagnosis.prepare import measured_speed, prepared
from noise.diagnosis.signature import KINDS
from noise.diagnosis.starts import shortest
from noise.recordings import find_recordings, read_recording
from noise.recordings.rotation import as_logged


def with_conditions(recording: Recording, rig: Rig) -> Recording:
    """Return a recording with the conditions that its angle and the rig tell where it states none.

    Parameters
    ----------
    recording : Recording
        Calibrated, named as its file.
    rig : Rig

    Returns
    -------
    Recording
        With speed, interference and support stiffness.

    Raises
    ------
    ParameterError
        Something is not stated, and nothing tells it; the message says what to write.

    Examples
    --------
    >>> import numpy as np
    >>> from models.condition import Condition
    >>> from models.recording import Channel
    >>> from models.rig_file import load_material_rig
    >>> import numpy as np
    >>> angle = Recording(np.arange(8000)[None] / 4e3, 8e3, (Channel("angle"),))
    >>> stated = Condition(interference=0.279e-3, support_stiffness=3745.0)
    >>> turned = with_conditions(
    ...     replace(angle, condition=stated), load_material_rig("fluorocarbon-thesis")
    ... )
    >>> turned.notes
    ("speed taken as 2 rad/s: the angle's",)
    """
    at, notes = recording.condition, recording.notes
    interferences = [fit.interference for fit in rig.fits]
    damped = {support for fit in rig.fits for support in fit.damping}
    supports = sorted({entry.support_stiffness for entry in rig.measured} or damped)
    if at.support_stiffness is None and len(supports) == 1:
        at = replace(at, support_stiffness=supports[0])
    if at.interference is None and len(interferences) == 1:
        at = replace(at, interference=interferences[0])
    angle = recording.first("angle")
    if not at.speed and angle is not None:
        late = recording.samples[angle][recording.samples.shape[1] // 2 :]  # a start lies before
        if speed := as_logged(measured_speed(late, recording.rate), None):
            at = replace(at, speed=speed)
            notes = (*notes, f"speed taken as {speed:g} rad/s: the angle's")
    wanted = {
        "speed_rad_s": ("" if at.speed else "rad/s"),
        "interference_mm": "" if at.interference else _choices(interferences, 1e3),
        "support_stiffness_Nm_rad": "" if at.support_stiffness else _choices(supports),
    }
    if lacking := {name: which for name, which in wanted.items() if which}:
        sidecar = PurePath(recording.name).with_suffix(".json").name if recording.name else "it"
        each = ", ".join(f'"{name}" ({which})' for name, which in lacking.items())
        raise ParameterError(
            f'states no {", ".join(lacking)}; write into {sidecar}, under "conditions": {each}'
        )
    return replace(recording, condition=at, notes=notes)


def _choices(values: Sequence[float], scale: float = 1.0) -> str:
    each = ["null: clamp fixed" if x == FIXED else f"{scale * x:.4g}" for x in values]
    return f"of the rig file: {', '.join(each)}"


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
        As `noise.diagnosis.prepare.prepared` gives them.
    refused : tuple of (str, str)
        Name and reason of what was left out.
    notes : tuple of str
        What was done to the recordings, a line each.
    faults : tuple of str
        Channels that are dead, and left out, or clip, one line each.
    unusable : tuple of str
        Findings, made before anything was cut, that all channels are dead or that another channel
        than the torque's holds the torque.
    estimated_noise : tuple of str
        Kinds of channel whose noise the rig file does not state and the recordings show.
    """

    rig: Rig
    names: tuple[str, ...]
    recordings: tuple[Recording, ...]
    refused: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()
    unusable: tuple[str, ...] = ()
    estimated_noise: tuple[str, ...] = ()

    @property
    def kinds(self) -> frozenset[str]:
        """Kinds of the recorded channels."""
        return frozenset(channel.kind for one in self.recordings for channel in one.channels)


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
            refused.append((name, str(error).removeprefix(f"{path}: ")))
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
    unusable = tuple(dead)
    if any(left is not None for left in alive):
        faults = [*dead, *faults]
        pairs = list(zip(names, alive, strict=True))
        refused += [(name, "all its channels are dead") for name, left in pairs if left is None]
        names = [name for name, left in pairs if left is not None]
        recordings = [left for _, left in pairs if left is not None]
        unusable = tuple(filter(None, [misplaced_torque(recordings, rig)]))
    known, ready, notes, left_out = prepared(rig, recordings)
    refused += [(names[i], reason) for i, reason in left_out.items()]
    retained = tuple(name for i, name in enumerate(names) if i not in left_out)
    estimated = tuple(
        kind
        for kind, sensor in known.sensors.by_kind.items()
        if rig.sensors.of(kind).noise is None and sensor.noise is not None
    )
    return Case(known, retained, ready, tuple(refused), notes, tuple(faults), unusable, estimated)


def usable(recording: Recording, rig: Rig) -> Recording:
    """Return the part of a recording that the diagnosis can use.

    Raises
    ------
    ParameterError
        What it lacks.
    """
    refuse_unusable(recording, shortest(recording.rate))
    if all(recording.first(kind) is None for kind in KINDS):
        raise ParameterError(f"has no channel of {', '.join(KINDS)}")
    recording = with_conditions(recording, rig)
    condition = known_condition(recording.condition)
    interference, support = condition.interference, condition.support_stiffness
    low, high = rig.interference_range
    if not low * (1.0 - _SAME) <= interference <= high * (1.0 + _SAME):
        raise ParameterError(
            f"interference_mm = {1e3 * interference:g} lies outside the fits of the rig file, "
            f"{1e3 * low:g} to {1e3 * high:g} mm"
        )
    known = [m.support_stiffness for m in rig.measured]
    if known and not any(same_support(support, k) for k in known):
        raise ParameterError(
            f"support_stiffness_Nm_rad = {support:g} has no measured_response in the rig file; "
            f"it has {', '.join(f'{k:g}' for k in known)}"
        )
    return replace(recording, condition=condition)
