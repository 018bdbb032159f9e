"""The impulse responses from torque and pulse to acceleration and sound at one condition.

Time domain, because simulated torques are signals without a period, and because a measured
response can stand in for a modelled one once it is an impulse response too.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft

from models.transfer_functions.filtering import convolve, transform_size

Path = Literal[
    "torque_to_acceleration", "torque_to_pressure", "pulse_to_acceleration", "pulse_to_pressure"
]


@dataclass(frozen=True, eq=False)
class ImpulseResponses:
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
    paths: ImpulseResponses, torque: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Acceleration and sound pressure that a torque causes.

    The first sample of the torque is taken to have acted for ever before, so a torque that
    starts at a constant part makes no thump.

    Parameters
    ----------
    paths : ImpulseResponses
    torque : ndarray, shape (n,)
        Of the bushing on the clamp, sampled at their rate [Nm].

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
    change = torque - torque[:1]
    return (
        _along(paths, "torque_to_acceleration", change),
        _along(paths, "torque_to_pressure", change),
    )


def radiate_pulses(
    paths: ImpulseResponses, pulse_force: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Acceleration and sound pressure that pulses cause, without those of the torque.

    Parameters
    ----------
    paths : ImpulseResponses
    pulse_force : ndarray, shape (n,)
        Of the anchors on the plate, sampled at their rate [N].

    Returns
    -------
    acceleration, pressure : ndarray, shape (n,)
        [m/s2] and [Pa]

    Examples
    --------
    >>> echo = ImpulseResponses(48e3, np.ones(1), np.ones(1), np.array([2.0]), np.array([0.0, 3.0]))
    >>> acceleration, pressure = radiate_pulses(echo, np.array([1.0, 0.0]))
    >>> acceleration.round(9), pressure.round(9)
    (array([2., 0.]), array([0., 3.]))
    """
    return (
        _along(paths, "pulse_to_acceleration", pulse_force),
        _along(paths, "pulse_to_pressure", pulse_force),
    )


def _along(paths: ImpulseResponses, path: Path, signal: NDArray[np.float64]) -> NDArray[np.float64]:
    impulse_response = getattr(paths, path)
    size = transform_size(signal.size, impulse_response.size)
    return convolve(signal, impulse_response, _spectrum(paths, path, size))


@lru_cache(maxsize=16)
def _spectrum(paths: ImpulseResponses, path: Path, size: int) -> NDArray[np.complex128]:
    return np.asarray(rfft(getattr(paths, path), size))
