"""The linear ways from torque to acceleration and to sound, as the rig file has them.

A measured response stands for its way, as it was measured, line by line; what was not measured is
modelled. Either is a table over frequency, which a torque is sent through whole, so a recording of
a second costs a transform and no search for a causal impulse response.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft, rfft

from models.radiation import response
from noise.diagnosis.reconstruction import closed_loop

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.rig import Rig

__all__ = ["Way", "predict", "ways"]

_SAME_SUPPORT = 1e-3
"""Relative difference up to which two supports are the same."""

_MODEL_RATE = 96e3
"""Sampling rate at which modelled responses are computed [Hz]."""


@dataclass(frozen=True, eq=False)
class Way:
    """A frequency response as a table.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        [Hz], rising.
    response : ndarray of complex, shape (n,)
        [unit per Nm], for signals that go as exp(+i omega t).
    """

    frequency: NDArray[np.float64]
    response: NDArray[np.complex128]

    def at(self, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Response at other frequencies: as f**2 below the table, none above it."""
        first = self.frequency[0]
        real = np.interp(frequency, self.frequency, self.response.real, right=0.0)
        imaginary = np.interp(frequency, self.frequency, self.response.imag, right=0.0)
        below = np.minimum(frequency / max(first, 1e-9), 1.0) ** 2
        return np.asarray((real + 1j * imaginary) * below)


def ways(rig: Rig, interference: float, support_stiffness: float) -> dict[str, Way]:
    """Return the ways from the torque to ``acceleration`` and to ``pressure``.

    Parameters
    ----------
    rig : Rig
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad] or `models.condition.FIXED`.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> found = ways(load_material_rig("fluorocarbon-thesis"), 0.279e-3, 2214.0)
    >>> sorted(found), abs(found["acceleration"].at(np.array([259.0]))[0]) > 1.0
    (['acceleration', 'pressure'], True)
    """
    found: dict[str, Way] = {}
    for entry in rig.measured:
        if _same(entry.support_stiffness, support_stiffness):
            measured = {
                "acceleration": entry.torque_to_acceleration,
                "pressure": entry.torque_to_pressure,
            }
            found = {
                name: Way(frf.frequency, frf.response)
                for name, frf in measured.items()
                if frf is not None
            }
    if len(found) < 2:
        modelled = response(rig, interference, support_stiffness, _MODEL_RATE)
        for name, impulse in (
            ("acceleration", modelled.torque_to_acceleration),
            ("pressure", modelled.torque_to_pressure),
        ):
            table = np.asarray(np.fft.rfftfreq(impulse.size, 1.0 / _MODEL_RATE), np.float64)
            found.setdefault(name, Way(table, rfft(impulse)))
    return found


def predict(torque: NDArray[np.float64], rate: float, way: Way) -> NDArray[np.float64]:
    """Send a torque through a way.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        [Nm]
    rate : float
        [Hz]
    way : Way

    Returns
    -------
    ndarray, shape (n,)
        What rings on from before the recording is missing at its start.

    Examples
    --------
    >>> double = Way(np.array([0.0, 4e3]), np.array([2.0 + 0j, 2.0 + 0j]))
    >>> tone = np.sin(2 * np.pi * 100.0 * np.arange(800) / 8e3)
    >>> bool(np.allclose(predict(tone, 8e3, double)[100:700], 2 * tone[100:700], atol=0.01))
    True
    """
    closed = closed_loop(torque, rate)
    frequency = np.asarray(np.fft.rfftfreq(closed.size, 1.0 / rate), np.float64)
    spectrum = rfft(closed - closed.mean()) * way.at(frequency)
    return np.asarray(irfft(spectrum, closed.size)[: torque.size])


def _same(one: float, other: float) -> bool:
    if math.isinf(one) or math.isinf(other):
        return math.isinf(one) and math.isinf(other)
    return abs(one - other) <= _SAME_SUPPORT * abs(one)
