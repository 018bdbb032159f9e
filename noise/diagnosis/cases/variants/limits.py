# mypy: allow-untyped-defs, allow-untyped-decorators
# ruff: noqa: ANN001, ANN201
"""An amplifier that has been overloaded and takes its time to amplify again."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def droop(x, limit, deep, rate):
    """Clip, and lose gain while clipping that comes back afterwards.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Signal over its peak [-].
    limit : float
        At which it is clipped, over the peak [-].
    deep : float
        Share of the gain that is lost in a long overload.
    rate : float
        At which it comes back, a sample [-].

    Returns
    -------
    ndarray, shape (n,)
        As `x` [-].

    Examples
    --------
    >>> droop(np.array([0.5, 2.0, 0.5]), 1.0, 1.0, 0.01).round(2)
    array([0.5 , 0.9 , 0.45])
    """
    y = np.empty_like(x)
    lost = 0.0
    for i in range(x.size):
        over = abs(x[i]) > limit
        lost += min(10.0 * rate, 1.0) * (deep - lost) if over else -min(rate, 1.0) * lost
        y[i] = (1.0 - lost) * min(max(x[i], -limit), limit)
    return y
