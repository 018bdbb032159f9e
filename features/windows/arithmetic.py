"""Sums and medians of many windows at once, each as if its window were alone."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

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
