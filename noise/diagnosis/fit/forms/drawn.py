"""Forms drawn from the library of variants: what a real rig might have that no formula foresees."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from noise.diagnosis.cases.variants import VARIANTS
from noise.diagnosis.cases.variants.common import Recipe
from noise.diagnosis.fit.forms.form import Form
from sim.effects.effect import Effect

_TRIED = (0.1, 0.4)
"""Strengths that a fit looks at; 1 is what nobody overlooks."""


def drawn_forms(name: str, count: int, seed: int) -> list[Form]:
    """Draw further forms of an effect, each recipe as often as the others.

    Parameters
    ----------
    name : str
        Of `sim.effects.EFFECTS`; others have none.
    count, seed : int

    Returns
    -------
    list of Form
        Of one number, ``strength``, from 0 to 1.

    Examples
    --------
    >>> [form.name for form in drawn_forms("clipping", 2, 0)]
    ['drawn 0', 'drawn 1']
    """
    if name not in VARIANTS:
        return []
    recipes = VARIANTS[name]
    order = np.random.default_rng(seed).permutation(len(recipes))
    return [_form(name, recipes[order[i % order.size]], i, seed) for i in range(count)]


def _form(name: str, recipe: Recipe, number: int, seed: int) -> Form:
    made: dict[float, Effect] = {}

    def make(values: Mapping[str, float]) -> Effect:
        strength = values["strength"]
        if strength not in made:
            made[strength] = recipe(strength, np.random.default_rng([seed, number]))
        return made[strength]

    return Form(name, f"drawn {number}", {"strength": _TRIED[0]}, {"strength": 1.0}, make, _TRIED)
