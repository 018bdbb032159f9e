"""Further forms of the film on the shaft, and of the heat of friction."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

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
    log_uniforms,
    noise,
    on_contact,
    overshoot,
)  # fmt: skip
from noise.diagnosis.cases.variants.hooks import film_hook, heating_hook

if TYPE_CHECKING:
    from sim.effects.effect import Effect

__all__ = ["FILM", "HEAT"]

_N_NOISE = 2**14


def _films(
    form: str, a: float, rng: Rng, shape: Array, *, patches: float = 0.0, fixed: bool = False
) -> Effect:
    ratio, left = float(rng.uniform(1.4, 3.0)), float(rng.uniform(0.1, 0.5))
    rough = 0.05 * float(rng.uniform(0.2, 1.0))
    scale = patches or log_uniform(rng, 0.2, 3.0)
    low = log_uniform(rng, 80.0, 400.0)
    high = low * float(rng.uniform(2.0, 8.0))
    points = 12.0 * high
    per = points / 3.0 if fixed else points

    def numbers(rng: Rng) -> Array:
        header = [a, ratio, left, rough, float(patches > 0.0), scale, float(fixed), per]
        time_series = noise(rng, _N_NOISE, points, low, high)
        return np.concatenate([header, shape, [_N_NOISE], time_series])

    return on_contact("transfer_film", form, a, film_hook, numbers, n_states=1)


def _film_patches(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(1, 5))
    edges = np.sort(rng.random((n, 2)), axis=1)
    soft = float(rng.uniform(0.01, 0.05))

    def shape(u: Array) -> Array:
        covered = np.zeros_like(u)
        for start, stop in edges:
            covered += 0.5 * (np.tanh((u - start) / soft) - np.tanh((u - stop) / soft))
        ends = np.clip(np.minimum(u, 1.0 - u) / 0.03, 0.0, 1.0)
        return np.asarray(ends * np.clip(covered, 0.0, 1.0))

    return _films("patches", a, rng, curve(shape), patches=log_uniform(rng, 0.1, 6.28), fixed=True)


def _film_grown(a: float, rng: Rng) -> Effect:
    n = float(rng.uniform(0.4, 0.9))
    return _films("power", a, rng, far_curve(lambda x: 1.0 - (1.0 + x) ** -n), fixed=True)


def _heats(
    form: str, a: float, shape: Array, lost: float, rise: float, weights: Array, rates: Array,
    *, passed_on: bool = False,
) -> Effect:  # fmt: skip
    header = [lost, rise, float(passed_on), float(rates.size)]
    return on_contact(
        "frictional_heating", form, a, heating_hook,
        lambda _rng: np.concatenate([header, weights, rates, shape]), n_states=rates.size,
    )  # fmt: skip


def _exponential(softening: float) -> tuple[Array, float, float]:
    """Curve, share and rise of a torque that falls by so much a kelvin, down to a tenth."""
    return far_curve(lambda x: -np.expm1(-np.minimum(x, 99.0))), 0.9, 0.9 / max(softening, 1e-12)


def _heat_several(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(2, 6))
    rates = 1.0 / log_uniforms(rng, 3e-3, 1.5, n)
    weights = log_uniform(rng, 0.3, 2.0) * rng.dirichlet(np.ones(n)) * rates
    shape, lost, rise = _exponential(0.02 * a)
    return _heats("several", a, shape, lost, rise, weights, rates)


def _heat_power(a: float, rng: Rng) -> Effect:
    power = float(rng.uniform(0.2, 0.8))
    rates = 1000.0 * 5.0 ** -np.arange(6, dtype=np.float64)
    steps = rates**-power
    weights = log_uniform(rng, 0.3, 2.0) * steps / steps.sum() * rates
    shape, lost, rise = _exponential(0.02 * a)
    return _heats("power_kernel", a, shape, lost, rise, weights, rates)


def _heat_table(a: float, rng: Rng) -> Effect:
    rates = 1.0 / np.array([log_uniform(rng, 0.03, 1.0)])
    weights = log_uniform(rng, 0.3, 2.0) * rates
    rise = log_uniform(rng, 2.0, 20.0)
    return _heats("table", a, drawn_curve(rng), 0.5 * a, rise, weights, rates)


def _heat_transition(a: float, rng: Rng) -> Effect:
    n, rise = float(rng.uniform(2.0, 5.0)), log_uniform(rng, 2.0, 12.0)
    rates = 1.0 / log_uniforms(rng, 0.01, 0.6, 2)
    weights = log_uniform(rng, 0.3, 2.0) * rng.dirichlet(np.ones(2)) * rates
    return _heats("transition", a, hill(n), 0.5 * a, rise, weights, rates)


def _heat_delayed(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(2, 4))
    rates = np.full(n, n / log_uniform(rng, 0.03, 0.5))
    weights = log_uniform(rng, 0.3, 2.0) * rates
    shape, lost, rise = _exponential(0.02 * a)
    return _heats("delayed", a, shape, lost, rise, weights, rates, passed_on=True)


FILM: tuple[Recipe, ...] = (
    *family(_films, ("table", drawn_curve)),
    _film_patches,
    *family(_films, ("torn_off", lambda rng: overshoot(float(rng.uniform(0.1, 0.7))))),
    _film_grown,
)
HEAT: tuple[Recipe, ...] = (
    _heat_several, _heat_power, _heat_table, _heat_transition, _heat_delayed,
)  # fmt: skip
