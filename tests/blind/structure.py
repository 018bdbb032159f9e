"""The second rig's own clamp, beams, plate and room, from torque to acceleration and pressure.

Modal, with numbers of its own. The clamp's torsional mode is the one that the motion itself has;
all else is a sum of modes that the torque of the elastomer drives. A user gets it measured:
frequency responses with the scatter and coherence of some thirty hammer blows, whose soft tip
spends itself at low frequencies.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from . import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .rig import Parameters, Signals, Turned

__all__ = ["Structure", "accelerance", "draw_structure", "filtered"]

_BLOWS = 32
_LINES = np.arange(10.0, 10_001.0, 2.5)
_POOR_NOISE, _POOR_GAIN = 1.0 / 0.9 - 1.0, 0.05
_LEAST_WIDTH = 7.5
"""Of a mode at half power [Hz]: three lines, since a hammer test could not resolve a narrower one.
Low ones that are lighter damped would besides ring on from the start into the recording."""
_WAY_BACK = 0.06
"""In which a torque goes gently back to where it began, as a periodic convolution has it do [s]."""


def accelerance(f, frequencies, dampings, gains):
    """Sum of modes g s^2 / (s^2 + 2 zeta omega s + omega^2) at frequencies `f` [Hz]."""
    total = np.zeros(f.size, dtype=complex)
    for f_r, zeta, gain in zip(frequencies, dampings, gains, strict=True):
        x = f / f_r
        total += -gain * x * x / (1.0 - x * x + 2j * zeta * x)
    return total


def filtered(signal, rate, response, pad=0):
    """Send a signal through a frequency response, given as a function of frequency."""
    n = next_fast_len(signal.size + pad, real=True)
    h = response(np.fft.rfftfreq(n, 1.0 / rate))
    return irfft(rfft(signal, n) * h, n)[: signal.size]


@dataclass(frozen=True, eq=False)
class Structure:
    """Modes of one support: rows of frequency, damping ratio and gain."""

    arm: float
    beams: NDArray[np.float64]
    plate: NDArray[np.float64]
    clamp_to_pressure: float
    distance: float
    kept: dict[tuple[int, float], tuple[NDArray, NDArray]] = field(default_factory=dict)

    def paths(self, f):
        """Torque to acceleration and to pressure, without the clamp's torsional mode."""
        late = np.exp(-2j * np.pi * f * self.distance / 343.0)
        return accelerance(f, *self.beams), late * accelerance(f, *self.plate)

    def respond(self, turned: Turned) -> Signals:
        """Acceleration and pressure of a run, from rest on."""
        torque = turned.states[:, kernel.TORQUE]
        clamp = turned.states[:, kernel.CLAMP_ACCELERATION]
        n = next_fast_len(torque.size + round(_WAY_BACK * turned.rate), real=True)
        turn = 0.5 + 0.5 * np.cos(np.linspace(0.0, np.pi, n - torque.size))
        closed = np.concatenate([torque, torque[0] + turn * (torque[-1] - torque[0])])
        key = (n, turned.rate)
        if key not in self.kept:
            f = np.fft.rfftfreq(n, 1.0 / turned.rate)
            self.kept[key] = (*self.paths(f), np.exp(-2j * np.pi * f * self.distance / 343.0))
        to_acceleration, to_pressure, late = self.kept[key]
        spectrum, turning = rfft(closed), rfft(clamp, n)
        acceleration = irfft(spectrum * to_acceleration, n)[: torque.size] + self.arm * clamp
        pressure = irfft(spectrum * to_pressure + self.clamp_to_pressure * late * turning, n)
        return {"acceleration": acceleration, "pressure": pressure[: torque.size]}

    def exact(self, parameters: Parameters, f):
        """Responses to the torque at frequencies `f` [Hz], the clamp's torsional mode in them."""
        to_acceleration, to_pressure = self.paths(f)
        if parameters.support_stiffness > 0.0:
            w = 2.0 * np.pi * f
            turning = -(w**2) / (
                parameters.support_stiffness
                + 0.5j * w * parameters.damping
                - parameters.clamp_inertia * w**2
            )
            to_acceleration = to_acceleration + self.arm * turning
            late = np.exp(-1j * w * self.distance / 343.0)
            to_pressure = to_pressure + self.clamp_to_pressure * late * turning
        return to_acceleration, to_pressure

    def measured(self, parameters: Parameters, rng: np.random.Generator, *, poor: bool = False):
        """Return what a hammer test gives: two mappings as an NPZ file holds them.

        A poor one has a coherence of 0.9 at most, and gains that are off by 5 %.
        """
        measured = []
        for response, unit in zip(self.exact(parameters, _LINES), ("m/s^2", "Pa"), strict=True):
            floor = 0.006 * np.median(np.abs(response)) * (1.0 + (30.0 / _LINES) ** 2)
            noise = (floor / np.abs(response)) ** 2 + 1e-3 * (1.0 + (_LINES / 6e3) ** 4)
            noise += _POOR_NOISE if poor else 0.0
            coherence = 1.0 / (1.0 + np.minimum(noise, np.where(_LINES < 250.0, 0.3, 9.0)))
            spread = np.abs(response) * np.sqrt((1.0 - coherence) / (2 * _BLOWS * coherence))
            error = rng.standard_normal((2, _LINES.size)) * spread / np.sqrt(2.0)
            found = np.clip(
                coherence
                + rng.standard_normal(_LINES.size)
                * (1.0 - coherence)
                * np.sqrt(2.0 * coherence / _BLOWS),
                0.01,
                1.0,
            )
            gain = np.exp(_POOR_GAIN * rng.standard_normal()) if poor else 1.0
            measured.append({
                "frequency_hz": _LINES,
                "response": (gain * (response + error[0] + 1j * error[1])).astype(np.complex64),
                "coherence": found.astype(np.float32),
                "input_unit": np.array("N m"),
                "output_unit": np.array(unit),
            })  # fmt: skip
        return tuple(measured)


def draw_structure(rng: np.random.Generator, support_stiffness: float) -> Structure:
    """Draw the structure of one support; shorter, stiffer beams ring higher."""
    scale = 1.0 if support_stiffness < 0.0 else (support_stiffness / 2214.0) ** 0.67
    beams = scale * np.array([930.0, 1480.0, 4350.0, 6100.0]) * rng.uniform(0.92, 1.08, 4)
    strength = 0.15 if support_stiffness < 0.0 else 1.0
    gains = strength * np.array([14.0, -9.0, 6.0, 5.0]) * rng.uniform(0.7, 1.4, 4)
    zetas = rng.uniform(0.01, 0.025, 8)
    if support_stiffness < 0.0:  # bolted down, the clamp moves with the plate
        beams = np.append(beams, np.array([140.0, 240.0, 410.0, 640.0]) * rng.uniform(0.9, 1.1, 4))
        gains = np.append(gains, rng.uniform(0.5, 2.0, 4))
    plate = np.sort(np.exp(rng.uniform(np.log(130.0), np.log(11e3), 26)))
    lossy = np.maximum(rng.uniform(0.008, 0.03, 26), 0.5 * _LEAST_WIDTH / plate)
    zetas = np.maximum(zetas[: beams.size], 0.5 * _LEAST_WIDTH / beams)
    return Structure(
        arm=0.08,
        beams=np.array([beams, zetas, gains]),
        plate=np.array([plate, lossy, 0.012 * rng.standard_normal(26)]),
        clamp_to_pressure=6e-5 * rng.uniform(0.7, 1.3),
        distance=rng.uniform(0.4, 0.8),
    )
