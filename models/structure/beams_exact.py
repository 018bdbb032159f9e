"""Clamp, bushing and beams with continuously distributed mass: the transfer matrices of 3.1.1.

A beam carries deflection, slope, moment and shear from the clamp to its anchor by an exact matrix
in its four waves (`models.structure.beams_waves`), so there is no error of discretisation. This is
the reference that the finite elements of `models.structure.beams` are held against, and it has what
they leave out: the bushing's stiffness and the clamp's sideways motion.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.structure.beams_waves import (
    RootMotion,
    boundary_conditions,
    wave_frequency,
    wavenumber,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from models.structure.beams_waves import ClampOnBeams

__all__ = ["natural_frequencies"]

_STEP = 0.05
"""Of wavenumber times length, in which sign changes are looked for."""

_MOST_ITERATIONS = 60


def natural_frequencies(
    structure: ClampOnBeams, highest_frequency: float, motion: RootMotion = RootMotion.TURNING
) -> NDArray[np.float64]:
    """Undamped natural frequencies up to a highest one.

    Parameters
    ----------
    structure : ClampOnBeams
    highest_frequency : float
        [Hz]
    motion : RootMotion, optional

    Returns
    -------
    ndarray, shape (n_modes,)
        [Hz], rising, to 1e-10 of themselves.

    Notes
    -----
    E. C. Pestel and F. A. Leckie, *Matrix Methods in Elastomechanics* (1963), chapter 4.

    Examples
    --------
    >>> from models.structure.beams_waves import ClampOnBeams
    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> rig = ClampOnBeams(steel, 0.123, 0.96, 1 / 1050, 6.13e5, 750.0)
    >>> natural_frequencies(rig, 4e3).round()
    array([ 250., 1152., 3030.])
    >>> natural_frequencies(rig, 4e3, RootMotion.SIDEWAYS).round()
    array([ 140., 1094., 2989.])
    """
    top = float(wavenumber(structure, highest_frequency).real) * structure.length
    grid = np.arange(_STEP, top + _STEP, _STEP)

    def determinant(wave: ArrayLike) -> NDArray[np.float64]:
        boundary = boundary_conditions(structure, wave_frequency(structure, wave), motion, 0.0).real
        return np.asarray(np.linalg.det(boundary))

    values = determinant(grid)
    (below,) = np.nonzero(np.signbit(values[1:]) != np.signbit(values[:-1]))
    roots = _roots(determinant, grid[below], grid[below + 1])
    frequencies = wave_frequency(structure, roots)
    return frequencies[frequencies <= highest_frequency]


def _roots(
    function: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Root between each `low` and `high`, all at once, by the Illinois form of regula falsi."""
    at_low, at_high = function(low), function(high)
    for _ in range(_MOST_ITERATIONS):
        middle = high - at_high * (high - low) / (at_high - at_low)
        at_middle = function(middle)
        kept = np.signbit(at_middle) == np.signbit(at_high)
        low, at_low = np.where(kept, low, high), np.where(kept, 0.5 * at_low, at_high)
        moved = np.abs(middle - high)
        high, at_high = middle, at_middle
        if np.all(moved <= 1e-13 * high):
            break
    return high
