"""Improved rig: a fit in the form of a rig file that closes the gap.

What fits best need not predict best: parameters that repeats scatter in are soon fitted to the
scatter of a few recordings. So what is simpler is taken where it leaves hardly more: parameters
alone, then effects alone, then both. Of what no file can state the fit is repeated in the
simulator's own forms.
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
from noise.diagnosis.first_answer import first_answer
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.fit.closing import rms
from noise.diagnosis.fit.fit import fit_closer, fit_effects
from noise.diagnosis.outcome import Improvement
from noise.diagnosis.simulated.model_runs import OFFSETS, Model, with_effects

if TYPE_CHECKING:
    from noise.diagnosis.case import Case
    from noise.diagnosis.causes.posterior import Posterior

CLOSED = 1.75
"""Floors up to which a gap counts as closed; assumed. Two of the simulated repeats that
`noise.diagnosis.sentences.AGREES` tells of leave more in 9 %, mostly where one fell
into another regime."""

_UNDETERMINED = 1.4
"""Standard deviation of a logarithm from which on a number is not determined; assumed."""


def improved_rig(
    case: Case,
    comparison: CaseComparison,
    fitted_to: Sequence[int],
    held: Sequence[int],
    alone: Model | None,
    effects: Model | None,
    posterior: Posterior,
    seed: int = 0,
) -> Improvement | None:
    """Return an improved rig, if one closes the gap.

    Parameters
    ----------
    case : Case
    comparison : CaseComparison
    fitted_to, held : sequence of int
        Recordings, as `noise.diagnosis.fit.fit.split` divides them.
    alone, effects : Model, optional
        As fitted: parameters alone, where no effect is named, and effects.
    posterior : Posterior
    seed : int
        Of what is tried, and of simulated repeats.

    Returns
    -------
    Improvement or None
        None where none closes the gap of the recordings held out, so that nothing is left to
        explain of all of them.
    """
    before = rms(comparison.squared(Model(), held))
    for model in _offered(comparison, fitted_to, alone, effects, seed):
        with suppress(ParameterError):  # it breaks down in one of its repeats
            if rms(comparison.squared(model, held)) > min(before, 2.0 * CLOSED):
                continue
            # In floors of its own: those of the rig file hide what it leaves where the rig is
            # about to change its regime.
            own = comparison.compared_about(model)
            fitted = fit_closer(own, fitted_to, model)
            after = rms(own.squared(fitted.model, held))
            made = _made(case, fitted.model) if after <= CLOSED else None
            if made is None:
                continue
            answer = first_answer(replace(case, rig=made[1]), comparison.library, posterior, seed)
            if answer.verdict:
                continue
            factors, rig = made
            spread = fitted.spread
            return Improvement(
                rig=rig,
                factors=factors,
                effects=tuple(spec for spec in rig.effects if spec not in case.rig.effects),
                spread={
                    name: math.sqrt(math.expm1(s**2))
                    for name, s in spread.items()
                    if s < _UNDETERMINED
                },
                undetermined=tuple(name for name, s in spread.items() if s >= _UNDETERMINED),
                fitted_to=tuple(case.names[i] for i in fitted_to),
                held_out=tuple(case.names[i] for i in held),
                gap_before=before,
                gap_after=after,
            )
    return None


def _offered(
    comparison: CaseComparison,
    fitted_to: Sequence[int],
    alone: Model | None,
    effects: Model | None,
    seed: int,
) -> Iterator[Model]:
    """Yield models that a rig file can state, the simpler first."""
    if alone is not None:
        yield alone
    if effects is None:
        return
    stated = effects
    if not all(map(comparison.is_stated, effects.effects)):
        names = [spec.name for spec in effects.effects]
        try:
            start = Model(effects.offsets)
            fit = fit_effects(comparison, fitted_to, names, start, seed, stated=True)
        except ParameterError:  # none of these forms can be simulated
            return
        stated = fit.model
    yield replace(stated, offsets=Model().offsets)
    if any(stated.offsets):
        yield stated


def _made(case: Case, model: Model) -> tuple[dict[str, float], Rig] | None:
    """Return factors and the rig with them and with effects, to the digits of a rig file."""
    factors = {
        name: math.exp(x) for name, x in zip(OFFSETS, model.offsets, strict=True) if x != 0.0
    }
    kinetic, critical = (factors.get(name, 1.0) for name in ("kinetic_torque", "critical_torque"))
    least = max(kinetic * fit.kinetic_torque / fit.critical_torque for fit in case.rig.fits)
    if critical < least * (1.0 + _ROUNDING):  # it is at least the kinetic torque
        factors["critical_torque"] = least * (1.0 + _ROUNDING)
    try:
        rig = changed_rig(case.rig, multiplied(case.rig, {}, factors), "improved rig")
    except ParameterError:  # beyond what is possible of a rig
        return None
    return factors, with_effects(rig, [_in_file(spec) for spec in model.effects])


_ROUNDING = 2e-6


def _in_file(spec: LawSpec) -> LawSpec:
    return parse_spec(str(spec))
