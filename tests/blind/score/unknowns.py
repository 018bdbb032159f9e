"""Whether what is in no library is called unknown."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import rankdata

from .bootstrap import Quantity, at_least, at_most

if TYPE_CHECKING:
    from .answers import Answer
    from .truth import Truth

__all__ = ["auroc", "recall", "unknowns"]

FALSE_UNKNOWNS = 0.05
SURE = 0.9


def auroc(rows: np.ndarray) -> float:
    """Probability that a stranger (second column 1) scores above another case; ties count half."""
    strange = rows[:, 1] == 1.0
    n, m = int(strange.sum()), int((~strange).sum())
    if not n or not m:
        return np.nan
    return float((rankdata(rows[:, 0])[strange].sum() - 0.5 * n * (n + 1)) / (n * m))


def recall(rows: np.ndarray) -> float:
    """Share of strangers above the least threshold which at most 5 % of the others exceed."""
    strange = rows[:, 1] == 1.0
    others = np.sort(rows[~strange, 0])[::-1]
    if not strange.any() or not others.size:
        return np.nan
    return float(np.mean(rows[strange, 0] > others[int(FALSE_UNKNOWNS * others.size)]))


def _named(answer: Answer) -> bool:
    wrong = (p for name, p in answer.probability.items() if name not in ("none", "unknown"))
    return answer.failed or max(wrong, default=0.0) > SURE


def unknowns(pairs: list[tuple[Truth, Answer]]) -> list[Quantity]:
    """Return the AUROC of the probability of unknown, recall at 5 %, strangers surely misnamed."""
    asked = [(t, a) for t, a in pairs if t.kind == "none" or t.counts]
    rows = [(_unknown(t, a), t.kind == "stranger") for t, a in asked]
    strangers = [a for t, a in asked if t.kind == "stranger"]
    return [
        Quantity.of("unknown: AUROC", rows, auroc, at_least(0.95)),
        Quantity.of("unknown: recall at 5 %", rows, recall, at_least(0.85)),
        Quantity.of("unknown: named with p > 0.9", [_named(a) for a in strangers],
                    aim=at_most(0.03)),
        Quantity.of("unknown: said so", ["unknown" in a.verdict for a in strangers],
                    aim=at_least(0.80)),
    ]  # fmt: skip


def _unknown(truth: Truth, answer: Answer) -> float:
    if answer.failed:
        return 0.0 if truth.kind == "stranger" else 1.0
    return answer.of("unknown")
