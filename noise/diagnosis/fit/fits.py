"""The second part of a diagnosis: how far parameters, and each likely cause, close the gap.

Effects that one verdict names together are fitted together, since each alone would have to stand
for the others; every further candidate is fitted alone. All are scored on recordings that no fit
has seen.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from noise.base.interval import SURE_90
from noise.diagnosis.cases.rigs import OFFSETS
from noise.diagnosis.causes.location import locate
from noise.diagnosis.evidence.friction_curves import friction_curves
from noise.diagnosis.findings import EffectFinding, Illustration
from noise.diagnosis.fit.by_fits import prefer_by_fits
from noise.diagnosis.fit.case_comparison import CaseComparison, Model
from noise.diagnosis.fit.closing import Scores, closed_interval, closed_share, rms
from noise.diagnosis.fit.fit_effect import fit_effect, strength_of
from noise.diagnosis.fit.fit_parameters import Fitted, fit_parameters, split
from noise.diagnosis.fit.improve import improved_rig
from noise.diagnosis.fit.labels_and_levels import labels_and_levels
from sim.constant_version import irregular_effects
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from noise.diagnosis.case import Case
    from noise.diagnosis.causes.posterior import Posterior
    from noise.diagnosis.evidence.summary import CaseTable
    from noise.diagnosis.outcome import Diagnosis
    from sim.effects.effect import Effect

__all__ = ["add_fits", "fitted_causes"]

_FITTED = 3
"""Candidates that are fitted."""

_LIKELY = 0.1
"""Candidates less probable than this are fitted only if nothing else is."""

_SHOWN = 3
"""Held-out recordings that are listened to."""


def add_fits(
    case: Case,
    diagnosis: Diagnosis,
    table: CaseTable,
    posterior: Posterior,
    library: Mapping[str, Effect],
    known: set[str],
    seed: int,
    tell: Callable[[str], None],
) -> Diagnosis:
    """Add to a first answer what the fits say.

    Parameters
    ----------
    case : Case
    diagnosis : Diagnosis
        The first answer.
    table : CaseTable
    posterior : Posterior
    library : mapping of str to Effect
    known : set of str
        Effects that the rig file lists.
    seed : int
    tell : callable
        Told what is being done.
    """
    comparison = CaseComparison(
        case.rig, case.recordings, library, table, posterior.names, posterior.scale
    )
    fitted_to, held = split([recording.condition for recording in case.recordings])
    diagnosis = replace(diagnosis, held_out=tuple(case.names[i] for i in held))
    user_effects = [name for name in library if name not in EFFECTS and name not in known]
    if not diagnosis.verdict and not user_effects:
        return replace(diagnosis, illustrations=_illustrations(case, comparison, held, None))
    tell("recalibrating the parameters")
    alone = fit_parameters(comparison, fitted_to)
    named = [name for name in diagnosis.verdict if name in library]
    groups = [named] if len(named) > 1 else []
    decided = user_effects
    if diagnosis.verdict:
        decided = [*user_effects, *(spec.name for spec in irregular_effects(case.rig, library))]
    single = [*_candidates(diagnosis), *decided] if diagnosis.verdict else decided
    single = list(dict.fromkeys(single))
    groups += [[name] for name in single if name not in named or len(named) == 1]
    fits = fitted_causes(comparison, fitted_to, held, groups, alone, seed, tell)
    findings = {
        name: _finding(name, comparison, diagnosis.probabilities, fitted, scores, seed)
        for name, (fitted, scores) in fits.items()
    }
    was = diagnosis.verdict
    diagnosis = prefer_by_fits(diagnosis, findings, decided)
    if diagnosis.verdict != was:
        stage = library[diagnosis.verdict[0]].stage.value
        diagnosis = replace(diagnosis, location=locate(table, posterior, stage))
    if not diagnosis.verdict:
        return replace(diagnosis, illustrations=_illustrations(case, comparison, held, None))
    listed = {effect.name for effect in diagnosis.effects}
    effects = [
        replace(
            findings.get(effect.name, effect),
            probability=diagnosis.probabilities.get(effect.name, 0.0),
        )
        for effect in (
            *diagnosis.effects,
            *(findings[name] for name in decided if name not in listed),
        )
    ]
    fitted = fits[diagnosis.verdict[0]][0] if diagnosis.verdict[0] in fits else None
    best = alone
    if fitted is not None and np.isfinite(comparison.squared(fitted.model, held)).all():
        best = fitted
    tell("looking for an improved rig")
    others = [one for one, _ in fits.values() if one is not fitted]
    tried = [alone, *([fitted] if fitted is not None else []), *others]
    improvement = improved_rig(case, comparison, fitted_to, held, tried, posterior, seed)
    listened = tuple(
        labels_and_levels(
            case.names[i],
            case.recordings[i],
            comparison.simulated(Model(), case.recordings[i], 7),
            comparison.simulated(best.model, case.recordings[i], 7),
        )
        for i in held[:_SHOWN]
    )
    return replace(
        diagnosis,
        effects=tuple(sorted(effects, key=lambda effect: -effect.probability)),
        parameters=_intervals(best),
        labels_and_levels=listened,
        illustrations=_illustrations(case, comparison, held, best.model),
        improvement=improvement,
    )


def fitted_causes(
    comparison: CaseComparison,
    fitted_to: Sequence[int],
    held: Sequence[int],
    groups: Sequence[Sequence[str]],
    alone: Fitted,
    seed: int = 0,
    tell: Callable[[str], None] | None = None,
) -> dict[str, tuple[Fitted, Scores]]:
    """Fit causes and score them on recordings that no fit has seen.

    Parameters
    ----------
    comparison : CaseComparison
    fitted_to, held : sequence of int
        Recordings, as `noise.diagnosis.fit.fit_parameters.split` divides them.
    groups : sequence of sequence of str
        Effects, those of one group together.
    alone : Fitted
        The parameters without any effect.
    seed : int
    tell : callable, optional
        Told what is being done.

    Returns
    -------
    dict of str to (Fitted, Scores)
        By the name of the effect; those of one group share their fit.
    """
    before, recalibrated = comparison.squared(Model(), held), comparison.squared(alone.model, held)
    found: dict[str, tuple[Fitted, Scores]] = {}
    for names in groups:
        if tell is not None:
            tell(f"fitting {' and '.join(names)}")
        fitted = fit_effect(comparison, fitted_to, names, alone.model, seed)
        after = comparison.squared(fitted.model, held)
        # A model that breaks down on recordings that it has not seen closes nothing there.
        after = np.where(np.isfinite(after), after, np.maximum(before, recalibrated))
        scores = Scores(before, recalibrated, after)
        found |= dict.fromkeys(names, (fitted, scores))
    return found


def _candidates(diagnosis: Diagnosis) -> list[str]:
    named = [name for name in diagnosis.verdict if name in EFFECTS]
    likely = [e.name for e in diagnosis.effects if e.probability >= _LIKELY]
    return list(dict.fromkeys([*named, *likely, diagnosis.effects[0].name]))[:_FITTED]


def _finding(
    name: str,
    comparison: CaseComparison,
    probabilities: Mapping[str, float],
    fitted: Fitted,
    scores: Scores,
    seed: int,
) -> EffectFinding:
    spec = next(spec for spec in fitted.model.effects if spec.name == name)
    interval = closed_interval(scores, seed)
    return EffectFinding(
        name=name,
        stage=comparison.library[name].stage.value,
        probability=probabilities.get(name, 0.0),
        parameters=spec.parameters,
        strength=_strength(fitted, comparison) if spec is fitted.model.effects[-1] else None,
        gap_before=rms(scores.before),
        gap_recalibrated=rms(scores.recalibrated),
        gap_after=rms(scores.after),
        gap_floor=1.0,
        closed=closed_share(scores.before, scores.after),
        closed_low=None if interval is None else interval[0],
        closed_high=None if interval is None else interval[1],
        closed_by_effect=closed_share(scores.recalibrated, scores.after),
    )


def _strength(fitted: Fitted, comparison: CaseComparison) -> tuple[float, float] | None:
    """Interval of the last effect's strength, of whose logarithm the fit gives an error."""
    n, spec = len(fitted.model.offsets), fitted.model.effects[-1]
    value = spec.parameters.get(strength_of(comparison, spec))
    if not isinstance(value, float) or len(fitted.spread) <= n:
        return None
    factor = float(np.exp(SURE_90 * fitted.spread[n]))
    low, high = sorted((value / factor, value * factor))
    return low, high


def _intervals(fitted: Fitted) -> dict[str, tuple[float, float]]:
    return {
        name: (float(np.exp(x - SURE_90 * s)), float(np.exp(x + SURE_90 * s)))
        for name, x, s in zip(OFFSETS, fitted.model.offsets, fitted.spread, strict=False)
    }


def _illustrations(
    case: Case, comparison: CaseComparison, held: Sequence[int], after: Model | None
) -> tuple[Illustration, ...]:
    return tuple(_illustration(case, comparison, i, after) for i in held[:2])


def _illustration(
    case: Case, comparison: CaseComparison, i: int, after: Model | None
) -> Illustration:
    shown = {
        "measured": case.recordings[i],
        "before": comparison.simulated(Model(), case.recordings[i], 7),
    }
    if after is not None:
        shown["after"] = comparison.simulated(after, case.recordings[i], 7)
    found = {name: friction_curves(recording, case.rig) for name, recording in shown.items()}
    contacts = {name: curves for name, curves in found.items() if curves is not None}
    return Illustration(
        case.names[i], shown["measured"], shown["before"], shown.get("after"), contacts
    )
