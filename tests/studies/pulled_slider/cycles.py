"""Statistics of force cycles: between turning points that lie further apart than a threshold.

The same definition serves a sawtooth of sticks and slips and a nearly harmonic oscillation, which
one spring and one surface give at different speeds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy.ndimage import median_filter

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "FEATURES",
    "block_features",
    "cycle_features",
    "smooth",
    "stick_slope",
    "threshold",
]

FEATURES = ("period", "drop", "level", "rise_share", "drop_scatter", "period_scatter")
"""Log of the median period [s], log of the median drop, mean force, share of the cycle in which
the force rises, and coefficients of variation of drop and period."""

_FEWEST = 4
"""Cycles that a statistic needs."""


@njit(cache=True)
def _turning_points(force, height):
    found = np.empty(len(force), np.int64)
    count = 0
    top = 0
    bottom = 0
    way = 0
    for i in range(len(force)):
        if force[i] > force[top]:
            top = i
        if force[i] < force[bottom]:
            bottom = i
        if way >= 0 and force[top] - force[i] >= height:
            found[count] = top
            count += 1
            way = -1
            bottom = i
            top = i
        elif way <= 0 and force[i] - force[bottom] >= height:
            found[count] = bottom
            count += 1
            way = 1
            top = i
            bottom = i
    return found[:count]


def smooth(force: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the running median of five samples: it removes spikes, keeps the edges of slips."""
    result: NDArray[np.float64] = median_filter(force, 5)
    return result


def threshold(force: NDArray[np.float64]) -> float:
    """Least height of a cycle: 2 % of the weight, or four times the noise of the record."""
    steps = np.diff(force)
    noise = 1.4826 * float(np.median(np.abs(steps - np.median(steps)))) / np.sqrt(2.0)
    return float(max(0.02, 4.0 * noise))


def turning_points(
    force: NDArray[np.float64], height: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the indices of bottoms, and of the top that follows each of them."""
    points = _turning_points(force, height)
    if len(points) > 1 and force[points[0]] > force[points[1]]:
        points = points[1:]
    points = points[: len(points) // 2 * 2]
    return points[0::2], points[1::2]


def cycle_features(force: NDArray[np.float64], rate: float, height: float) -> NDArray[np.float64]:
    """Features of a force record in the order of `FEATURES`; NaN where cycles are too few.

    Parameters
    ----------
    force : ndarray, shape (n_samples,)
        In shares of the weight.
    rate : float
        Sampling rate [Hz].
    height : float
        Least distance between turning points.

    Returns
    -------
    ndarray, shape (6,)

    Examples
    --------
    >>> import numpy as np
    >>> saw = 0.3 + 0.1 * (np.arange(10000) % 100) / 100
    >>> cycle_features(saw, 1000.0, 0.02).round(2)
    array([-2.3 , -2.31,  0.35,  0.99,  0.  ,  0.  ])
    """
    bottoms, tops = turning_points(force, height)
    features = np.full(len(FEATURES), np.nan)
    features[2] = np.mean(force)
    if len(bottoms) <= _FEWEST:
        return features
    periods = np.diff(bottoms) / rate
    drops = force[tops[:-1]] - force[bottoms[1:]]
    features[0] = np.log(np.median(periods))
    features[1] = np.log(np.median(drops))
    features[3] = np.median((tops - bottoms)[:-1] / np.diff(bottoms))
    features[4] = np.std(drops) / np.mean(drops)
    features[5] = np.std(periods) / np.mean(periods)
    return features


def block_features(
    force: NDArray[np.float64], rate: float, height: float, blocks: int
) -> NDArray[np.float64]:
    """Features of equal parts of a record, shape (blocks, 6)."""
    return np.array([cycle_features(part, rate, height) for part in np.array_split(force, blocks)])


def stick_slope(
    force: NDArray[np.float64], rate: float, height: float
) -> tuple[float, float, float]:
    """Median rate of rise [1/s], and mean force at tops and at bottoms."""
    bottoms, tops = turning_points(force, height)
    rises = force[tops] - force[bottoms]
    slope = float(np.median(rises / (tops - bottoms)) * rate)
    return slope, float(np.mean(force[tops])), float(np.mean(force[bottoms]))
