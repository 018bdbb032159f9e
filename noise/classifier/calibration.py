"""From the trees' votes to probabilities: raised to a power and weighted by label."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Calibration", "means_of_groups"]

_FLOOR = 1e-3
"""No few hundred trees can tell less."""


@dataclass(frozen=True)
class Calibration:
    """What makes votes probabilities.

    Parameters
    ----------
    sharpness : float
        Exponent: above 1 it makes them more certain.
    weights : tuple of float
        Of the labels.

    Examples
    --------
    >>> Calibration(2.0, (1.0, 1.0, 1.0))(np.array([[0.5, 0.25, 0.25]])).round(2).tolist()
    [[0.67, 0.17, 0.17]]
    """

    sharpness: float
    weights: tuple[float, ...]

    def __call__(self, votes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return probabilities, each row of which sums to 1."""
        p = (votes + _FLOOR) ** self.sharpness * np.array(self.weights)
        return np.asarray(p / p.sum(axis=1, keepdims=True))


def means_of_groups(p: NDArray[np.float64], group: NDArray[np.int64]) -> NDArray[np.float64]:
    """Mean of the rows of each group 0, 1, 2 ..., none of which is empty.

    Examples
    --------
    >>> means_of_groups(np.array([[1.0], [3.0], [5.0]]), np.array([0, 0, 1])).tolist()
    [[2.0], [5.0]]
    """
    sums = np.zeros((int(group.max()) + 1, p.shape[1]))
    np.add.at(sums, group, p)
    return np.asarray(sums / np.bincount(group)[:, None])
