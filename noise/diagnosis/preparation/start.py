"""When the shaft of a recording has come to its speed: after a start from rest, a run-up, a swing.

A start is a deviation of the speed from what it is later that is there at the beginning, ends, and
is several times larger than whatever the speed does afterwards. A speed that fluctuates all the
time is none, nor is a short dip in the middle. The shaft's angle tells it, read where it crosses
the steps of its converter, so that a coarse one tells as much as a fine one. A torque that rises
from zero tells a start from rest, and where there is no angle, how fast it rises while the contact
sticks tells the rest: the elastomer is twisted as the shaft turns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

if TYPE_CHECKING:
    from models.recording import Recording


_BLOCK, _LAG = 5e-3, 2
"""Of which an angle is averaged [s], and blocks to either side that a speed is the slope of;
assumed."""

_LATE = 0.6
"""Share of a recording after which a start is over [-]; assumed."""

_EARLY = 0.08
"""Within which a start shows [s]; a quarter of the slowest swing of a controller and more;
assumed."""

_SMALLEST, _LARGER = 0.04, 4.0
"""Deviation of the speed that is a start [-], and how many times what comes after it at least;
assumed."""

_OVER = 0.012
"""Deviation of the speed that is none any more [-]; assumed."""

_RISE, _STUCK, _STEEP = 5e-4, 0.02, 0.8
"""Over which a torque rises [s], how long that is looked at [s], and what share is exceeded [-];
assumed."""

_SMALLEST_RISE, _LARGER_RISE, _OVER_RISE = 0.12, 2.5, 0.05
"""As of the speed, which a torque tells less exactly [-]; assumed."""

_FEWEST_LEVELS = 8
"""Of an angle that is read between them; assumed."""

_FROM_ZERO = 0.25
"""Share of its lowest torque later at which the torque of a shaft that starts from rest begins;
assumed."""


def start_of(recording: Recording) -> float:
    """Return when the shaft of a recording has come to its speed; 0 where it always has [s].

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> even = np.linspace(0.0, 1.0, 30_000)[None]
    >>> start_of(Recording(even, 30e3, (Channel("angle"),)))
    0.0
    """
    rate, starts = recording.rate, [0.0]
    angle, torque = recording.first("angle"), recording.first("torque")
    if angle is not None:
        starts.append(_start_by_angle(recording.samples[angle], rate))
    if torque is not None:
        starts.append(_start_from_zero(recording.samples[torque], rate))
    if torque is not None and angle is None:
        starts.append(_start_by_sticking(recording.samples[torque], rate))
    return max(starts)


def _start_by_angle(angle: NDArray[np.float64], rate: float) -> float:
    block = max(1, round(_BLOCK * rate))
    n = angle.size // block
    turned = angle * (1.0 if angle[-1] >= angle[0] else -1.0)
    means = _continuous(turned)[: n * block].reshape(n, block).mean(axis=1)
    if n < 8 * _LAG:
        return 0.0
    at = np.arange(n)
    after, before = np.minimum(at + _LAG, n - 1), np.maximum(at - _LAG, 0)
    speed = (means[after] - means[before]) / (after - before)
    settled = _settled(speed, round(_EARLY / _BLOCK), _OVER, _SMALLEST, _LARGER)
    return min((settled + _LAG) * block, angle.size) / rate if settled else 0.0


def _start_by_sticking(torque: NDArray[np.float64], rate: float) -> float:
    """When a torque has come to rise as fast as it does later: while it sticks, as the shaft turns.

    What is seldom exceeded is the rate of rise in the stick phase, whatever falls in between.
    """
    turned = torque * (1.0 if torque.mean() >= 0.0 else -1.0)
    lag, hop, length = (max(1, round(x * rate)) for x in (_RISE, _BLOCK, _STUCK))
    rises = turned[lag:] - turned[:-lag]
    if rises.size < 8 * length:
        return 0.0
    rise = np.quantile(sliding_window_view(rises, length)[::hop], _STEEP, axis=1)
    settled = _settled(rise, round(_EARLY / _BLOCK), _OVER_RISE, _SMALLEST_RISE, _LARGER_RISE)
    return min(settled * hop + length, torque.size) / rate if settled else 0.0


def _settled(
    values: NDArray[np.float64], n_early: int, over: float, smallest: float, larger: float
) -> int:
    """Return from where on values are what they are late; 0 where they do not begin otherwise."""
    first_late = round(_LATE * values.size)
    late = values[first_late:].mean()
    if late <= 0.0:
        return 0
    away = np.abs(values / late - 1.0)
    beyond = np.maximum.accumulate(away[::-1])[::-1]  # the largest from each on
    settled = int(np.argmax(beyond <= max(over, 1.2 * beyond[first_late])))
    limit = max(smallest, larger * beyond[settled])
    if settled == 0 or away[:settled].max() < limit or away[:n_early].max() < 0.5 * limit:
        return 0
    return settled


def _continuous(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angle between the steps of its converter: straight from where it crosses one to the next.

    How many samples lie below a step is when it is crossed, however often noise makes it be.
    """
    levels, count = np.unique(angle, return_counts=True)
    if levels.size > 0.5 * angle.size or levels.size < _FEWEST_LEVELS:
        return angle
    crossed = np.cumsum(count)[:-1] - 0.5
    between = 0.5 * (levels[1:] + levels[:-1])
    first, last = np.polyfit(crossed[:3], between[:3], 1), np.polyfit(crossed[-3:], between[-3:], 1)
    at = np.arange(angle.size)
    found = np.interp(at, crossed, between)
    before, after = at < crossed[0], at > crossed[-1]
    found[before], found[after] = np.polyval(first, at[before]), np.polyval(last, at[after])
    return np.asarray(found)


def _start_from_zero(torque: NDArray[np.float64], rate: float) -> float:
    """When a torque that begins at zero has come to where it stays."""
    turned = torque * (1.0 if torque.mean() >= 0.0 else -1.0)
    late = turned[round(_LATE * turned.size) :]
    lowest = float(np.quantile(late, 0.01))
    n = max(1, round(1e-3 * rate))
    if lowest <= 0.0 or np.abs(turned[:n]).mean() > _FROM_ZERO * lowest:
        return 0.0
    return float(np.argmax(turned >= lowest)) / rate
