"""Further forms of an elastomer that is softer in large motions, or stiffer in fast ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from sim.effects.effect import Effect

__all__ = ["SOFTENING", "VISCOELASTICITY"]

_SHORTEST = 2e-5


def _softens(form: str, a: float, rng: Rng, shape: Array, held: float = 0.0) -> Effect:
    header = [0.6 * a, log_uniform(rng, 4e-4, 6e-3), log_uniform(rng, 0.02, 0.2), held]
    return on_contact(
        "amplitude_softening", form, a, softening_hook,
        lambda _rng: np.concatenate([header, shape]), n_states=2,
    )  # fmt: skip


def _soft_held(a: float, rng: Rng) -> Effect:
    return _softens("held", a, rng, drawn_curve(rng), log_uniform(rng, 3e-3, 0.1))


def _soft_bristles(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(2, 7))
    twists = log_uniforms(rng, 4e-4, 8e-3, n)
    return on_contact(
        "amplitude_softening", "bristles", a, bristle_hook,
        lambda _rng: np.concatenate([[0.6 * a, n], twists]), n_states=n,
    )  # fmt: skip


def _branches(form: str, a: float, shares: Array, times: Array) -> Effect:
    rates = 1.0 / np.maximum(times, _SHORTEST)
    parts = 0.9 * a * shares / shares.sum()
    return on_contact(
        "viscoelastic_stiffness", form, a, EFFECTS["viscoelastic_stiffness"].contact,
        lambda _rng: np.concatenate([[times.size], parts, rates]), n_states=times.size,
    )  # fmt: skip


def _springpot(a: float, rng: Rng) -> Effect:
    times = np.geomspace(3e-5, log_uniform(rng, 0.02, 0.3), 7)
    return _branches("springpot", a, times ** -float(rng.uniform(0.1, 0.7)), times)


def _drawn_branches(a: float, rng: Rng) -> Effect:
    n = int(rng.integers(2, 6))
    times = log_uniforms(rng, 3e-5, 3e-2, n)
    return _branches("drawn_branches", a, rng.dirichlet(np.ones(n)), times)


def _slow_and_fast(a: float, rng: Rng) -> Effect:
    times = np.array([log_uniform(rng, 3e-5, 2e-4), log_uniform(rng, 5e-3, 0.1)])
    return _branches("slow_and_fast", a, rng.uniform(0.2, 1.0, 2), times)


def _flows(form: str, a: float, rng: Rng, thinning: float, twist: float) -> Effect:
    n = int(rng.integers(1, 3))
    rates = 1.0 / log_uniforms(rng, 2e-4, 1e-2, n)
    shares = 0.9 * a * rng.dirichlet(np.ones(n))
    return on_contact(
        "viscoelastic_stiffness", form, a, dashpot_hook,
        lambda _rng: np.concatenate([[n, thinning, twist], shares, rates]), n_states=n,
    )  # fmt: skip


def _thinning(a: float, rng: Rng) -> Effect:
    return _flows("thinning_dashpot", a, rng, 1.0, log_uniform(rng, 5e-4, 4e-3))


def _thickening(a: float, rng: Rng) -> Effect:
    return _flows("thickening_dashpot", a, rng, 0.0, log_uniform(rng, 5e-4, 4e-3))


def _threshold(rng: Rng) -> Array:
    at = float(rng.uniform(0.1, 0.6))
    return far_curve(lambda x: np.maximum(x - at, 0) ** 1.5 / (1.0 + x**1.5))


SOFTENING: tuple[Recipe, ...] = (
    *family(_softens, ("table", drawn_curve),
            ("rehardening", lambda rng: overshoot(float(rng.uniform(-0.2, 0.6))))),
    _soft_held, *family(_softens, ("threshold", _threshold)), _soft_bristles,
)  # fmt: skip
VISCOELASTICITY: tuple[Recipe, ...] = (
    _springpot, _drawn_branches, _slow_and_fast, _thinning, _thickening,
)  # fmt: skip
