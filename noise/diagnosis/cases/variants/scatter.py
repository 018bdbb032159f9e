"""Further forms of critical torques that differ from stick to stick."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

from noise.diagnosis.cases.variants.common import (
    Array,
    Recipe,
    Rng,
    log_uniform,
    noise,
    on_contact,
)  # fmt: skip
from noise.diagnosis.cases.variants.hooks import patch_hook
from sim.effects import EFFECTS
from sim.effects.effect import Effect

_N_DRAWS = 4096
_MOST = 0.8
"""Standard deviation of the drop over its mean at strength 1."""


def _scatters(
    form: str, a: float, time_series: Callable[[Rng], Array], most: float = _MOST
) -> Effect:
    def numbers(rng: Rng) -> Array:
        z = time_series(rng)
        return np.concatenate([[5e-3], most * a * (z - z.mean()) / (z.std() + 1e-9)])

    plain = EFFECTS["critical_torque_scatter"]
    return on_contact(
        "critical_torque_scatter", form, a, plain.contact, numbers, n_states=plain.n_states
    )


def _heavy(a: float, rng: Rng) -> Effect:
    freedom = float(rng.uniform(2.1, 4.0))
    return _scatters(
        "heavy_tails", a, lambda r: np.clip(r.standard_t(freedom, _N_DRAWS), -12.0, 12.0)
    )


def _long(a: float, rng: Rng) -> Effect:
    power = float(rng.uniform(0.25, 0.7))

    def time_series(rng: Rng) -> Array:
        size = np.maximum(np.arange(_N_DRAWS // 2 + 1), 8.0) ** -power
        return np.fft.irfft(size * np.exp(2j * np.pi * rng.random(size.size)), _N_DRAWS)

    return _scatters("long_memory", a, time_series)


def _states(a: float, rng: Rng) -> Effect:
    down, up = rng.uniform(0.05, 0.6, 2)

    def time_series(rng: Rng) -> Array:
        chance, state, states = rng.random(_N_DRAWS), 0, np.zeros(_N_DRAWS)
        for i in range(_N_DRAWS):
            if chance[i] < (down if state else up):
                state = 1 - state
            states[i] = state
        return np.asarray(states + 0.1 * rng.standard_normal(_N_DRAWS))

    return _scatters("two_states", a, time_series)


def _skewed(a: float, rng: Rng) -> Effect:
    sign, memory = float(rng.choice([-1.0, 1.0])), float(rng.uniform(0.0, 0.5))
    return _scatters(
        "skewed", a,
        lambda r: lfilter([1.0], [1.0, -memory], sign * r.standard_exponential(_N_DRAWS)),
    )  # fmt: skip


def _alternating(a: float, rng: Rng) -> Effect:
    memory = -float(rng.uniform(0.3, 0.9))
    return _scatters(
        "alternating", a, lambda r: lfilter([1.0], [1.0, -memory], r.standard_normal(_N_DRAWS))
    )


def _lognormal(a: float, rng: Rng) -> Effect:
    """Scatter by a factor rather than by an amount, as strengths of bonds do."""
    wide = float(rng.uniform(0.3, 1.2))
    return _scatters("lognormal", a, lambda r: r.lognormal(0.0, wide, _N_DRAWS))


def _weakest(a: float, rng: Rng) -> Effect:
    """Let the weakest of many links break first (Weibull 1951)."""
    modulus = log_uniform(rng, 1.2, 12.0)
    return _scatters("weakest_link", a, lambda r: r.weibull(modulus, _N_DRAWS))


def _early_breaks(a: float, rng: Rng) -> Effect:
    """Let few sticks break early, the others never."""
    often = log_uniform(rng, 0.05, 0.4)
    return _scatters(
        "early_breaks", a, lambda r: np.where(r.random(_N_DRAWS) < often, -1.0, 0.0), 1.0
    )


def _levels(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(2, 6))
    levels = rng.standard_normal(n)
    return _scatters("levels", a, lambda r: r.choice(levels, _N_DRAWS))


def _clipped(a: float, rng: Rng) -> Effect:
    """Scatter the whole critical torque, which never falls below the kinetic one."""
    most = float(rng.uniform(1.0, 3.0))
    return _scatters("whole_torque", a, lambda r: r.standard_normal(_N_DRAWS), most)


def _drifting(a: float, rng: Rng) -> Effect:
    memory = 1.0 - log_uniform(rng, 0.01, 0.1)
    return _scatters(
        "drifting", a, lambda r: lfilter([1.0], [1.0, -memory], r.standard_normal(_N_DRAWS))
    )


def _along(form: str, a: float, finest: float, *, over_time: bool) -> Effect:
    def numbers(rng: Rng) -> Array:
        time_series = noise(rng, _N_DRAWS, 8.0 * finest, 0.05 * finest, finest)
        header = [8.0 * finest, over_time, _N_DRAWS]
        return np.concatenate([header, 1.0 + _MOST * a * time_series])

    return on_contact("critical_torque_scatter", form, a, patch_hook, numbers)


def _surface(a: float, rng: Rng) -> Effect:
    """Let the drop depend on the place along the shaft, so that it is the same each time round."""
    return _along("surface", a, log_uniform(rng, 3.0, 200.0), over_time=False)


def _in_time(a: float, rng: Rng) -> Effect:
    """Let the drop wander over time, also within a stick."""
    return _along("in_time", a, log_uniform(rng, 5.0, 300.0), over_time=True)


SCATTER: tuple[Recipe, ...] = (
    _heavy, _long, _states, _skewed, _alternating, _surface, _lognormal, _weakest, _early_breaks,
    _levels, _clipped, _drifting, _in_time,
)  # fmt: skip
