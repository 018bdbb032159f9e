"""Further forms of a drive that turns unevenly, and of a shaft that yields."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

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

if TYPE_CHECKING:
    from collections.abc import Callable

    from sim.effects.effect import Effect

__all__ = ["FLUCTUATION", "SHAFT"]

_HIGHEST = 2.0 * math.pi * 4e3
"""[rad/s]"""

_LEAST_SPEED = 0.05
"""Of the mean one, so that the shaft does not turn back."""


def _compliance(
    form: str,
    a: float,
    rng: Rng,
    *,
    softening: float = 0.0,
    cubic: float = 0.0,
    dry_torque: float = 0.0,
    branch: float = 0.0,
) -> Effect:
    if a == 0.0:
        numbers = np.zeros(10)
    else:
        stiffness = 1.0 / (8e-4 * a)
        lag = log_uniform(rng, 4.0, 20.0) / stiffness
        built = dry_torque / stiffness / float(rng.uniform(0.2, 0.7)) or 1.0
        stiffest = stiffness * (1.0 + branch + 0.7 * (dry_torque > 0.0) + 3.0 * cubic)
        inertia = max(log_uniform(rng, 3e-5, 2e-4), stiffest / _HIGHEST**2)
        damping = 2.0 * log_uniform(rng, 0.01, 0.2) * math.sqrt(stiffness * inertia)
        numbers = np.array([
            inertia, stiffness, softening, cubic, lag, damping, dry_torque, built,
            branch, 1.0 / log_uniform(rng, 2e-4, 1e-2),
        ])  # fmt: skip
    return on_contact(
        "shaft_compliance", form, a, compliance_hook, lambda _rng: numbers, n_states=2
    )


def _shaft_softening(a: float, rng: Rng) -> Effect:
    return _compliance("softening", a, rng, softening=float(rng.uniform(0.4, 0.8)))


def _shaft_cubic(a: float, rng: Rng) -> Effect:
    return _compliance("cubic", a, rng, cubic=float(rng.uniform(0.3, 0.8)))


def _shaft_dry(a: float, rng: Rng) -> Effect:
    return _compliance("dry_friction", a, rng, dry_torque=log_uniform(rng, 0.2, 2.0))


def _shaft_creeping(a: float, rng: Rng) -> Effect:
    return _compliance("maxwell_branch", a, rng, branch=log_uniform(rng, 0.3, 2.0))


def _uneven(form: str, a: float, time_series: Callable[[Array, float, Rng], Array]) -> Effect:
    def change(speed: Array, rate: float, rng: Rng) -> Array:
        q = time_series(np.arange(speed.size) / rate, rate, rng)
        q = q - q.mean()
        size = float(q.std())
        depth = 0.25 * a * math.sqrt(0.5) / size if size > 1e-9 else 0.0
        return np.asarray(np.maximum(depth * q, _LEAST_SPEED - 1.0))

    return on_drive("speed_fluctuation", form, a, change)


def _sawtooth(a: float, rng: Rng) -> Effect:
    frequency, width = log_uniform(rng, 3.0, 45.0), float(rng.uniform(0.03, 0.97))

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
    first = log_uniform(rng, 4.0, 45.0)
    second = first * (1.0 + float(rng.uniform(0.03, 0.3)))
    balance = float(rng.uniform(0.4, 1.0))

    def time_series(time: Array, _rate: float, rng: Rng) -> Array:
        phases = 2.0 * np.pi * rng.random(2)
        beat = np.sin(2 * np.pi * first * time + phases[0])
        return np.asarray(beat + balance * np.sin(2 * np.pi * second * time + phases[1]))

    return _uneven("beating", a, time_series)


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


SHAFT: tuple[Recipe, ...] = (_shaft_softening, _shaft_cubic, _shaft_dry, _shaft_creeping)
FLUCTUATION: tuple[Recipe, ...] = (_sawtooth, _belt_slip, _beating, _controller, _steps)
