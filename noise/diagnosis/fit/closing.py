"""Share of a gap that a fit closes, with its interval.

A share is that of what can be closed: a gap of one floor is none, and closing all of it is 1.
Beside the recordings, of which there are few, what is left after the fit is unsure, by as much as
one recording's distance is where nothing is left to explain.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from noise.diagnosis.gap.distance import closed_fraction

CLOSABLE = 0.5
"""A gap is worth closing from so many floors above the floor; assumed."""

_FLOOR_SPREAD = 0.35
"""Standard deviation of one recording's distance where nothing is left to explain; assumed. Of 66
recordings of quiet development cases without a cause (seed 4) it is 0.36."""

_LEVEL = (5.0, 95.0)
_DRAWS = 400


@dataclass(frozen=True, eq=False)
class Scores:
    """Squared distances of held-out recordings from three models, one entry a recording.

    Parameters
    ----------
    before, recalibrated, after : ndarray, shape (n,)
        From the rig file's, from that with other parameters, from that with effects In squared
        floors [-].
    """

    before: NDArray[np.float64]
    recalibrated: NDArray[np.float64]
    after: NDArray[np.float64]


def rms(squared: NDArray[np.float64]) -> float:
    """Root mean square distance of recordings.

    Parameters
    ----------
    squared : ndarray, shape (n,)
        Distances in squared floors [-].

    Returns
    -------
    float
        In floors [-].

    Examples
    --------
    >>> rms(np.array([1.0, 7.0]))
    2.0
    """
    return float(np.sqrt(np.mean(squared)))


def closed_share(before: NDArray[np.float64], after: NDArray[np.float64]) -> float | None:
    """Share of the closable gap; None where there is less than `CLOSABLE` to close.

    Parameters
    ----------
    before, after : ndarray, shape (n,)
        Distances of recordings in squared floors [-].

    Returns
    -------
    float or None
        [-]

    Examples
    --------
    >>> closed_share(np.array([9.0]), np.array([4.0])), closed_share(np.array([2.0]), np.ones(1))
    (0.5, None)
    """
    gap, left = rms(before), max(rms(after), 1.0)
    return None if gap - 1.0 < CLOSABLE else closed_fraction(gap, left)


def closed_interval(scores: Scores, seed: int = 0) -> tuple[float, float] | None:
    """90 % interval of the share that the effect closes; None where there is nothing to close.

    Parameters
    ----------
    scores : Scores
    seed : int
        Of the bootstrap over recordings.

    Examples
    --------
    >>> sure = Scores(np.full(4, 400.0), np.full(4, 300.0), np.ones(4))
    >>> low, high = closed_interval(sure)
    >>> 0.95 < low < high == 1.0
    True
    """
    share = closed_share(scores.before, scores.after)
    if share is None:
        return None
    rng = np.random.default_rng(seed)
    n = len(scores.before)
    found = []
    for _ in range(_DRAWS):
        place = rng.integers(n, size=n)
        gap = rms(scores.before[place])
        if gap - 1.0 < CLOSABLE:
            gap = rms(scores.before)
        left = rms(scores.after[place]) + _FLOOR_SPREAD / np.sqrt(n) * rng.standard_normal()
        found.append(closed_fraction(gap, max(left, 1.0)))
    low, high = np.percentile(found, _LEVEL).tolist()
    return min(low, share), max(high, share)
