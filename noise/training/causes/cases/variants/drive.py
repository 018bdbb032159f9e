"""Further forms of a drive that turns unevenly."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.signal import lfilter

from noise.diagnosis.cases.draws import Array, Rng, telegraph

_LEAST_SPEED = 0.05
"""Of the mean one, so that the shaft does not turn back."""


def uneven(a: float, form: str, most: float = 0.6, **numbers: Any) -> dict[str, Any]:
    """Change the speed by a time series, of a depth at strength 1 as a sine has it."""

    def drive(speed: Array, rate: float, _form: str, _values: Any, rng: Rng) -> Array:
        q = _SERIES[form](np.arange(speed.size) / rate, rate, rng, **numbers)
        q = q - q.mean()
        size = float(q.std())
        depth = most * a * math.sqrt(0.5) / size if size > 1e-9 else 0.0
        return np.asarray(speed * (1.0 + np.maximum(depth * q, _LEAST_SPEED - 1.0)))

    return {"drive": drive}


def _sawtooth(time: Array, _rate: float, rng: Rng, frequency: float, width: float) -> Array:
    turn = (frequency * time + rng.random()) % 1.0
    return np.where(turn < width, turn / width, (1.0 - turn) / (1.0 - width))


def _belt_slip(time: Array, rate: float, rng: Rng, often: float, recovery: float) -> Array:
    slips = (rng.random(time.size) < often / rate) * rng.exponential(1.0, time.size)
    slips[int(rng.integers(time.size))] += 1.0
    attack, decay = math.exp(-1.0 / (2e-3 * rate)), math.exp(-1.0 / (recovery * rate))
    return -np.asarray(lfilter([1.0], np.convolve([1.0, -attack], [1.0, -decay]), slips))


def _beating(
    time: Array, _rate: float, rng: Rng, frequency: float, apart: float, balance: float
) -> Array:
    second = frequency * (1.0 + apart)
    phases = 2.0 * np.pi * rng.random(2)
    beat = np.sin(2 * np.pi * frequency * time + phases[0])
    return np.asarray(beat + balance * np.sin(2 * np.pi * second * time + phases[1]))


def _ripple(
    time: Array, _rate: float, rng: Rng, frequency: float, second: int, balance: float
) -> Array:
    """Pulse with poles, teeth or the inverter: a fast ripple of few orders."""
    phases = 2.0 * np.pi * rng.random(2)
    first = np.sin(2 * np.pi * frequency * time + phases[0])
    return np.asarray(first + balance * np.sin(2 * np.pi * second * frequency * time + phases[1]))


def _controller(time: Array, rate: float, rng: Rng, frequency: float, damping: float) -> Array:
    coarse = 2000.0  # [Hz]; far above any controller
    n = math.ceil(time.size / rate * coarse) + 2
    before = math.ceil(coarse / (damping * frequency))
    radius = math.exp(-2.0 * math.pi * damping * frequency / coarse)
    turn = 2.0 * math.pi * frequency / coarse
    poles = [1.0, -2.0 * radius * math.cos(turn), radius**2]
    ringing = lfilter([1.0], poles, rng.standard_normal(n + before))[before:]
    return np.asarray(np.interp(time, np.arange(n) / coarse, ringing))


def _steps(time: Array, rate: float, rng: Rng, often: float, rounding: float) -> Array:
    decay = math.exp(-1.0 / (rounding * rate))
    smooth = [(1.0 - decay) ** 2], [1.0, -2.0 * decay, decay**2]
    return np.asarray(lfilter(*smooth, telegraph(rng, time.size, rate, often)))


def _ramp(time: Array, _rate: float, _rng: Rng, bend: float, sign: float) -> Array:
    """Speed up or slow down through the recording, as a drive that warms or is let go."""
    return np.asarray(sign * (time / (float(time[-1]) or 1.0)) ** bend)


def _hunting(
    time: Array, _rate: float, rng: Rng, frequency: float, wide: float, slow: float
) -> Array:
    """Hunt with a frequency that wanders."""
    wander = wide * frequency / slow * np.sin(2 * np.pi * (slow * time + rng.random()))
    return np.asarray(np.sin(2 * np.pi * (frequency * time + rng.random()) + wander))


_SERIES: dict[str, Callable[..., Array]] = {
    "sawtooth": _sawtooth, "belt_slip": _belt_slip, "beating": _beating, "ripple": _ripple,
    "controller_resonance": _controller, "steps": _steps, "ramp": _ramp, "hunting": _hunting,
}  # fmt: skip
