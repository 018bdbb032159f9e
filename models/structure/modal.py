"""Modal model of a structure: frequency responses and sampled impulse responses.

Modes have viscous damping, so every impulse response is causal. Each becomes a digital section of
second order with the poles of the continuous mode. Its numerator has the zeros of the quantity: two
at 0 Hz for the acceleration, none for the displacement, for which Numerov's weights (1, 10, 1)/12
flatten the band. The gain is matched at low frequencies. Up to a sixth of the sampling rate the
result differs from the continuous mode by less than 0.2 dB, up to a quarter by less than 1 dB;
sampling the continuous impulse response would alias, in particular for an acceleration, which does
not fall off towards high frequencies.

From zeta = 1 on a mode does not oscillate: s^2 + 2 zeta omega s + omega^2 = 0 has two real roots

    s = -omega (zeta -+ sqrt(zeta^2 - 1)),

of which the slower, -omega / (zeta + sqrt(zeta^2 - 1)), determines the length of the response. Up
to a sixth of the sampling rate such a mode differs by less than 0.5 dB at any damping.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import lfilter

DECAY_EXPONENT = 14.0
"""Exponent of the decay at which the response of a mode ends: exp(14), 122 dB."""


@dataclass(frozen=True, eq=False)
class ModalModel:
    """Linear structure of modes with q'' + 2 zeta omega q' + omega^2 q = inputs.

    Parameters
    ----------
    frequencies, damping_ratios : ndarray, shape (n_modes,)
        Undamped natural frequencies [Hz] and fractions of critical damping.
    inputs : ndarray, shape (n_modes, n_inputs)
        Modal force for a unit of each input [1/sqrt(kg) for a force], with mode shapes normalised
        to unit modal mass.
    displacements, accelerations : ndarray, shape (n_outputs, n_modes)
        Contributions of q and q'' to each output [unit of the output over that of each].
    feedthrough : ndarray, shape (n_outputs, n_inputs)
        Instantaneous part of the outputs [unit of the output over that of the input]: the static
        contribution of the modes left out.

    Examples
    --------
    An oscillator of 2 kg at 100 Hz, of which the acceleration is measured:

    >>> one, none = np.array([[1 / np.sqrt(2)]]), np.zeros((1, 1))
    >>> oscillator = ModalModel(np.array([100.0]), np.array([0.01]), one, none, one, none)
    >>> gain = oscillator.frequency_response([100.0, 1e5])[0, 0]
    >>> np.abs(gain).round(3)
    array([25. ,  0.5])
    """

    frequencies: NDArray[np.float64]
    damping_ratios: NDArray[np.float64]
    inputs: NDArray[np.float64]
    displacements: NDArray[np.float64]
    accelerations: NDArray[np.float64]
    feedthrough: NDArray[np.float64]

    def frequency_response(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Return the frequency response of the outputs to each input, exact in continuous time.

        Parameters
        ----------
        frequency : array_like, shape (n,)
            [Hz]

        Returns
        -------
        ndarray, shape (n_outputs, n_inputs, n)
            [unit of the output over that of the input]
        """
        omega = 2 * np.pi * np.asarray(frequency, dtype=np.float64)
        natural = 2 * np.pi * self.frequencies[:, None]
        q = 1 / (natural**2 - omega**2 + 2j * self.damping_ratios[:, None] * natural * omega)
        return np.asarray(
            np.einsum("om,mi,mf->oif", self.displacements, self.inputs, q, optimize=True)
            - np.einsum(
                "om,mi,mf->oif", self.accelerations, self.inputs, omega**2 * q, optimize=True
            )
            + self.feedthrough[:, :, None]
        )

    def impulse_response(self, rate: float, n_samples: int) -> NDArray[np.float64]:
        """Return the sampled impulse response of the outputs to each input.

        Parameters
        ----------
        rate : float
            Sampling rate [Hz]; more than twice the highest of the `frequencies`.
        n_samples : int

        Returns
        -------
        ndarray, shape (n_outputs, n_inputs, n_samples)
            [unit of the output over that of the input]
        """
        response = np.zeros((*self.feedthrough.shape, n_samples))
        response[:, :, 0] = self.feedthrough
        for r, (frequency, ratio) in enumerate(
            zip(self.frequencies, self.damping_ratios, strict=True)
        ):
            ringing = ringing_samples(frequency, ratio, rate, n_samples)
            unit = np.zeros(ringing)
            unit[0] = 1.0
            q = lfilter(*displacement_section(frequency, ratio, rate), unit)
            q_tt = lfilter(*acceleration_section(frequency, ratio, rate), unit)
            outputs = np.outer(self.displacements[:, r], q) + np.outer(
                self.accelerations[:, r], q_tt
            )
            response[:, :, :ringing] += self.inputs[r][None, :, None] * outputs[:, None, :]
        return response


def acceleration_section(
    frequency: float, damping_ratio: float, rate: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the digital filter from modal force to q'' of a mode of unit modal mass.

    Parameters
    ----------
    frequency : float
        Undamped natural frequency [Hz], below half of `rate`.
    damping_ratio : float
        [-]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    numerator, denominator : ndarray, shape (3,)
        [-], in rising powers of the unit delay.

    Examples
    --------
    >>> b, a = acceleration_section(1000.0, 0.02, 96e3)
    >>> bool(abs(b.sum()) < 1e-12)  # nothing at 0 Hz
    True
    """
    denominator = _poles(frequency, damping_ratio, rate)
    gain = denominator.sum() / (2 * np.pi * frequency / rate) ** 2
    return gain * np.array([1.0, -2.0, 1.0]), denominator


def displacement_section(
    frequency: float, damping_ratio: float, rate: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the digital filter from modal force to q of a mode of unit modal mass.

    Parameters and returns are those of `acceleration_section`, shapes (3,), the
    numerator in [s2].

    Examples
    --------
    >>> b, a = displacement_section(1000.0, 0.02, 96e3)
    >>> float(b.sum() / a.sum() * (2 * np.pi * 1000.0) ** 2)  # static: force over stiffness
    1.0
    """
    denominator = _poles(frequency, damping_ratio, rate)
    gain = denominator.sum() / (2 * np.pi * frequency) ** 2
    return gain * np.array([1.0, 10.0, 1.0]) / 12, denominator


def add_ringing(
    response: NDArray[np.float64],
    modes: Any,
    inputs: NDArray[np.float64],
    taps: NDArray[np.float64],
    delay: int,
    rate: float,
) -> None:
    """Add the sound of modes to the impulse responses of inputs.

    Parameters
    ----------
    response : ndarray, shape (n_inputs, n_samples)
        Sound pressure after a unit sample of each input, changed in place [Pa per unit].
    modes : object
        With `frequencies` [Hz] and `damping_ratios` [-], ndarrays of shape (n_modes,).
    inputs : ndarray, shape (n_modes, n_inputs)
        Modal force for a unit of each input [1/sqrt(kg) for a force].
    taps : ndarray, shape (n_taps, n_modes)
        Filter from the acceleration q'' of each mode to the sound pressure [Pa over unit of q''].
    delay : int
        Samples before the first tap.
    rate : float
        Sampling rate [Hz].

    Examples
    --------
    >>> sound, one = np.zeros((1, 8)), np.ones((1, 1))
    >>> mode = ModalModel(np.array([100.0]), np.array([0.01]), one, one, one, 0 * one)
    >>> add_ringing(sound, mode, one, one, 3, 8e3)
    >>> sound[0, :4].round(2)
    array([0., 0., 0., 1.])
    """
    n_samples = response.shape[1]
    for r, (frequency, ratio) in enumerate(
        zip(modes.frequencies, modes.damping_ratios, strict=True)
    ):
        ringing = taps.shape[0] + ringing_samples(frequency, ratio, rate, n_samples)
        end = min(delay + ringing, n_samples)
        excitation = np.zeros(ringing)
        excitation[: taps.shape[0]] = taps[:, r]
        sound = lfilter(*acceleration_section(frequency, ratio, rate), excitation)
        response[:, delay:end] += np.outer(inputs[r], sound[: end - delay])


def ringing_samples(frequency: float, damping_ratio: float, rate: float, n_samples: int) -> int:
    """Return the number of samples until a mode has decayed by 122 dB, at most `n_samples`.

    Examples
    --------
    >>> ringing_samples(1000.0, 0.01, 48e3, 48000)
    10696
    """
    decay = 2 * np.pi * frequency * damping_ratio / rate
    if damping_ratio > 1:
        decay = _real_decays(2 * np.pi * frequency / rate, damping_ratio)[0]
    return n_samples if decay * n_samples <= DECAY_EXPONENT else int(DECAY_EXPONENT / decay) + 1


def _poles(frequency: float, damping_ratio: float, rate: float) -> NDArray[np.float64]:
    angle = 2 * np.pi * frequency / rate
    if damping_ratio > 1:
        slow, fast = np.exp([-decay for decay in _real_decays(angle, damping_ratio)])
        return np.array([1.0, -(slow + fast), slow * fast])
    radius = np.exp(-damping_ratio * angle)
    turn = np.cos(angle * np.sqrt(1 - damping_ratio**2))
    return np.array([1.0, -2 * radius * turn, radius**2])


def _real_decays(angle: float, damping_ratio: float) -> tuple[float, float]:
    """Return the two decay exponents per sample of an overdamped mode."""
    apart = damping_ratio + float(np.sqrt(damping_ratio**2 - 1))
    return angle / apart, angle * apart
