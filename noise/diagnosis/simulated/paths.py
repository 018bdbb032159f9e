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

from models.radiation.rig_response import response
from noise.diagnosis.evidence.reconstruction import closed_loop

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.rig import Rig
    from sim.bushing import LumpedBushing

__all__ = ["KnownWays", "Way", "moved", "predict", "ways"]

_SAME_SUPPORT = 1e-3
"""Relative difference up to which two supports are the same."""

_MODEL_RATE = 96e3
"""Sampling rate at which modelled responses are computed [Hz]."""

_FINER = 8
"""By how much lines are refined before straight lines join them."""

_FEWEST_LINES = 16
_UNEVEN = 1e-3

_RINGS, _SILENT, _EARLY = 0.6, 0.75, 0.05
"""Up to where a measured impulse response counts, where it has faded, and how much of what comes
before the blow counts, as shares of one over the spacing of lines."""


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
    >>> from models.rig_files.rig_file import load_material_rig
    >>> found = ways(load_material_rig("fluorocarbon-thesis"), 0.279e-3, 2214.0)
    >>> sorted(found), bool(abs(found["acceleration"].at(np.array([259.0]))[0]) > 1.0)
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
                name: _between_lines(frf.frequency, frf.response)
                for name, frf in measured.items()
                if frf is not None
            }
    if len(found) < 2:
        modelled = response(rig, interference, support_stiffness, _MODEL_RATE)
        for name, impulse in (
            ("acceleration", modelled.torque_to_acceleration),
            ("pressure", modelled.torque_to_pressure),
        ):
            n = _FINER * impulse.size
            table = np.asarray(np.fft.rfftfreq(n, 1.0 / _MODEL_RATE), np.float64)
            found.setdefault(name, Way(table, rfft(impulse, n)))
    return found


class KnownWays:
    """Ways of a rig, each looked up once.

    Parameters
    ----------
    rig : Rig
    """

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self._known: dict[tuple[float, float], dict[str, Way]] = {}

    def at(self, interference: float, support_stiffness: float) -> dict[str, Way]:
        """Return the ways at a condition; arguments as of `ways`."""
        key = (interference, support_stiffness)
        if key not in self._known:
            self._known[key] = ways(self._rig, *key)
        return self._known[key]


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
    >>> bool(np.allclose(predict(tone, 8e3, double)[100:700], 2 * tone[100:700], atol=0.1))
    True
    """
    closed = closed_loop(torque, rate)
    frequency = np.asarray(np.fft.rfftfreq(closed.size, 1.0 / rate), np.float64)
    spectrum = rfft(closed - closed.mean()) * way.at(frequency)
    return np.asarray(irfft(spectrum, closed.size)[: torque.size])


def moved(way: Way, nominal: LumpedBushing, scattered: LumpedBushing) -> Way:
    """Move the clamp's torsional mode of a way to where a scattered rig has it.

    A torque has little at the frequency at which the clamp gives way most, so a way and a torque
    that disagree on it would make a resonance that neither has. Other modes stay.

    Parameters
    ----------
    way : Way
    nominal, scattered : LumpedBushing
        The rig of the way, and the one of the torque.

    Returns
    -------
    Way
    """
    if nominal.clamp_is_fixed:
        return way
    s = 2j * np.pi * way.frequency
    of_nominal, of_scattered = (
        b.support_stiffness + b.support_damping * s + b.clamp_inertia * s * s
        for b in (nominal, scattered)
    )
    return Way(way.frequency, way.response * of_nominal / of_scattered)


def _between_lines(frequency: NDArray[np.float64], response: NDArray[np.complex128]) -> Way:
    """Fill in a measured response between its lines, for as long as it can ring.

    Straight lines would have it echo after one over their spacing, and so would errors of the
    lines; so its impulse response is gated, and transformed again with finer lines. A table whose
    lines are not equally spaced is left as it is.
    """
    steps = np.diff(frequency)
    step = float(steps.mean())
    if frequency.size < _FEWEST_LINES or np.ptp(steps) > _UNEVEN * step:
        return Way(frequency, response)
    lines = step * np.arange(1 + round(frequency[-1] / step))
    spectrum = Way(frequency, response).at(lines)
    spectrum[0] = 0.0
    n = 2 * (lines.size - 1)
    impulse = irfft(spectrum, n)
    late = np.arange(n) / n
    out = np.clip((late - _RINGS) / (_SILENT - _RINGS), 0.0, 1.0)
    back = np.clip((1.0 - late) / _EARLY, 0.0, 1.0)
    gate = 0.5 + 0.5 * np.cos(np.pi * out)
    gate = np.maximum(gate, 0.5 + 0.5 * np.cos(np.pi * back))
    fine = np.zeros(_FINER * n)
    fine[: n - n // 4] = (impulse * gate)[: n - n // 4]
    fine[-(n // 4) :] = (impulse * gate)[-(n // 4) :]
    table = np.asarray(step / _FINER * np.arange(fine.size // 2 + 1), np.float64)
    return Way(table, rfft(fine))


def _same(one: float, other: float) -> bool:
    if math.isinf(one) or math.isinf(other):
        return math.isinf(one) and math.isinf(other)
    return abs(one - other) <= _SAME_SUPPORT * abs(one)
