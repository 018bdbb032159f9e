# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Sums and prominent maxima of many windows, independent of the other windows."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.compilation import COMPILED

OCTAVES = 1.0 / np.log(2.0)
"""Factor from natural logarithms to octaves."""

_Float = TypeVar("_Float", bound=np.floating)


def ordered_sum(terms: NDArray[_Float], axis: int = 0) -> NDArray[_Float]:
    """Return the sum of terms in their order and precision.

    `numpy.sum` uses pairwise summation over the last axis, and if that has one column, so the last
    digits would depend on the number of windows.

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
    """Return the squared magnitudes of spectra, in one pass.

    Parameters
    ----------
    spectrum : ndarray of complex64, shape (n_rows, n_bins)
        [unit]
    least : float
        Constant to be added [unit^2].

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


def prominent_maxima(
    level: NDArray[np.float32],
    first: int,
    last: int,
    prominence: float,
    *,
    pointed: bool = False,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the maxima with a given prominence.

    Parameters
    ----------
    level : ndarray of float32, shape (n_rows, n)
        [dB]
    first, last : int
        Range of columns.
    prominence : float
        Minimum fall on either side before the level rises higher [dB].
    pointed : bool
        Whether a maximum has to exceed the next value, which decides at the ends of flat tops; it
        needs a value beyond the end.

    Returns
    -------
    row, at : ndarray of int, shape (n_maxima,)
        Row and column of each maximum, in order.

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
                # Rising from the lowest level since the last maximum.
                if v < lowest:
                    lowest = v
                if v >= lowest + prominence and (
                    not pointed or (v > level[row, k + 1] and v >= level[row, k - 1])
                ):
                    candidate = k
            elif v > level[row, candidate]:
                candidate = k
            elif v < level[row, candidate] - prominence:
                # The fall is sufficient: the candidate was a maximum.
                maxima[0, count] = row
                maxima[1, count] = candidate
                count += 1
                candidate = -1
                lowest = v
    return count
