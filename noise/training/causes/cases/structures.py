"""Random structures: modes of clamp, beams, plate and air, and their simulated hammer test."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft

from models.radiation.impulse_responses import ImpulseResponses
from models.transfer_functions.measured import MeasuredResponse
from models.transfer_functions.transfer_function import TransferFunction
from noise.base import log_uniform, packaged_toml
from noise.base.arrays import Array, Rng
from noise.diagnosis.cases.draws import log_uniforms
from sim.bushing import LumpedBushing

_LINES = np.arange(10.0, 10_001.0, 2.5)
"""Frequencies of the hammer test [Hz]."""

_SOUND_SPEED = 343.0


TRADES = packaged_toml("noise.training.causes.cases", "cases.toml")["trades"]
"""Kinds of structure behind a clamp: rows of the table."""


@dataclass(frozen=True, eq=False)
class Structure:
    """Responses of acceleration and sound to torque and to impacts in the anchors: sums of modes.

    Parameters
    ----------
    bushing : LumpedBushing
        Its clamp and support make the torsional mode.
    beams, plate, anchors : ndarray, shape (3, n_modes)
        Frequency [Hz], damping ratio and modal constant.
    lever : float
        Distance of the accelerometer from the axis of torsion [m].
    clamp_to_pressure : float
        [Pa per rad/s2]
    distance : float
        Distance of the microphone [m].
    """

    bushing: LumpedBushing
    beams: Array
    plate: Array
    anchors: Array
    lever: float
    clamp_to_pressure: float
    distance: float

    def from_torque(
        self, frequency: Array
    ) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Return the responses of acceleration and pressure to the torque.

        Parameters
        ----------
        frequency : ndarray, shape (n,)
            [Hz]

        Returns
        -------
        acceleration, pressure : ndarray of complex, shape (n,)
            [m/s2 per Nm], [Pa per Nm]
        """
        late = np.exp(-2j * np.pi * frequency * self.distance / _SOUND_SPEED)
        acceleration = _modes(frequency, self.beams)
        pressure = late * _modes(frequency, self.plate)
        if not self.bushing.clamp_is_fixed:
            s = 2j * np.pi * frequency
            bushing = self.bushing
            swinging = bushing.support_damping * s + bushing.clamp_inertia * s * s
            turning = s * s / (bushing.support_stiffness + swinging)
            acceleration = acceleration + self.lever * turning
            pressure = pressure + self.clamp_to_pressure * late * turning
        return acceleration, pressure

    def measured(
        self, support_stiffness: float, rng: Rng, *, poor: bool = False
    ) -> MeasuredResponse:
        """Return the responses to the torque by a hammer test of a support [Nm/rad]."""
        acceleration, pressure = (_as_measured(h, rng, poor) for h in self.from_torque(_LINES))
        return MeasuredResponse(
            support_stiffness,
            TransferFunction(_LINES, *acceleration, "N m", "m/s^2", "torque_to_acceleration"),
            TransferFunction(_LINES, *pressure, "N m", "Pa", "torque_to_pressure"),
        )

    def response(self, rate: float) -> ImpulseResponses:
        """Return the impulse responses at a sampling rate [Hz]."""
        n = int(0.25 * rate)
        frequency = np.asarray(np.fft.rfftfreq(2 * n, 1.0 / rate), np.float64)
        x = np.clip((frequency - 0.4 * rate) / (0.05 * rate), 0.0, 1.0)
        taper = 0.5 + 0.5 * np.cos(np.pi * x)
        acceleration, pressure = self.from_torque(frequency)
        struck = _modes(frequency, self.anchors)
        late = np.exp(-2j * np.pi * frequency * self.distance / _SOUND_SPEED)

        def impulse(response: NDArray[np.complex128]) -> Array:
            return np.asarray(irfft(response * taper, 2 * n)[:n])

        return ImpulseResponses(
            rate, impulse(acceleration), impulse(pressure), impulse(struck),
            impulse(0.02 * late * struck),
        )  # fmt: skip


def draw_structure(bushing: LumpedBushing, rng: Rng, trade: str = "thesis") -> Structure:
    """Draw the structure of a support; beams and fixed clamps of stiffer supports ring higher."""
    fixed, row = bushing.clamp_is_fixed, TRADES[trade]
    stiffer = 1.0 if fixed else (bushing.support_stiffness / 2214.0) ** 0.67
    n_beams, n_plate = int(rng.integers(2, 7)), int(rng.integers(*row["modes"]))
    frequency = stiffer * log_uniforms(rng, 500.0, 7500.0, n_beams)
    damping, constant = rng.uniform(0.008, 0.03, n_beams), rng.uniform(3.0, 18.0, n_beams)
    constant *= (0.2 if fixed else 1.0) * rng.choice([-1.0, 1.0], n_beams)
    beams = np.array([frequency, damping, constant])
    if fixed:
        n = int(rng.integers(2, 6))
        low, damping = log_uniforms(rng, 110.0, 900.0, n), rng.uniform(0.01, 0.03, n)
        beams = np.concatenate([beams, [low, damping, rng.uniform(0.4, 2.5, n)]], axis=1)
    least, most = row["damping_ratios"]
    loud = 0.012 * row["loud"] * log_uniform(0.4, 2.5, rng)
    plate = [
        log_uniforms(rng, 110.0, 12e3, n_plate),
        rng.uniform(least, most, n_plate),
        loud * rng.standard_normal(n_plate),
    ]
    anchors = [
        log_uniforms(rng, 1500.0, 12e3, 8),
        rng.uniform(0.008, 0.04, 8),
        (0.6 if fixed else 1.2) * rng.standard_normal(8),
    ]
    return Structure(
        bushing,
        beams,
        np.array(plate),
        np.array(anchors),
        lever=float(rng.uniform(0.06, 0.1)),
        clamp_to_pressure=6e-5 * float(rng.uniform(0.5, 1.6)),
        distance=float(rng.uniform(0.3, 1.0)),
    )


def _modes(frequency: Array, modes: Array) -> NDArray[np.complex128]:
    total = np.zeros(frequency.size, dtype=complex)
    for f, damping, constant in modes.T.tolist():
        x = frequency / f
        total -= constant * x * x / (1.0 - x * x + 2j * damping * x)
    return total


def _as_measured(
    response: NDArray[np.complex128], rng: Rng, poor: bool
) -> tuple[NDArray[np.complex128], Array]:
    """Return a response with the scatter of an average over impacts, and its coherence."""
    size = np.abs(response)
    floor = 0.006 * float(np.median(size)) * (1.0 + (30.0 / _LINES) ** 2)
    noise = (floor / size) ** 2 + 1e-3 * (1.0 + (_LINES / 6e3) ** 4)
    impacts, gain = 32, 1.0
    if poor:  # in coherence, number of impacts, and the channel's gain
        noise += 1.0 / float(rng.uniform(0.85, 0.97)) - 1.0
        impacts = int(rng.integers(3, 9))
        gain += float(rng.uniform(-0.06, 0.06))
    coherence = 1.0 / (1.0 + np.minimum(noise, 9.0))
    spread = size * np.sqrt((1.0 - coherence) / (2.0 * impacts * coherence))
    error = rng.standard_normal((2, _LINES.size)) * spread / math.sqrt(2.0)
    return np.asarray(gain * (response + error[0] + 1j * error[1])), coherence
