"""Effects fitted together with the rig's parameters: many forms tried, the best ones refined.

Nobody knows the form that the real effect has, so a fit begins with many: the simulator's own with
parameters drawn over all that they may be, forms drawn from the library of variants, and forms
estimated from the recordings themselves. What comes nearest at a look is searched about.

Forms drawn from the library of variants: what a real rig might have that no formula foresees.

Candidates that a fit of an effect begins with: its forms, from weak to strong.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.rig import LawSpec
from noise.diagnosis.cases.strengths import drawn_effect
from noise.diagnosis.cases.variants import VARIANTS
from noise.diagnosis.cases.variants.common import Recipe
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.fit.fit_parameters import (
    Fitted,
    different,
    fit_parameters,
    offset_cost,
    pattern_search,
    spreads,
)
from noise.diagnosis.fit.forms.estimated import estimated_forms
from noise.diagnosis.fit.forms.form import Form
from noise.diagnosis.simulated.model_runs import Model
from sim.effects import EFFECTS
from sim.effects.effect import Effect, Stage

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


_DRAWN = 18
"""Of the simulator's own forms tried, and of variants; what a fit may cost settles it, as all
numbers to `_SETTLING`; assumed."""

_VARIANTS = {
    Stage.DRIVE: 16, Stage.FRICTION: 16, Stage.STRUCTURE: 16, Stage.RADIATION: 16,
    Stage.MEASUREMENT: 32,
}  # fmt: skip
"""Of an effect whose motion need not be made again more can be tried."""

_LOOKED = 2
"""Recordings that candidates are looked at with."""

_PROMISING = 6
"""Candidates that are looked at more closely, with the parameters recalibrated and without; the
best of either is searched about."""

_STEP = 0.5
_SHRINK = (1.0, 0.5, 0.25)
"""Of a parameter's logarithm."""

_ROUNDS = 2
"""Of the search for parameters with the effect, with small steps."""

_SETTLING = (1.0, 0.7, 1.4)
"""Factors on the strength, tried last."""

_LOOK = 0.3
_LEAST_SURE = 1.5
"""So far off the cost is looked at for how sure a strength is, and how unsure it is at most;
assumed."""

_SHARES = ("torque", "acceleration", "pressure", "angle")
"""Parameters that say which channel an effect is on; they are drawn, not searched."""


def fit_effect(
    comparison: CaseComparison,
    chosen: Sequence[int],
    names: Sequence[str],
    start: Model,
    seed: int = 0,
    *,
    begun: Model | None = None,
    stated: bool = False,
) -> Fitted:
    """Fit effects together with the parameters.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int
        Recordings to fit to.
    names : sequence of str
        Of effects in the comparison's library, the strongest first.
    start : Model
        With the parameters as they were recalibrated alone.
    seed : int
        Of what is tried.
    begun : Model, optional
        Of a fit of some of the effects, which the others are added to.
    stated : bool
        Whether only forms are tried that a rig file can state.
    """
    few = different(comparison, chosen)
    best = begun or Model()
    there = {spec.name for spec in best.effects}
    for name in (name for name in names if name not in there):
        candidates = stated_candidates(comparison.library[name], seed)
        if not stated:
            candidates += _further_candidates(comparison, chosen, name, seed)
        best = _added(comparison, few, best, start.offsets, candidates)
    if len(names) > 1:  # what the first had to stand for is the others' now
        for place in range(len(names)):
            best = _refined(comparison, few, best, place)
    fitted = fit_parameters(comparison, chosen, best, rounds=_ROUNDS)
    model = _settled(comparison, few, fitted.model)
    strength = partial(_strength_spread, comparison, few, model)
    return replace(fitted, model=model, spreads=(*fitted.spreads, strength))


def _added(
    comparison: CaseComparison,
    few: Sequence[int],
    model: Model,
    offsets: tuple[float, ...],
    candidates: Sequence[LawSpec],
) -> Model:
    """Add the candidates of one effect; return the best model that comes of it."""
    looked = [
        (offset_cost(comparison, few[:_LOOKED], one, single_run=True), one)
        for spec in candidates
        for one in [replace(model, effects=(*model.effects, spec))]
    ]
    looked.sort(key=lambda pair: pair[0])
    # The effect may be what the parameters had to stand for, or one beside them.
    starts = []
    for x in dict.fromkeys((model.offsets, offsets)):
        shown = [replace(one, offsets=x) for _, one in looked[:_PROMISING]]
        starts.append(min(shown, key=lambda one: offset_cost(comparison, few, one)))
    refined = [_refined(comparison, few, one, len(one.effects) - 1) for one in starts]
    return min(refined, key=lambda one: offset_cost(comparison, few, one))


def stated_candidates(effect: Effect, seed: int) -> list[LawSpec]:
    """Return an effect in the simulator's own forms, as a fit of a seed begins with it."""
    rng = np.random.default_rng([seed, 7])
    return list(drawn_candidates(effect, _DRAWN, rng)) or plain_candidates(effect)


def _further_candidates(
    comparison: CaseComparison, chosen: Sequence[int], name: str, seed: int
) -> list[LawSpec]:
    """Return what the simulator has no form for; the comparison is told how it is made."""
    number = _VARIANTS[comparison.library[name].stage]
    forms = [*estimated_forms(comparison, chosen, name), *drawn_forms(name, number, seed)]
    comparison.forms.update({(name, form.name): form for form in forms})
    return [spec for form in forms for spec in form.specs()]


def is_stated(comparison: CaseComparison, spec: LawSpec) -> bool:
    """Tell whether a rig file can state an effect as it was fitted."""
    return (spec.name, str(spec.parameters.get("form"))) not in comparison.forms


def _refined(comparison: CaseComparison, few: Sequence[int], model: Model, place: int) -> Model:
    """Search about an effect's numbers."""
    spec = model.effects[place]
    free = fitted_numbers(comparison, spec)

    def model_at(x: NDArray[np.float64]) -> Model:
        values = dict(spec.parameters)
        for (name, base, low, high), log in zip(free, x.tolist(), strict=True):
            values[name] = float(np.clip(base * math.exp(log), low, high))
        effects = list(model.effects)
        effects[place] = LawSpec(spec.name, values)
        return replace(model, effects=tuple(effects))

    x, _ = pattern_search(
        lambda x: offset_cost(comparison, few, model_at(x)), np.zeros(len(free)),
        np.full(len(free), _STEP), _SHRINK,
    )  # fmt: skip
    return model_at(x)


def _settled(comparison: CaseComparison, few: Sequence[int], model: Model) -> Model:
    """Settle the last effect's strength with scattered repeats, as scores are made."""
    spec = model.effects[-1]
    name = strength_of(comparison, spec)
    limits = {n: (low, high) for n, _, low, high in fitted_numbers(comparison, spec)}
    if name not in limits:
        return model
    tried = []
    for factor in _SETTLING:
        value = float(np.clip(factor * float(spec.parameters[name]), *limits[name]))
        changed = LawSpec(spec.name, {**spec.parameters, name: value})
        tried.append(replace(model, effects=(*model.effects[:-1], changed)))
    return min(tried, key=lambda one: float(np.sum(np.sqrt(comparison.squared(one, few)))))


def _strength_spread(
    comparison: CaseComparison, few: Sequence[int], model: Model
) -> tuple[float, ...]:
    """Return the standard deviation of the logarithm of the last effect's strength."""
    spec = model.effects[-1]
    return _spread_of(comparison, few, model, spec, strength_of(comparison, spec))


def number_spreads(
    comparison: CaseComparison, chosen: Sequence[int], model: Model
) -> dict[str, float]:
    """Tell how well each fitted number of the effects of a model is known.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int
        Recordings that it was fitted to.
    model : Model

    Returns
    -------
    dict of str to float
        Standard deviation of the number's logarithm by ``EFFECT.NUMBER`` [-].
    """
    few = different(comparison, chosen)
    return {
        f"{spec.name}.{name}": spread
        for spec in model.effects
        for name, *_ in fitted_numbers(comparison, spec)
        for spread in _spread_of(comparison, few, model, spec, name)
    }


def _spread_of(
    comparison: CaseComparison, few: Sequence[int], model: Model, spec: LawSpec, name: str
) -> tuple[float, ...]:
    value = spec.parameters.get(name)
    if not isinstance(value, float) or value == 0.0:
        return ()
    limits = {free: (low, high) for free, _, low, high in fitted_numbers(comparison, spec)}
    low, high = limits.get(name, (-math.inf, math.inf))

    def cost(x: NDArray[np.float64]) -> float:
        tried = float(np.clip(value * math.exp(float(x[0])), low, high))
        changed = LawSpec(spec.name, {**spec.parameters, name: tried})
        effects = tuple(changed if one is spec else one for one in model.effects)
        try:
            return offset_cost(comparison, few, replace(model, effects=effects))
        except ParameterError:
            return math.inf

    return spreads(cost, np.zeros(1), np.full(1, _LOOK), _LEAST_SURE)


def strength_of(comparison: CaseComparison, spec: LawSpec) -> str:
    """Name of the number that switches an effect off, in the form that it has."""
    form = comparison.forms.get((spec.name, str(spec.parameters.get("form"))))
    if form is not None:
        return "strength" if "strength" in form.start else "amount"
    return comparison.library[spec.name].strength


def fitted_numbers(
    comparison: CaseComparison, spec: LawSpec
) -> list[tuple[str, float, float, float]]:
    """Numbers that are fitted: name, value, and how far each may go."""
    form = comparison.forms.get((spec.name, str(spec.parameters.get("form"))))
    effect = comparison.library[spec.name]
    found = []
    for name, value in spec.parameters.items():
        if isinstance(value, str) or value == 0.0 or name in _SHARES:
            continue
        low, high = -math.inf, math.inf
        if form is not None:
            high = form.highest.get(name, math.inf)
        else:
            low, high = effect.parameters[name].low, effect.parameters[name].high
        found.append((name, float(value), low, high))
    return found
