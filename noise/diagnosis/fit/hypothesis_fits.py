"""Hypotheses fitted, the likeliest first, until what is left unfitted is unlikely.

Each fit changes the odds of its hypothesis by what it closes; then all are as probable as they have
become, and the likeliest of those not yet fitted is next.

Hypotheses judged by their fits: which is the likeliest once it is known what each closes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from noise.diagnosis.causes.verdict import ALONE, Hypothesis, likeliest, marginals, normalised
from noise.diagnosis.findings import SHOWN_IN, StageFinding
from noise.diagnosis.first_answer import FirstAnswer, known_effects
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.fit.closing import (
    CLOSABLE,
    ClosingOdds,
    closed_of,
    differing,
    load_closing_odds,
    rms,
)
from noise.diagnosis.fit.fit_effect import fit_effect
from noise.diagnosis.fit.fit_parameters import Fitted, fit_parameters, split
from noise.diagnosis.simulated.model_runs import Model
from noise.diagnosis.text.words import joined
from sim.effects import EFFECTS
from sim.effects.effect import Effect
from sim.rig_effects import irregular_effects

if TYPE_CHECKING:
    from noise.diagnosis.case import Case


_UNSEEN = 0.1
"""Probability before any fit of an effect that the posterior knows nothing of [-]; assumed."""


@dataclass(frozen=True, eq=False)
class Judged:
    """What the fits of a case say.

    Parameters
    ----------
    comparison : CaseComparison
    held : tuple of int
        Recordings that no fit has seen.
    fits : CaseFits, optional
        None where nothing was fitted.
    hypotheses : mapping of frozenset of str to float
        Their probabilities, the likeliest first [-].
    probabilities : mapping of str to float
        Of the causes, as the hypotheses have them [-].
    verdict : tuple of str
    among : tuple of str
        Effects that alone were weighed against nothing being the matter; empty where all were.
    """

    comparison: CaseComparison
    held: tuple[int, ...]
    fits: CaseFits | None
    hypotheses: Mapping[Hypothesis, float]
    probabilities: Mapping[str, float]
    verdict: tuple[str, ...]
    among: tuple[str, ...] = ()


def judge(
    case: Case,
    first: FirstAnswer,
    stages: Mapping[str, StageFinding],
    library: Mapping[str, Effect],
    seed: int,
    tell: Callable[[str], None],
) -> Judged:
    """Fit the likeliest hypotheses of a case, and say which is the likeliest then.

    Where the first answer finds nothing to explain, the user's own effects alone are fitted, of
    which it knows nothing; all probabilities are then of these and of nothing being the matter.

    Parameters
    ----------
    case : Case
    first : FirstAnswer
    stages : mapping of str to StageFinding
    library : mapping of str to Effect
    seed : int
    tell : callable
        Told what is being done.
    """
    comparison = first.comparison
    fitted_to, held = map(tuple, split([r.condition for r in case.recordings]))
    known = known_effects(case.rig, library)
    always = [name for name in library if name not in EFFECTS and name not in known]
    if first.verdict:
        always += [spec.name for spec in irregular_effects(case.rig, library)]
    elif not always:
        return Judged(comparison, held, None, first.hypotheses, first.probabilities, ())
    tell("recalibrating the parameters")
    alone, whole = fit_parameters(comparison, fitted_to), range(len(case.recordings))
    before, recalibrated = (comparison.squared(m, whole) for m in (Model(), alone.model))
    asked = _with_unseen(first.hypotheses, always)
    if not first.verdict:  # what the posterior knows of is not there
        asked = normalised({h: p for h, p in asked.items() if not h or h <= set(always)})
    fits = CaseFits(comparison, fitted_to, held, alone, before, recalibrated, {})
    fits = fit_hypotheses(fits, asked, always, stages, seed, tell)
    hypotheses = settled(updated(asked, fits, stages), fits)
    if not first.verdict:  # what closes nothing then speaks for nothing being the matter
        hypotheses = normalised({h: p for h, p in hypotheses.items() if h in asked})
    verdict, single = likeliest(hypotheses, fits.of), marginals(hypotheses)
    probabilities = {n: single.get(n, 0.0) for n in {**first.probabilities, **single}}
    among = () if first.verdict else tuple(always)
    return Judged(comparison, held, fits, hypotheses, probabilities, verdict, among)


def _with_unseen(
    hypotheses: Mapping[Hypothesis, float], names: Sequence[str]
) -> dict[Hypothesis, float]:
    """Give effects that the posterior knows nothing of a chance, each alone."""
    least = {frozenset({name}): _UNSEEN for name in names}
    return normalised(
        dict(hypotheses) | {h: max(p, hypotheses.get(h, 0.0)) for h, p in least.items()}
    )


def fit_notes(judged: Judged) -> list[str]:
    """Say what probabilities are given, and what could not be fitted.

    Parameters
    ----------
    judged : Judged

    Returns
    -------
    list of str
        One line each.
    """
    found = []
    if judged.among:
        found.append(
            "among the causes that the program brings there is nothing to explain: the "
            f"probabilities are of {joined(judged.among)} and of no gap, as if there were no other"
        )
    if judged.fits is not None:
        found += [
            f"{' and '.join(sorted(names))} was not fitted, since no model of it can be simulated: "
            f"{why}"
            for names, why in judged.fits.impossible.items()
        ]
    return found


_MOST = 5
"""Fits of a diagnosis, those of the user's own effects not counted; what a diagnosis may cost
settles it; assumed."""

_ENOUGH = 0.9
"""Probability of what was fitted, or needs no fit, from which on no more is fitted; assumed."""

_LIKELY = 0.05
"""Probability of a hypothesis that is worth a fit; assumed."""

_NO_FIT: tuple[Hypothesis, ...] = (frozenset(), *ALONE)


@dataclass(frozen=True, eq=False)
class HypothesisFit:
    """A set of effects as fitted together.

    Parameters
    ----------
    names : tuple of str
        The likeliest first.
    fitted : Fitted
    squared : ndarray, shape (n_recordings,)
        What is left of each recording, in squared floors [-].
    """

    names: tuple[str, ...]
    fitted: Fitted
    squared: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CaseFits:
    """Fits of a case.

    Parameters
    ----------
    comparison : CaseComparison
    fitted_to, held : tuple of int
        Recordings, as `noise.diagnosis.fit.fit_parameters.split` divides them.
    alone : Fitted
        The parameters without any effect.
    before, recalibrated : ndarray, shape (n_recordings,)
        Squared distance of each recording from the rig as its file has it, and with parameters
        alone, in squared floors [-].
    of : mapping of frozenset of str to HypothesisFit
    impossible : mapping of frozenset of str to str
        Sets of effects that cannot be simulated, and why.
    odds : ClosingOdds
        That say what fits tell.
    """

    comparison: CaseComparison
    fitted_to: tuple[int, ...]
    held: tuple[int, ...]
    alone: Fitted
    before: NDArray[np.float64]
    recalibrated: NDArray[np.float64]
    of: Mapping[Hypothesis, HypothesisFit]
    impossible: Mapping[Hypothesis, str] = field(default_factory=dict)
    odds: ClosingOdds = field(default_factory=load_closing_odds)

    def held_out(self, squared: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what belongs to recordings that no fit has seen.

        Parameters
        ----------
        squared : ndarray, shape (n_recordings,)
            [-]

        Returns
        -------
        ndarray, shape (n_held,)
            [-]
        """
        return squared[list(self.held)]

    def least(self, hypothesis: Hypothesis) -> NDArray[np.float64]:
        """Return what a fit leaves of each recording, or that of a part of it where that is less.

        More effects leave no more than fewer do, but a search among more of them may stop short.

        Parameters
        ----------
        hypothesis : frozenset of str

        Returns
        -------
        ndarray, shape (n_recordings,)
            In squared floors [-].
        """
        parts = [fit.squared for names, fit in self.of.items() if names < hypothesis]
        return min((self.of[hypothesis].squared, *parts), key=rms)

    def closes(self, hypothesis: Hypothesis) -> bool:
        """Tell whether a fit closes some of what parameters leave of recordings held out.

        Where these have nothing to close, all recordings tell, in which an effect may still show.
        What changes nothing closes nothing.
        """
        after = self.least(hypothesis)
        left, now = (rms(self.held_out(x)) for x in (self.recalibrated, after))
        if left < 1.0 + CLOSABLE:
            left, now = rms(self.recalibrated), rms(after)
        if left < 1.0 + CLOSABLE:
            return now < left
        return closed_of(left, now) >= self.odds.enough


def fit_hypotheses(
    fits: CaseFits,
    hypotheses: Mapping[Hypothesis, float],
    always: Sequence[str],
    stages: Mapping[str, StageFinding],
    seed: int = 0,
    tell: Callable[[str], None] = lambda _text: None,
) -> CaseFits:
    """Fit the likeliest hypotheses.

    Parameters
    ----------
    fits : CaseFits
        Of parameters alone.
    hypotheses : mapping of frozenset of str to float
        Their probabilities before any fit [-].
    always : sequence of str
        Effects that are fitted whatever their probability.
    stages : mapping of str to StageFinding
    seed : int
    tell : callable
        Told what is being done.
    """
    single = marginals(hypotheses)

    def with_fit(fits: CaseFits, hypothesis: Hypothesis) -> CaseFits:
        names = tuple(sorted(hypothesis, key=lambda name: (-single.get(name, 0.0), name)))
        tell(f"fitting {' and '.join(names)}")
        parts = [fit for fewer, fit in fits.of.items() if fewer < hypothesis]
        part = max(parts, key=lambda fit: (len(fit.names), -rms(fit.squared)), default=None)
        try:
            fitted = fit_effect(
                fits.comparison, fits.fitted_to, names, fits.alone.model, seed,
                begun=None if part is None else part.fitted.model,
            )  # fmt: skip
        except ParameterError as error:
            return replace(fits, impossible={**fits.impossible, hypothesis: str(error)})
        after = fits.comparison.squared(fitted.model, range(len(fits.before)))
        # A model that breaks down on recordings that it has not seen closes nothing there.
        after = np.where(np.isfinite(after), after, np.maximum(fits.before, fits.recalibrated))
        return replace(fits, of={**fits.of, hypothesis: HypothesisFit(names, fitted, after)})

    for name in always:
        fits = with_fit(fits, frozenset({name}))
    for _ in range(_MOST):
        now = updated(hypotheses, fits, stages)
        done = {*fits.of, *fits.impossible, *_NO_FIT}
        unfitted = {h: p for h, p in now.items() if h not in done}
        next_one = max(unfitted, key=lambda hypothesis: unfitted[hypothesis], default=frozenset())
        if sum(unfitted.values()) < 1.0 - _ENOUGH or unfitted[next_one] < _LIKELY:
            break
        fits = with_fit(fits, next_one)
    return fits


def settled(hypotheses: Mapping[Hypothesis, float], fits: CaseFits) -> dict[Hypothesis, float]:
    """Hand what speaks for sets of effects whose fits close nothing to the unknown.

    Parameters
    ----------
    hypotheses : mapping of frozenset of str to float
        As `updated` has them [-].
    fits : CaseFits

    Returns
    -------
    dict of frozenset of str to float
        The likeliest first; they sum to 1 [-].
    """
    idle = {h for h in fits.of if not fits.closes(h)}
    left = {h: p for h, p in hypotheses.items() if h not in idle}
    unknown = frozenset({"unknown"})
    lost = sum(hypotheses.get(h, 0.0) for h in idle)
    return normalised(left | {unknown: left.get(unknown, 0.0) + lost})


def updated(
    hypotheses: Mapping[Hypothesis, float],
    fits: CaseFits,
    stages: Mapping[str, StageFinding],
) -> dict[Hypothesis, float]:
    """Probabilities of hypotheses once some of them are fitted.

    Parameters
    ----------
    hypotheses : mapping of frozenset of str to float
        Their probabilities before any fit [-].
    fits : CaseFits
    stages : mapping of str to StageFinding

    Returns
    -------
    dict of frozenset of str to float
        The likeliest first; they sum to 1 [-].
    """
    odds, library = fits.odds, fits.comparison.library
    gap, left = rms(fits.before), rms(fits.recalibrated)
    gaps = {hypothesis: rms(fits.least(hypothesis)) for hypothesis in fits.of}
    looked = {name: how for name, stage in stages.items()
              if (how := differing(stage)) is not None}  # fmt: skip
    # Where no stage differs for sure, that of an effect differs no less than the others.
    surest = max(looked.values(), default=1.0)
    looked = {name: how + 1.0 - surest for name, how in looked.items()}

    def ratio(hypothesis: Hypothesis) -> float:
        if not hypothesis:
            return odds.of_none(gap)
        if hypothesis == {"parameters"}:
            return odds.of_parameters(gap, left)
        if hypothesis == {"unknown"}:
            return 0.0
        if hypothesis not in gaps:  # more beside what closes can close no more than that leaves
            fewer = [other for other in gaps if other < hypothesis]
            return max([0.0, *(ratio(other) + odds.of_more(gaps[other], 1.0) for other in fewer)])
        shown = [SHOWN_IN[library[name].stage.value] for name in hypothesis]
        return odds.of_effects(
            left,
            gaps[hypothesis],
            [gap for other, gap in gaps.items() if other < hypothesis],
            [max(how) for among in shown if (how := [looked[s] for s in among if s in looked])],
        )

    return normalised({h: p * math.exp(ratio(h)) for h, p in hypotheses.items()})
