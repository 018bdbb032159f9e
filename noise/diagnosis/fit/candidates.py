"""Candidates that a fit of an effect begins with: its forms, from weak to strong."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from models.rig import LawSpec
from noise.diagnosis.cases.strengths import drawn_effect
from sim.effects import EFFECTS
from sim.effects.effect import Effect

_BEYOND_DEFAULT = (0.1, 0.3, 1.0, 3.0, 10.0)
"""Strengths tried of an effect that is not the library's, over its default."""


def plain_candidates(effect: Effect) -> list[LawSpec]:
    """Forms of an effect at their defaults, its strength over two decades about its own."""
    declared = effect.parameters[effect.strength]
    size = abs(declared.default) or 1.0
    signs = (1.0, -1.0) if declared.low < 0.0 else (1.0,)
    values = {
        min(max(sign * factor * size, declared.low), declared.high)
        for sign in signs
        for factor in _BEYOND_DEFAULT
    }
    return [
        LawSpec(effect.name, {"form": form, effect.strength: value})
        for form in effect.forms
        for value in sorted(values - {0.0})
    ]


def drawn_candidates(effect: Effect, count: int, rng: np.random.Generator) -> Iterator[LawSpec]:
    """Draw an effect as the library of cases does, strengths from weak to strong."""
    if EFFECTS.get(effect.name) is not effect:
        return
    for i in range(count):
        strength = float(np.exp(rng.uniform(np.log(0.02), 0.0)))
        spec = drawn_effect(effect.name, strength, rng)
        yield LawSpec(effect.name, {**spec.parameters, "form": effect.forms[i % len(effect.forms)]})
