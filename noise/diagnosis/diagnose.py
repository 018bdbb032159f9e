"""The diagnosis: from recordings and a rig file to what is missing, and how sure that is.

In order: is there a gap beyond what repeats differ by; where; which cause is how probable; how far
parameters alone, and each likely cause with them, close it on recordings that no fit has seen.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from noise.diagnosis.equivalence import equivalent_pairs, next_measurement
from noise.diagnosis.floor import case_gap
from noise.diagnosis.heard import heard_of
from noise.diagnosis.library.rigs import OFFSETS
from noise.diagnosis.location import locate, stage_findings
from noise.diagnosis.outcome import Diagnosis, EffectFinding, Illustration
from noise.diagnosis.own import with_own
from noise.diagnosis.posterior import load_posterior
from noise.diagnosis.refit import Bench, Model, fit_effect, fit_parameters, split
from noise.diagnosis.summary import case_table
from noise.diagnosis.verdict import verdict_of
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from noise.diagnosis.case import Case
    from noise.diagnosis.posterior import Posterior
    from noise.diagnosis.refit import Fitted
    from noise.diagnosis.summary import CaseTable
    from sim.effects.effect import Effect

__all__ = ["diagnose_case"]

_LISTED = 5
"""Effects that are listed at least."""

_FITTED = 3
"""Candidates that are fitted."""

_LIKELY = 0.1
"""Candidates less probable than this are fitted only if nothing else is."""

_CLOSABLE = 0.5
"""A gap is worth closing from so many floors above the floor (`before` - `floor`)."""

_DRAWS = 400
_INTERVAL = (5.0, 95.0)


@dataclass(frozen=True, eq=False)
class _Scores:
    """Squared distances of held-out recordings from the three models."""

    before: NDArray[np.float64]
    recalibrated: NDArray[np.float64]
    after: NDArray[np.float64]


def diagnose_case(
    case: Case,
    *,
    quick: bool = False,
    library: Mapping[str, Effect] | None = None,
    posterior: Posterior | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Diagnose a case.

    Parameters
    ----------
    case : Case
    quick : bool
        Whether to give the first answer alone, without fits.
    library : mapping of str to Effect, optional
        Effects that may be missing, the user's own among them.
    posterior : Posterior, optional
    seed : int
        Of simulations and bootstraps.
    progress : callable, optional
        Told what is being done.

    Returns
    -------
    Diagnosis
    """
    started = time.perf_counter()
    tell = progress or (lambda _text: None)
    library = library or EFFECTS
    posterior = posterior or load_posterior()
    tell("comparing the recordings with the rig file")
    table = case_table(case.recordings, case.rig, library=library, seed=seed)
    tell("measuring the gap against simulated repeats")
    gap = case_gap(case.recordings, case.rig, library=library, seed=seed)
    known = {spec.name for spec in case.rig.effects}
    probabilities = _without(posterior.probabilities(table), known)
    verdict = verdict_of(probabilities, posterior.alarm, gap)
    findings = stage_findings(table, posterior)
    ranked = [name for name in _ranked(probabilities) if name in EFFECTS]
    stage = EFFECTS[verdict[0]].stage.value if verdict and verdict[0] in EFFECTS else None
    diagnosis = Diagnosis(
        verdict=verdict,
        equivalent=equivalent_pairs(ranked, probabilities, _kinds(case)),
        location=locate(table, posterior, stage) if verdict else None,
        stages=findings,
        effects=tuple(_unfitted(name, probabilities) for name in ranked[:_LISTED]),
        probabilities=probabilities,
        parameters={},
        next_measurement=next_measurement(verdict, probabilities, _kinds(case)),
        held_out=(),
        gap=gap.distance,
        floor=1.0,
        p_value=gap.p_value,
        seconds=time.perf_counter() - started,
        notes=_notes(case),
    )
    if not quick:
        diagnosis = _with_fits(case, diagnosis, table, posterior, library, known, seed, tell)
    return replace(diagnosis, seconds=time.perf_counter() - started)


def _with_fits(
    case: Case,
    diagnosis: Diagnosis,
    table: CaseTable,
    posterior: Posterior,
    library: Mapping[str, Effect],
    known: set[str],
    seed: int,
    tell: Callable[[str], None],
) -> Diagnosis:
    bench = Bench(case.rig, case.recordings, library, table, posterior.names, posterior.scale)
    fitted_to, held = split([recording.condition for recording in case.recordings])
    diagnosis = replace(diagnosis, held_out=tuple(case.names[i] for i in held))
    if not diagnosis.verdict:
        return replace(diagnosis, illustrations=_illustrations(case, bench, held, Model(), None))
    tell("recalibrating the parameters")
    alone = fit_parameters(bench, fitted_to)
    before = bench.squared(Model(), held)
    recalibrated = bench.squared(alone.model, held)
    own = [name for name in library if name not in EFFECTS and name not in known]
    findings: dict[str, EffectFinding] = {}
    fits: dict[str, Fitted] = {}
    named = [name for name in diagnosis.verdict if name in library]
    if len(named) > 1:  # effects of one verdict are fitted together, and close what they close
        tell(f"fitting {' and '.join(named)} together")
        joint = fit_effect(bench, fitted_to, named, alone.model)
        scores = _Scores(before, recalibrated, bench.squared(joint.model, held))
        for name in named:
            fits[name] = joint
            findings[name] = _finding(name, library, diagnosis.probabilities, joint, scores, seed)
    for name in [*_candidates(diagnosis), *own]:
        if name in findings:
            continue
        tell(f"fitting {name}")
        fits[name] = fit_effect(bench, fitted_to, [name], alone.model)
        scores = _Scores(before, recalibrated, bench.squared(fits[name].model, held))
        findings[name] = _finding(name, library, diagnosis.probabilities, fits[name], scores, seed)
    diagnosis = with_own(diagnosis, findings, own)
    if diagnosis.verdict[0] in own:
        stage = library[diagnosis.verdict[0]].stage.value
        diagnosis = replace(diagnosis, location=locate(table, posterior, stage))
    effects = [
        replace(
            findings.get(effect.name, effect),
            probability=diagnosis.probabilities.get(effect.name, 0.0),
        )
        for effect in (*diagnosis.effects, *(findings[name] for name in own))
    ]
    best = fits.get(diagnosis.verdict[0])
    chosen = best.model if best is not None else alone.model
    labels = tuple(
        heard_of(case.names[i], case.recordings[i], bench.simulated(Model(), case.recordings[i], 7),
                 bench.simulated(chosen, case.recordings[i], 7))
        for i in held[:3]
    )  # fmt: skip
    return replace(
        diagnosis,
        effects=tuple(sorted(effects, key=lambda effect: -effect.probability)),
        parameters=_intervals(best or alone),
        heard=labels,
        illustrations=_illustrations(case, bench, held, Model(), chosen),
    )


def _candidates(diagnosis: Diagnosis) -> list[str]:
    named = [name for name in diagnosis.verdict if name in EFFECTS]
    likely = [e.name for e in diagnosis.effects if e.probability >= _LIKELY]
    return list(dict.fromkeys([*named, *likely, diagnosis.effects[0].name]))[:_FITTED]


def _finding(
    name: str,
    library: Mapping[str, Effect],
    probabilities: Mapping[str, float],
    fitted: Fitted,
    scores: _Scores,
    seed: int,
) -> EffectFinding:
    spec = next(spec for spec in fitted.model.effects if spec.name == name)
    rng = np.random.default_rng(seed)
    draws = rng.integers(len(scores.before), size=(_DRAWS, len(scores.before)))
    drawn = [_closed(scores.before[i], scores.after[i]) for i in draws]
    known = [x for x in drawn if x is not None]
    closed = _closed(scores.before, scores.after)
    low, high = np.percentile(known, _INTERVAL) if closed is not None and known else (None, None)
    return EffectFinding(
        name=name,
        stage=library[name].stage.value,
        probability=probabilities.get(name, 0.0),
        parameters=spec.parameters,
        strength=_strength(fitted, library[name]) if spec is fitted.model.effects[-1] else None,
        gap_before=_root(scores.before),
        gap_recalibrated=_root(scores.recalibrated),
        gap_after=_root(scores.after),
        gap_floor=1.0,
        closed=closed,
        closed_low=None if low is None else float(low),
        closed_high=None if high is None else float(high),
        closed_by_effect=_closed(scores.recalibrated, scores.after),
    )


def _root(squared: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(squared)))


def _closed(before: NDArray[np.float64], after: NDArray[np.float64]) -> float | None:
    """Share of the closable gap; None where there is less than a floor to close."""
    gap, left = _root(before), max(_root(after), 1.0)
    return None if gap - 1.0 < _CLOSABLE else (gap - left) / (gap - 1.0)


def _strength(fitted: Fitted, effect: Effect) -> tuple[float, float] | None:
    """Interval of the last effect's strength, of whose logarithm the fit gives an error."""
    n = len(fitted.model.offsets)
    value = fitted.model.effects[-1].parameters.get(effect.strength)
    if not isinstance(value, float) or len(fitted.spread) <= n:
        return None
    factor = float(np.exp(1.645 * min(fitted.spread[n], 1.5)))
    low, high = sorted((value / factor, value * factor))
    return low, high


def _intervals(fitted: Fitted) -> dict[str, tuple[float, float]]:
    spread = fitted.spread or (0.0,) * len(OFFSETS)
    return {
        name: (float(np.exp(x - 1.645 * s)), float(np.exp(x + 1.645 * s)))
        for name, x, s in zip(OFFSETS, fitted.model.offsets, spread, strict=False)
    }


def _illustrations(
    case: Case, bench: Bench, held: Sequence[int], before: Model, after: Model | None
) -> tuple[Illustration, ...]:
    return tuple(
        Illustration(
            case.names[i],
            case.recordings[i],
            bench.simulated(before, case.recordings[i], 7),
            None if after is None else bench.simulated(after, case.recordings[i], 7),
        )
        for i in held[:2]
    )


def _ranked(probabilities: Mapping[str, float]) -> list[str]:
    return sorted(probabilities, key=lambda name: -probabilities[name])


def _without(probabilities: Mapping[str, float], known: set[str]) -> dict[str, float]:
    """Leave out what the rig file lists."""
    return {name: 0.0 if name in known else p for name, p in probabilities.items()}


def _unfitted(name: str, probabilities: Mapping[str, float]) -> EffectFinding:
    return EffectFinding(name, EFFECTS[name].stage.value, probabilities[name])


def _kinds(case: Case) -> frozenset[str]:
    return frozenset(
        channel.kind for recording in case.recordings for channel in recording.channels
    )


def _notes(case: Case) -> tuple[str, ...]:
    kinds = _kinds(case)
    notes = [_COST[kind] for kind in _COST if kind not in kinds]
    different = {recording.condition for recording in case.recordings}
    if len(case.recordings) == 1:
        notes.append(
            "one recording: what it was fitted to is what it is judged by; record more conditions"
        )
    elif len(different) == len(case.recordings):
        notes.append("no condition was recorded twice: how much repeats differ is assumed (2 %)")
    notes += [f"{name} was left out: {reason}" for name, reason in case.refused]
    return tuple(notes)


_COST = {
    "torque": "no torque: drive, contact and structure cannot be told apart from the sound alone",
    "acceleration": "no acceleration: structure and radiation cannot be told apart",
    "pressure": "no sound: nothing is said of radiation and room",
    "angle": "no shaft angle: the shaft is taken to turn evenly at the speed that was set",
}
