"""Rayleigh's integral for the sound of a vibrating surface in a rigid baffle, as a short filter.

p(t) = rho_0 / (2 pi) * integral of a(t - r/c) / r dA, where a is the normal acceleration at the
distance r from the microphone. Travel times over a plate differ by a few milliseconds at most, so
for a fixed distribution of the acceleration the integral is a filter of some hundred taps, and one
sparse matrix serves all distributions. Times between samples are interpolated by Lagrange's cubic,
with an error of 0.1 dB at a sixth of the sampling rate.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

AIR_DENSITY = 1.204
"""Density of dry air at 20 degree Celsius and 1013 hPa [kg/m3]."""

SOUND_SPEED = 343.2
"""Speed of sound in dry air at 20 degree Celsius [m/s]."""

GRID_STEP = 3e-3
"""Largest surface element: a seventh of the wavelength in air at 16 kHz [m]."""


@dataclass(frozen=True, eq=False)
class RayleighIntegral:
    """Rayleigh's integral from one set of surface elements to one microphone.

    Parameters
    ----------
    matrix : sparse array, shape (n_taps, n_elements)
        Maps the elements' acceleration [m/s2] to filter taps [Pa].
    delay : int
        Samples before the first tap.
    """

    matrix: csr_array
    delay: int

    def taps(self, distribution: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the filter from the time course of an acceleration to the sound pressure.

        Parameters
        ----------
        distribution : ndarray, shape (n_elements,) or (n_elements, n_distributions)
            Acceleration of each element relative to that time course.

        Returns
        -------
        ndarray, shape (n_taps,) or (n_taps, n_distributions)
            [Pa per m/s2], delayed by `delay` samples.
        """
        return np.asarray(self.matrix @ distribution)


def rayleigh_integral(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    area: NDArray[np.float64] | float,
    microphone: tuple[float, float, float],
    rate: float,
) -> RayleighIntegral:
    """Return Rayleigh's integral over surface elements.

    Parameters
    ----------
    x, y : ndarray, shape (n_elements,)
        Middle of each surface element at z = 0 [m].
    area : ndarray, shape (n_elements,), or float
        [m2]; the elements must be small against the wavelength and the microphone's height.
    microphone : tuple of 3 floats
        [m]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    RayleighIntegral

    Notes
    -----
    F. Fahy and P. Gardonio, *Sound and Structural Vibration*, 2nd ed., chapter 3.

    Examples
    --------
    A small piston of 1 cm2 with an acceleration of 1 m/s2, at 1 m:

    >>> middle = np.zeros(1)
    >>> piston = rayleigh_integral(middle, middle, 1e-4, (0.0, 0.0, 1.0), 96e3)
    >>> float(piston.taps(np.ones(1)).sum().round(9))  # 1.204 * 1e-4 / (2 pi)
    1.9162e-05
    >>> piston.delay  # one sample ahead of the arrival at 279.7, for the interpolation
    278
    """
    distance = np.sqrt((x - microphone[0]) ** 2 + (y - microphone[1]) ** 2 + microphone[2] ** 2)
    strength = AIR_DENSITY / (2 * np.pi) * area / distance
    time = distance * (rate / SOUND_SPEED)
    sample = np.maximum(np.floor(time).astype(np.int64), 1)
    f = time - sample
    weights = cubic_weights(f)
    delay = int(sample.min()) - 1
    rows = sample - 1 - delay + np.arange(4)[:, None]
    columns = np.broadcast_to(np.arange(distance.size), rows.shape)
    matrix = csr_array(
        ((weights * strength).ravel(), (rows.ravel(), columns.ravel())),
        shape=(int(rows.max()) + 1, distance.size),
    )
    return RayleighIntegral(matrix, delay)


def cubic_weights(f: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the weights of Lagrange's cubic between samples.

    Parameters
    ----------
    f : ndarray, shape (n,)
        Distance from the second of four samples, 0 to 1 [samples].

    Returns
    -------
    ndarray, shape (4, n)
        [-]

    Examples
    --------
    >>> cubic_weights(np.array([0.5]))[:, 0].tolist()
    [-0.0625, 0.5625, 0.5625, -0.0625]
    """
    return np.stack(
        [
            -f * (1 - f) * (2 - f) / 6,
            (1 + f) * (1 - f) * (2 - f) / 2,
            (1 + f) * f * (2 - f) / 2,
            -(1 + f) * f * (1 - f) / 6,
        ]
    )


def element_middles(length: float) -> NDArray[np.float64]:
    """Return the middles of surface elements along a side about the origin [m], shape (n,).

    Parameters
    ----------
    length : float
        Length of the side [m].

    Examples
    --------
    >>> element_middles(6e-3)
    array([-0.0015,  0.0015])
    """
    n = int(np.ceil(length / GRID_STEP))
    return np.asarray((np.arange(n, dtype=np.float64) + 0.5) * (length / n) - length / 2)
