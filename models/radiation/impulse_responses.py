"""Impulse responses from torque and pulse to acceleration and sound at one condition.

The time domain is used because simulated torques are not periodic, and because a measured response
can replace a modelled one once it is an impulse response too.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft

from models.transfer_functions.filtering import convolve, transform_size

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
