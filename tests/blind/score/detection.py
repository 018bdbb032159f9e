"""Whether anything is said to be the matter, where, and whether it is physics or parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .bootstrap import Quantity, at_least, at_most

if TYPE_CHECKING:
    from .answers import Answer
    from .truth import Truth

__all__ = ["detection", "found_something"]


def found_something(answer: Answer) -> bool:
    """Whether a gap was reported."""
    return bool(answer.verdict)


def _balanced(rows: np.ndarray) -> float:
    """Mean of the shares in two groups, which the second column tells apart."""
    groups = [rows[rows[:, 1] == g, 0] for g in (0.0, 1.0)]
    return float(np.mean([g.mean() for g in groups])) if all(g.size for g in groups) else np.nan


def detection(pairs: list[tuple[Truth, Answer]]) -> list[Quantity]:
    """Return false alarms, detection, stage, and parameters told from missing physics."""
    nulls = [found_something(a) or a.failed for t, a in pairs if t.kind == "none"]
    real = [(t, a) for t, a in pairs if t.counts]
    told = []
    for t, a in real:
        physics = t.kind != "parameters"
        right = found_something(a) and (("parameters" not in a.verdict) == physics)
        told.append((right, physics))
    offset = [a for t, a in real if t.kind == "parameters"]
    known = [a.stage in t.stages for t, a in real if t.kind in ("one", "pair", "triple")]
    strange = [a.stage in t.stages for t, a in real if t.kind == "stranger"]
    return [
        Quantity.of("false alarms on null cases", nulls, aim=at_most(0.02)),
        Quantity.of("detection", [found_something(a) for _, a in real], aim=at_least(0.98)),
        Quantity.of("stage", known, aim=at_least(0.98)),
        Quantity.of("stage of strangers", strange),
        Quantity.of("parameters told as such", ["parameters" in a.verdict for a in offset]),
        Quantity.of("parameters told from physics", told, _balanced, at_least(0.95)),
        Quantity.of("failed", [a.failed for _, a in pairs]),
    ]
