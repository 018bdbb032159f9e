# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Maxima of levels that stand out of what surrounds them: blows in time, lines in a spectrum."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.compilation import COMPILED


def prominent_maxima(
    level: NDArray[np.float32],
    first: int,
    last: NDArray[np.int64],
    prominence: float,
    *,
    pointed: bool = False,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Find maxima from which the level falls on either side before it rises higher.

    Parameters
    ----------
    level : ndarray of float32, shape (n_rows, n)
        [dB]
    first : int
        Where each row begins.
    last : ndarray of int, shape (n_rows,)
        Where each ends.
    prominence : float
        Least fall on either side [dB].
    pointed : bool
        A maximum is first taken for one where it is above what follows, not where the level has
        risen enough; the two tell apart the ends of flat tops. Needs a value beyond the end.

    Returns
    -------
    row, at : ndarray of int, shape (n_maxima,)
        Of each, row by row and in rising order.

    Examples
    --------
    >>> level = np.array([[0.0, 1.0, 9.0, 2.0, 8.0, 0.0]], dtype=np.float32)
    >>> row, at = prominent_maxima(level, 0, np.array([6]), 5.0)
    >>> row.tolist(), at.tolist()
    ([0, 0], [2, 4])
    """
    found = np.empty((2, level.size // 2 + len(level)), dtype=np.int64)
    count = _find(level, first, last, float(prominence), pointed, found)
    return found[0, :count], found[1, :count]


@njit(cache=True, **COMPILED)
def _find(level, first, last, prominence, pointed, found) -> int:
    count = 0
    for row in range(level.shape[0]):
        lowest = level[row, first]
        candidate = -1
        for k in range(first, last[row]):
            v = level[row, k]
            if candidate < 0:
                # On the way up from the lowest level since the last maximum.
                if v < lowest:
                    lowest = v
                if v >= lowest + prominence and (
                    not pointed or (v > level[row, k + 1] and v >= level[row, k - 1])
                ):
                    candidate = k
            elif v > level[row, candidate]:
                candidate = k
            elif v < level[row, candidate] - prominence:
                # It has fallen far enough: the candidate was a maximum.
                found[0, count] = row
                found[1, count] = candidate
                count += 1
                candidate = -1
                lowest = v
    return count
