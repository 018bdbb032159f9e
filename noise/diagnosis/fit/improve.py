"""The improved rig: parameters and effects as a rig file can say them, where they close the gap.

A fit may find that a form fits best which was estimated from the recordings, or drawn at random;
no rig file knows those. Here the cause that the verdict names is fitted in forms of the simulator's
own, or put into the responses of the structure where it is there, and the rig is offered as
improved only if recordings that no fit has seen agree with it, and nothing is left to explain.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from models.change import changed_rig, multiplied
from models.errors import ParameterError
from models.rig import LawSpec, Rig, parse_spec
from noise.diagnosis.cases.rigs import OFFSETS
from noise.diagnosis.first_answer import first_answer
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.fit.closing import rms
from noise.diagnosis.fit.corrected_responses import corrected_responses, is_in_responses
from noise.diagnosis.fit.fit_effect import is_stated, number_spreads
from noise.diagnosis.fit.fit_parameters import Fitted
from noise.diagnosis.fit.stated_fit import fit_again, fit_stated
from noise.diagnosis.improvement import Improvement
from noise.diagnosis.simulated.model_runs import Model, with_effects

if TYPE_CHECKING:
    from noise.diagnosis.case import Case
    from noise.diagnosis.causes.posterior import Posterior


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
        tried = [(rms(comparison.squared(one.model, held)) / ease, one.model)
                 for ease, one in offered(batch)]  # fmt: skip
        tried.sort(key=lambda entry: entry[0])
        again = []
        for _, model in tried[:_AGAIN]:
            with suppress(ParameterError):  # it breaks down in one of its repeats
                own, fitted = fit_again(comparison, fitted_to, model)
                again.append((rms(own.squared(fitted.model, held)), own, fitted))
        for after, own, fitted in sorted(again, key=lambda entry: entry[0]):
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
    if critical < least * (1.0 + _ROUNDING):  # a contact breaks at no less than it slides at
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
