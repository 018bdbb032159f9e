"""Further forms of friction over speed, age, torque and place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import lfilter

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    curve,
    drawn_curve,
    family,
    far_curve,
    hill,
    log_uniform,
    noise,
    on_contact,
    overshoot,
)  # fmt: skip
from noise.diagnosis.cases.variants.hooks import (
    ageing_hook,
    creep_hook,
    patch_hook,
    rate_dependence_hook,
)
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from collections.abc import Callable

    from sim.effects.effect import Effect

__all__ = ["AGEING", "CREEP", "SCATTER", "STRENGTHENING", "WEAKENING"]

_RENEWAL = 4e-4
_N_DRAWS = 4096


def _over_speed(
    name: str, form: str, a: float, gain: float, speed: float, shape: Array, lag: float = 0.0
) -> Effect:
    return on_contact(
        name, form, a, rate_dependence_hook,
        lambda _rng: np.concatenate([[gain, speed, lag], shape]), n_states=1,
    )  # fmt: skip


def _weakens(form: str, a: float, rng: Rng, shape: Array, lag: float = 0.0) -> Effect:
    speed = log_uniform(rng, 2.0, 20.0)
    return _over_speed("velocity_weakening", form, a, -0.5 * a, speed, shape, lag)


def _weak_lagging(a: float, rng: Rng) -> Effect:
    lag = log_uniform(rng, 1e-4, 2e-3)
    return _weakens("lagging", a, rng, drawn_curve(rng), lag)


def _strengthens(form: str, a: float, rng: Rng, shape: Array, height: float = 1.0) -> Effect:
    speed = log_uniform(rng, 5.0, 20.0)
    return _over_speed("velocity_strengthening", form, a, 0.5 * a * height, speed, shape)


def _strong_table(a: float, rng: Rng) -> Effect:
    return _strengthens("table", a, rng, drawn_curve(rng), float(rng.uniform(1.0, 2.5)))


def _strong_late(a: float, rng: Rng) -> Effect:
    n = float(rng.uniform(1.5, 3.0))
    return _strengthens("hill", a, rng, hill(n), 2.0)


def _ages(form: str, a: float, rng: Rng, shape: Array) -> Effect:
    time = log_uniform(rng, 5e-4, 2e-2)
    return on_contact(
        "static_ageing", form, a, ageing_hook,
        lambda _rng: np.concatenate([[0.97 * a, time, _RENEWAL], shape]), n_states=1,
    )  # fmt: skip


def _creeps(form: str, a: float, _rng: Rng, shape: Array, lag: float = 0.0) -> Effect:
    return on_contact(
        "partial_slip", form, a, creep_hook,
        lambda _rng: np.concatenate([[0.92 * a, lag], shape]), n_states=1,
    )  # fmt: skip


def _creep_lagging(a: float, rng: Rng) -> Effect:
    n, lag = log_uniform(rng, 1.0, 6.0), log_uniform(rng, 1e-4, 3e-3)
    return _creeps("lagging", a, rng, curve(lambda r: r**n), lag)


def _scatters(form: str, a: float, time_series: Callable[[Rng], Array]) -> Effect:
    def numbers(rng: Rng) -> Array:
        z = time_series(rng)
        return np.concatenate([[5e-3], 0.5 * a * (z - z.mean()) / z.std()])

    plain = EFFECTS["critical_torque_scatter"]
    return on_contact(
        "critical_torque_scatter", form, a, plain.contact, numbers, n_states=plain.n_states
    )


def _scatter_heavy(a: float, rng: Rng) -> Effect:
    freedom = float(rng.uniform(2.1, 4.0))
    return _scatters(
        "heavy_tails", a, lambda r: np.clip(r.standard_t(freedom, _N_DRAWS), -12.0, 12.0)
    )


def _scatter_long(a: float, rng: Rng) -> Effect:
    power = float(rng.uniform(0.25, 0.7))

    def time_series(rng: Rng) -> Array:
        size = np.maximum(np.arange(_N_DRAWS // 2 + 1), 8.0) ** -power
        return np.fft.irfft(size * np.exp(2j * np.pi * rng.random(size.size)), _N_DRAWS)

    return _scatters("long_memory", a, time_series)


def _scatter_states(a: float, rng: Rng) -> Effect:
    down, up = rng.uniform(0.05, 0.6, 2)

    def time_series(rng: Rng) -> Array:
        chance, state, states = rng.random(_N_DRAWS), 0, np.zeros(_N_DRAWS)
        for i in range(_N_DRAWS):
            if chance[i] < (down if state else up):
                state = 1 - state
            states[i] = state
        return np.asarray(states + 0.1 * rng.standard_normal(_N_DRAWS))

    return _scatters("two_states", a, time_series)


def _scatter_skewed(a: float, rng: Rng) -> Effect:
    sign, memory = float(rng.choice([-1.0, 1.0])), float(rng.uniform(0.0, 0.5))
    return _scatters(
        "skewed", a,
        lambda r: lfilter([1.0], [1.0, -memory], sign * r.standard_exponential(_N_DRAWS)),
    )  # fmt: skip


def _scatter_alternating(a: float, rng: Rng) -> Effect:
    memory = -float(rng.uniform(0.3, 0.9))
    return _scatters(
        "alternating", a, lambda r: lfilter([1.0], [1.0, -memory], r.standard_normal(_N_DRAWS))
    )


def _scatter_surface(a: float, rng: Rng) -> Effect:
    finest = log_uniform(rng, 5.0, 80.0)  # periods a radian

    def numbers(rng: Rng) -> Array:
        time_series = noise(rng, _N_DRAWS, 8.0 * finest, 0.05 * finest, finest)
        return np.concatenate([[8.0 * finest, _N_DRAWS], 1.0 + 0.5 * a * time_series])

    return on_contact("critical_torque_scatter", "surface", a, patch_hook, numbers)


def _power(rng: Rng) -> Array:
    p = float(rng.uniform(0.35, 0.8))
    return far_curve(lambda x: (np.minimum(x, 20.0) + 0.01) ** p - 0.01**p)


def _softplus(rng: Rng) -> Array:
    at, wide = float(rng.uniform(0.2, 1.0)), float(rng.uniform(0.1, 0.4))

    def shape(x: Array) -> Array:
        risen = wide * np.logaddexp(0.0, (np.minimum(x, 8.0) - at) / wide)
        return np.asarray(risen - wide * np.log1p(np.exp(-at / wide)))

    return far_curve(shape)


def _any_power(rng: Rng) -> Array:
    p = log_uniform(rng, 0.2, 2.0)
    return far_curve(lambda x: 1.0 - (1.0 + x) ** -p)


def _delayed(rng: Rng) -> Array:
    at, steep = float(rng.uniform(0.2, 1.0)), float(rng.uniform(1.0, 4.0))
    return far_curve(lambda x: -np.expm1(-steep * np.maximum(x - at, 0.0) ** 1.5))


def _stretched(rng: Rng) -> Array:
    p = float(rng.uniform(0.35, 0.75))
    return far_curve(lambda x: -np.expm1(-(x**p)))


def _threshold(rng: Rng) -> Array:
    at, n = float(rng.uniform(0.2, 0.85)), float(rng.uniform(1.0, 2.5))
    return curve(lambda r: np.maximum((r - at) / (1.0 - at), 0.0) ** n)


def _logarithm(rng: Rng) -> Array:
    k = 1.0 - log_uniform(rng, 1e-3, 0.1)
    return curve(lambda r: np.log1p(-k * r) / np.log1p(-k))


def _bristles(rng: Rng) -> Array:
    k = log_uniform(rng, 1.0, 20.0)
    return curve(lambda r: r / (1.0 + k * (1.0 - r)))


WEAKENING: tuple[Recipe, ...] = (
    *family(
        _weakens, ("arctangent", lambda _rng: far_curve(lambda x: np.arctan(x) * 2.0 / np.pi)),
        ("table", drawn_curve), ("table", drawn_curve),
        ("hill", lambda rng: hill(float(rng.uniform(1.5, 4.0)))),
        ("recovering", lambda rng: overshoot(float(rng.uniform(0.2, 0.8)))),
    ),
    _weak_lagging,
)  # fmt: skip
STRENGTHENING: tuple[Recipe, ...] = (
    _strong_table, _strong_table, *family(_strengthens, ("power", _power)), _strong_late,
    *family(_strengthens, ("threshold", _softplus)),
)  # fmt: skip
AGEING = family(
    _ages, ("any_power", _any_power), ("hill", lambda rng: hill(float(rng.uniform(1.4, 4.0)))),
    ("delayed", _delayed), ("stretched", _stretched), ("table", drawn_curve),
)  # fmt: skip
CREEP = (
    *family(_creeps, ("table", drawn_curve), ("threshold", _threshold),
            ("logarithmic", _logarithm), ("bristles", _bristles)),
    _creep_lagging,
)  # fmt: skip
SCATTER: tuple[Recipe, ...] = (
    _scatter_heavy, _scatter_long, _scatter_states, _scatter_skewed, _scatter_alternating,
    _scatter_surface,
)  # fmt: skip
