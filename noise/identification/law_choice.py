"""The law of friction: each fitted, compared on recordings left out, the simplest as good.

Whole conditions are left out. What counts is how much of their oscillation a law foretells, cycle
by cycle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.identification.law_fit import LawFit, Sketch, fit_law, fit_some, sketch_law
from noise.identification.law_model import CANDIDATES, LawModel
from noise.identification.outcome import LawScore

if TYPE_CHECKING:
    from noise.identification.bushing_fit import Known
    from noise.identification.evidence import Evidence
    from noise.identification.measured import Measured
    from noise.identification.subjects import Subject

MARGIN = 1.09
"""A simpler law may miss so many times as much for each number that it has less; assumed."""

_LEAST = 0.005
"""Share of the oscillation that any law may miss: what a cell and a start leave; assumed."""

_HOPELESS = 3.0
"""A law that misses so many times as much at first is not searched to the end; assumed."""


@dataclass(frozen=True, eq=False)
class Choice:
    """The law that was chosen.

    Parameters
    ----------
    fit : LawFit
        To all recordings.
    scores : tuple of LawScore
        Best first.
    held_out : tuple of str
        Recordings that the laws were compared on.
    """

    fit: LawFit
    scores: tuple[LawScore, ...]
    held_out: tuple[str, ...]


def left_out(recordings: Sequence[Measured]) -> list[int]:
    """Choose recordings to leave out: whole conditions, about a third, no interference altogether.

    Returns
    -------
    list of int
        None of them where there are fewer than three conditions.
    """
    by_condition: dict[tuple[float, float, float], list[int]] = {}
    for i, one in enumerate(recordings):
        c = one.condition
        key = (round(c.speed, 1), c.interference, c.support_stiffness)
        by_condition.setdefault(key, []).append(i)
    if len(by_condition) < 3:
        return []
    chosen: list[int] = []
    ordered = sorted(by_condition, key=lambda key: (key[1], key[2], key[0]))
    for key in ordered[1::2]:
        rest = [k for k in ordered if k != key and not set(by_condition[k]) & set(chosen)]
        known = any(k[1] == key[1] for k in rest) and any(k[2] == key[2] for k in rest)
        if known and len(chosen) + len(by_condition[key]) <= len(recordings) / 3:
            chosen += by_condition[key]
    return chosen


def choose_law(
    known: Known,
    subjects: Sequence[Subject],
    progress: Callable[[str], None],
    evidence: Mapping[bool, tuple[Evidence, ...]],
) -> Choice:
    """Fit all laws and choose.

    Parameters
    ----------
    known : Known
    subjects : sequence of Subject
        Recordings that slip.
    progress : callable
        Told what is being done.
    evidence : mapping of bool to tuple of Evidence
        Of the rig's numbers from elsewhere than stick-slip, by whether a law truly sticks.

    Returns
    -------
    Choice
    """
    recordings = [one.measured for one in subjects]
    held = left_out(recordings)
    trained = [i for i in range(len(subjects)) if i not in held]
    sketches: dict[str, Sketch] = {}
    for candidate in CANDIDATES:
        progress(f"law {candidate.name}: a first look")
        chosen = tuple(subjects[i] for i in trained)
        model = LawModel(candidate, chosen, known, evidence[candidate.sticks])
        alike = [s for s in sketches.values() if s.model.candidate.sticks == candidate.sticks]
        sketches[candidate.name] = sketch_law(model, alike)
    least = min(sketch.away for sketch in sketches.values())
    fits: dict[str, LawFit] = {}
    scores = []
    for name, sketch in sketches.items():
        fits[name] = fit_law(sketch, hopeless=sketch.away > _HOPELESS * least)
        missed = _with_held(fits[name], subjects, trained, held).missed
        scores.append(
            LawScore(
                name, _mean(missed[held or trained]), _mean(missed[trained]), _mean(missed),
                _parameters(fits[name]),
            )
        )  # fmt: skip
        share = 100.0 * scores[-1].missed
        progress(f"law {name}: leaves {share:.1f} % of the oscillation unexplained")
    scores.sort(key=lambda score: score.missed)
    fit = fits[_simplest(scores)]
    if held:
        whole = _with_held(fit, subjects, trained, held)
        fit = fit_law(Sketch(whole.model, (whole.vector,), 0.0))
    return Choice(fit, tuple(scores), tuple(recordings[i].name for i in held))


def _mean(shares: NDArray[np.float64]) -> float:
    return float(np.exp(np.mean(np.log(shares))))


def _simplest(scores: Sequence[LawScore]) -> str:
    """Name the simplest law that foretells nearly as much as the best."""
    best = scores[0]
    missed = {score.law: score.missed for score in scores}
    numbers = {candidate.name: candidate.n_parameters for candidate in CANDIDATES}
    return next(
        law
        for law, n in numbers.items()
        if missed[law] + _LEAST <= MARGIN ** max(numbers[best.law] - n, 0) * (best.missed + _LEAST)
    )


def _with_held(
    fit: LawFit, subjects: Sequence[Subject], trained: Sequence[int], held: Sequence[int]
) -> LawFit:
    """Let recordings left out have numbers of their own about the rig that the others gave."""
    if not held:
        return fit
    model = replace(fit.model, subjects=tuple(subjects))
    x = model.extended(fit.model, fit.vector, trained)
    free = np.zeros(x.size, dtype=bool)
    free[: model.n_local].reshape(len(subjects), -1)[held] = True
    return fit_some(model, x, free)


def _parameters(fit: LawFit) -> dict[str, float]:
    law, effects = fit.model.specs(fit.vector)
    return {key: float(value) for spec in (law, *effects) for key, value in spec.parameters.items()}
