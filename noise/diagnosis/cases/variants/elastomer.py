"""Further forms of an elastomer that is softer in large motions, or stiffer in fast ones."""

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
    log_uniform,
    log_uniforms,
    on_contact,
    overshoot,
)  # fmt: skip
from noise.diagnosis.cases.variants.hooks import bristle_hook, dashpot_hook, softening_hook
from sim.effects.effect import Effect

_SHORTEST = 2e-5
"""Relaxation time that the integration resolves [s]."""

_SOFTEST = 0.78
"""Share of the stiffness lost at strength 1, so that the torque still rises with the twist."""

_STIFFEST = 3.0
"""Of all branches over the spring at strength 1."""

_LINEAR = 2.0
"""Kind of dashpot."""

_NEVER = 1e9
"""[s]"""


def _soften(
    form: str, a: float, rng: Rng, shape: Array, held: float = 0.0, *, whole: bool = False
) -> Effect:
    twist = log_uniform(rng, 2e-3, 3e-2) if whole else log_uniform(rng, 2e-4, 8e-3)
    mean = _NEVER if whole else log_uniform(rng, 0.01, 0.5)
    header = [_SOFTEST * a, twist, mean, held]
    return on_contact(
        "amplitude_softening", form, a, softening_hook,
        lambda _rng: np.concatenate([header, shape]), n_states=2,
    )  # fmt: skip


def _softens(form: str, a: float, rng: Rng, shape: Array) -> Effect:
    return _soften(form, a, rng, shape)


def _softens_whole(form: str, a: float, rng: Rng, shape: Array) -> Effect:
    """Count the whole twist as amplitude, so that the mean torque takes longer to build up."""
    return _soften(form, a, rng, shape, whole=True)


def _soft_held(a: float, rng: Rng) -> Effect:
    """Keep the amplitude of a cycle, as fits of a dynamic stiffness over amplitude do."""
    return _soften("held", a, rng, drawn_curve(rng), log_uniform(rng, 3e-3, 0.1))


def _soft_recovering(a: float, rng: Rng) -> Effect:
    """Heal slowly: thixotropy after Mullins."""
    return _soften("recovering", a, rng, drawn_curve(rng), log_uniform(rng, 0.1, 3.0),
                   whole=bool(rng.integers(2)))  # fmt: skip


def _soft_bristles(a: float, rng: Rng) -> Effect:
    """Let small parts of the network slip (Masing 1926; Berg 1998)."""
    n = int(rng.integers(1, 7))
    twists = log_uniforms(rng, 2e-4, 1e-2, n)
    return on_contact(
        "amplitude_softening", "bristles", a, bristle_hook,
        lambda _rng: np.concatenate([[_SOFTEST * a, n], twists]), n_states=n,
    )  # fmt: skip


def _branches(
    form: str, a: float, rng: Rng, shares: Array, times: Array, kind: float = _LINEAR,
    twist: float = 1.0, *, lost: bool = False,
) -> Effect:  # fmt: skip
    """Put Maxwell branches beside the spring, or let them take the place of a part of it."""
    rates = 1.0 / np.maximum(times, _SHORTEST)
    most = 0.85 if lost else 0.9 if kind < _LINEAR else _STIFFEST
    replaced = float(rng.uniform(0.4, 1.0)) if lost else 0.0
    parts = most * a * shares / shares.sum()
    header = [times.size, kind, twist, most * a * replaced]
    return on_contact(
        "viscoelastic_stiffness", form, a, dashpot_hook,
        lambda _rng: np.concatenate([header, parts, rates]), n_states=times.size,
    )  # fmt: skip


def _springpot(a: float, rng: Rng) -> Effect:
    """Stand for a fractional derivative over many decades (Koeller 1984)."""
    times = np.geomspace(3e-5, log_uniform(rng, 0.02, 0.3), 7)
    return _branches("springpot", a, rng, times ** -float(rng.uniform(0.1, 0.7)), times)


def _drawn_branches(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(2, 6))
    times = log_uniforms(rng, 3e-5, 3e-2, n)
    return _branches("drawn_branches", a, rng, rng.dirichlet(np.ones(n)), times)


def _slow_and_fast(a: float, rng: Rng) -> Effect:
    times = np.array([log_uniform(rng, 3e-5, 2e-4), log_uniform(rng, 5e-3, 0.1)])
    return _branches("slow_and_fast", a, rng, rng.uniform(0.2, 1.0, 2), times)


def _relaxing(a: float, rng: Rng) -> Effect:
    """Let the rig file's be the stiffness of fast motions, or of middling ones; slow ones relax."""
    n = int(rng.integers(1, 4))
    times = log_uniforms(rng, 2e-4, 0.3, n)
    return _branches("relaxing", a, rng, rng.dirichlet(np.ones(n)), times, lost=True)


def _slow_creep(a: float, rng: Rng) -> Effect:
    """Relax within seconds, as after a load has been put on."""
    times = log_uniforms(rng, 0.05, 2.0, 2)
    lost = bool(rng.integers(2))
    return _branches("slow", a, rng, rng.uniform(0.2, 1.0, 2), times, lost=lost)


def _constant_loss(a: float, rng: Rng) -> Effect:
    """Damp alike at all frequencies: structural damping (Bert 1973)."""
    times = np.geomspace(2.5e-5, 0.05, 6)
    return _branches("constant_loss", a, rng, np.ones(6), times, lost=bool(rng.integers(2)))


def _flows(form: str, a: float, rng: Rng, kind: float) -> Effect:
    n, twist = int(rng.integers(1, 3)), log_uniform(rng, 5e-4, 4e-3)
    times = log_uniforms(rng, 2e-4, 1e-2, n)
    return _branches(form, a, rng, rng.dirichlet(np.ones(n)), times, kind, twist)


def _thinning(a: float, rng: Rng) -> Effect:
    return _flows("thinning_dashpot", a, rng, 1.0)


def _thickening(a: float, rng: Rng) -> Effect:
    return _flows("thickening_dashpot", a, rng, 0.0)


def _threshold(rng: Rng) -> Array:
    at = float(rng.uniform(0.1, 0.6))
    return far_curve(lambda x: np.maximum(x - at, 0) ** 1.5 / (1.0 + x**1.5))


def _kraus(rng: Rng) -> Array:
    m = float(rng.uniform(0.3, 0.9))
    return far_curve(lambda x: x ** (2.0 * m) / (1.0 + x ** (2.0 * m)))


def _power(rng: Rng) -> Array:
    p = log_uniform(rng, 0.2, 1.0)
    return far_curve(lambda x: 1.0 - (1.0 + x) ** -p)


def _logarithm(rng: Rng) -> Array:
    k = log_uniform(rng, 1.0, 30.0)
    return far_curve(lambda x: np.log1p(k * np.minimum(x, 20.0)) / math.log1p(20.0 * k))


# Kraus 1984 with any exponent, Ulmer 1996 (exponential), Fletcher and Gent 1953 (logarithm).
SOFTENING: tuple[Recipe, ...] = (
    *family(_softens, ("table", drawn_curve),
            ("rehardening", lambda rng: overshoot(float(rng.uniform(-0.2, 0.6)))),
            ("threshold", _threshold), ("kraus", _kraus), ("power", _power),
            ("logarithm", _logarithm)),
    *family(_softens_whole, ("whole_table", drawn_curve), ("whole_power", _power)),
    _soft_held, _soft_recovering, _soft_bristles,
)  # fmt: skip
VISCOELASTICITY: tuple[Recipe, ...] = (
    _springpot, _drawn_branches, _slow_and_fast, _relaxing, _slow_creep, _constant_loss,
    _thinning, _thickening,
)  # fmt: skip
