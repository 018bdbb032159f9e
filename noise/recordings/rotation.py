"""Unwrapping of shaft angles, and comparison of measured with logged speeds.

Encoders give 0 to 2 pi, 0 to 360 degrees, or several turns. The angle jumps where the step between
two samples deviates by more than 2 rad from the median step. Jumps are unwrapped if all are the
same number of whole turns; other jumps are noted and left as they are.

Median steps are computed over fixed stretches of a file, so that a part of a recording is identical
bit for bit however it is read.
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
"""Deviation from the median step that is a jump [rad]."""

_STRETCH = 1 << 16
"""Length of a stretch with its own median step [samples]."""

_SPEED_TOLERANCE = 0.005
"""Largest relative difference at which measured and logged speed agree [-]."""

_DIGITS = 4
"""Significant digits of a speed that is measured from an angle."""

_TURN = 2.0 * math.pi
_NEAR = 0.1  # tolerance of whole turns [turns]: the speed changes during the jump


@dataclass(frozen=True, eq=False)
class Unwrapping:
    """Offsets that unwrap the angles of a recording.

    Parameters
    ----------
    jumps : tuple of (int, ndarray of shape (n,), ndarray of shape (n,))
        Row of the channel, index of the sample after each jump, and offset from there on [rad].
    notes : tuple of str
    """

    jumps: tuple[tuple[int, NDArray[np.int64], NDArray[np.float64]], ...]
    notes: tuple[str, ...]

    def add(self, samples: NDArray[np.float64], first: int) -> None:
        """Unwrap samples in place, shape (n_channels, n), from index `first` of the recording."""
        for row, indices, offsets in self.jumps:
            number = np.searchsorted(indices, first + np.arange(samples.shape[1]), side="right")
            samples[row] += np.concatenate([[0.0], offsets])[number]


def find_turns(
    channels: Sequence[Channel],
    read: Callable[[int, int], NDArray[np.float64]],
    n_samples: int,
    calibrated: bool,
) -> Unwrapping:
    """Find the jumps of the angles of a recording.

    Parameters
    ----------
    channels : sequence of Channel
    read : callable
        ``read(first, last)`` returns samples, shape (n_channels, last - first) [unit of each].
    n_samples : int
    calibrated : bool
        Angles without calibration are not unwrapped.

    Returns
    -------
    Unwrapping

    Examples
    --------
    >>> angle = np.mod(0.05 * np.arange(1000.0), 2.0 * np.pi)[np.newaxis]
    >>> unwrapping = find_turns([Channel("angle")], lambda a, b: angle[:, a:b], 1000, True)
    >>> unwrapping.add(angle, 0)
    >>> np.allclose(angle, 0.05 * np.arange(1000.0)), unwrapping.notes
    (True, ())
    """
    rows = [row for row, channel in enumerate(channels) if channel.kind == "angle" and calibrated]
    jumps_of: dict[int, list[tuple[NDArray[np.int64], NDArray[np.float64]]]] = {r: [] for r in rows}
    ends = np.linspace(0, n_samples - 1, max(1, n_samples // _STRETCH) + 1).astype(int).tolist()
    for start, end in pairwise(ends) if rows else ():
        samples = read(start, end + 1)
        for row in rows:
            step = np.diff(samples[row])
            deviation = step - np.median(step)
            at = np.flatnonzero(np.abs(deviation) > _JUMP)
            if at.size:
                jumps_of[row].append((start + 1 + at, deviation[at]))
    jumps, notes = [], []
    for row, parts in jumps_of.items():
        if not parts:
            continue
        indices, sizes = (np.concatenate(part) for part in zip(*parts, strict=True))
        turns = round(float(np.median(np.abs(sizes))) / _TURN)
        if not turns or np.any(np.abs(np.abs(sizes) / _TURN - turns) >= _NEAR):
            notes.append(
                f"{channels[row].name} jumps by {sizes[0]:.4g} rad at sample {indices[0]}"
                f"{f' and at {sizes.size - 1} more' * (sizes.size > 1)}, not by whole turns; "
                "speeds from it are wrong there"
            )
            continue
        jumps.append((row, indices, np.cumsum(-np.sign(sizes) * turns * _TURN)))
    return Unwrapping(tuple(jumps), tuple(notes))


def agrees(measured: float, logged: float) -> bool:
    """Whether measured and logged speed agree, regardless of the direction of rotation.

    Parameters
    ----------
    measured, logged : float
        [rad/s]

    Examples
    --------
    >>> agrees(-4.999989, 5.0), agrees(10.0, 5.0)
    (True, False)
    """
    return abs(abs(measured) - abs(logged)) <= _SPEED_TOLERANCE * abs(logged)


def as_logged(measured: float, logged: float | None) -> float:
    """Return a measured speed rounded for tables.

    Parameters
    ----------
    measured : float
        [rad/s]
    logged : float or None
        [rad/s]

    Returns
    -------
    float
        The logged speed with the sign of the measured one if they agree, otherwise the measured
        speed with four significant digits [rad/s].

    Examples
    --------
    >>> as_logged(-4.999989, 5.0), as_logged(10.00002, 5.0), as_logged(4.999989, None)
    (-5.0, 10.0, 5.0)
    """
    if logged is not None and agrees(measured, logged):
        return math.copysign(logged, measured)
    return float(f"{measured:.{_DIGITS}g}")
