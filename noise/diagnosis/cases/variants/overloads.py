"""Further forms of overload: where a channel stops following, and how it comes back."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.signal import butter, lfilter

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    draw_shares,
    drawn_curve,
    log_uniform,
    on_sensors,
)  # fmt: skip
from noise.diagnosis.cases.variants.limits import droop
from sim.effects.effect import Effect

_DEEPEST = 0.9
"""Share of the peak that is cut off at strength 1."""


def _clips(
    form: str, a: float, rng: Rng, limited: Callable[[Array, float, float], Array]
) -> Effect:
    """Limit a channel over its peak: ``limited(x / peak, cut, rate)``."""

    def change(x: Array, share: float, rate: float, _rng: Rng) -> Array:
        peak = float(np.abs(x).max())
        if peak == 0.0:
            return x
        cut = _DEEPEST * a * share * (1.0 - abs(float(x.mean())) / peak)
        return np.asarray(peak * limited(x / peak, cut, rate))

    return on_sensors("clipping", form, a, draw_shares(rng), change)


def _clip_polynomial(a: float, rng: Rng) -> Effect:
    power = float(rng.uniform(1.5, 6.0))
    # Rising as far as 1: of what a higher cut asks beyond, the rest is cut hard.
    most = 1.0 / (power + 1.0)

    def limited(x: Array, cut: float, _rate: float) -> Array:
        bent = min(cut, most)
        y = x * (1.0 - bent * np.abs(x) ** power)
        return np.asarray(np.clip(y, cut - 1.0, 1.0 - cut))

    return _clips("polynomial", a, rng, limited)


def _clip_wrapped(a: float, rng: Rng) -> Effect:
    def limited(x: Array, cut: float, _rate: float) -> Array:
        limit = 1.0 - cut
        over = np.abs(x) > limit
        return np.where(over, (x + limit) % (2.0 * limit) - limit, x)

    return _clips("wrapped", a, rng, limited)


def _clip_folded(a: float, rng: Rng) -> Effect:
    back = float(rng.uniform(0.3, 1.0))

    def limited(x: Array, cut: float, _rate: float) -> Array:
        over = np.maximum(np.abs(x) - (1.0 - cut), 0.0)
        return np.asarray(np.sign(x) * (np.minimum(np.abs(x), 1.0 - cut) - back * over))

    return _clips("folded", a, rng, limited)


def _clip_recovering(a: float, rng: Rng) -> Effect:
    time, deep = log_uniform(rng, 1e-4, 0.02), float(rng.uniform(0.3, 1.0))

    def limited(x: Array, cut: float, rate: float) -> Array:
        return np.asarray(droop(np.ascontiguousarray(x), 1.0 - cut, deep, 1.0 / (time * rate)))

    return _clips("recovering", a, rng, limited)


def _clip_table(a: float, rng: Rng) -> Effect:
    shape = drawn_curve(rng)[1:]
    knots = np.linspace(0.0, 1.0, shape.size)

    def limited(x: Array, cut: float, _rate: float) -> Array:
        # True up to a knee, from there by a random time series to the peak's reading.
        size, knee = np.abs(x), max(1.0 - 2.0 * cut, 0.2)
        above = np.interp((size - knee) / (1.0 - knee), knots, shape)
        top = max(1.0 - cut - knee, 0.0)
        bent = np.minimum(size, min(knee, 1.0 - cut)) + np.where(size > knee, top * above, 0.0)
        return np.asarray(np.sign(x) * (bent if cut > 0.0 else size))

    return _clips("table", a, rng, limited)


def _limits(
    form: str, a: float, rng: Rng, limited: Callable[[Array, float, float, Rng], Array]
) -> Effect:
    """Limit the swing about the mean, over its peak: ``limited(y, limit, rate, rng)``."""

    def change(x: Array, share: float, rate: float, rng: Rng) -> Array:
        mean = float(x.mean())
        peak = float(np.abs(x - mean).max()) or 1.0
        limit = 1.0 - _DEEPEST * a * share
        return np.asarray(mean + peak * limited((x - mean) / peak, limit, rate, rng))

    return on_sensors("clipping", form, a, draw_shares(rng), change)


def _limit_swings(a: float, rng: Rng) -> Effect:
    """Clip both sides of a signal that is coupled for alternating current."""
    return _limits("swings", a, rng, lambda y, limit, _rate, _rng: np.clip(y, -limit, limit))


def _limit_one_side(a: float, rng: Rng) -> Effect:
    above = bool(rng.integers(2))

    def limited(y: Array, limit: float, _rate: float, _rng: Rng) -> Array:
        side = limit * float(y.max() if above else -y.min())
        return np.minimum(y, side) if above else np.maximum(y, -side)

    return _limits("one_side", a, rng, limited)


def _limit_unequal(a: float, rng: Rng) -> Effect:
    """Clip both sides, one earlier: a supply that is not symmetrical, a bias that has moved."""
    other = float(rng.uniform(0.2, 1.0))

    def limited(y: Array, limit: float, _rate: float, _rng: Rng) -> Array:
        return np.clip(y, -(1.0 - other * (1.0 - limit)), limit)

    return _limits("unequal", a, rng, limited)


def _limit_softly(a: float, rng: Rng) -> Effect:
    """Saturate by any sharpness from a valve's to a rail's: y / (1 + |y / L|^p)^(1/p)."""
    p = log_uniform(rng, 1.5, 20.0)

    def limited(y: Array, limit: float, _rate: float, _rng: Rng) -> Array:
        if limit >= 1.0:
            return y
        rail = limit / (1.0 - limit**p) ** (1.0 / p)  # so that the peak reads the limit
        return np.asarray(y / (1.0 + np.abs(y / rail) ** p) ** (1.0 / p))

    return _limits("saturating", a, rng, limited)


def _limit_filtered(a: float, rng: Rng) -> Effect:
    """Clip before a filter, which rounds the corners and lets them ring."""
    order, corner = int(rng.integers(1, 5)), log_uniform(rng, 600.0, 9000.0)

    def limited(y: Array, limit: float, rate: float, _rng: Rng) -> Array:
        b, c = butter(order, min(2.0 * corner / rate, 0.9))
        lost = y - np.clip(y, -limit, limit)
        return np.asarray(y - lfilter(b, c, lost))

    return _limits("filtered", a, rng, limited)


def _limit_some(a: float, rng: Rng) -> Effect:
    """Clip some recordings more than others, as one range does for all."""

    def limited(y: Array, limit: float, _rate: float, rng: Rng) -> Array:
        own = 1.0 - (1.0 - limit) * float(rng.uniform(0.0, 1.0)) ** 0.5
        return np.clip(y, -own, own)

    return _limits("some_runs", a, rng, limited)


def _limit_dead(a: float, rng: Rng) -> Effect:
    """Pass nothing near zero: crossover, a sticky pen, a noise gate."""

    def limited(y: Array, limit: float, _rate: float, _rng: Rng) -> Array:
        dead = 0.3 * (1.0 - limit)
        return np.asarray(np.sign(y) * np.maximum(np.abs(y) - dead, 0.0))

    return _limits("crossover", a, rng, limited)


def _limit_compressed(a: float, rng: Rng) -> Effect:
    """Go on above the limit with a smaller slope: a compressor, a sensor beyond its range."""
    slope = float(rng.uniform(0.05, 0.5))

    def limited(y: Array, limit: float, _rate: float, _rng: Rng) -> Array:
        over = np.maximum(np.abs(y) - limit, 0.0)
        return np.asarray(y - np.sign(y) * (1.0 - slope) * over)

    return _limits("compressed", a, rng, limited)


def _limit_reading(a: float, rng: Rng) -> Effect:
    """Clip the reading itself, mean and all: a torque beyond its range is a flat line."""

    def change(x: Array, share: float, _rate: float, _rng: Rng) -> Array:
        limit = (1.0 - 0.85 * a * share) * float(np.abs(x).max())
        return np.clip(x, -limit, limit)

    return on_sensors("clipping", "reading", a, draw_shares(rng), change)


CLIPPING: tuple[Recipe, ...] = (
    _clip_polynomial, _clip_wrapped, _clip_folded, _clip_recovering, _clip_table, _limit_swings,
    _limit_one_side, _limit_unequal, _limit_softly, _limit_filtered, _limit_some, _limit_dead,
    _limit_compressed, _limit_reading,
)  # fmt: skip
