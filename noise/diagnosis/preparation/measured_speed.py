"""The speed that recordings were made at, by the shaft's angle.

A sidecar says what was set. Recordings of one stated condition are repeats of each other and get
one speed, the mean of theirs: what they differ by is what repeats differ by.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.condition import known_condition

if TYPE_CHECKING:
    from models.recording import Recording


FARTHEST = 0.08
"""Relative difference from which an angle's speed is no correction of the one that is stated but
says that one of the two is wrong [-]; assumed."""

_OFF = 0.005
"""Relative difference from which a stated speed is off [-]; runs of one speed differ by as much;
assumed."""


def measured_speed(angle: NDArray[np.float64], rate: float) -> float:
    """Mean speed of a shaft [rad/s].

    Parameters
    ----------
    angle : ndarray, shape (n,)
        [rad]
    rate : float
        Sampling rate [Hz].

    Examples
    --------
    >>> round(measured_speed(np.linspace(0.0, 2.0, 30_001), 30e3), 6)
    2.0
    """
    n = max(1, angle.size // 20)  # ends that noise and steps are averaged over
    turned = angle[-n:].mean() - angle[:n].mean()
    return float(turned * rate / max(angle.size - n, 1))


def at_measured_speeds(
    recordings: Sequence[Recording],
) -> tuple[tuple[Recording, ...], tuple[str, ...]]:
    """Return recordings with the speed in their conditions that their angles have.

    Parameters
    ----------
    recordings : sequence of Recording
        With speed, interference and support stiffness in their conditions.

    Returns
    -------
    recordings : tuple of Recording
        Those without an angle, or whose angle turns as stated or at quite another speed, are
        themselves.
    notes : tuple of str
        By how much the stated speeds were off, if that is worth telling.

    Examples
    --------
    >>> from models.condition import KnownCondition
    >>> from models.recording import Channel, Recording
    >>> angle = 1.02 * np.arange(30_000)[None] / 30e3
    >>> at = KnownCondition(1.0, 0.279e-3, 3745.0)
    >>> runs, notes = at_measured_speeds([Recording(angle, 30e3, (Channel("angle"),), at)])
    >>> round(runs[0].condition.speed, 6), notes
    (1.02, ('the shaft turns up to 2 % faster than stated; its angle counts',))
    """
    speeds: dict[tuple[object, ...], list[float]] = {}
    stated = [known_condition(recording.condition) for recording in recordings]
    for recording, at in zip(recordings, stated, strict=True):
        row = recording.first("angle")
        if row is not None:
            speed = measured_speed(recording.samples[row], recording.rate)
            if at.speed and abs(speed / at.speed - 1.0) <= FARTHEST:
                speeds.setdefault(_stated(recording), []).append(speed)
    found, off = [], [0.0]
    for recording, at in zip(recordings, stated, strict=True):
        if _stated(recording) in speeds:
            speed = float(np.mean(speeds[_stated(recording)]))
            by = speed / at.speed - 1.0
            if abs(by) > _OFF:
                off.append(by)
                recording = replace(recording, condition=replace(at, speed=speed))
        found.append(recording)
    return tuple(found), tuple(_told(off))


def _stated(recording: Recording) -> tuple[object, ...]:
    at = known_condition(recording.condition)
    return at.speed, at.interference, at.support_stiffness, at.material, at.temperature


def _told(off: Sequence[float]) -> list[str]:
    slower, faster = -min(off), max(off)
    said = [
        f"up to {100.0 * by:.2g} % {word}"
        for by, word in ((faster, "faster"), (slower, "slower"))
        if by > _OFF
    ]
    return [f"the shaft turns {' and '.join(said)} than stated; its angle counts"] if said else []
