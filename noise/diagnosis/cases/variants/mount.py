"""Further forms of sensors that move on their mounts."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.signal import bilinear, butter, lfilter, lfilter_zi

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    draw_shares,
    log_uniform,
    log_uniforms,
    on_sensors,
)  # fmt: skip
from sim.effects.effect import Effect


def _mounts(form: str, a: float, rng: Rng, lost: Callable[[Array, float], Array]) -> Effect:
    """Take away what the mount does not pass: ``lost(x, rate)``."""
    mostly = ("acceleration",) if rng.random() < 0.7 else ("torque", "acceleration", "pressure")

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        return np.asarray(x - a * share * lost(x, rate))

    return on_sensors("mount_resonance", form, a, draw_shares(rng, mostly), change)


def _filtered(x: Array, b: Array, c: Array) -> Array:
    return np.asarray(lfilter(b, c, x, zi=lfilter_zi(b, c) * x[0])[0])


def _mode(x: Array, rate: float, frequency: float, damping: float, numerator: list[float]) -> Array:
    """Filter by a mode, with a numerator in falling powers of s / omega."""
    share = min(frequency / rate, 0.45)
    tuned = 0.5 / math.tan(math.pi * share)
    return _filtered(x, *bilinear(numerator, [1.0, 2.0 * damping, 1.0], fs=tuned))


def _moving(x: Array, rate: float, frequency: float, damping: float) -> Array:
    """Relative motion of a mode below its base, of gain 1 far above."""
    return _mode(x, rate, frequency, damping, [1.0, 0.0, 0.0])


def _mount_several(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(3, 6))
    modes = log_uniforms(rng, 900.0, 12e3, n).tolist()
    dampings = log_uniforms(rng, 0.012, 0.15, n).tolist()
    parts = rng.dirichlet(np.full(n, 2.0)).tolist()
    listed = list(zip(modes, dampings, parts, strict=True))
    return _mounts(
        "several", a, rng,
        lambda x, rate: np.asarray(sum(part * _moving(x, rate, f, d) for f, d, part in listed)),
    )  # fmt: skip


def _mount_cascade(a: float, rng: Rng) -> Effect:
    first, second = log_uniform(rng, 900.0, 5000.0), log_uniform(rng, 3000.0, 12e3)
    dampings = [log_uniform(rng, 0.02, 0.2) for _ in range(2)]

    def lost(x: Array, rate: float) -> Array:
        base = x - _moving(x, rate, first, dampings[0])
        return np.asarray(x - (base - _moving(base, rate, second, dampings[1])))

    return _mounts("cascade", a, rng, lost)


def _mount_absorbing(a: float, rng: Rng) -> Effect:
    """Swallow a band rather than ring in it, as a cable or a putty does."""
    frequency, damping = log_uniform(rng, 900.0, 9000.0), log_uniform(rng, 0.1, 0.6)

    def lost(x: Array, rate: float) -> Array:
        return _mode(x, rate, frequency, damping, [0.0, 2.0 * damping, 0.0])

    return _mounts("absorbing", a, rng, lost)


def _mount_soft(a: float, rng: Rng) -> Effect:
    corner, order = log_uniform(rng, 900.0, 7000.0), int(rng.integers(1, 4))

    def lost(x: Array, rate: float) -> Array:
        return np.asarray(x - _filtered(x, *butter(order, 2.0 * min(corner, 0.45 * rate) / rate)))

    return _mounts("soft", a, rng, lost)


def _mount_any(form: str, band: tuple[float, float], dampings: tuple[float, float]) -> Recipe:
    """Ring on one mode of a band: a stud's, a magnet's, a hand's."""

    def recipe(a: float, rng: Rng) -> Effect:
        frequency, damping = log_uniform(rng, *band), log_uniform(rng, *dampings)
        return _mounts(form, a, rng, lambda x, rate: _moving(x, rate, frequency, damping))

    return recipe


def _mount_peak(a: float, rng: Rng) -> Effect:
    """Ring without losing what lies above: a bracket beside the sensor."""
    frequency, damping = log_uniform(rng, 400.0, 12e3), log_uniform(rng, 0.01, 0.2)
    peak = log_uniform(rng, 2.0, 15.0)

    def lost(x: Array, rate: float) -> Array:
        return -peak * _mode(x, rate, frequency, damping, [0.0, 2.0 * damping, 0.0])

    return _mounts("peak", a, rng, lost)


def _mount_rattling(a: float, rng: Rng) -> Effect:
    """Lift off where the motion pulls: what is beyond a level is read as a ringing less."""
    frequency, damping = log_uniform(rng, 1500.0, 9000.0), log_uniform(rng, 0.03, 0.2)
    level = float(rng.uniform(0.5, 2.0))

    def lost(x: Array, rate: float) -> Array:
        over = np.maximum(x - level * x.std() - x.mean(), 0.0)
        return np.asarray(over + _moving(over, rate, frequency, damping))

    return _mounts("lifting", a, rng, lost)


# ISO 5348; soft mounts as isolators (Den Hartog 1956).
MOUNT: tuple[Recipe, ...] = (
    _mount_several, _mount_cascade, _mount_absorbing, _mount_soft, _mount_peak, _mount_rattling,
    _mount_any("very_soft", (150.0, 900.0), (0.02, 0.5)),
    _mount_any("damped", (400.0, 6000.0), (0.2, 1.0)),
    _mount_any("hard", (5000.0, 14e3), (0.01, 0.1)),
)  # fmt: skip
