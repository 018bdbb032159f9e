"""How strong an effect must be to be found: detection by strength and by gap."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .bootstrap import Quantity
from .detection import found_something

if TYPE_CHECKING:
    from .answers import Answer
    from .truth import Truth

__all__ = ["GAPS", "STRENGTHS", "power"]

STRENGTHS = (0.01, 0.025, 0.063, 0.16, 0.4, 1.0)
GAPS = (1.0, 1.1, 1.25, 1.5, 2.0, 3.0, 6.0, np.inf)


def _by(name: str, edges: tuple[float, ...], found: list[tuple[float, bool]]) -> list[Quantity]:
    return [
        Quantity.of(
            f"detection at {name} {low:g} to {high:g}", [hit for x, hit in found if low <= x < high]
        )
        for low, high in zip(edges, (*edges[1:-1], edges[-1] * (1 + 1e-9)), strict=False)
    ]


def power(pairs: list[tuple[Truth, Answer]]) -> list[Quantity]:
    """Detection of all single effects by strength, and of all that is the matter by gap."""
    singles = [
        (t.strength, found_something(a))
        for t, a in pairs
        if t.kind == "one" and t.strength is not None
    ]
    wide = [(t.gap, found_something(a)) for t, a in pairs if t.kind != "none" and t.gap is not None]
    return _by("strength", STRENGTHS, singles) + _by("a gap of", GAPS, wide)
