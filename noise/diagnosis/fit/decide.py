"""Fits of the likeliest hypotheses, and update of their probabilities by what they leave.

A fitted rig is diagnosed again: what the cause posterior makes of the recordings beside it tells
what is still missing. An effect that is named there is likelier to be one more, and one that is not
is less. How much of the gap a fit closes counts little: on 339 whole answers of the second rig
(development, `tests/blind/README.md`) closing all of a large gap was worth a factor of three, where
on own cases it had been twenty. But it decides whether an effect is named: its fit must close some
of the held-out gap, parameters included, since these may have stood for the effect. Of effects that
the posterior has not learned it is the only evidence.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.rig import LawSpec
from noise.diagnosis.case import Case
from noise.diagnosis.causes.posterior import Posterior
from noise.diagnosis.causes.verdict import ALONE, Hypothesis, likeliest, marginals, normalised
from noise.diagnosis.first_answer import FirstAnswer, known_effects
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.fit.closing import CLOSABLE, closed_of, rms, room_of
from noise.diagnosis.fit.fit import Fitted, fit_effects, fit_parameters, split
from noise.diagnosis.simulated.model_runs import Model
from noise.diagnosis.words import joined, percent
from sim.effects import EFFECTS, irregular_effects
from sim.effects.effect import Effect

_UNSEEN = 0.1
"""Probability before any fit of an effect that the posterior knows nothing of [-]; assumed."""

_CLOSING, _ONE_MORE, _REMAINING = 1.0, 0.5, 0.4
"""Logarithms of the factors on odds that come of closing all of a large gap and of one effect more,
and the weight of that effect's log odds in what a fit of the others leaves [-]; of a conditional
logit model of 339 development cases of the second rig (seeds 51 to 54), rounded."""

_CLOSING_UNLEARNED = 3.0
"""The first of these for an effect that was not learned, and against nothing being the matter [-];
of 71 fits of own cases it was 2.9 to 3.3."""

_MOST_LOG_ODDS = 4.0
"""Log odds in what a fit leaves count up to this [-]; assumed."""

_FEWEST, _MOST = 3, 5
"""Fits of a diagnosis, those of the user's own effects not counted: as the right cause is among the
first three in 0.95, so many are fitted unless one closes some of the held-out gap; what a diagnosis
may cost settles the other."""

_ENOUGH = 0.9
"""Probability of what was fitted, or needs no fit, from which on no more is fitted; assumed."""

_LIKELY = 0.05
"""Probability of a hypothesis that is worth a fit; assumed."""

_SHARES = (0.5, 0.25)
"""Of a fit that opens the gap of recordings held out; assumed."""

_NO_FIT: tuple[Hypothesis, ...] = (frozenset(), *ALONE)


@dataclass(frozen=True, eq=False)
class HypothesisFit:
    """Joint fit of a set of effects.

    Parameters
    ----------
    names : tuple of str
        The likeliest first.
    fitted : Fitted
    squared : ndarray, shape (n_recordings,)
        What is left of each recording, in squared floors [-].
    share : float
        Of the fit that is taken, 1 where all of it is [-].
    """

    names: tuple[str, ...]
    fitted: Fitted
    squared: NDArray[np.float64]
    share: float = 1.0


@dataclass(frozen=True, eq=False)
class CaseFits:
    """Fits of a case.

    Parameters
    ----------
    comparison : CaseComparison
    fitted_to, held : tuple of int
        Recordings, as `noise.diagnosis.fit.fit.split` divides them.
    alone : Fitted
        The parameters without any effect.
    before, recalibrated : ndarray, shape (n_recordings,)
        Squared distance of each recording from the rig as its file has it, and with parameters
        alone, in squared floors [-].
    of : mapping of frozenset of str to HypothesisFit
    remaining : mapping of frozenset of str to mapping of str to float
        Probability of each cause in what the fit of a set leaves [-]; empty of a set whose fit
        tells nothing of larger ones.
    unlearned : frozenset of str
        Effects of which only a fit tells: the user's own, and irregularities that the rig file
        lists.
    impossible : mapping of frozenset of str to str
        Sets of effects that cannot be simulated, and why.
    """

    comparison: CaseComparison
    fitted_to: tuple[int, ...]
    held: tuple[int, ...]
    alone: Fitted
    before: NDArray[np.float64]
    recalibrated: NDArray[np.float64]
    of: Mapping[Hypothesis, HypothesisFit] = field(default_factory=dict)
    remaining: Mapping[Hypothesis, Mapping[str, float]] = field(default_factory=dict)
    unlearned: frozenset[str] = frozenset()
    impossible: Mapping[Hypothesis, str] = field(default_factory=dict)

    def held_out(self, squared: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values of the held-out recordings.

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

    def gap(self, squared: NDArray[np.float64]) -> float:
        """Return the gap in floors [-], weighing held-out and fitted recordings alike.

        Parameters
        ----------
        squared : ndarray, shape (n_recordings,)
            [-]
        """
        fitted = squared[list(self.fitted_to)]
        return math.hypot(rms(self.held_out(squared)), rms(fitted)) / math.sqrt(2.0)

    def least(self, hypothesis: Hypothesis) -> NDArray[np.float64]:
        """Return the residual of a fit, or of a fit of a subset where that is smaller.

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
        return min((self.of[hypothesis].squared, *parts), key=self.gap)

    def closes(self, hypothesis: Hypothesis) -> bool:
        """Return whether a fit, parameters included, closes some of the held-out gap.

        Where there was none to close, the fit must open none.
        """
        return self.closes_held_out(self.held_out(self.least(hypothesis)))

    def closes_held_out(self, left: NDArray[np.float64]) -> bool:
        """Return whether a residual of held-out recordings is a closed gap, as `closes`.

        Parameters
        ----------
        left : ndarray, shape (n_held,)
            In squared floors [-].
        """
        gap = rms(self.held_out(self.before))
        return rms(left) < gap if gap >= 1.0 + CLOSABLE else rms(left) < 1.0 + CLOSABLE


@dataclass(frozen=True, eq=False)
class Judged:
    """Result of the fits of a case.

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
    """

    comparison: CaseComparison
    held: tuple[int, ...]
    fits: CaseFits | None
    hypotheses: Mapping[Hypothesis, float]
    probabilities: Mapping[str, float]
    verdict: tuple[str, ...]


def judge(
    case: Case,
    first: FirstAnswer,
    library: Mapping[str, Effect],
    posterior: Posterior,
    seed: int,
    tell: Callable[[str], None],
) -> Judged:
    """Fit the likeliest hypotheses of a case and return the updated verdict.

    Where the first answer finds nothing to explain, nothing is fitted.

    Parameters
    ----------
    case : Case
    first : FirstAnswer
    library : mapping of str to Effect
    posterior : Posterior
    seed : int
    tell : callable
        Told what is being done.
    """
    comparison, whole = first.comparison, range(len(case.recordings))
    before = comparison.squared(Model(), whole)
    conditions = [recording.condition for recording in case.recordings]
    fitted_to, held = map(tuple, split(conditions, np.sqrt(before).tolist()))
    if not first.verdict:
        return Judged(comparison, held, None, first.hypotheses, first.probabilities, ())
    known = known_effects(case.rig, library)
    always = [name for name in library if name not in EFFECTS and name not in known]
    always += [spec.name for spec in irregular_effects(case.rig, library)]
    tell("recalibrating the parameters")
    alone = fit_parameters(comparison, fitted_to)
    recalibrated = comparison.squared(alone.model, whole)
    least = {frozenset({name}): _UNSEEN for name in always}
    prior = normalised(
        dict(first.hypotheses) | {h: max(p, first.hypotheses.get(h, 0.0)) for h, p in least.items()}
    )
    fits = CaseFits(
        comparison, fitted_to, held, alone, before, recalibrated, unlearned=frozenset(always)
    )

    def left_by(model: Model) -> dict[str, float]:
        return remaining_causes(comparison, model, posterior, first.probabilities)

    fits = fit_hypotheses(fits, prior, left_by, seed, tell)
    hypotheses = settled(updated(prior, fits), fits)
    verdict = likeliest(hypotheses, [h for h in fits.of if fits.closes(h)])
    single = marginals(hypotheses)
    probabilities = {n: single.get(n, 0.0) for n in {**first.probabilities, **single}}
    return Judged(comparison, held, fits, hypotheses, probabilities, verdict)


def fit_notes(judged: Judged) -> list[str]:
    """Return notes on partial fits and on effects that were not fitted.

    Parameters
    ----------
    judged : Judged

    Returns
    -------
    list of str
        One line each.
    """
    fits = judged.fits
    if fits is None:
        return []
    notes = []
    if rms(fits.held_out(fits.before)) < 1.0 + CLOSABLE <= rms(fits.before[[*fits.fitted_to]]):
        notes.append(
            "what was held out hardly deviates, so that no fit could be tried on a deviation that "
            "it had not seen: record the condition that deviates once more"
        )
    fit = fits.of.get(frozenset(judged.verdict))
    if fit is not None and fit.share < 1.0:
        notes.append(
            f"{joined(fit.names)} as fitted overshoots in the recordings held out: "
            f"{percent(fit.share)} of it is taken, which these have settled, so what it closes of "
            "them is no forecast"
        )
    notes += [
        f"{' and '.join(sorted(names))} was not fitted, since no model of it can be simulated: "
        f"{why}"
        for names, why in fits.impossible.items()
    ]
    return notes


def remaining_causes(
    comparison: CaseComparison,
    model: Model,
    posterior: Posterior,
    before: Mapping[str, float],
) -> dict[str, float]:
    """Return the probability of each cause beside a rig as fitted.

    Parameters
    ----------
    comparison : CaseComparison
    model : Model
    posterior : Posterior
    before : mapping of str to float
        Probabilities of the causes beside the rig file; one of 0 stays 0 [-].

    Returns
    -------
    dict of str to float
        Empty where the model cannot be simulated [-].
    """
    try:
        table = comparison.table_beside(model)
    except ParameterError:
        return {}
    return {
        name: p if before.get(name, 0.0) > 0.0 else 0.0
        for name, p in posterior.probabilities(table).items()
    }


def fit_hypotheses(
    fits: CaseFits,
    hypotheses: Mapping[Hypothesis, float],
    left_by: Callable[[Model], Mapping[str, float]] = lambda _model: {},
    seed: int = 0,
    tell: Callable[[str], None] = lambda _text: None,
) -> CaseFits:
    """Fit the likeliest hypotheses one by one, by odds updated after each fit.

    Parameters
    ----------
    fits : CaseFits
        Of parameters alone. Its unlearned effects are fitted whatever their probability.
    hypotheses : mapping of frozenset of str to float
        Their probabilities before any fit [-].
    left_by : callable
        Returns the probability of each cause in what a model leaves, as `remaining_causes` does.
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
            fitted = fit_effects(
                fits.comparison, fits.fitted_to, names, fits.alone.model, seed,
                begun=None if part is None else part.fitted.model,
            )  # fmt: skip
        except ParameterError as error:
            return replace(fits, impossible={**fits.impossible, hypothesis: str(error)})
        after = fits.comparison.squared(fitted.model, range(len(fits.before)))
        # A model that breaks down on recordings that it has not seen closes nothing there.
        after = np.where(np.isfinite(after), after, np.maximum(fits.before, fits.recalibrated))
        fit = weakened(fits, HypothesisFit(names, fitted, after))
        # What it leaves is weighed for larger sets of learned effects alone.
        larger = any(hypothesis < other for other in hypotheses)
        weighed = larger and not hypothesis & fits.unlearned
        left = left_by(fit.fitted.model) if weighed else {}
        remaining = {**fits.remaining, hypothesis: left}
        return replace(fits, of={**fits.of, hypothesis: fit}, remaining=remaining)

    for name in sorted(fits.unlearned):
        fits = with_fit(fits, frozenset({name}))
    for count in range(_MOST):
        done = {*fits.of, *fits.impossible, *_NO_FIT}
        unfitted = {h: p for h, p in updated(hypotheses, fits).items() if h not in done}
        least = _LIKELY
        if sum(unfitted.values()) < 1.0 - _ENOUGH:
            if count >= _FEWEST or any(map(fits.closes, fits.of)):
                break
            unfitted = {h: p for h, p in unfitted.items() if len(h) == 1}
            least = 0.0 if fits.of else _LIKELY
        next_one = max(unfitted, key=lambda hypothesis: unfitted[hypothesis], default=frozenset())
        if not next_one or unfitted[next_one] < least:
            break
        fits = with_fit(fits, next_one)
    return fits


def weakened(fits: CaseFits, fit: HypothesisFit) -> HypothesisFit:
    """Return the part of a fit that closes the held-out gap, if all of it does not.

    A form that is not quite the rig's may follow the recordings that were fitted to and overshoot
    beyond them, and a rig near a change of regime may change it by a little more. The strongest of
    the shares that closes some of the gap held out is taken, of strengths and offsets alike; where
    none does, the fit stays as it is.

    Parameters
    ----------
    fits : CaseFits
    fit : HypothesisFit
    """
    comparison, model = fits.comparison, fit.fitted.model
    if fits.closes_held_out(fits.held_out(fit.squared)):
        return fit
    for share in _SHARES:
        effects = tuple(_scaled(comparison.effect_of(spec), spec, share) for spec in model.effects)
        weaker = Model(tuple(share * x for x in model.offsets), effects)
        left = comparison.squared(weaker, fits.held)
        if fits.closes_held_out(left):
            squared = fit.squared.copy()
            squared[list(fits.held)] = left
            squared[list(fits.fitted_to)] = comparison.squared(weaker, fits.fitted_to)
            return HypothesisFit(fit.names, replace(fit.fitted, model=weaker), squared, share)
    return fit


def _scaled(effect: Effect, spec: LawSpec, share: float) -> LawSpec:
    """Return an effect with its strength scaled, within its limits."""
    declared = effect.parameters[effect.strength]
    value = share * float(spec.parameters.get(effect.strength, declared.default))
    value = min(max(value, declared.low), declared.high)
    return LawSpec(spec.name, {**spec.parameters, effect.strength: value})


def settled(hypotheses: Mapping[Hypothesis, float], fits: CaseFits) -> dict[Hypothesis, float]:
    """Move half of the probability of effects whose fits close nothing to the unknown cause.

    They are not named. On the cases of `_CLOSING` their names are right as often as others that
    are as likely, so that the Brier score was least where nothing was moved and most where all was.

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
    moved = {h: 0.5 * hypotheses.get(h, 0.0) for h in fits.of if not fits.closes(h)}
    left = {h: p - moved.get(h, 0.0) for h, p in hypotheses.items()}
    unknown = frozenset({"unknown"})
    return normalised(left | {unknown: left.get(unknown, 0.0) + sum(moved.values())})


def updated(hypotheses: Mapping[Hypothesis, float], fits: CaseFits) -> dict[Hypothesis, float]:
    """Return the probabilities of hypotheses updated by their fits.

    Parameters
    ----------
    hypotheses : mapping of frozenset of str to float
        Their probabilities before any fit [-].
    fits : CaseFits

    Returns
    -------
    dict of frozenset of str to float
        The likeliest first; they sum to 1 [-].
    """
    gap, left = fits.gap(fits.before), fits.gap(fits.recalibrated)
    gaps = {hypothesis: fits.gap(fits.least(hypothesis)) for hypothesis in fits.of}
    known = min([left, *(now for h, now in gaps.items() if not h & fits.unlearned)])

    def remaining_odds(hypothesis: Hypothesis, name: str) -> float | None:
        """Return log odds of an effect beside a fit of the others; None where they have none."""
        p = fits.remaining.get(hypothesis - {name}, {}).get(name, 0.0)
        if not p:
            return None
        return min(max(math.log(p / (1.0 - p)), -_MOST_LOG_ODDS), _MOST_LOG_ODDS)

    def ratio(hypothesis: Hypothesis) -> float:
        if not hypothesis:
            return -_CLOSING_UNLEARNED * room_of(gap)
        if hypothesis == {"parameters"}:
            return _CLOSING * (closed_of(gap, left) - room_of(left))
        if hypothesis & fits.unlearned:
            now = gaps.get(hypothesis, known)
            return _CLOSING_UNLEARNED * closed_of(known, now)
        parts = [now for fewer, now in gaps.items() if fewer <= hypothesis]
        closed = _CLOSING * closed_of(left, min(parts)) if parts else 0.0
        each = (remaining_odds(hypothesis, name) for name in hypothesis)
        odds = [one for one in each if one is not None]
        return closed + (_ONE_MORE + _REMAINING * min(odds) if odds else 0.0)

    return normalised({h: p * math.exp(ratio(h)) for h, p in hypotheses.items()})
