"""Modes of a thin rectangular plate, simply supported all round, in closed form."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["supported_modes"]


def supported_modes(
    sides: tuple[float, float], stiffness_per_mass: float, highest_frequency: float
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """All modes up to a frequency.

    Parameters
    ----------
    sides : tuple of 2 floats
        Length and width [m].
    stiffness_per_mass : float
        D / (rho h), bending stiffness over mass per area [m4/s2].
    highest_frequency : float
        [Hz]

    Returns
    -------
    frequencies : ndarray, shape (n_modes,)
        Rising [Hz].
    m, n : ndarray, shape (n_modes,), int
        Half-waves along length and width.

    Notes
    -----
    f = pi/2 sqrt(D / (rho h)) ((m/a)^2 + (n/b)^2); A. W. Leissa, *Vibration of Plates*,
    NASA SP-160 (1969), section 4.1.

    Examples
    --------
    >>> frequencies, m, n = supported_modes((1.0, 1.0), 1.0, 10.0)
    >>> (2 * np.pi * frequencies / np.pi**2).round(12), m, n
    (array([2., 5., 5.]), array([1, 2, 1]), array([1, 1, 2]))
    """
    scale = np.pi / 2 * np.sqrt(stiffness_per_mass)
    largest = np.sqrt(highest_frequency / scale)
    m, n = np.meshgrid(
        np.arange(1, int(largest * sides[0]) + 1), np.arange(1, int(largest * sides[1]) + 1)
    )
    frequencies = scale * ((m / sides[0]) ** 2 + (n / sides[1]) ** 2)
    kept = frequencies <= highest_frequency
    m, n, frequencies = m[kept], n[kept], frequencies[kept]
    order = np.argsort(frequencies, kind="stable")
    return frequencies[order], m[order], n[order]
