# mypy: allow-untyped-decorators
"""Slips of a long torque: `features.kernels.slip_drops` in passes over its pieces.

Each pass needs what the one before it found: which way the torque is turned, how large a drop has
to be, where drops begin and end, how long falls take, how steep rises are.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from features.kernels.conditioning import NOTHING
from features.kernels.slip_drops import (
    DROP_SHARE,
    FALLEN,
    LEAST_SLIPS,
    SLOW,
    SMOOTHING,
    TorqueSlips,
    alternates,
    described_slips,
    no_slips,
    slope_ends,
    sudden_falls,
    upright_sign,
)
from features.long.sums import Moments
from features.long.turning_points import Smoother, TurningPoints
from models.compilation import COMPILED

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from features.long.parts import Pieces

__all__ = ["long_torque_slips"]

_BINS = 1 << 17
"""Of the counts from which percentiles are taken."""


def long_torque_slips(pieces: Pieces, n_samples: int, rate: float) -> TorqueSlips:
    """Find the slips in a torque that comes piece by piece.

    Parameters
    ----------
    pieces : callable
        Gives the pieces anew at each call, each of shape (n,) [N m].
    n_samples : int
        Of all pieces together.
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    TorqueSlips

    Examples
    --------
    >>> t = np.arange(30000) / 30e3
    >>> torque = 8.0 + 2.7 * ((150.0 * t) % 1.0)
    >>> slips = long_torque_slips(lambda: iter(np.split(torque, 3)), 30000, 30e3)
    >>> round(slips.rate), round(slips.mean_drop, 1), round(slips.stick_slope)
    (149, 2.5, 405)
    """
    raw, smooth, slow, fast, steps = (Moments() for _ in range(5))
    for piece in pieces():
        raw.add(piece)
    if raw.highest - raw.lowest <= NOTHING * max(abs(raw.lowest), abs(raw.highest)):
        return no_slips(math.nan)
    last = np.empty(0)
    for torque, running in _with_running_mean(pieces, n_samples, rate):
        smooth.add(torque)
        slow.add(running)
        fast.add(torque - running)
        steps.add(np.diff(torque, prepend=last))
        last = torque[-1:]
    sign = None
    if not alternates(slow.lowest, slow.highest, math.sqrt(fast.variance)):
        sign = upright_sign(smooth.mean, math.sqrt(smooth.variance), steps.skewness)

    def upright() -> Iterator[NDArray[np.float64]]:
        for torque, running in _with_running_mean(pieces, n_samples, rate):
            yield torque * (np.sign(running) if sign is None else sign)

    most = max(abs(smooth.lowest), abs(smooth.highest))
    (low, high), asymmetry = _range(upright(), most)
    points = TurningPoints(max(DROP_SHARE * (high - low), 1e-300))
    for torque in upright():
        points.add(torque)
    if points.peaks.size < LEAST_SLIPS:
        return no_slips(asymmetry)
    return _described(upright, points, n_samples, rate, asymmetry)


def _described(
    upright: Pieces, points: TurningPoints, n_samples: int, rate: float, asymmetry: float
) -> TorqueSlips:
    peaks, troughs, heights, depths = points.peaks, points.troughs, points.heights, points.depths
    falls, beside = np.zeros(peaks.size), np.zeros((peaks.size, 2))
    levels = heights - FALLEN * (heights - depths)
    for first, _, torque in _numbered(upright()):
        _time_falls(torque, first, peaks, levels, troughs, falls, beside)
    sudden = sudden_falls(falls, peaks, troughs)
    if np.count_nonzero(sudden) < max(LEAST_SLIPS, 0.5 * sudden.size):
        return no_slips(asymmetry)
    kept = np.flatnonzero(sudden)
    ends = np.append(kept[1:], peaks.size)
    lowest = np.array([k + int(depths[k:e].argmin()) for k, e in zip(kept, ends, strict=True)])
    peaks, heights, beside = peaks[kept], heights[kept], beside[kept]
    troughs, depths = troughs[lowest], depths[lowest]
    drops = heights - depths
    drops = drops[:-1] if troughs[-1] == n_samples - 1 else drops
    start, middle, late = slope_ends(peaks, troughs)
    slopes = []
    for begin, end in ((start, middle), (middle, late), (start, late)):
        sums = np.zeros((begin.size, 2))
        slopes.append((begin, end, sums))
    for first, fresh, torque in _numbered(upright()):
        for begin, end, sums in slopes:
            _sum_rises(torque, first, fresh, begin, end, heights, sums)
    return described_slips(
        peaks,
        _exact(peaks, heights, beside),
        troughs,
        drops,
        [_slope((end - begin + 1).astype(np.float64), sums) for begin, end, sums in slopes],
        n_samples=n_samples,
        rate=rate,
        asymmetry=asymmetry,
    )


def _with_running_mean(
    pieces: Pieces, n_samples: int, rate: float
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Yield the smoothed torque, and its running mean that shows which way the shaft turns."""
    smoother = Smoother.gaussian(SMOOTHING * rate, 4.0)
    running = Smoother.mean(min(round(SLOW * rate), n_samples))
    held = np.empty(0)
    for piece in pieces():
        smooth = smoother.add(piece)
        held, slow = np.concatenate([held, smooth]), running.add(smooth)
        if slow.size:
            yield held[: slow.size], slow
            held = held[slow.size :]
    smooth = smoother.finish()
    slow = np.concatenate([running.add(smooth), running.finish()])
    yield np.concatenate([held, smooth]), slow


def _range(
    upright: Iterator[NDArray[np.float64]], most: float
) -> tuple[tuple[float, float], float]:
    """5th and 95th percentile of a torque, and the skewness of its steps."""
    counts, steps, last = np.zeros(_BINS), Moments(), np.empty(0)
    for torque in upright:
        steps.add(np.diff(torque, prepend=last))
        last = torque[-1:]
        place = ((torque / most + 1.0) * (0.5 * _BINS)).astype(np.intp)
        counts += np.bincount(np.clip(place, 0, _BINS - 1), minlength=_BINS)
    below = np.append(0.0, np.cumsum(counts))
    edges = most * np.linspace(-1.0, 1.0, _BINS + 1)
    low, high = np.interp(np.array([0.05, 0.95]) * below[-1], below, edges).tolist()
    return (low, high), steps.skewness


def _numbered(
    pieces: Iterator[NDArray[np.float64]],
) -> Iterator[tuple[int, int, NDArray[np.float64]]]:
    """Yield pieces that begin two samples early: the numbers of their first and first new one."""
    fresh, last = 0, np.empty(0)
    for piece in pieces:
        longer = np.concatenate([last, piece])
        yield fresh - last.size, fresh, longer
        fresh += piece.size
        last = longer[-2:]


def _exact(
    peaks: NDArray[np.intp], heights: NDArray[np.float64], beside: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Where the parabolas through three samples are highest."""
    left, right = beside.T
    curvature = left - 2.0 * heights + right
    safe = np.where(curvature < 0.0, curvature, -1.0)
    return np.asarray(peaks + np.where(curvature < 0.0, 0.5 * (left - right) / safe, 0.0))


def _slope(n: NDArray[np.float64], sums: NDArray[np.float64]) -> NDArray[np.float64]:
    """Least-squares slope over `n` samples from their sum and first moment; NaN below three."""
    spread = np.where(n > 2, n * (n**2 - 1.0) / 12.0, np.nan)
    return np.asarray((sums[:, 1] - 0.5 * (n - 1.0) * sums[:, 0]) / spread)


@njit(cache=True, **COMPILED)
def _time_falls(
    torque: NDArray[np.float64],
    first: int,
    peaks: NDArray[np.intp],
    levels: NDArray[np.float64],
    troughs: NDArray[np.intp],
    falls: NDArray[np.float64],
    beside: NDArray[np.float64],
) -> None:
    """Count the samples until each level is reached; note the samples beside each maximum."""
    end = first + torque.size
    for k in range(np.searchsorted(troughs, first), peaks.size):
        if peaks[k] >= end:
            break
        if peaks[k] - 1 >= first and peaks[k] + 1 < end:
            beside[k, 0], beside[k, 1] = torque[peaks[k] - 1 - first], torque[peaks[k] + 1 - first]
        if falls[k] > 0.0:
            continue
        for i in range(max(peaks[k], first), min(troughs[k] + 1, end)):
            if torque[i - first] <= levels[k]:
                falls[k] = i - peaks[k]
                break


@njit(cache=True, **COMPILED)
def _sum_rises(
    torque: NDArray[np.float64],
    first: int,
    fresh: int,
    begin: NDArray[np.intp],
    end: NDArray[np.intp],
    about: NDArray[np.float64],
    sums: NDArray[np.float64],
) -> None:
    """Sum up what is new of a torque about a level, and its moment, from each begin to each end."""
    stop = first + torque.size
    for k in range(np.searchsorted(end, fresh), begin.size):
        if begin[k] >= stop:
            break
        for i in range(max(begin[k], fresh), min(end[k] + 1, stop)):
            off = torque[i - first] - about[k]
            sums[k, 0] += off
            sums[k, 1] += (i - begin[k]) * off
