"""Driven oscillators with missing terms in many forms, by an integrator of their own."""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.signal import resample

from tests.studies.oscillator_terms import DrivenRecord

RATE = 610.35
GAIN = 1.3
"""Static displacement a drive."""

FORCES = (
    "none", "x^2", "x^3", "sign v", "v|v|", "v^3", "t x", "hardening by tanh", "x|x|^1.5",
    "softening by tanh", "even root", "log cosh", "Dahl", "arctan v", "v|v|^0.8", "sinh v",
    "relaxing", "echo", "second mode",
)  # fmt: skip
_OVER = 16


@njit
def _moved(kind, drive, h, omega, zeta, a, x_of):
    """Semi-implicit Euler at many times the rate; `memory` is the state of Dahl and other forms."""
    x = v = memory = memory_speed = 0.0
    for i in range(len(drive)):
        if i % 16 == 0:
            x_of[i // 16] = x
        s = v / omega
        t = i / len(drive) - 0.5
        f = 0.0
        if kind == 1:
            f = a * x * x
        elif kind == 2:
            f = a * x**3
        elif kind == 3:
            f = a * np.tanh(s / 0.01)
        elif kind == 4:
            f = a * s * abs(s)
        elif kind == 5:
            f = a * s**3
        elif kind == 6:
            f = a * t * x
        elif kind == 7:
            f = a * (x - 1.5 * np.tanh(x / 1.5))
        elif kind == 8:
            f = a * x * abs(x) ** 1.5
        elif kind == 9:
            f = -a * (x - np.tanh(x))
        elif kind == 10:
            f = a * (np.sqrt(1.0 + x * x) - 1.0)
        elif kind == 11:
            f = a * np.log(np.cosh(x))
        elif kind == 12:
            f = a * memory
        elif kind == 13:
            f = a * 2.0 / np.pi * np.arctan(s / 0.05)
        elif kind == 14:
            f = a * s * abs(s) ** 0.8
        elif kind == 15:
            f = a * (np.sinh(0.8 * s) - 0.8 * s)
        elif kind == 16:
            f = a * x * np.exp(-(t + 0.5) / 0.6)
        elif kind == 17:
            f = -a * x_of[max(i // 16 - 40, 0)]
        elif kind == 18:
            f = a * 10.0 * (x - memory)
        v += h * (omega * omega * (drive[i] - x - f) - 2.0 * zeta * omega * v)
        step = h * v
        if kind == 12:
            memory += step / 0.05 * (1.0 - memory * np.sign(v))
        elif kind == 18:
            rate = 1.7 * omega
            memory_speed += h * (rate * rate * (x - memory) - 0.02 * rate * memory_speed)
            memory += h * memory_speed
        x += step


def driven_record(
    force="none", strength=0.0, seed=1, samples=12_000, noise=0.003, driven=None, sensed=None
):
    """Noise-driven record, the first 2500 samples at a twentieth of the level.

    Forces act on a displacement of about unit rms; `driven` and `sensed` change the drive before
    it acts, also in its rms, and the displacement before noise is added.
    """
    rng = np.random.default_rng(seed)
    frequency = np.fft.rfftfreq(samples, 1.0 / RATE)
    spectrum = np.fft.rfft(rng.standard_normal(samples))
    spectrum[(frequency > 180.0) | (frequency < 2.0)] = 0.0
    drive = np.fft.irfft(spectrum, samples)
    level = 0.05 + 0.95 / (1.0 + np.exp(-(np.arange(samples) - 2600) / 25.0))
    drive *= level
    fine = resample(drive, samples * _OVER)
    x = np.empty(samples)
    turn, h = 2.0 * np.pi * 68.0, 1.0 / (RATE * _OVER)
    _moved(0, fine, h, turn, 0.05, 0.0, x)
    unit = 1.0 / np.std(x[3000:])
    if driven is not None:
        size = np.std(fine[3000 * _OVER :])
        fine = driven(fine / size) * size
    _moved(FORCES.index(force), fine * unit, h, turn, 0.05, strength, x)
    response = x if sensed is None else sensed(x)
    response = response + noise * rng.standard_normal(samples)
    return DrivenRecord(drive * unit / GAIN, response, RATE)
