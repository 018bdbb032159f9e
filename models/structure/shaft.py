"""Torsional modes of a uniform shaft (Appendix A): what bounds the rig's own resonances.

Two ends of the truth: a shaft held at one end that carries an inertia at the other, and a free
one. Both depend on the time that a wave of shear takes along the shaft, and the first on one ratio
of inertias, so that Table 3.1 has two unknowns for six numbers.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

from models.errors import ParameterError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["fixed_free_frequencies", "free_free_frequencies"]


def free_free_frequencies(transit_time: float, n_modes: int = 3) -> NDArray[np.float64]:
    """Natural frequencies of a free shaft, equation (A20), the rigid rotation left out.

    Parameters
    ----------
    transit_time : float
        l sqrt(rho / G): of a wave of shear from end to end [s].
    n_modes : int

    Returns
    -------
    ndarray, shape (n_modes,)
        [Hz]

    Raises
    ------
    ParameterError
        If the transit time is not positive.

    Examples
    --------
    >>> free_free_frequencies(1 / 16262).round()
    array([ 8131., 16262., 24393.])
    """
    _check(transit_time)
    return np.arange(1, n_modes + 1) / (2.0 * transit_time)


def fixed_free_frequencies(
    transit_time: float, ratio: float, n_modes: int = 3
) -> NDArray[np.float64]:
    """Natural frequencies of a shaft held at one end with an inertia at the other, (A14), (A15).

    Parameters
    ----------
    transit_time : float
        l sqrt(rho / G) [s].
    ratio : float
        Inertia of the shaft over that at its end [-].
    n_modes : int

    Returns
    -------
    ndarray, shape (n_modes,)
        [Hz]

    Raises
    ------
    ParameterError
        If the transit time or the ratio is not positive.

    Examples
    --------
    >>> fixed_free_frequencies(1 / 16262, 0.4201).round()
    array([ 1569.,  8462., 16433.])
    """
    _check(transit_time)
    if not 0.0 < ratio < math.inf:
        raise ParameterError(f"shaft: ratio of inertias = {ratio:g} must be positive and finite")

    def unbalance(beta: float) -> float:
        return beta * math.sin(beta) - ratio * math.cos(beta)

    # Each branch of beta tan(beta) rises from zero to infinity, so it meets the ratio once.
    roots = [brentq(unbalance, n * math.pi, (n + 0.5) * math.pi) for n in range(n_modes)]
    return np.array(roots) / (2.0 * math.pi * transit_time)


def _check(transit_time: float) -> None:
    if not 0.0 < transit_time < math.inf:
        raise ParameterError(f"shaft: transit time = {transit_time:g} s must be positive")
