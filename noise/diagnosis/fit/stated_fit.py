"""Effects fitted in forms that a rig file can state, each form for itself and with all numbers.

The numbers of one form, and the rig's parameters with them, hang together: less of a share at a
lower speed does nearly the same. So all are moved at once, by least squares of what a signature
deviates by (`scipy.optimize.least_squares`, trust region reflective) with slopes from steps that
are wide against the roughness of such costs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from models.errors import ParameterError
from models.rig import LawSpec
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.fit.fit_effect import fit_effect, fitted_numbers, is_stated, stated_candidates
from noise.diagnosis.fit.fit_parameters import (
    HOLD,
    PRIOR,
    Fitted,
    different,
    fitted_with_spreads,
    offset_cost,
)
from noise.diagnosis.simulated.model_runs import Model

_LOOKED = 2
"""Recordings that candidates are looked at with."""

_KEPT = 3
"""Candidates that fits begin with."""

_STEP_OF_OFFSET, _STEP_OF_EFFECT = 0.02, 0.1
"""Of logarithms, for slopes."""

_FARTHEST_OFFSET, _FARTHEST_EFFECT = 0.5, 3.0
"""Of logarithms, from where a fit begins; assumed."""

_ITERATIONS = 5
_HOPELESS = 30.0
"""Deviation of a model that cannot be simulated."""


def fit_stated(
    comparison: CaseComparison,
    chosen: Sequence[int],
    fitted: Fitted,
    alone: Fitted,
    seed: int = 0,
) -> list[list[Fitted]]:
    """Fit the effects of a model in forms that a rig file can state.

    What fits best need not predict best: parameters that repeats scatter in are soon fitted to the
    scatter of a few recordings, and forms differ where nothing was recorded. So several are told.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int
        Recordings to fit to.
    fitted : Fitted
        The effects in whatever forms fitted best.
    alone : Fitted
        The parameters without any effect.
    seed : int
        Of what is tried.

    Returns
    -------
    list of list of Fitted
        The effects alone, each form; and the best with the parameters recalibrated.
    """
    few = different(comparison, chosen)
    names = [spec.name for spec in fitted.model.effects]
    starts: list[Model] = []
    if all(is_stated(comparison, spec) for spec in fitted.model.effects):
        starts.append(fitted.model)
    elif len(names) > 1:
        starts.append(fit_effect(comparison, chosen, names, alone.model, seed, stated=True).model)
    if len(names) == 1:
        starts += _best_of_forms(comparison, few, names[0], alone.model, seed)
    if not starts:  # none can be simulated
        return [[], []]
    as_filed = [replace(one, offsets=Model().offsets) for one in starts]
    plain = [
        _moved(comparison, few, one, offsets=False)
        for one in {repr(one): one for one in as_filed}.values()
    ]

    def cheapest(models: Sequence[Model]) -> Model:
        return min(models, key=lambda model: offset_cost(comparison, few, model))

    further = [_moved(comparison, few, one) for one in (cheapest(plain), cheapest(starts))]
    return [
        [fitted_with_spreads(comparison, few, one) for one in models] for models in (plain, further)
    ]


def fit_again(
    comparison: CaseComparison, chosen: Sequence[int], model: Model
) -> tuple[CaseComparison, Fitted]:
    """Fit a model again in floors of its own.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int
        Recordings to fit to.
    model : Model

    Returns
    -------
    CaseComparison
        In these floors.
    Fitted

    Raises
    ------
    ParameterError
        The model cannot be simulated.
    """
    own, few = comparison.compared_about(model), different(comparison, chosen)
    plain = all(offset == 0.0 for offset in model.offsets)
    return own, fitted_with_spreads(own, few, _moved(own, few, model, offsets=not plain))


def _best_of_forms(
    comparison: CaseComparison, few: Sequence[int], name: str, alone: Model, seed: int
) -> list[Model]:
    """Return where fits begin: of each form, with the parameters recalibrated and without."""
    best: dict[tuple[object, ...], tuple[float, Model]] = {}
    for spec in stated_candidates(comparison.library[name], seed):
        for offsets in dict.fromkeys((Model().offsets, alone.offsets)):
            model = Model(offsets, (spec,))
            cost = offset_cost(comparison, few[:_LOOKED], model, single_run=True)
            key = (offsets, spec.parameters.get("form"))
            if key not in best or cost < best[key][0]:
                best[key] = cost, model
    tried = [(offset_cost(comparison, few, model), model) for _, model in best.values()]
    tried.sort(key=lambda pair: pair[0])
    return [model for cost, model in tried[:_KEPT] if math.isfinite(cost)]


def _moved(
    comparison: CaseComparison, few: Sequence[int], model: Model, *, offsets: bool = True
) -> Model:
    """Move the numbers of a model to where it deviates least; none where it does not help."""
    free = [
        (place, *number)
        for place, spec in enumerate(model.effects)
        for number in fitted_numbers(comparison, spec)
    ]
    n = len(model.offsets) if offsets else 0
    steps = np.array([_STEP_OF_OFFSET] * n + [_STEP_OF_EFFECT] * len(free))
    farthest = np.array([_FARTHEST_OFFSET] * n + [_FARTHEST_EFFECT] * len(free))

    def model_at(y: NDArray[np.float64]) -> Model:
        away = (y - 1.0).tolist()
        moved = tuple(base + x for base, x in zip(model.offsets[:n], away[:n], strict=True))
        values = [dict(spec.parameters) for spec in model.effects]
        for (place, name, value, low, high), x in zip(free, away[n:], strict=True):
            values[place][name] = float(np.clip(value * math.exp(x), low, high))
        effects = zip(model.effects, values, strict=True)
        specs = tuple(LawSpec(spec.name, one) for spec, one in effects)
        return Model((*moved, *model.offsets[n:]), specs)

    def residuals(y: NDArray[np.float64]) -> NDArray[np.float64]:
        one = model_at(y)
        held = math.sqrt(HOLD) * np.array(one.offsets) / PRIOR
        try:
            parts = [comparison.residual_signature(one, i) for i in few]
        except ParameterError:
            size = sum(comparison.signatures[i].size for i in few)
            parts = [np.full(size, _HOPELESS / math.sqrt(size / len(few)))]
        return np.concatenate([*parts, held])

    if not free and not n:
        return model
    begin = np.ones(n + len(free))  # steps are relative to it
    found = least_squares(
        residuals, begin, bounds=(begin - farthest, begin + farthest), diff_step=steps,
        x_scale=farthest, max_nfev=_ITERATIONS,
    )  # fmt: skip
    best = model_at(found.x)
    if offset_cost(comparison, few, best) < offset_cost(comparison, few, model):
        return best
    return model
