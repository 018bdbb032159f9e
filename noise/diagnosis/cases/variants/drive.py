"""Further forms of a drive that turns unevenly, and of a shaft that yields."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    log_uniform,
    on_contact,
    on_drive,
    telegraph,
)  # fmt: skip
from noise.diagnosis.cases.variants.hooks import compliance_hook
from sim.effects.effect import Effect

_HIGHEST = 2.0 * math.pi * 4e3
"""[rad/s]"""

_LEAST_SPEED = 0.05
"""Of the mean one, so that the shaft does not turn back."""

_DEEPEST = 0.6
"""Depth at strength 1, of a sine [-]."""

_SOFTEST = 2.5e-3
"""Compliance at strength 1: 400 Nm/rad, less than the elastomer's stiffness [rad/Nm]."""


def _compliance(
    form: str, a: float, rng: Rng, *, softening: float = 0.0, cubic: float = 0.0,
    dry_torque: float = 0.0, branch: float = 0.0, damping_ratio: tuple[float, float] = (0.01, 0.2),
    inertias: tuple[float, float] = (3e-5, 2e-4),
) -> Effect:  # fmt: skip
    if a == 0.0:
        numbers = np.zeros(11)
    else:
        stiffness = 1.0 / (_SOFTEST * a)
        lag = log_uniform(rng, 4.0, 20.0) / stiffness
        built = dry_torque / stiffness / float(rng.uniform(0.2, 0.7)) or 1.0
        stiffest = stiffness * (1.0 + branch + 0.7 * (dry_torque > 0.0) + 3.0 * cubic)
        inertia = max(log_uniform(rng, *inertias), stiffest / _HIGHEST**2)
        damping = 2.0 * log_uniform(rng, *damping_ratio) * math.sqrt(stiffness * inertia)
        numbers = np.array([
            inertia, stiffness, softening, cubic, lag, damping, dry_torque, built,
            branch, 1.0 / log_uniform(rng, 2e-4, 1e-2), 0.0,
        ])  # fmt: skip
    return on_contact(
        "shaft_compliance", form, a, compliance_hook, lambda _rng: numbers, n_states=2
    )


def _shaft_softening(a: float, rng: Rng) -> Effect:
    return _compliance("softening", a, rng, softening=float(rng.uniform(0.4, 0.8)))


def _shaft_cubic(a: float, rng: Rng) -> Effect:
    return _compliance("cubic", a, rng, cubic=float(rng.uniform(0.3, 0.8)))


def _shaft_dry(a: float, rng: Rng) -> Effect:
    """Rub in its own bearing or coupling."""
    return _compliance("dry_friction", a, rng, dry_torque=log_uniform(rng, 0.2, 2.0))


def _shaft_creeping(a: float, rng: Rng) -> Effect:
    """Yield through a rubber coupling, which relaxes."""
    return _compliance("maxwell_branch", a, rng, branch=log_uniform(rng, 0.3, 2.0))


def _shaft_heavy(a: float, rng: Rng) -> Effect:
    """Carry a flange or a brake disc at its end, so that it swings slowly."""
    return _compliance("heavy_end", a, rng, inertias=(2e-4, 1e-2))


def _shaft_damped(a: float, rng: Rng) -> Effect:
    return _compliance("damped", a, rng, damping_ratio=(0.2, 1.5))


def _shaft_ringing(a: float, rng: Rng) -> Effect:
    return _compliance("ringing", a, rng, damping_ratio=(0.001, 0.01))


def _uneven(
    form: str, a: float, time_series: Callable[[Array, float, Rng], Array], most: float = _DEEPEST
) -> Effect:
    def change(speed: Array, rate: float, rng: Rng) -> Array:
        q = time_series(np.arange(speed.size) / rate, rate, rng)
        q = q - q.mean()
        size = float(q.std())
        depth = most * a * math.sqrt(0.5) / size if size > 1e-9 else 0.0
        return np.asarray(np.maximum(depth * q, _LEAST_SPEED - 1.0))

    return on_drive("speed_fluctuation", form, a, change)


def _sawtooth(a: float, rng: Rng) -> Effect:
    frequency, width = log_uniform(rng, 2.0, 60.0), float(rng.uniform(0.03, 0.97))

    def time_series(time: Array, _rate: float, rng: Rng) -> Array:
        turn = (frequency * time + rng.random()) % 1.0
        return np.where(turn < width, turn / width, (1.0 - turn) / (1.0 - width))

    return _uneven("sawtooth", a, time_series)


def _belt_slip(a: float, rng: Rng) -> Effect:
    often, recovery = log_uniform(rng, 4.0, 30.0), log_uniform(rng, 5e-3, 0.06)

    def time_series(time: Array, rate: float, rng: Rng) -> Array:
        slips = (rng.random(time.size) < often / rate) * rng.exponential(1.0, time.size)
        slips[int(rng.integers(time.size))] += 1.0
        attack, decay = math.exp(-1.0 / (2e-3 * rate)), math.exp(-1.0 / (recovery * rate))
        return -np.asarray(lfilter([1.0], np.convolve([1.0, -attack], [1.0, -decay]), slips))

    return _uneven("belt_slip", a, time_series)


def _beating(a: float, rng: Rng) -> Effect:
    first = log_uniform(rng, 2.0, 60.0)
    second = first * (1.0 + float(rng.uniform(0.03, 0.3)))
    balance = float(rng.uniform(0.4, 1.0))

    def time_series(time: Array, _rate: float, rng: Rng) -> Array:
        phases = 2.0 * np.pi * rng.random(2)
        beat = np.sin(2 * np.pi * first * time + phases[0])
        return np.asarray(beat + balance * np.sin(2 * np.pi * second * time + phases[1]))

    return _uneven("beating", a, time_series)


def _ripple(a: float, rng: Rng) -> Effect:
    """Pulse with poles, teeth or the inverter: a fast ripple of few orders."""
    frequency = log_uniform(rng, 40.0, 400.0)
    second, balance = int(rng.integers(2, 5)), float(rng.uniform(0.0, 0.7))

    def time_series(time: Array, _rate: float, rng: Rng) -> Array:
        phases = 2.0 * np.pi * rng.random(2)
        first = np.sin(2 * np.pi * frequency * time + phases[0])
        return np.asarray(
            first + balance * np.sin(2 * np.pi * second * frequency * time + phases[1])
        )

    return _uneven("ripple", a, time_series, 0.5)


def _controller(a: float, rng: Rng) -> Effect:
    frequency, damping = log_uniform(rng, 4.0, 45.0), log_uniform(rng, 0.02, 0.3)

    def time_series(time: Array, rate: float, rng: Rng) -> Array:
        coarse = 2000.0  # [Hz]; far above any controller
        n = math.ceil(time.size / rate * coarse) + 2
        before = math.ceil(coarse / (damping * frequency))
        radius = math.exp(-2.0 * math.pi * damping * frequency / coarse)
        turn = 2.0 * math.pi * frequency / coarse
        poles = [1.0, -2.0 * radius * math.cos(turn), radius**2]
        ringing = lfilter([1.0], poles, rng.standard_normal(n + before))[before:]
        return np.asarray(np.interp(time, np.arange(n) / coarse, ringing))

    return _uneven("controller_resonance", a, time_series)


def _steps(a: float, rng: Rng) -> Effect:
    often, rounding = log_uniform(rng, 6.0, 60.0), log_uniform(rng, 2e-3, 0.02)

    def time_series(time: Array, rate: float, rng: Rng) -> Array:
        decay = math.exp(-1.0 / (rounding * rate))
        smooth = [(1.0 - decay) ** 2], [1.0, -2.0 * decay, decay**2]
        return np.asarray(lfilter(*smooth, telegraph(rng, time.size, rate, often)))

    return _uneven("steps", a, time_series)


def _ramp(a: float, rng: Rng) -> Effect:
    """Speed up or slow down through the recording, as a drive that warms or is let go."""
    bend = float(rng.uniform(0.5, 2.0))
    sign = float(rng.choice([-1.0, 1.0]))
    return _uneven(
        "ramp", a, lambda time, _rate, _rng: sign * (time / (float(time[-1]) or 1.0)) ** bend
    )


def _hunting(a: float, rng: Rng) -> Effect:
    """Hunt with a frequency that wanders."""
    frequency, wide = log_uniform(rng, 2.0, 30.0), float(rng.uniform(0.1, 0.5))
    slow = log_uniform(rng, 0.5, 4.0)

    def time_series(time: Array, _rate: float, rng: Rng) -> Array:
        wander = wide * frequency / slow * np.sin(2 * np.pi * (slow * time + rng.random()))
        return np.asarray(np.sin(2 * np.pi * (frequency * time + rng.random()) + wander))

    return _uneven("hunting", a, time_series)


# Bearings and flanges: Den Hartog 1956.
SHAFT: tuple[Recipe, ...] = (
    _shaft_softening, _shaft_cubic, _shaft_dry, _shaft_creeping, _shaft_heavy, _shaft_damped,
    _shaft_ringing,
)  # fmt: skip
FLUCTUATION: tuple[Recipe, ...] = (
    _sawtooth,
    _belt_slip,
    _beating,
    _ripple,
    _controller,
    _steps,
    _ramp,
    _hunting,
)
