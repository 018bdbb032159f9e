"""A search that follows no slope.

Where a rig changes its regime a cost jumps, and between two jumps it is rough. So each number is
tried by a step up and a step down, kept where that helps and tried again in the same direction,
with steps that shrink (Hooke and Jeeves 1961, J. ACM 8, 212).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

_FARTHEST = 4
"""A step is repeated in one direction so often at most."""


def pattern_search(
    cost: Callable[[NDArray[np.float64]], float],
    start: NDArray[np.float64],
    steps: NDArray[np.float64],
    shrink: Sequence[float],
) -> tuple[NDArray[np.float64], float]:
    """Search for the least cost about a start.

    Parameters
    ----------
    cost : callable
        Of an ndarray as `start`; may be infinite.
    start, steps : ndarray, shape (n,)
        Steps of 0 leave a number as it is [any unit].
    shrink : sequence of float
        Factors on the steps, one a round.

    Returns
    -------
    ndarray, shape (n,)
        The best that was tried [unit of `start`].
    float
        Its cost [unit of the cost].

    Examples
    --------
    >>> found, _ = pattern_search(lambda x: float(abs(x - 0.7).sum()), np.zeros(2), np.ones(2),
    ...                           (1.0, 0.5, 0.25, 0.125))
    >>> bool(np.all(abs(found - 0.7) < 0.1))
    True
    """
    x, best = start.copy(), cost(start)
    for factor in shrink:
        for i in np.flatnonzero(steps):
            for sign in (1.0, -1.0):
                improved = False
                for _ in range(_FARTHEST):
                    candidate = x.copy()
                    candidate[i] += sign * factor * steps[i]
                    tried = cost(candidate)
                    if tried >= best:
                        break
                    x, best, improved = candidate, tried, True
                if improved:
                    break
    return x, best
