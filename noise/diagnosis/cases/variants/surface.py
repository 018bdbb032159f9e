"""Further forms of the film on the shaft, and of the heat of friction."""

from __future__ import annotations

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
from sim.effects.effect import Effect

_N_NOISE = 2**14


def _film(
    form: str, a: float, rng: Rng, shape: Array, *, patches: float = 0.0, fixed: bool = False,
    ratio: tuple[float, float] = (1.3, 4.0), left: tuple[float, float] = (0.05, 0.7),
    rough: tuple[float, float] = (0.005, 0.1),
) -> Effect:  # fmt: skip
    torque, drop = log_uniform(rng, *ratio), float(rng.uniform(*left))
    roughness, scale = log_uniform(rng, *rough), patches or log_uniform(rng, 0.05, 3.0)
    low = log_uniform(rng, 40.0, 600.0)
    high = low * float(rng.uniform(1.5, 8.0))
    points = 12.0 * high
    per = points / 3.0 if fixed else points

    def numbers(rng: Rng) -> Array:
        header = [a, torque, drop, roughness, float(patches > 0.0), scale, float(fixed), per]
        time_series = noise(rng, _N_NOISE, points, low, high)
        return np.concatenate([header, shape, [_N_NOISE], time_series])

    return on_contact("transfer_film", form, a, film_hook, numbers, n_states=1)


def _films(form: str, a: float, rng: Rng, shape: Array) -> Effect:
    return _film(form, a, rng, shape)


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

    return _film("patches", a, rng, curve(shape), patches=log_uniform(rng, 0.1, 6.28), fixed=True)


def _film_grown(a: float, rng: Rng) -> Effect:
    n = float(rng.uniform(0.4, 0.9))
    shape = far_curve(lambda x: 1.0 - (1.0 + x) ** -n)
    return _film("power", a, rng, shape, fixed=True)


def _film_there(a: float, rng: Rng) -> Effect:
    """Begin with a film that is there: it only changes torque, drop and roughness."""
    return _film("there", a, rng, curve(np.ones_like), rough=(0.02, 0.15))


def _film_smooth(a: float, rng: Rng) -> Effect:
    """Carry more torque and less drop, evenly."""
    return _film("smooth", a, rng, drawn_curve(rng), rough=(1e-5, 1e-4))


def _film_rough(a: float, rng: Rng) -> Effect:
    """Make friction random above all (Rabinowicz 1995, on galling films)."""
    return _film(
        "rough", a, rng, drawn_curve(rng), ratio=(0.8, 1.3), left=(0.5, 1.0), rough=(0.05, 0.3)
    )


def _film_lubricating(a: float, rng: Rng) -> Effect:
    """Lower the torque, as films of PTFE do (Pooley and Tabor 1972)."""
    return _film("lubricating", a, rng, drawn_curve(rng), ratio=(0.25, 0.75), left=(0.1, 1.0))


def _film_sticky(a: float, rng: Rng) -> Effect:
    """Raise the critical torque more than the kinetic one: a degraded, tacky layer."""
    return _film("sticky", a, rng, drawn_curve(rng), ratio=(1.0, 1.8), left=(1.3, 3.0))


def _heats(
    form: str, a: float, shape: Array, lost: float, rise: float, weights: Array, rates: Array,
    *, passed_on: bool = False, on: tuple[float, float, float] = (1.0, 1.0, 0.0),
) -> Effect:  # fmt: skip
    """Lose torque over heat; `on` are the shares of kinetic and critical torque, and stiffness."""
    header = [lost, rise, float(passed_on), float(rates.size), *on]
    return on_contact(
        "frictional_heating", form, a, heating_hook,
        lambda _rng: np.concatenate([header, weights, rates, shape]), n_states=rates.size,
    )  # fmt: skip


def _exponential(softening: float) -> tuple[Array, float, float]:
    """Curve, share and rise of a torque that falls by so much a kelvin, down to a tenth."""
    return far_curve(lambda x: -np.expm1(-np.minimum(x, 99.0))), 0.9, 0.9 / max(softening, 1e-12)


def _resistance(rng: Rng) -> float:
    """Draw what the surface warms by [K/W]."""
    return log_uniform(rng, 0.3, 4.0)


def _heat_several(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(2, 6))
    rates = 1.0 / log_uniforms(rng, 3e-3, 1.5, n)
    weights = _resistance(rng) * rng.dirichlet(np.ones(n)) * rates
    shape, lost, rise = _exponential(0.04 * a)
    return _heats("several", a, shape, lost, rise, weights, rates)


def _heat_power(a: float, rng: Rng) -> Effect:
    power = float(rng.uniform(0.2, 0.8))
    rates = 1000.0 * 5.0 ** -np.arange(6, dtype=np.float64)
    steps = rates**-power
    weights = _resistance(rng) * steps / steps.sum() * rates
    shape, lost, rise = _exponential(0.04 * a)
    return _heats("power_kernel", a, shape, lost, rise, weights, rates)


def _heat_table(a: float, rng: Rng) -> Effect:
    rates = 1.0 / np.array([log_uniform(rng, 0.03, 1.0)])
    weights = _resistance(rng) * rates
    rise = log_uniform(rng, 2.0, 20.0)
    return _heats("table", a, drawn_curve(rng), 0.75 * a, rise, weights, rates)


def _heat_transition(a: float, rng: Rng) -> Effect:
    n, rise = float(rng.uniform(2.0, 5.0)), log_uniform(rng, 2.0, 12.0)
    rates = 1.0 / log_uniforms(rng, 0.01, 0.6, 2)
    weights = _resistance(rng) * rng.dirichlet(np.ones(2)) * rates
    return _heats("transition", a, hill(n), 0.75 * a, rise, weights, rates)


def _heat_delayed(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(2, 4))
    rates = np.full(n, n / log_uniform(rng, 0.03, 0.5))
    weights = _resistance(rng) * rates
    shape, lost, rise = _exponential(0.04 * a)
    return _heats("delayed", a, shape, lost, rise, weights, rates, passed_on=True)


def _heat_flash(a: float, rng: Rng) -> Effect:
    """Warm spots within a slip, cold before the next (Blok 1937; Rice 2006)."""
    rates = 1.0 / np.array([log_uniform(rng, 1e-4, 3e-3)])
    weights = log_uniform(rng, 0.05, 0.5) * rates
    shape, lost, rise = _exponential(0.05 * a)
    return _heats("flash", a, shape, lost, rise, weights, rates)


def _heat_slow(a: float, rng: Rng) -> Effect:
    """Warm through over seconds: the torque drifts down through a recording."""
    rates = 1.0 / np.array([log_uniform(rng, 1.0, 20.0)])
    weights = log_uniform(rng, 2.0, 20.0) * rates
    shape, lost, rise = _exponential(0.04 * a)
    return _heats("slow", a, shape, lost, rise, weights, rates)


def _heat_on(form: str, on: tuple[float, float, float]) -> Recipe:
    def recipe(a: float, rng: Rng) -> Effect:
        rates = 1.0 / log_uniforms(rng, 0.01, 1.0, 2)
        weights = _resistance(rng) * rng.dirichlet(np.ones(2)) * rates
        shape, lost, rise = _exponential(0.05 * a)
        return _heats(form, a, shape, lost, rise, weights, rates, on=on)

    return recipe


FILM: tuple[Recipe, ...] = (
    *family(_films, ("table", drawn_curve)),
    _film_patches,
    *family(_films, ("torn_off", lambda rng: overshoot(float(rng.uniform(0.1, 0.7))))),
    _film_grown, _film_there, _film_smooth, _film_rough, _film_lubricating, _film_sticky,
)  # fmt: skip

# Sums of exponentials stand for any heat path (Carslaw and Jaeger 1959).
HEAT: tuple[Recipe, ...] = (
    _heat_several, _heat_power, _heat_table, _heat_transition, _heat_delayed, _heat_flash,
    _heat_slow, _heat_on("kinetic_alone", (1.0, 0.0, 0.0)),
    _heat_on("critical_alone", (0.0, 1.0, 0.0)), _heat_on("and_stiffness", (1.0, 1.0, 0.8)),
)  # fmt: skip
