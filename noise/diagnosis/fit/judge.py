"""Hypotheses judged by their fits: which is the likeliest once it is known what each closes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from noise.diagnosis.causes.joint import Hypothesis, marginals, normalised
from noise.diagnosis.causes.verdict import likeliest
from noise.diagnosis.findings import StageFinding
from noise.diagnosis.first_answer import FirstAnswer, known_effects
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.fit.fit_parameters import fit_parameters, split
from noise.diagnosis.fit.hypothesis_fits import CaseFits, fit_hypotheses, settled, updated
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
