"""All quantities of a set of cases with their intervals: as figures, as a table, as JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .answers import merged, read_answer
from .bootstrap import DRAWS, LEVEL, Figure, figure
from .causes import causes
from .closing import LEAST_CLOSED, closing
from .detection import detection
from .power import power
from .probabilities import probabilities
from .unknowns import unknowns

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from .answers import Answer
    from .truth import Truth

__all__ = ["Scores", "as_json", "as_text", "loss", "score", "score_pairs"]

COMPARED = (
    "detection", "stage", "parameters told from physics", "right cause first",
    "probability on the true cause", "exact pair", "exact triple", "unknown: AUROC",
    "closed, median", "Brier", "ECE",
)  # fmt: skip
"""What forms of one's own and of others are compared by."""


@dataclass(frozen=True, eq=False)
class Scores:
    """Figures by name, and the pairs they come from."""

    figures: dict[str, Figure]
    pairs: list[tuple[Truth, Answer]]


def score(
    scored: Sequence[tuple[Truth, Mapping | None]],
    *,
    same: Mapping[str, str] | None = None,
    least_closed: float = LEAST_CLOSED,
    seed: int = 0,
    draws: int = DRAWS,
) -> Scores:
    """Score diagnoses (None where one failed) of cases; `same` gives equivalent names one name."""
    pairs = [merged(t, read_answer(d, t.case), same or {}) for t, d in scored]
    return Scores(score_pairs(pairs, least_closed=least_closed, seed=seed, draws=draws), pairs)


def score_pairs(
    pairs: list[tuple[Truth, Answer]],
    *,
    names: Collection[str] | None = None,
    least_closed: float = LEAST_CLOSED,
    seed: int = 0,
    draws: int = DRAWS,
) -> dict[str, Figure]:
    """Return figures by name of pairs of truth and answer; `names` are those wanted, if not all."""
    quantities = [
        *detection(pairs), *causes(pairs), *unknowns(pairs), *probabilities(pairs),
        *closing(pairs, least_closed), *power(pairs),
    ]  # fmt: skip
    rng = np.random.default_rng(seed)
    wanted = [q for q in quantities if names is None or q.name in names]
    return {q.name: figure(q, rng, draws) for q in wanted}


def loss(own: Scores, others: Scores) -> dict[str, Figure]:
    """What is lost from one's own forms to those of others: own less others, drawn apart."""
    lost = {}
    for name in COMPARED:
        a, b = own.figures[name], others.figures[name]
        if a.value is None or b.value is None:
            continue
        draws = a.draws - b.draws
        kept = draws[np.isfinite(draws)]
        low, high = np.quantile(kept, [0.5 - LEVEL / 2, 0.5 + LEVEL / 2])
        title = f"loss: {name}"
        lost[title] = Figure(
            title, b.cases, a.value - b.value, float(low), float(high), None, draws
        )
    return lost


def as_text(figures: Mapping[str, Figure]) -> str:
    """Lay out a table; quantities that no case asks for are left out."""
    lines = [f"{'quantity':44}{'cases':>6}{'value':>8}  {'95 % interval':16}  aim"]
    for f in figures.values():
        if f.value is None:
            continue
        aim = "" if f.aim is None else f"{f.aim} {'met' if f.met else 'MISSED'}"
        inside = f"{f.low:.3f} to {f.high:.3f}"
        lines.append(f"{f.name:44}{f.cases:6d}{f.value:8.3f}  {inside:16}  {aim}".rstrip())
    return "\n".join(lines)


def as_json(figures: Mapping[str, Figure]) -> dict[str, dict]:
    """Return figures as JSON has them."""
    return {
        name: {
            "cases": f.cases,
            "value": f.value,
            "low": f.low,
            "high": f.high,
            "aim": None if f.aim is None else str(f.aim),
            "met": f.met,
        }
        for name, f in figures.items()
    }
