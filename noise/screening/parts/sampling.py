"""Samples of parts whose parameters vary independently of each other.

Samples are Sobol' points, scrambled: they fill the space of the parameters more evenly than chance
does, and stay unbiased, so that a few scramblings side by side tell how far off the result may be
(A. B. Owen, *Scrambled net variance for integrals of smooth functions*, Annals of Statistics 25,
1997).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from models.errors import ParameterError


class Distribution(Protocol):
    """How one parameter varies: a frozen distribution of `scipy.stats`."""

    def ppf(self, probability: NDArray[np.float64], /) -> NDArray[np.float64]:
        """Value that the parameter stays below with a probability.

        Parameters
        ----------
        probability : ndarray, shape (n,)
            [-]

        Returns
        -------
        ndarray, shape (n,)
            In the unit of the parameter, such as [-] of a factor.
        """


def parts(
    distributions: Mapping[str, Distribution], points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Parameters of parts, from points of the unit cube.

    Parameters
    ----------
    distributions : mapping of str to Distribution, length d
        By the name of the parameter.
    points : ndarray, shape (n, d)
        From 0 to 1 [-].

    Returns
    -------
    ndarray, shape (n, d)
        A row a part, a column a parameter, in the units of the distributions, such as [-] of
        factors.

    Examples
    --------
    >>> from scipy.stats import uniform
    >>> parts({"width": uniform(2.0, 4.0), "height": uniform()}, np.array([[0.5, 1.0]]))
    array([[4., 1.]])
    """
    columns = [one.ppf(points[:, i]) for i, one in enumerate(distributions.values())]
    return np.column_stack(columns)


def sobol_points(dimensions: int, rng: np.random.Generator) -> qmc.Sobol:
    """Start a sequence of scrambled Sobol' points; ``.random(n)`` goes on with it.

    Parameters
    ----------
    dimensions : int
    rng : numpy.random.Generator
        Of the scrambling.

    Returns
    -------
    scipy.stats.qmc.Sobol

    Raises
    ------
    ParameterError
        If there is no parameter to vary.

    Examples
    --------
    >>> points = sobol_points(2, np.random.default_rng(0))
    >>> np.histogram(points.random(8)[:, 0], bins=8, range=(0.0, 1.0))[0]
    array([1, 1, 1, 1, 1, 1, 1, 1])
    """
    if not dimensions:
        raise ParameterError("scatter: there must be at least one")
    return qmc.Sobol(dimensions, scramble=True, seed=rng)
