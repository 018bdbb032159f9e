"""Further forms of kinetic torque over sliding speed: curves that fall, and curves that rise."""

from __future__ import annotations

import math

import numpy as np

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    drawn_curve,
    family,
    far_curve,
    hill,
    log_uniform,
    on_contact,
    overshoot,
)  # fmt: skip
from noise.diagnosis.cases.variants.hooks import rate_dependence_hook
from sim.effects.effect import Effect

_STEEPEST = 0.5
"""Rise over the kinetic torque that the solver follows well [s/rad]."""

_FARTHEST = 50.0
"""Speeds over the characteristic one up to which unbounded forms rise."""


def _over_speed(
    name: str, form: str, a: float, gain: float, speed: float, shape: Array, lag: float = 0.0
) -> Effect:
    return on_contact(
        name, form, a, rate_dependence_hook,
        lambda _rng: np.concatenate([[gain, speed, lag], shape]), n_states=1,
    )  # fmt: skip


def _weakens(form: str, a: float, rng: Rng, shape: Array, lag: float = 0.0) -> Effect:
    speed = log_uniform(rng, 0.8, 50.0)
    return _over_speed("velocity_weakening", form, a, -0.85 * a, speed, shape, lag)


def _strengthens(
    form: str, a: float, rng: Rng, shape: Array, lag: float = 0.0, height: float = 1.0
) -> Effect:
    speed = log_uniform(rng, 1.5, 40.0)
    gain = 1.5 * height  # of strength 1, whatever the strength: forms stay what they are
    u = np.linspace(0.0, 1.0, shape.size - 1)
    slope = float(np.max(np.gradient(shape[1:], u) * (1.0 - u) ** 2))
    speed = max(speed, gain * slope / _STEEPEST)
    return _over_speed("velocity_strengthening", form, a, a * gain, speed, shape, lag)


def _weak_lagging(a: float, rng: Rng) -> Effect:
    """Follow the speed late: a memory of the contact (Hess and Soom 1990)."""
    lag = log_uniform(rng, 1e-4, 2e-3)
    return _weakens("lagging", a, rng, drawn_curve(rng), lag)


def _weak_averaged(a: float, rng: Rng) -> Effect:
    """Fall with the mean speed alone, as a curve measured in steady sliding is often applied."""
    return _weakens("averaged", a, rng, drawn_curve(rng), log_uniform(rng, 5e-3, 0.1))


def _strong_table(a: float, rng: Rng) -> Effect:
    return _strengthens("table", a, rng, drawn_curve(rng), height=float(rng.uniform(0.7, 1.7)))


def _strong_averaged(a: float, rng: Rng) -> Effect:
    """Rise with the mean speed, of critical and kinetic torque alike: a rate of loading."""
    return _strengthens("averaged", a, rng, drawn_curve(rng), log_uniform(rng, 5e-3, 0.1))


def _strong_lagging(a: float, rng: Rng) -> Effect:
    return _strengthens("lagging", a, rng, drawn_curve(rng), log_uniform(rng, 1e-4, 2e-3))


def _powers(low: float, high: float, rng: Rng) -> Array:
    p = log_uniform(rng, low, high)
    return far_curve(lambda x: (np.minimum(x, _FARTHEST) / 10.0) ** p)


def _power(rng: Rng) -> Array:
    p = float(rng.uniform(0.35, 0.8))
    return far_curve(lambda x: (np.minimum(x, 20.0) + 0.01) ** p - 0.01**p)


def _softplus(rng: Rng) -> Array:
    at, wide = float(rng.uniform(0.2, 1.0)), float(rng.uniform(0.1, 0.4))

    def shape(x: Array) -> Array:
        risen = wide * np.logaddexp(0.0, (np.minimum(x, 8.0) - at) / wide)
        return np.asarray(risen - wide * np.log1p(np.exp(-at / wide)))

    return far_curve(shape)


def _stretched(rng: Rng) -> Array:
    p = float(rng.uniform(0.5, 2.5))
    return far_curve(lambda x: -np.expm1(-(np.minimum(x, 99.0) ** p)))


def _hyperbola(rng: Rng) -> Array:
    p = log_uniform(rng, 0.3, 3.0)
    return far_curve(lambda x: 1.0 - (1.0 + x) ** -p)


def _logarithm(rng: Rng) -> Array:
    k = log_uniform(rng, 1.0, 300.0)
    return far_curve(lambda x: np.log1p(k * np.minimum(x, _FARTHEST)) / math.log1p(k * 5.0) * 0.6)


def _flash(rng: Rng) -> Array:
    soft = float(rng.uniform(0.02, 0.2))

    def shape(x: Array) -> Array:
        over = soft * np.logaddexp(0.0, (np.minimum(x, 99.0) - 1.0) / soft)
        return np.asarray(over / (1.0 + over))

    return far_curve(shape)


def _cubic(rng: Rng) -> Array:
    left = float(rng.uniform(0.2, 0.9))

    def shape(x: Array) -> Array:
        y = np.minimum(x, 2.0)
        falls = 1.5 * y - 0.5 * y**3
        return np.where(y < 1.0, falls, np.maximum(falls, left))

    return far_curve(shape)


def _lowest(rng: Rng) -> Array:
    """Fall, and rise again without bound: the whole Stribeck curve."""
    viscous = log_uniform(rng, 0.003, 0.05)
    return far_curve(lambda x: -np.expm1(-np.minimum(x, 99.0)) - viscous * np.minimum(x, _FARTHEST))


# Tustin 1947 and Bo and Pavelescu 1982 (stretched), Hess and Soom 1990 (hill of power 2), Ruina
# 1983 (logarithm), Rice 2006 (flash), Ibrahim 1994 (cubic), Armstrong-Helouvry 1994 (hyperbola,
# lowest); tables stand for curves as measured.
WEAKENING: tuple[Recipe, ...] = (
    *family(
        _weakens, ("arctangent", lambda _rng: far_curve(lambda x: np.arctan(x) * 2.0 / np.pi)),
        ("table", drawn_curve),
        ("hill", lambda rng: hill(float(rng.uniform(1.5, 4.0)))),
        ("recovering", lambda rng: overshoot(float(rng.uniform(0.2, 0.8)))),
        ("stretched", _stretched), ("hyperbola", _hyperbola), ("logarithm", _logarithm),
        ("linear", lambda _rng: far_curve(lambda x: np.minimum(x, 1.0))),
        ("flash", _flash), ("cubic", _cubic), ("lowest", _lowest),
        ("step", lambda rng: hill(float(rng.uniform(5.0, 10.0)))),
    ),
    _weak_lagging, _weak_averaged,
)  # fmt: skip

# Viscous and hydrodynamic drag (linear, square), films between (root), thermal activation
# (logarithm; Ruina 1983), Grosch 1963 (hill: the master curve's rise of an elastomer).
STRENGTHENING: tuple[Recipe, ...] = (
    _strong_table, *family(_strengthens, ("power", _power),
        ("hill", lambda rng: hill(float(rng.uniform(1.5, 3.0)))),
        ("threshold", _softplus), ("viscous", lambda _rng: far_curve(
            lambda x: np.minimum(x, _FARTHEST) / 5.0)),
        ("square", lambda rng: _powers(1.5, 2.2, rng)),
        ("root", lambda rng: _powers(0.3, 0.7, rng)),
        ("any_logarithm", _logarithm), ("stretched", _stretched), ("hyperbola", _hyperbola),
        ("step", lambda rng: hill(float(rng.uniform(4.0, 8.0))))),
    _strong_averaged, _strong_lagging,
)  # fmt: skip
