"""How far probabilities can be believed: Brier, log score and expected calibration error.

Brier is the sum over names of (p - true)^2, from 0 to 2 where one name is true. The log score is
the mean of -ln p of the names that are true, p being at least `LEAST`. Calibration compares, in ten
groups of equally many cases, the highest probability with the share in which its name is true; few
cases give some error even to a perfect answer, so that of a calibrated one stands beside it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .bootstrap import Quantity, at_most

if TYPE_CHECKING:
    from .answers import Answer
    from .truth import Truth

__all__ = ["LEAST", "calibration_error", "probabilities"]

LEAST = 1e-4
_GROUPS = 10


def calibration_error(rows: np.ndarray) -> float:
    """Expected calibration error of rows of confidence and whether it was right."""
    order = np.argsort(rows[:, 0], kind="stable")
    groups = np.array_split(rows[order], min(_GROUPS, len(rows)))
    return float(sum(abs(g[:, 0].mean() - g[:, 1].mean()) * len(g) for g in groups) / len(rows))


def _if_calibrated(rows: np.ndarray) -> float:
    rng = np.random.default_rng(0)
    drawn = [
        calibration_error(np.column_stack([rows[:, 0], rng.random(len(rows)) < rows[:, 0]]))
        for _ in range(20)
    ]
    return float(np.mean(drawn))


def _brier(truth: Truth, answer: Answer) -> float:
    names = set(truth.names) | set(answer.probability)
    return sum((answer.of(name) - (name in truth.names)) ** 2 for name in names)


def _top(truth: Truth, answer: Answer) -> tuple[float, bool]:
    if not answer.probability:
        return 1.0, False
    name = answer.ranking[0]
    return answer.of(name), name in truth.names


def probabilities(pairs: list[tuple[Truth, Answer]]) -> list[Quantity]:
    """Scores over null cases and those above the least gap."""
    asked = [(t, a) for t, a in pairs if t.kind == "none" or t.counts]
    logs = [-np.mean(np.log([max(a.of(n), LEAST) for n in t.names])) for t, a in asked]
    tops = [_top(t, a) for t, a in asked]
    return [
        Quantity.of("Brier", [_brier(t, a) for t, a in asked], aim=at_most(0.15)),
        Quantity.of("log score", logs),
        Quantity.of("ECE", tops, calibration_error, at_most(0.03)),
        Quantity.of("ECE if calibrated", tops, _if_calibrated),
    ]
