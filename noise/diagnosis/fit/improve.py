"""The improved rig: parameters and effects as a rig file can say them, where they close the gap.

A fit may find that a form fits best which was estimated from the recordings, or drawn at random;
no rig file knows those. Here the cause that the verdict names is fitted in forms of the simulator's
own, or put into the responses of the structure where it is there, and the rig is offered as
improved only if recordings that no fit has seen agree with it, and nothing is left to explain.

Responses of a structure corrected by what recordings show it to do besides.

What a torque makes of acceleration and sound can be estimated from recordings more exactly than a
mode or a reflection can be fitted. A rig file has no form for that, but it has measured responses:
those of the rig with the estimate in it.

Effects fitted in forms that a rig file can state, each form for itself and with all numbers.

The numbers of one form, and the rig's parameters with them, hang together: less of a share at a
lower speed does nearly the same. So all are moved at once, by least squares of what a signature
deviates by (`scipy.optimize.least_squares`, trust region reflective) with slopes from steps that
are wide against the roughness of such costs.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from models.change import changed_rig, multiplied
from models.condition import known_condition, same_support
from models.errors import ParameterError
from models.rig import LawSpec, Rig, parse_spec
from models.transfer_functions.measured import MeasuredResponse
from noise.diagnosis.first_answer import first_answer
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.fit.closing import rms
from noise.diagnosis.fit.fit_effect import (
    fit_effect,
    fitted_numbers,
    is_stated,
    number_spreads,
    stated_candidates,
)
from noise.diagnosis.fit.fit_parameters import (
    HOLD,
    PRIOR,
    Fitted,
    different,
    fitted_with_spreads,
    offset_cost,
)
from noise.diagnosis.improvement import Improvement
from noise.diagnosis.simulated.model_runs import OFFSETS, Model, with_effects
from noise.diagnosis.simulated.transfer_functions import shift_clamp_mode, with_chain_effects
from sim.bushing import lumped_bushing
from sim.effects.effect import ActiveEffect

if TYPE_CHECKING:
    from noise.diagnosis.case import Case
    from noise.diagnosis.causes.posterior import Posterior
    from noise.diagnosis.fit.case_comparison import CaseComparison

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


def is_in_responses(active: ActiveEffect) -> bool:
    """Tell whether all that an effect does is to change the structure's responses."""
    effect = active.effect
    others = (effect.drive, effect.contact, effect.force, effect.sensors)
    return effect.chain is not None and all(one is None for one in others)


def corrected_responses(
    comparison: CaseComparison, rig: Rig, effects: Sequence[ActiveEffect]
) -> tuple[MeasuredResponse, ...]:
    """Return the responses of a rig with effects in them, one entry a support.

    Parameters
    ----------
    comparison : CaseComparison
        Of recordings with the supports that are wanted.
    rig : Rig
        With the parameters as they were recalibrated.
    effects : sequence of ActiveEffect
        On the structure's responses alone.

    Returns
    -------
    tuple of MeasuredResponse
        Of supports recorded; and those that the rig has of others, as they are.

    Raises
    ------
    ParameterError
        The rig cannot be modelled with a support.
    """
    found: list[MeasuredResponse] = []

    def has(support: float) -> bool:
        return any(same_support(support, one.support_stiffness) for one in found)

    for recording in comparison.recordings:
        at = known_condition(recording.condition)
        where = (at.interference, at.support_stiffness)
        if has(at.support_stiffness):
            continue
        plain, changed = (lumped_bushing(one, *where) for one in (comparison.rig, rig))
        shifted = {
            name: shift_clamp_mode(h, plain, changed)
            for name, h in comparison.runs.transfer_functions.at(*where).items()
        }
        made = with_chain_effects(rig, *where, shifted, effects)
        units = {"acceleration": "m/s^2", "pressure": "Pa"}
        to = {
            f"torque_to_{name}": replace(made[name], coherence=None, input_unit="N m",
                                         output_unit=unit)
            for name, unit in units.items()
        }  # fmt: skip
        found.append(MeasuredResponse(at.support_stiffness, **to))
    found += [one for one in rig.measured if not has(one.support_stiffness)]
    return tuple(found)


CLOSED = 1.75
"""Floors up to which a gap counts as closed; assumed. Two of the simulated repeats that
`noise.diagnosis.text.agreement_sentences.AGREES` tells of leave more in 9 %, mostly where one fell
into another regime."""

_SIMPLER = 0.95
"""What is less simple must leave at most this share of what the simpler leaves; assumed."""

_AGAIN = 2
"""Candidates that are fitted again in floors of their own."""

_UNDETERMINED = 1.4
"""Standard deviation of a logarithm from which on a number is not determined; assumed."""


def improved_rig(
    case: Case,
    comparison: CaseComparison,
    fitted_to: Sequence[int],
    held: Sequence[int],
    candidates: Sequence[Fitted],
    posterior: Posterior,
    seed: int = 0,
) -> Improvement | None:
    """Offer an improved rig.

    Parameters
    ----------
    case : Case
    comparison : CaseComparison
    fitted_to, held : sequence of int
        Recordings, as `noise.diagnosis.fit.fit_parameters.split` divides them.
    candidates : sequence of Fitted
        Parameters alone, and then effects in whatever forms fitted best, the verdict's first.
    posterior : Posterior
    seed : int
        Of what is tried, and of simulated repeats.

    Returns
    -------
    Improvement or None
        None where none closes the gap of the recordings held out, so that nothing is left to
        explain of all of them.
    """
    alone, *others = candidates

    def offered(batch: Sequence[Fitted]) -> Iterator[tuple[float, Fitted]]:
        """Forms that a file can say, and responses; what is simpler may leave a little more."""
        for one in batch:
            if one is alone:
                yield 1.0, alone
                continue
            plain, recalibrated = fit_stated(comparison, fitted_to, one, alone, seed)
            yield from ((1.0, each) for each in plain)
            yield from ((_SIMPLER, each) for each in recalibrated)
            stated = all(is_stated(comparison, spec) for spec in one.model.effects)
            if not stated and all(_is_said(comparison, spec) for spec in one.model.effects):
                yield _SIMPLER, one

    for batch in ([alone, *others[:1]], *([one] for one in others[1:])):
        tried: list[tuple[float, Model]] = []
        with suppress(ParameterError):  # none of it can be simulated
            tried += [
                (rms(comparison.squared(one.model, fitted_to)) / ease, one.model)
                for ease, one in offered(batch)
            ]
        # Those held out choose none: what they are off by would be too small.
        for _, model in sorted(tried, key=lambda entry: entry[0])[:_AGAIN]:
            try:
                own, fitted = fit_again(comparison, fitted_to, model)
            except ParameterError:  # it breaks down in one of its repeats
                continue
            after = rms(own.squared(fitted.model, held))
            made = _made(case, comparison, fitted.model) if after <= CLOSED else None
            if made is None:
                continue
            found = first_answer(replace(case, rig=made[1]), comparison.library, posterior, seed)
            if not found.verdict:
                before = rms(comparison.squared(Model(), held))
                return _improvement(case, own, fitted_to, held, fitted, *made, before, after)
    return None


def _improvement(
    case: Case,
    comparison: CaseComparison,
    fitted_to: Sequence[int],
    held: Sequence[int],
    fitted: Fitted,
    factors: dict[str, float],
    rig: Rig,
    before: float,
    after: float,
) -> Improvement:
    spread = dict(zip(OFFSETS, fitted.spread, strict=False))
    spread |= number_spreads(comparison, fitted_to, fitted.model)
    return Improvement(
        rig=rig,
        factors=factors,
        effects=tuple(spec for spec in rig.effects if spec not in case.rig.effects),
        in_responses=tuple(
            spec.name for spec in fitted.model.effects if not is_stated(comparison, spec)
        ),
        spread={
            name: math.sqrt(math.expm1(s**2)) for name, s in spread.items() if s < _UNDETERMINED
        },
        undetermined=tuple(name for name, s in spread.items() if s >= _UNDETERMINED),
        fitted_to=tuple(case.names[i] for i in fitted_to),
        held_out=tuple(case.names[i] for i in held),
        gap_before=before,
        gap_after=after,
    )


def _is_said(comparison: CaseComparison, spec: LawSpec) -> bool:
    """Tell whether a rig file can say an effect, itself or by responses."""
    return is_stated(comparison, spec) or is_in_responses(comparison.runs.active(spec))


def _made(
    case: Case, comparison: CaseComparison, model: Model
) -> tuple[dict[str, float], Rig] | None:
    """Return factors and the rig with them and with effects, to the digits of a rig file."""
    factors = {
        name: math.exp(x) for name, x in zip(OFFSETS, model.offsets, strict=True) if x != 0.0
    }
    kinetic, critical = (factors.get(name, 1.0) for name in ("kinetic_torque", "critical_torque"))
    least = max(kinetic * fit.kinetic_torque / fit.critical_torque for fit in case.rig.fits)
    if critical < least * (1.0 + _ROUNDING):  # it is at least the kinetic torque
        factors["critical_torque"] = least * (1.0 + _ROUNDING)
    stated = [spec for spec in model.effects if is_stated(comparison, spec)]
    further = [comparison.runs.active(spec) for spec in model.effects if spec not in stated]
    try:
        rig = changed_rig(case.rig, multiplied(case.rig, {}, factors), "improved rig")
        if further:
            rig = replace(rig, measured=corrected_responses(comparison, rig, further))
    except ParameterError:  # beyond what is possible of a rig
        return None
    return factors, with_effects(rig, [_in_file(spec) for spec in stated])


_ROUNDING = 2e-6


def _in_file(spec: LawSpec) -> LawSpec:
    return parse_spec(str(spec))
