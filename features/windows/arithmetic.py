# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Sums, medians and prominent maxima of many windows at once, each as if its window were alone."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.compilation import COMPILED

OCTAVES = 1.0 / np.log(2.0)
"""What makes a natural logarithm one of base two."""

_Float = TypeVar("_Float", bound=np.floating)


def ordered_sum(terms: NDArray[_Float], axis: int = 0) -> NDArray[_Float]:
    """Add up one term after the other, in the precision of the terms.

    `numpy.sum` does so over any axis but the last; over the last, and where that has one column
    only, it adds in pairs, so that the last digits change with the number of windows at once.

    Examples
    --------
    >>> ordered_sum(np.array([[0.1, 1.0], [0.2, 2.0], [0.3, 3.0]]))
    array([0.6, 6. ])
    """
    if terms.shape[axis] == 0 or (axis < terms.ndim - 1 and terms.shape[-1] > 1):
        return np.asarray(np.ascontiguousarray(terms).sum(axis=axis))
    last: Any = (*[slice(None)] * axis, -1)
    return np.asarray(np.add.accumulate(terms, axis=axis)[last])


def power_of(spectrum: NDArray[Any], least: float | np.float32 = 0.0) -> NDArray[np.float32]:
    """Square the magnitudes of spectra, in one pass over them.

    Parameters
    ----------
    spectrum : ndarray of complex64, shape (n_rows, n_bins)
        [unit]
    least : float
        Added to each [unit^2].

    Examples
    --------
    >>> power_of(np.array([[3.0 + 4.0j]], dtype=np.complex64)).tolist()
    [[25.0]]
    """
    power = np.empty(spectrum.shape, dtype=np.float32)
    _square(spectrum, np.float32(least), power)
    return power


@njit(cache=True, **COMPILED)
def _square(spectrum, least, power) -> None:
    for row in range(power.shape[0]):
        for k in range(power.shape[1]):
            real, imaginary = spectrum[row, k].real, spectrum[row, k].imag
            power[row, k] = real * real + imaginary * imaginary + least


def padded_rows(
    values: NDArray[Any], row: NDArray[np.int64], counts: NDArray[np.int64], fill: float
) -> NDArray[Any]:
    """Put values that lie row by row into a matrix.

    Parameters
    ----------
    values : ndarray, shape (n,)
        In any [unit].
    row : ndarray of int, shape (n,)
        Of each value, not falling.
    counts : ndarray of int, shape (n_rows,)
        Values in each row.
    fill : float
        What follows them, in the same [unit].

    Returns
    -------
    ndarray, shape (n_rows, max(1, counts.max()))
        In the same [unit].

    Examples
    --------
    >>> padded_rows(np.array([1.0, 2.0, 3.0]), np.array([0, 0, 2]), np.array([2, 0, 1]), 0.0)
    array([[1., 2.],
           [0., 0.],
           [3., 0.]])
    """
    out = np.full((counts.size, int(counts.max(initial=1))), fill, dtype=values.dtype)
    out[row, np.arange(row.size) - (np.cumsum(counts) - counts)[row]] = values
    return out


def padded_medians(rows: NDArray[Any], counts: NDArray[np.int64]) -> NDArray[Any]:
    """Median of each row's first values, in their precision; NaN where there are none.

    Parameters
    ----------
    rows : ndarray, shape (n_rows, most)
        As `padded_rows` gives them, in any [unit], with infinity behind them; some column at least.
    counts : ndarray of int, shape (n_rows,)
        Values in each row.

    Returns
    -------
    ndarray, shape (n_rows,)
        In the same [unit].

    Examples
    --------
    >>> rows = np.array([[3.0, 1.0, 2.0, 8.0], [5.0, np.inf, np.inf, np.inf]])
    >>> padded_medians(rows, np.array([4, 1]))
    array([2.5, 5. ])
    """
    rows = np.sort(rows, axis=1)
    row = np.arange(counts.size)
    middle = rows[row, np.maximum(counts - 1, 0) // 2] + rows[row, counts // 2]
    return np.asarray(np.where(counts > 0, middle / rows.dtype.type(2.0), rows.dtype.type(np.nan)))


def prominent_maxima(
    level: NDArray[np.float32],
    first: int,
    last: int,
    prominence: float,
    *,
    pointed: bool = False,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Find maxima from which the level falls on either side before it rises higher.

    Parameters
    ----------
    level : ndarray of float32, shape (n_rows, n)
        [dB]
    first, last : int
        Where each row begins and ends.
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
    >>> row, at = prominent_maxima(level, 0, 6, 5.0)
    >>> row.tolist(), at.tolist()
    ([0, 0], [2, 4])
    """
    maxima = np.empty((2, level.size // 2 + len(level)), dtype=np.int64)
    count = _find(level, first, last, float(prominence), pointed, maxima)
    return maxima[0, :count], maxima[1, :count]


@njit(cache=True, **COMPILED)
def _find(level, first, last, prominence, pointed, maxima) -> int:
    count = 0
    for row in range(level.shape[0]):
        lowest = level[row, first]
        candidate = -1
        for k in range(first, last):
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
                maxima[0, count] = row
                maxima[1, count] = candidate
                count += 1
                candidate = -1
                lowest = v
    return count
