"""Whether the right cause comes first, and whether pairs and triples are named in full."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .bootstrap import Quantity, at_least
from .truth import LEAST_GAP

if TYPE_CHECKING:
    from .answers import Answer
    from .truth import Truth

__all__ = ["causes"]


def _exact(truth: Truth, answer: Answer) -> bool:
    return set(answer.verdict) == set(truth.verdict)


def causes(pairs: list[tuple[Truth, Answer]]) -> list[Quantity]:
    """Return top-1 and top-3, each cause by itself, exact pairs and triples."""
    singles = [(t, a) for t, a in pairs if t.kind == "one" and t.counts]
    first = [(t.verdict[0], t.verdict[0] in a.ranking[:1]) for t, a in singles]
    quantities = [
        Quantity.of("right cause first", [right for _, right in first], aim=at_least(0.92)),
        Quantity.of("right cause among three", [t.verdict[0] in a.ranking[:3] for t, a in singles]),
        Quantity.of(
            "probability on the true cause",
            [a.of(t.verdict[0]) for t, a in singles],
            aim=at_least(0.88),
        ),
        Quantity.of("exact single", [_exact(t, a) for t, a in singles]),
    ]
    for kind, aim in (("pair", 0.65), ("triple", 0.35)):
        these = [(t, a) for t, a in pairs if t.kind == kind and t.counts]
        plain = [(t, a) for t, a in these if t.alone and min(t.alone.values()) > LEAST_GAP]
        quantities += [
            Quantity.of(f"exact {kind}", [_exact(t, a) for t, a in these]),
            Quantity.of(f"exact {kind}, each plain by itself", [_exact(t, a) for t, a in plain],
                        aim=at_least(aim)),
        ]  # fmt: skip
    for cause in sorted({name for name, _ in first}):
        right = [right for name, right in first if name == cause]
        quantities.append(Quantity.of(f"cause {cause}", right, aim=at_least(0.85)))
    return quantities
