"""Further forms of what goes on in stick: a contact that grows stronger, and one that creeps."""

from __future__ import annotations

import math

import numpy as np

from noise.diagnosis.cases.variants.common import (
    Array,
    Rng,
    curve,
    drawn_curve,
    family,
    far_curve,
    hill,
    log_uniform,
    on_contact,
)  # fmt: skip
from noise.diagnosis.cases.variants.hooks import ageing_hook, creep_hook
from sim.effects.effect import Effect

_RENEWAL = 4e-4
"""Angle after which a slip has made the contact anew [rad]."""

_MOST = 0.95
"""Share of the shaft's speed that a contact creeps at most."""


def _age(
    form: str, a: float, rng: Rng, shape: Array, *, level: float = 1.0, whole: bool = False,
    renewal: float = 0.0, kinetic: float = 0.0, gain: float = 0.97,
) -> Effect:  # fmt: skip
    time = log_uniform(rng, 1e-3, 0.15)
    header = [gain * a, time, renewal or _RENEWAL, level, whole, renewal > 0.0, kinetic]
    return on_contact(
        "static_ageing", form, a, ageing_hook,
        lambda _rng: np.concatenate([header, shape]), n_states=1,
    )  # fmt: skip


def _ages(form: str, a: float, rng: Rng, shape: Array) -> Effect:
    return _age(form, a, rng, shape)


def _grows(form: str, a: float, rng: Rng, shape: Array) -> Effect:
    """Let the contact grow beyond the torque of the rig file, which is a fresh contact's."""
    whole = bool(rng.random() < 0.6)
    gain = 1.0 if whole else 4.0
    return _age(form, a, rng, shape, level=0.0, whole=whole, gain=gain)


def _turns(form: str, a: float, rng: Rng, shape: Array) -> Effect:
    """Let the rig file's torque be that of some age: younger is weaker, older stronger."""
    whole = bool(rng.random() < 0.5)
    level = float(rng.uniform(0.25, 0.75))
    return _age(form, a, rng, shape, level=level, whole=whole, gain=1.0 if whole else 2.0)


def _remembers(form: str, a: float, rng: Rng, shape: Array) -> Effect:
    """Let slips renew a part of the contact only (Ruina 1983)."""
    renewal, level = log_uniform(rng, 2e-3, 0.1), float(rng.choice([0.0, 0.5, 1.0]))
    whole = bool(rng.random() < 0.5)
    return _age(form, a, rng, shape, level=level, whole=whole, renewal=renewal,
                gain=0.97 if level == 1.0 else 1.0)  # fmt: skip


def _rate_and_state(form: str, a: float, rng: Rng, shape: Array) -> Effect:
    """Let the sliding torque age along, as in laws of rate and state (Dieterich 1979)."""
    renewal, kinetic = log_uniform(rng, 1e-3, 0.05), float(rng.uniform(0.2, 0.8))
    return _age(form, a, rng, shape, level=float(rng.choice([0.0, 0.5])), whole=True,
                renewal=renewal, kinetic=kinetic, gain=0.9)  # fmt: skip


def _stiffens(a: float, rng: Rng) -> Effect:
    """Let the contact yield less the older it is (Berthoude et al. 1999)."""
    fading = log_uniform(rng, 3e-4, 2e-2)
    n = float(rng.uniform(0.0, 2.0))
    shape = curve(lambda r: (r + 1e-9) ** n)
    header = [0.93 * a, 0.0, 0.0, fading, 0.0]
    return on_contact(
        "static_ageing", "stiffness", a, creep_hook,
        lambda _rng: np.concatenate([header, shape]), n_states=1,
    )  # fmt: skip


def _any_power(rng: Rng) -> Array:
    p = log_uniform(rng, 0.2, 2.0)
    return far_curve(lambda x: 1.0 - (1.0 + x) ** -p)


def _delayed(rng: Rng) -> Array:
    at, steep = float(rng.uniform(0.2, 1.0)), float(rng.uniform(1.0, 4.0))
    return far_curve(lambda x: -np.expm1(-steep * np.maximum(x - at, 0.0) ** 1.5))


def _stretched(rng: Rng) -> Array:
    p = float(rng.uniform(0.35, 0.75))
    return far_curve(lambda x: -np.expm1(-(x**p)))


def _logarithm(rng: Rng) -> Array:
    k = log_uniform(rng, 3.0, 100.0)
    return far_curve(lambda x: np.log1p(k * np.minimum(x, 100.0)) / math.log1p(100.0 * k))


def _root(rng: Rng) -> Array:
    p = float(rng.uniform(0.1, 0.5))
    return far_curve(lambda x: (np.minimum(x, 100.0) / 100.0) ** p)


def _exponential(_rng: Rng) -> Array:
    return far_curve(lambda x: -np.expm1(-np.minimum(x, 99.0)))


def _creeps(
    form: str, a: float, _rng: Rng, shape: Array, lag: float = 0.0, speed: float = 0.0,
    fading: float = 0.0, share: float | None = None, lost: float = 0.0,
) -> Effect:  # fmt: skip
    header = [_MOST * a if share is None else share, lag, speed, fading, lost]
    return on_contact(
        "partial_slip", form, a, creep_hook,
        lambda _rng: np.concatenate([header, shape]), n_states=1,
    )  # fmt: skip


def _creep_lagging(a: float, rng: Rng) -> Effect:
    n, lag = log_uniform(rng, 1.0, 6.0), log_uniform(rng, 1e-4, 3e-3)
    return _creeps("lagging", a, rng, curve(lambda r: r**n), lag)


def _creep_weakened(a: float, rng: Rng) -> Effect:
    """Carry less before the slip, too: what has slipped already holds the kinetic torque alone."""
    return _creeps("weakened", a, rng, drawn_curve(rng), lost=a * float(rng.uniform(0.2, 0.8)))


def _creep_fading(a: float, rng: Rng) -> Effect:
    """Creep ever more slowly in a stick, its way growing with the logarithm of time."""
    n = log_uniform(rng, 0.5, 6.0)
    return _creeps("fading", a, rng, curve(lambda r: (r + 1e-9) ** n),
                   fading=log_uniform(rng, 5e-4, 2e-2))  # fmt: skip


def _creep_viscous(a: float, rng: Rng) -> Effect:
    """Creep at a speed of its own, by a power of the torque (Norton 1929)."""
    n, speed = log_uniform(rng, 1.0, 15.0), log_uniform(rng, 0.5, 12.0)
    return _creeps("viscous", a, rng, curve(lambda r: r**n), speed=speed, share=a)


def _creep_activated(a: float, rng: Rng) -> Effect:
    """Creep at a speed that is exponential in the torque (Eyring 1936; Heslot et al. 1994)."""
    wide, speed = log_uniform(rng, 0.03, 0.5), log_uniform(rng, 0.5, 12.0)
    shape = curve(lambda r: np.exp((r - 1.0) / wide) - np.exp(-1.0 / wide))
    return _creeps("activated", a, rng, shape, speed=speed, share=a)


def _yields(form: str, a: float, rng: Rng, power: float) -> Effect:
    """Put a contact that is the softer the nearer it is to slip in series with the elastomer."""
    compliance = 3.0 * a**1.5 * log_uniform(rng, 0.3, 1.0)  # unloaded, over the elastomer's
    shape = curve(lambda r: compliance / (compliance + (1.0 - r) ** power + 1e-9))
    return _creeps(form, a, rng, shape, share=_MOST * (a > 0.0))


def _dahl(a: float, rng: Rng) -> Effect:
    return _yields("dahl", a, rng, log_uniform(rng, 0.6, 3.0))


def _mindlin(a: float, rng: Rng) -> Effect:
    return _yields("mindlin_series", a, rng, float(rng.uniform(0.25, 0.45)))


def _threshold(rng: Rng) -> Array:
    at, n = float(rng.uniform(0.2, 0.85)), float(rng.uniform(1.0, 2.5))
    return curve(lambda r: np.maximum((r - at) / (1.0 - at), 0.0) ** n)


def _late(rng: Rng) -> Array:
    k = 1.0 - log_uniform(rng, 1e-3, 0.1)
    return curve(lambda r: np.log1p(-k * r) / np.log1p(-k))


def _bristles(rng: Rng) -> Array:
    k = log_uniform(rng, 1.0, 20.0)
    return curve(lambda r: r / (1.0 + k * (1.0 - r)))


def _early(rng: Rng) -> Array:
    n = log_uniform(rng, 0.15, 1.2)
    return curve(lambda r: (r + 1e-9) ** n)


def _annulus(rng: Rng) -> Array:
    n = float(rng.uniform(0.4, 0.8))
    return curve(lambda r: 1.0 - (1.0 - 0.999 * r) ** n)


def _zones(rng: Rng) -> Array:
    n, soft = int(rng.integers(2, 7)), float(rng.uniform(0.01, 0.03))
    at, steps = rng.uniform(0.15, 0.98, n), rng.dirichlet(np.ones(n))
    return curve(
        lambda r: sum(s / (1.0 + np.exp((p - r) / soft)) for p, s in zip(at, steps, strict=True))
    )


def _precursors(rng: Rng) -> Array:
    n, wide = int(rng.integers(2, 7)), float(rng.uniform(0.006, 0.02))
    at, size = rng.uniform(0.4, 1.0, n), rng.uniform(0.4, 1.0, n)
    return curve(
        lambda r: np.minimum(
            sum(s * np.exp(-0.5 * ((r - p) / wide) ** 2) for p, s in zip(at, size, strict=True)), 1
        )
    )


# Rabinowicz 1958 and Brockley and Davis 1968 (root, exponential), Dieterich 1972 (logarithm).
AGEING = (
    *family(_ages, ("any_power", _any_power), ("hill", lambda rng: hill(log_uniform(rng, 1.4, 4))),
            ("delayed", _delayed), ("stretched", _stretched), ("table", drawn_curve),
            ("any_logarithm", _logarithm)),
    *family(_grows, ("growing_logarithm", _logarithm), ("growing_root", _root),
            ("growing_exponential", _exponential), ("growing_table", drawn_curve)),
    *family(_turns, ("turning_logarithm", _logarithm), ("turning_table", drawn_curve)),
    *family(_remembers, ("memory_logarithm", _logarithm), ("memory_table", drawn_curve)),
    *family(_rate_and_state, ("rate_and_state", _logarithm)),
    _stiffens,
)  # fmt: skip

# Cattaneo 1938 (annulus), Mindlin 1949 (mindlin_series), Dahl 1968, Canudas de Wit et al. 1995
# (bristles), Iwan 1966 (zones), Rubinstein, Cohen and Fineberg 2007 (precursors), Johnson 1985
# (series: the contact's own stiffness, the same at all torques).
CREEP = (
    *family(_creeps, ("table", drawn_curve), ("threshold", _threshold), ("logarithmic", _late),
            ("bristles", _bristles), ("early", _early), ("annulus", _annulus), ("zones", _zones),
            ("precursors", _precursors), ("series", lambda _rng: curve(np.ones_like))),
    _creep_lagging, _creep_weakened, _creep_fading, _creep_viscous, _creep_activated,
    _dahl, _mindlin,
)  # fmt: skip
