"""Impulse responses from torque and pulse to acceleration and sound, and their application.

Time domain, because simulated torques are signals without a period, and because a measured
response can stand in for a modelled one once it is an impulse response too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "FrequencyResponse", "Response", "convolve", "frequency_response", "radiate", "radiate_pulses",
]  # fmt: skip

Path = Literal[
    "torque_to_acceleration", "torque_to_pressure", "pulse_to_acceleration", "pulse_to_pressure"
]

BLOCK = 2**18
"""Samples convolved at a time, which bounds the memory for long signals."""


@dataclass(frozen=True, eq=False)
class Response:
    """Impulse responses of structure and plate, for convolution with samples.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    torque_to_acceleration, torque_to_pressure : ndarray, shape (n,)
        To a unit sample of the bushing's torque on the clamp [m/s2 and Pa per Nm].
    pulse_to_acceleration, pulse_to_pressure : ndarray, shape (n,)
        To a unit sample of the anchors' pulse force [m/s2 and Pa per N].

    Examples
    --------
    >>> pair = Response(48e3, np.array([0.0, 2.0]), np.zeros(2), np.zeros(2), np.zeros(2))
    >>> pair.duration * 1e6
    41.66...
    """

    rate: float
    torque_to_acceleration: NDArray[np.float64]
    torque_to_pressure: NDArray[np.float64]
    pulse_to_acceleration: NDArray[np.float64]
    pulse_to_pressure: NDArray[np.float64]

    @property
    def duration(self) -> float:
        """Length [s]."""
        return self.torque_to_pressure.size / self.rate


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Spectra of a `Response`: output per unit of input at each frequency.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        [Hz]
    torque_to_acceleration, torque_to_pressure : ndarray, shape (n,), complex
        [m/s2 and Pa per Nm]
    pulse_to_acceleration, pulse_to_pressure : ndarray, shape (n,), complex
        [m/s2 and Pa per N]
    """

    frequency: NDArray[np.float64]
    torque_to_acceleration: NDArray[np.complex128]
    torque_to_pressure: NDArray[np.complex128]
    pulse_to_acceleration: NDArray[np.complex128]
    pulse_to_pressure: NDArray[np.complex128]


def radiate(
    response: Response, torque: NDArray[np.float64], pulse_force: NDArray[np.float64] | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Acceleration and sound pressure that torque and pulses cause.

    The first sample of the torque is taken to have acted for ever before, so a torque that
    starts at a constant part makes no thump.

    Parameters
    ----------
    response : Response
    torque : ndarray, shape (n,)
        Of the bushing on the clamp, sampled at the response's rate [Nm].
    pulse_force : ndarray, shape (n,), optional
        Of the anchors on the plate [N].

    Returns
    -------
    acceleration, pressure : ndarray, shape (n,)
        [m/s2] and [Pa]

    Examples
    --------
    >>> echo = Response(48e3, np.array([0.0, 2.0]), np.array([0.5]), np.ones(1), np.ones(1))
    >>> acceleration, pressure = radiate(echo, np.array([7.0, 8.0, 8.0]))
    >>> acceleration.round(9), pressure.round(9)
    (array([0., 0., 2.]), array([0. , 0.5, 0.5]))
    """
    change = torque - torque[:1]
    acceleration = _along(response, "torque_to_acceleration", change)
    pressure = _along(response, "torque_to_pressure", change)
    if pulse_force is not None and np.any(pulse_force):
        struck, sounding = radiate_pulses(response, pulse_force)
        acceleration += struck
        pressure += sounding
    return acceleration, pressure


def radiate_pulses(
    response: Response, pulse_force: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Acceleration and sound pressure that pulses cause, without those of the torque.

    Parameters
    ----------
    response : Response
    pulse_force : ndarray, shape (n,)
        Of the anchors on the plate, sampled at the response's rate [N].

    Returns
    -------
    acceleration, pressure : ndarray, shape (n,)
        [m/s2] and [Pa]

    Examples
    --------
    >>> echo = Response(48e3, np.ones(1), np.ones(1), np.array([2.0]), np.array([0.0, 3.0]))
    >>> acceleration, pressure = radiate_pulses(echo, np.array([1.0, 0.0]))
    >>> acceleration.round(9), pressure.round(9)
    (array([2., 0.]), array([0., 3.]))
    """
    return (
        _along(response, "pulse_to_acceleration", pulse_force),
        _along(response, "pulse_to_pressure", pulse_force),
    )


def frequency_response(response: Response, frequency: ArrayLike) -> FrequencyResponse:
    """Spectra of the responses at given frequencies.

    Parameters
    ----------
    response : Response
    frequency : array_like, shape (n,)
        [Hz]

    Returns
    -------
    FrequencyResponse

    Examples
    --------
    >>> echo = Response(48e3, np.array([0.0, 2.0]), np.array([0.5]), np.ones(1), np.ones(1))
    >>> frequency_response(echo, [12e3]).torque_to_acceleration.round(6)  # a quarter turn late
    array([0.-2.j])
    """
    frequency = np.asarray(frequency, dtype=np.float64)
    angle = 2 * np.pi * frequency / response.rate
    return FrequencyResponse(
        frequency,
        _fourier_transform(response.torque_to_acceleration, angle),
        _fourier_transform(response.torque_to_pressure, angle),
        _fourier_transform(response.pulse_to_acceleration, angle),
        _fourier_transform(response.pulse_to_pressure, angle),
    )


def convolve(
    signal: NDArray[np.float64],
    impulse_response: NDArray[np.float64],
    spectrum: NDArray[np.complex128] | None = None,
) -> NDArray[np.float64]:
    """Causal convolution by overlap-add, in blocks, so that long signals need little memory.

    Parameters
    ----------
    signal : ndarray, shape (n,)
    impulse_response : ndarray, shape (m,)
    spectrum : ndarray, optional
        Its transform, if kept from a signal of the same length.

    Returns
    -------
    ndarray, shape (n,)
        As long as the signal; what rings on after its end is dropped.

    Examples
    --------
    >>> convolve(np.array([1.0, 0.0, 2.0]), np.array([3.0, 1.0])).round(9)
    array([3., 1., 6.])
    """
    n, overlap = signal.size, impulse_response.size - 1
    size = _transform_size(n, impulse_response.size)
    step = size - overlap
    if spectrum is None:
        spectrum = rfft(impulse_response, size)
    result = np.zeros(n)
    for start in range(0, n, step):
        block = irfft(rfft(signal[start : start + step], size) * spectrum, size)
        end = min(start + size, n)
        result[start:end] += block[: end - start]
    return result


def _along(response: Response, path: Path, signal: NDArray[np.float64]) -> NDArray[np.float64]:
    impulse_response = getattr(response, path)
    size = _transform_size(signal.size, impulse_response.size)
    return convolve(signal, impulse_response, _spectrum(response, path, size))


@lru_cache(maxsize=16)
def _spectrum(response: Response, path: Path, size: int) -> NDArray[np.complex128]:
    spectrum: NDArray[np.complex128] = rfft(getattr(response, path), size)
    return spectrum


def _transform_size(signal: int, impulse_response: int) -> int:
    size: int = next_fast_len(min(signal, BLOCK) + impulse_response - 1, real=True)
    return size


def _fourier_transform(
    impulse_response: NDArray[np.float64], angle: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Sum of h[n] exp(-i angle n), in rows of samples and a sum over the rows."""
    row = math.isqrt(impulse_response.size) + 1
    rows = np.zeros((row, row))
    rows.ravel()[: impulse_response.size] = impulse_response
    within = np.exp(-1j * np.outer(np.arange(row), angle))
    between = np.exp(-1j * np.outer(np.arange(row) * row, angle))
    transform: NDArray[np.complex128] = np.sum(between * (rows @ within), axis=0)
    return transform
