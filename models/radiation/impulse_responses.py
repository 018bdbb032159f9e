"""Impulse responses from torque and pulse to acceleration and sound at one condition.

The time domain is used because simulated torques are not periodic, and because a measured response
can replace a modelled one once it is an impulse response too.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

Source = Literal["torque", "pulse"]
"""Excitation of the structure: the bushing's torque, or the anchors' pulse force."""


@dataclass(frozen=True, eq=False)
class ImpulseResponses:
    """Impulse responses of structure and plate, for convolution with samples.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    torque_to_acceleration, torque_to_pressure : ndarray, shape (n,)
        Responses to a unit sample of the bushing's torque on the clamp [m/s2 and Pa per Nm].
    pulse_to_acceleration, pulse_to_pressure : ndarray, shape (n,)
        Responses to a unit sample of the anchors' pulse force [m/s2 and Pa per N].

    Examples
    --------
    >>> none = np.zeros(2)
    >>> pair = ImpulseResponses(48e3, np.array([0.0, 2.0]), none, none, none)
    >>> pair.torque_to_acceleration.size / pair.rate * 1e6
    41.66...
    """

    rate: float
    torque_to_acceleration: NDArray[np.float64]
    torque_to_pressure: NDArray[np.float64]
    pulse_to_acceleration: NDArray[np.float64]
    pulse_to_pressure: NDArray[np.float64]


def radiate(
    paths: ImpulseResponses, signal: NDArray[np.float64], source: Source = "torque"
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compute acceleration and sound pressure from a torque or from pulses of force.

    A torque is assumed constant before its first sample, so a non-zero start causes no transient.

    Parameters
    ----------
    paths : ImpulseResponses
    signal : ndarray, shape (n,)
        Torque of the bushing on the clamp [Nm] or pulse force of the anchors on the plate [N],
        sampled at their rate.
    source : {"torque", "pulse"}
        Kind of the signal.

    Returns
    -------
    acceleration, pressure : ndarray, shape (n,)
        [m/s2] and [Pa]

    Examples
    --------
    >>> one = np.ones(1)
    >>> echo = ImpulseResponses(48e3, np.array([0.0, 2.0]), 0.5 * one, one, one)
    >>> acceleration, pressure = radiate(echo, np.array([7.0, 8.0, 8.0]))
    >>> acceleration.round(9), pressure.round(9)
    (array([0., 0., 2.]), array([0. , 0.5, 0.5]))
    """
    change = signal - signal[:1] if source == "torque" else signal
    acceleration, pressure = (
        convolve(
            change, response, _spectrum(paths, name, transform_size(change.size, response.size))
        )
        for name in (f"{source}_to_acceleration", f"{source}_to_pressure")
        for response in [getattr(paths, name)]
    )
    return acceleration, pressure


@lru_cache(maxsize=16)
def _spectrum(paths: ImpulseResponses, name: str, size: int) -> NDArray[np.complex128]:
    return np.asarray(rfft(getattr(paths, name), size))


BLOCK = 2**18
"""Samples per block of a convolution, which bounds the memory for long signals."""


def convolve(
    signal: NDArray[np.float64],
    impulse_response: NDArray[np.float64],
    spectrum: NDArray[np.complex128] | None = None,
) -> NDArray[np.float64]:
    """Convolve a signal causally by overlap-add in blocks, which bounds the memory.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        In any [unit].
    impulse_response : ndarray, shape (m,)
        [unit of the output / unit of the signal]
    spectrum : ndarray, shape (`transform_size` // 2 + 1,), complex, optional
        Its transform, if cached for a signal of the same length.

    Returns
    -------
    ndarray, shape (n,)
        In the output's [unit], as long as the signal.

    Examples
    --------
    >>> convolve(np.array([1.0, 0.0, 2.0]), np.array([3.0, 1.0])).round(9)
    array([3., 1., 6.])
    """
    n, overlap = signal.size, impulse_response.size - 1
    size = transform_size(n, impulse_response.size)
    step = size - overlap
    if spectrum is None:
        spectrum = rfft(impulse_response, size)
    result = np.zeros(n)
    for start in range(0, n, step):
        block = irfft(rfft(signal[start : start + step], size) * spectrum, size)
        end = min(start + size, n)
        result[start:end] += block[: end - start]
    return result


def transform_size(signal: int, impulse_response: int) -> int:
    """Return the length of the transforms of `convolve` for these numbers of samples.

    Examples
    --------
    >>> transform_size(1000, 25)
    1024
    """
    size: int = next_fast_len(min(signal, BLOCK) + impulse_response - 1, real=True)
    return size
