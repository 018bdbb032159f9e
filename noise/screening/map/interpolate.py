"""Interpolation of levels to the points of a map that were not simulated.

Within a region of one label and regime a level varies smoothly, across its edge it jumps: so a
level is interpolated among points of the same code alone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from noise.screening.map.refine import SIMULATED

_NEAREST = 4
"""Simulated points that an interpolated level is made of."""


def interpolate_levels(
    levels: NDArray[np.float64], codes: NDArray[np.int64], how: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Interpolate levels of simulated points to the others of the same code in the same plane.

    Parameters
    ----------
    levels : ndarray, shape (n_planes, n_rows, n_columns)
        [dB]; any at points that were not simulated.
    codes, how : ndarray of int, same shape
        Of a `Refined`.

    Returns
    -------
    ndarray, same shape
        Means of the nearest simulated points, weighted by the inverse square of their distance
        [dB].

    Examples
    --------
    >>> codes, how = np.zeros((1, 1, 5), dtype=int), np.array([[[0, 2, 2, 2, 0]]])
    >>> interpolate_levels(np.array([[[60.0, 0.0, 0.0, 0.0, 80.0]]]), codes, how).round()
    array([[[60., 62., 70., 78., 80.]]])
    """
    filled = levels.copy()
    for plane in range(codes.shape[0]):
        simulated = np.argwhere(how[plane] == SIMULATED)
        of_simulated = codes[plane][tuple(simulated.T)]
        for code in np.unique(codes[plane]):
            holes = np.argwhere((codes[plane] == code) & (how[plane] != SIMULATED))
            near = simulated[of_simulated == code]
            if not (holes.size and near.size):
                continue
            distance, which = cKDTree(near).query(holes, k=min(_NEAREST, len(near)))
            distance, which = distance.reshape(len(holes), -1), which.reshape(len(holes), -1)
            weight = distance**-2
            found = levels[plane][tuple(near[which].transpose(2, 0, 1))]
            filled[plane][tuple(holes.T)] = (weight * found).sum(1) / weight.sum(1)
    return filled
