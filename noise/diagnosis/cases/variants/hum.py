"""Further forms of what cables pick up from the mains."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from noise.diagnosis.cases.variants.common import (
    SENSED,
    Array,
    Recipe,
    Rng,
    log_uniform,
    on_signals,
    telegraph,
)  # fmt: skip
from noise.diagnosis.cases.variants.disturbance import adds
from sim.effects.effect import Effect, Signals

_LEVELS = (0.8, 18.0, 0.8)
"""Of torque, acceleration and pressure at strength 1, at most [Nm], [m/s2], [Pa]."""

_MAINS = (50.0, 60.0)
_OTHERS = (50.0 / 3.0, 25.0, 400.0)
"""Of railways and aircraft [Hz]."""


def _frequency(rng: Rng) -> float:
    usual = rng.random() < 0.9
    return float(rng.choice(_MAINS if usual else _OTHERS)) * (1.0 + 2e-3 * rng.standard_normal())


def _hums(
    form: str, a: float, rng: Rng, wave: Callable[[Array, float, Rng], Array], *,
    wobble: float = 0.0, depth: float = 0.0, uneven: float = 0.0, together: bool = False,
) -> Effect:  # fmt: skip
    """Add a wave over the periods passed; frequency and level may wander."""
    frequency, corner = _frequency(rng), log_uniform(rng, 1.0, 15.0)

    def time_series(n: int, rate: float, rng: Rng) -> Array:
        time = np.arange(n) / rate
        phases = rng.random(3)
        turns = (
            frequency * time + phases[0] + wobble * np.sin(2 * np.pi * (corner * time + phases[1]))
        )
        level = 1.0 + depth * np.sin(2 * np.pi * (0.7 * corner * time + phases[2]))
        return np.asarray(level * wave(turns, rate, rng))

    return adds("mains_hum", form, a, rng, _LEVELS, time_series, together=together, uneven=uneven)


def _partials(rng: Rng) -> Callable[[Array, float, Rng], Array]:
    """Draw a wave of few harmonics."""
    orders = np.unique(rng.integers(1, 12, int(rng.integers(1, 7))))
    sizes = rng.exponential(1.0, orders.size) / np.sqrt(orders)
    phases = rng.random(orders.size)

    def wave(turns: Array, _rate: float, _rng: Rng) -> Array:
        parts = zip(orders.tolist(), sizes.tolist(), phases.tolist(), strict=True)
        return np.asarray(sum(c * np.sin(2 * np.pi * (k * turns + p)) for k, c, p in parts))

    return wave


def _hum_modulated(a: float, rng: Rng) -> Effect:
    return _hums("modulated", a, rng, _partials(rng), depth=float(rng.uniform(0.4, 1.2)))


def _hum_wobbling(a: float, rng: Rng) -> Effect:
    return _hums("wobbling", a, rng, _partials(rng), wobble=float(rng.uniform(0.05, 0.4)))


def _hum_drawn(a: float, rng: Rng) -> Effect:
    return _hums("drawn_harmonics", a, rng, _partials(rng))


def _hum_cut(a: float, rng: Rng) -> Effect:
    """Cut the phase: the sine begins late in each half-wave."""
    late = float(rng.uniform(0.1, 0.9))
    return _hums(
        "phase_cut", a, rng,
        lambda turns, _rate, _rng: np.where((2 * turns) % 1.0 > late, np.sin(2 * np.pi * turns), 0),
    )  # fmt: skip


def _hum_broken(a: float, rng: Rng) -> Effect:
    often, wave = log_uniform(rng, 3.0, 25.0), _partials(rng)

    def broken(turns: Array, rate: float, rng: Rng) -> Array:
        return wave(turns, rate, rng) * (0.05 + (telegraph(rng, turns.size, rate, often) > 0.0))

    return _hums("intermittent", a, rng, broken)


def _hum_each_run(a: float, rng: Rng) -> Effect:
    """Hum otherwise in each recording: cables that are moved."""
    return _hums("each_run", a, rng, _partials(rng), uneven=float(rng.uniform(0.5, 1.2)))


def _hum_together(a: float, rng: Rng) -> Effect:
    """Hum in all channels alike: one loop of earth."""
    return _hums("together", a, rng, _partials(rng), together=True)


def _hum_double(a: float, rng: Rng) -> Effect:
    """Sound at twice the mains, as transformers and chokes do (magnetostriction)."""
    even = 2 * np.arange(1, int(rng.integers(2, 8)))
    sizes = even ** -log_uniform(rng, 0.3, 3.0)
    phases = rng.random(even.size)

    def wave(turns: Array, _rate: float, _rng: Rng) -> Array:
        parts = zip(even.tolist(), sizes.tolist(), phases.tolist(), strict=True)
        return np.asarray(sum(c * np.sin(2 * np.pi * (k * turns + p)) for k, c, p in parts))

    return _hums("double", a, rng, wave)


def _hum_spikes(a: float, rng: Rng) -> Effect:
    """Click with each half-wave: commutation of a converter, a dimmer."""
    wide, each = log_uniform(rng, 0.004, 0.1), float(rng.choice([1.0, 2.0, 6.0]))
    alternating = bool(rng.integers(2))

    def wave(turns: Array, _rate: float, _rng: Rng) -> Array:
        place = (each * turns) % 1.0
        sign = np.where((each * turns) % 2.0 < 1.0, 1.0, -1.0) if alternating else 1.0
        return np.asarray(sign * np.exp(-place / wide) - (0.0 if alternating else wide))

    return _hums("spikes", a, rng, wave)


def _hum_multiplying(a: float, rng: Rng) -> Effect:
    """Modulate the gain of a channel rather than add to it: the ripple of a supply."""
    frequency = float(rng.choice([1.0, 2.0])) * _frequency(rng)
    shares = dict(zip(SENSED, (0.8 * a * rng.uniform(0.2, 1.0, 3)).tolist(), strict=True))

    def change(signals: Signals, rate: float, rng: Rng) -> Signals:
        turns = frequency / rate * np.arange(signals["torque"].size) + rng.random()
        hum = np.sin(2.0 * np.pi * turns)
        return {name: x * (1.0 + shares.get(name, 0.0) * hum) for name, x in signals.items()}

    return on_signals("mains_hum", "multiplying", a, change)


# IEC 61000-3-2 (harmonics), IEC 61000-4-7 (between them), EN 50160 (wander); loops: Ott 1988.
HUM: tuple[Recipe, ...] = (
    _hum_modulated, _hum_wobbling, _hum_drawn, _hum_cut, _hum_broken, _hum_each_run, _hum_together,
    _hum_double, _hum_spikes, _hum_multiplying,
)  # fmt: skip
