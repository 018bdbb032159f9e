r"""Bodies as sums of modes, and their impulse responses.

.. math::
    h(t) = \sum_i w_i \, e^{-\zeta_i \omega_i t} \sin(\omega_i \sqrt{1 - \zeta_i^2} \, t)

The weights w_i, the product of the mode's shapes at the contact and its radiation to the ear, are
random; frequencies are as a plate's, evenly dense, or a beam's, thinning out; damping is the
material's with scatter. Where modes overlap, as a panel's do above a kilohertz or two, there are
hundreds and none stands out: the response is noise that decays (Schroeder 1962).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from noise.training.draws import coloured_noise, log_uniform


@dataclass(frozen=True, eq=False)
class ModalBody:
    """Modes of a body.

    Parameters
    ----------
    frequency : ndarray, shape (n_modes,)
        Natural frequencies [Hz].
    damping_ratio : ndarray, shape (n_modes,)
        [-]
    weight : ndarray, shape (n_modes,)
        Signed [arbitrary unit].
    """

    frequency: NDArray[np.float64]
    damping_ratio: NDArray[np.float64]
    weight: NDArray[np.float64]

    def impulse_response(self, rate: float, longest: float = 0.4) -> NDArray[np.float64]:
        """Return the impulse response until it has decayed, limited to a duration.

        Parameters
        ----------
        rate : float
            [Hz]
        longest : float
            [s]

        Returns
        -------
        ndarray, shape (n,)
            [unit of the weights]

        Examples
        --------
        >>> body = ModalBody(np.array([500.0]), np.array([0.02]), np.array([1.0]))
        >>> body.impulse_response(48e3).size
        5277
        """
        decay = 2.0 * np.pi * self.frequency * self.damping_ratio
        n = int(min(longest, 6.908 / float(decay.min())) * rate)
        time = np.arange(n) / rate
        damped = 2.0 * np.pi * self.frequency * np.sqrt(1.0 - self.damping_ratio**2)
        pole = np.exp((1j * damped - decay)[:, None] * (time[None, : int(0.01 * rate)]))
        # Blocks of 10 ms: each is the first block times a complex factor.
        step = np.exp((1j * damped - decay) * pole.shape[1] / rate)
        sound = np.zeros(n)
        factor = self.weight.astype(complex)
        for first in range(0, n, pole.shape[1]):
            block = (factor @ pole).imag
            sound[first : first + block.size] = block[: n - first]
            factor = factor * step
        return sound


def random_body(
    modes: tuple[float, float], damping_ratio: tuple[float, float], rng: np.random.Generator
) -> ModalBody:
    """Return a random body of 10 to 60 modes.

    Parameters
    ----------
    modes : pair of float
        Lowest and highest natural frequency of its kind [Hz].
    damping_ratio : pair of float
        Smallest and largest [-].
    rng : numpy.random.Generator

    Examples
    --------
    >>> body = random_body((80.0, 9000.0), (0.015, 0.08), np.random.default_rng(0))
    >>> 10 <= body.frequency.size <= 60
    True
    """
    least, largest = damping_ratio
    lowest = modes[0] * math.exp(rng.uniform(0.0, 1.2))
    highest = modes[1] * math.exp(rng.uniform(-0.7, 0.25))
    n = int(rng.integers(10, 61))
    place = rng.random(n)
    if rng.random() < 0.5:
        frequency = lowest + (highest - lowest) * place
    else:
        frequency = lowest * (highest / lowest) ** place
    damping = least * (largest / least) ** rng.random() * np.exp(rng.normal(0.0, 0.4, n))
    tilt = rng.uniform(-0.5, 0.7)
    weight = rng.standard_normal(n) * (frequency / lowest) ** tilt
    # Up to three modes may be much stronger than the others.
    loud = rng.integers(0, n, int(rng.integers(0, 4)) if rng.random() < 0.5 else 0)
    weight[loud] *= rng.uniform(1.0, 5.0)
    return ModalBody(frequency, np.clip(damping, 0.002, 0.12), weight)


def overlapping_modes(rate: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return the impulse response of overlapping modes: coloured noise with a decay of 1 to 25 ms.

    Parameters
    ----------
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> sound = overlapping_modes(48e3, np.random.default_rng(0))
    >>> bool(np.abs(sound[:100]).max() > np.abs(sound[-100:]).max())
    True
    """
    lasting = log_uniform(0.001, 0.025, rng)
    n = int(7.0 * lasting * rate)
    sound = coloured_noise(n, rng.uniform(-0.6, 1.2), rng)
    sound *= np.exp(-np.arange(n) / (lasting * rate))
    return np.asarray(sound / np.abs(sound).max())
