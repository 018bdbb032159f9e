"""Rotation of the shaft: angles that start again after a turn, and speeds beside logged ones.

An encoder gives 0 to 2 pi, 0 to 360 degrees, or counts from 0 up to where its counter overflows.
Where the step from one sample to the next differs by more than 2 rad from the usual step, the angle
jumps. Jumps that all have the size of the same number of whole turns, or of which there are three
or more of one size, are a counter that starts again; any others are said and left as they are.

Usual steps are taken from stretches that do not depend on how a file is read, so that a part of a
recording is the same, bit for bit, whether the whole is read or not.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from models.recording import Channel

_JUMP = 2.0
"""Off the usual step [rad]."""

_STRETCH = 1 << 16
"""Samples of which the median step is the usual one."""

_AS_LOGGED = 0.005
"""A measured speed that is off by no more is the one that was logged [-]."""

_DIGITS = 4
"""Of a measured speed, of which an angle tells no more."""

_TURN = 2.0 * math.pi
_NEAR = 0.1  # of a turn, by which jumps of whole turns may be off: the speed changes meanwhile
_ALIKE = 0.02  # share by which jumps of one counter may differ
_MANY = 3  # jumps of one size that are a counter, whatever the size


@dataclass(frozen=True, eq=False)
class Unwrapping:
    """What has to be added to the angles of a recording.

    Parameters
    ----------
    jumps : tuple of (int, ndarray of shape (n,), ndarray of shape (n,))
        Row; number of the sample after each jump; what is added from there on [rad].
    notes : tuple of str
    """

    jumps: tuple[tuple[int, NDArray[np.int64], NDArray[np.float64]], ...]
    notes: tuple[str, ...]

    def add(self, samples: NDArray[np.float64], first: int) -> None:
        """Let angles go on, in place, in samples of shape (n_channels, n) from number `first`."""
        for row, places, added in self.jumps:
            number = np.searchsorted(places, first + np.arange(samples.shape[1]), side="right")
            samples[row] += np.concatenate([[0.0], added])[number]


def find_turns(
    channels: Sequence[Channel],
    read: Callable[[int, int], NDArray[np.float64]],
    n_samples: int,
    calibrated: bool,
) -> Unwrapping:
    """Find where the angles of a recording start again.

    Parameters
    ----------
    channels : sequence of Channel
    read : callable
        From first and last sample to those between them, shape (n_channels, n) [unit of each].
    n_samples : int
    calibrated : bool
        Angles that are not in radians are left alone.

    Examples
    --------
    >>> angle = np.mod(0.05 * np.arange(1000.0), 2.0 * np.pi)[np.newaxis]
    >>> found = find_turns([Channel("angle")], lambda a, b: angle[:, a:b], 1000, True)
    >>> found.add(angle, 0)
    >>> np.allclose(angle, 0.05 * np.arange(1000.0)), found.notes
    (True, ())
    """
    rows = [row for row, channel in enumerate(channels) if channel.kind == "angle" and calibrated]
    found: dict[int, list[tuple[NDArray[np.int64], NDArray[np.float64]]]] = {r: [] for r in rows}
    ends = np.linspace(0, n_samples - 1, max(1, n_samples // _STRETCH) + 1).astype(int).tolist()
    for start, end in pairwise(ends) if rows else ():
        samples = read(start, end + 1)
        for row in rows:
            step = np.diff(samples[row])
            off = step - np.median(step)
            at = np.flatnonzero(np.abs(off) > _JUMP)
            if at.size:
                found[row].append((start + 1 + at, off[at]))
    jumps, notes = [], []
    for row, parts in found.items():
        if not parts:
            continue
        places, sizes = (np.concatenate(part) for part in zip(*parts, strict=True))
        period, whole = _period(np.abs(sizes))
        if not period:
            notes.append(
                f"{channels[row].name} jumps by {sizes[0]:.4g} rad at sample {places[0]}"
                f"{f' and at {sizes.size - 1} more' * (sizes.size > 1)}, which are no whole turns; "
                "a speed from it is wrong there"
            )
            continue
        if not whole:
            notes.append(
                f"{channels[row].name} starts again after {period:.4g} rad, which are no whole "
                "turns, and is made to go on; is it in rad?"
            )
        jumps.append((row, places, np.cumsum(-np.sign(sizes) * period)))
    return Unwrapping(tuple(jumps), tuple(notes))


def _period(sizes: NDArray[np.float64]) -> tuple[float, bool]:
    """After how much an angle starts again [rad], 0 where it jumps otherwise; if it is turns."""
    turns = round(float(np.median(sizes)) / _TURN)
    if turns and bool(np.all(np.abs(sizes / _TURN - turns) < _NEAR)):
        return turns * _TURN, True
    mean = float(sizes.mean())
    alike = bool(np.all(np.abs(sizes - mean) < _ALIKE * mean))
    return (mean if alike and sizes.size >= _MANY else 0.0), False


def agrees(measured: float, logged: float) -> bool:
    """Whether a measured speed is the one that was logged, whatever the sense of rotation.

    Parameters
    ----------
    measured, logged : float
        [rad/s]

    Examples
    --------
    >>> agrees(-4.999989, 5.0), agrees(10.0, 5.0)
    (True, False)
    """
    return abs(abs(measured) - abs(logged)) <= _AS_LOGGED * abs(logged)


def as_logged(measured: float, logged: float | None) -> float:
    """Return a measured speed as it is written.

    Parameters
    ----------
    measured : float
        [rad/s]
    logged : float or None
        [rad/s]; ``None`` where none was.

    Returns
    -------
    float
        The logged one with the sign of the measured one where they agree, else the measured one
        with as many digits as a channel tells [rad/s].

    Examples
    --------
    >>> as_logged(-4.999989, 5.0), as_logged(10.00002, 5.0), as_logged(4.999989, None)
    (-5.0, 10.0, 5.0)
    """
    if logged is not None and agrees(measured, logged):
        return math.copysign(logged, measured)
    return float(f"{measured:.{_DIGITS}g}")
