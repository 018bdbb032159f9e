"""Recordings of torque and shaft angle for an identification, and prior knowledge of the rig.

Prior knowledge is what the rig file states itself, without defaults.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.fft import irfft, rfft, rfftfreq

from models.change import changed_rig
from models.condition import KnownCondition
from models.errors import BushingNoiseError, ParameterError
from models.recording import Recording
from models.rig import Rig
from models.rig_file import read_toml, rig_from, shipped_name
from models.show import short_repr
from noise.base.arrays import Array
from noise.diagnosis.bench.check import refuse_unusable, speed_words
from noise.diagnosis.evidence.reconstruction import LEAD, TAIL, closed_loop
from noise.identification.bushing_fit import Known
from noise.recordings import find_recordings, read_recording
from noise.recordings.rotation import as_logged

_STATED_ERROR = 0.02
"""Relative standard error of a stated number: the scatter of bushings; assumed."""

_GUESSED_ERROR = 0.5
"""Relative standard error of a number that is not stated; assumed."""


@dataclass(frozen=True)
class Beforehand:
    """Prior knowledge of a rig.

    Parameters
    ----------
    rig : Rig
        Rig of the file, with the shipped bench as default.
    known : Known
    stated : frozenset of str
        Keys of the file and of files that it is based on.
    structure : str, optional
        Rig file, if it may have a structure or sensors of its own.
    """

    rig: Rig
    known: Known
    stated: frozenset[str]
    structure: str | None = None

    @property
    def inertias_stated(self) -> bool:
        """Whether both inertias are stated."""
        return {"elastomer_inertia_kgm2", "clamp_inertia_kgm2"} <= self.stated


def known_beforehand(
    path: Path | None, change: Mapping[str, str | float] | None = None
) -> Beforehand:
    """Read the prior knowledge in a rig file.

    Parameters
    ----------
    path : Path, optional
        Without one, only the sidecars of the recordings count.
    change : mapping of str to str or float, optional
        As ``[change]`` of the file.

    Raises
    ------
    ParameterError
        The file cannot be used.

    Examples
    --------
    >>> known_beforehand(None).inertias_stated
    False
    """
    where = f"rig file {path}"
    content = {} if path is None else read_toml(path, where)
    folder = Path() if path is None else path.parent
    rig = changed_rig(rig_from(content, folder, where), change or {}, "--change")
    stated = frozenset(_stated(content, folder) | _stated({"change": change or {}}, folder))
    shared = "elastomer_damping_share" in stated
    share = rig.elastomer_damping_share if shared else 0.5
    both = {"elastomer_inertia_kgm2", "clamp_inertia_kgm2"} <= stated
    error = _STATED_ERROR if both else _GUESSED_ERROR
    return Beforehand(
        rig,
        Known(
            rig.elastomer_inertia,
            rig.clamp_inertia,
            error,
            share,
            _STATED_ERROR if shared else _GUESSED_ERROR,
        ),
        stated,
        str(path.resolve().as_posix()) if path is not None and stated & _STRUCTURE else None,
    )


_STRUCTURE = {"base", "beams", "plate", "microphone", "measured_response", "sensors"}


def _stated(content: Mapping[str, Any], folder: Path) -> set[str]:
    """Return the keys of a file, of its changes, and of the files that it is based on."""
    changed = {
        f"{key}_kgm2" if key.endswith("inertia") else key for key in content.get("change", {})
    }
    base = content.get("base")
    if base is None or shipped_name(base) is not None:
        return {*content, *changed}
    path = folder / base
    return {*content, *changed, *_stated(read_toml(path, f"rig file {path}"), path.parent)}


SHORTEST = LEAD + TAIL + 0.1
"""Shortest usable recording [s]: shorter ones have too few cycles; assumed."""

LEAST_TURN = 0.02
"""Smallest rotation of the shaft [rad]: less is rest, or degrees declared as radians; assumed."""

_SPEED_BAND = 25.0
"""Corner of the low-pass filter of the shaft's speed [Hz], below an encoder's noise; assumed."""


@short_repr
@dataclass(frozen=True, eq=False)
class Measured:
    """Recording prepared for an identification.

    Parameters
    ----------
    name : str
        Name of the file.
    recording : Recording
        With a known condition.
    torque : ndarray, shape (n,)
        Of the cell, positive along the rotation [Nm].
    shaft_speed : ndarray, shape (n,)
        Positive [rad/s].
    logged_speed : float, optional
        Set speed in the sidecar [rad/s].
    """

    name: str
    recording: Recording
    torque: Array
    shaft_speed: Array
    logged_speed: float | None = None

    @property
    def condition(self) -> KnownCondition:
        """Known condition."""
        condition = self.recording.condition
        assert isinstance(condition, KnownCondition)  # `measured` made it so
        return condition

    @property
    def written_speed(self) -> float:
        """Speed for files: the logged one if the shaft turned at it [rad/s]."""
        return as_logged(self.condition.speed, self.logged_speed)

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.recording.rate


def read_measurements(paths: Sequence[Path]) -> tuple[list[Measured], list[tuple[str, str]]]:
    """Read the recordings in files and folders.

    Parameters
    ----------
    paths : sequence of Path

    Returns
    -------
    used : list of Measured
        Recordings of rotation.
    refused : list of (str, str)
        Name and reason of each recording that is left out.

    Raises
    ------
    ParameterError
        There is no recording at all.
    """
    used, refused = [], []
    for path, name in find_recordings(paths):
        try:
            used.append(measured(read_recording(path), name))
        except BushingNoiseError as error:
            refused.append((name, str(error).removeprefix(f"{path}: ")))
    if not (used or refused):
        raise ParameterError(f"{', '.join(str(path) for path in paths)}: no recording")
    return used, refused


def measured(recording: Recording, name: str) -> Measured:
    """Prepare a recording for an identification.

    Parameters
    ----------
    recording : Recording
    name : str
        Name of its file.

    Returns
    -------
    Measured

    Raises
    ------
    ParameterError
        The recording lacks something, as the message says.
    """
    refuse_unusable(recording, SHORTEST)
    rows = {kind: recording.first(kind) for kind in ("torque", "angle", "speed")}
    turning = rows["angle"] if rows["angle"] is not None else rows["speed"]
    if rows["torque"] is None or turning is None:
        lacking = "torque [N m]" if rows["torque"] is None else "angle [rad] or speed [rad/s]"
        raise ParameterError(
            f"has no channel of {lacking}; a rig is identified from the torque of the cell and the "
            "shaft's angle"
        )
    torque = np.asarray(recording.samples[rows["torque"]], dtype=np.float64)
    course = np.asarray(recording.samples[turning], dtype=np.float64)
    if not (np.isfinite(torque).all() and np.isfinite(course).all()):
        raise ParameterError("holds samples of torque or angle that are no numbers")
    speed = course if rows["angle"] is None else shaft_speed(course, recording.rate)
    mean = float(np.mean(speed))
    if abs(mean) * recording.duration < LEAST_TURN:
        raise ParameterError(
            f"turns by {abs(mean) * recording.duration:.2g} rad; {LEAST_TURN:g} rad at least, at a "
            "speed of one sign"
        )
    if np.min(speed / mean) <= 0.0:
        raise ParameterError("turns back and forth, or stops; record rotation of one sign")
    stated = abs(recording.condition.speed or 0.0)
    if stated and (words := speed_words(abs(mean) / stated, stated)):
        raise ParameterError(words)
    speed = np.abs(speed)
    if (
        float(np.mean(torque)) < 0.0
    ):  # the shaft turned backwards, or the sign of the cell is reversed
        torque = -torque
    if float(np.ptp(torque)) == 0.0:
        raise ParameterError("has a torque that never changes; is the cell connected?")
    c = recording.condition
    if c.interference is None or c.support_stiffness is None:
        what = "interference_mm" if c.interference is None else "support_stiffness_Nm_rad"
        raise ParameterError(f"states no {what}; give it under conditions of the sidecar")
    known = KnownCondition(
        float(np.mean(speed)), c.interference, c.support_stiffness, c.material, c.temperature
    )
    return Measured(name, replace(recording, condition=known), torque, speed, c.speed)


def shaft_speed(angle: Array, rate: float) -> Array:
    """Return the low-pass filtered speed of the shaft from its angle.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        [rad]
    rate : float
        [Hz]

    Returns
    -------
    ndarray, shape (n,)
        [rad/s]

    Examples
    --------
    >>> shaft_speed(2.0 * np.arange(9000) / 30e3, 30e3)[[0, -1]].round(6)
    array([2., 2.])
    """
    t = np.arange(angle.size) / rate
    t -= t.mean()
    course = np.polynomial.Polynomial.fit(t, angle, 3)
    rest = closed_loop(angle - course(t), rate)
    frequency = rfftfreq(rest.size, 1.0 / rate)
    low_pass = 1.0 / (1.0 + (frequency / _SPEED_BAND) ** 4)
    slow = irfft(rfft(rest) * low_pass * 2j * np.pi * frequency, rest.size)[: angle.size]
    return np.asarray(course.deriv()(t) + slow)
