"""Start of a recording, in which the shaft comes to its speed.

A start is a deviation from the later speed that exists at the beginning, ends, and is several times
larger than all later deviations. It is detected from the angle, which is read where it crosses the
steps of its converter, so that a coarse converter is as accurate as a fine one. A torque that rises
from zero shows a start from rest.
"""

from __future__ import annotations

import numpy as np

from models.recording import Recording
from noise.base.arrays import Array

_BLOCK, _LAG = 5e-3, 2
"""Length of the blocks over which an angle is averaged [s], and number of blocks on either side for
the slope that is the speed; assumed."""

_LATE = 0.6
"""Share of a recording after which every start has ended [-]; assumed."""

_EARLY = 0.08
"""Time from the beginning within which a start is visible [s], at least a quarter of the slowest
swing of a controller; assumed."""

_SMALLEST, _LARGER = 0.04, 4.0
"""Least relative deviation of the speed in a start, and its least ratio to later deviations [-];
assumed."""

_OVER = 0.012
"""Largest relative deviation of a settled speed [-]; assumed."""

_FEWEST_LEVELS = 8
"""Least number of converter levels of an angle for interpolation between them; assumed."""

_FROM_ZERO = 0.25
"""Largest initial torque of a start from rest, as a share of the lowest later torque [-];
assumed."""


def start_of(recording: Recording) -> float:
    """Return the time at which the shaft of a recording reaches its speed; 0 without a start [s].

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> even = np.linspace(0.0, 1.0, 30_000)[None]
    >>> start_of(Recording(even, 30e3, (Channel("angle"),)))
    0.0
    """
    by_angle = by_torque = 0.0
    if (row := recording.first("angle")) is not None:
        by_angle = _start_by_angle(recording.samples[row], recording.rate)
    if (row := recording.first("torque")) is not None:
        by_torque = _start_from_zero(recording.samples[row], recording.rate)
    return max(by_angle, by_torque)


def _start_by_angle(angle: Array, rate: float) -> float:
    """Return the time at which the speed of an angle settles; 0 without a start [s]."""
    block = max(1, round(_BLOCK * rate))
    n = angle.size // block
    if n < 8 * _LAG:
        return 0.0
    turned = _continuous(angle * (1.0 if angle[-1] >= angle[0] else -1.0))
    means = turned[: n * block].reshape(n, block).mean(axis=1)
    at = np.arange(n)
    after, before = np.minimum(at + _LAG, n - 1), np.maximum(at - _LAG, 0)
    speed = (means[after] - means[before]) / (after - before)
    first_late = round(_LATE * n)
    late = speed[first_late:].mean()
    if late <= 0.0:
        return 0.0
    away = np.abs(speed / late - 1.0)
    beyond = np.maximum.accumulate(away[::-1])[::-1]  # largest deviation from each block on
    settled = int(np.argmax(beyond <= max(_OVER, 1.2 * beyond[first_late])))
    limit = max(_SMALLEST, _LARGER * beyond[settled])
    early = away[: round(_EARLY / _BLOCK)].max()
    if settled == 0 or away[:settled].max() < limit or early < 0.5 * limit:
        return 0.0
    return min((settled + _LAG) * block, angle.size) / rate


def _continuous(angle: Array) -> Array:
    """Return an angle interpolated linearly between the crossings of its converter's levels.

    The number of samples below a level is the time of its crossing, even if noise crosses it
    several times.
    """
    levels, count = np.unique(angle, return_counts=True)
    if levels.size > 0.5 * angle.size or levels.size < _FEWEST_LEVELS:
        return angle
    crossed = np.cumsum(count)[:-1] - 0.5
    between = 0.5 * (levels[1:] + levels[:-1])
    first, last = np.polyfit(crossed[:3], between[:3], 1), np.polyfit(crossed[-3:], between[-3:], 1)
    at = np.arange(angle.size)
    smooth = np.interp(at, crossed, between)
    before, after = at < crossed[0], at > crossed[-1]
    smooth[before], smooth[after] = np.polyval(first, at[before]), np.polyval(last, at[after])
    return np.asarray(smooth)


def _start_from_zero(torque: Array, rate: float) -> float:
    """Return the time at which a torque that begins at zero reaches its later range [s].

    The result is 0 if the torque does not begin at zero.
    """
    turned = torque * (1.0 if torque.mean() >= 0.0 else -1.0)
    late = turned[round(_LATE * turned.size) :]
    lowest = float(np.quantile(late, 0.01))
    n = max(1, round(1e-3 * rate))
    if lowest <= 0.0 or np.abs(turned[:n]).mean() > _FROM_ZERO * lowest:
        return 0.0
    return float(np.argmax(turned >= lowest)) / rate
