"""The confusion matrix as a picture: what was the matter, by row, and what was said of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .truth import SPECIAL

if TYPE_CHECKING:
    from pathlib import Path

    from .answers import Answer
    from .truth import Truth

__all__ = ["confusion", "draw_confusion"]


def confusion(pairs: list[tuple[Truth, Answer]]) -> tuple[list[str], np.ndarray]:
    """Count cases of one name by name and by what came first in the verdict; failures last.

    Returns the names and an array of names by names + 1.
    """
    asked = [(t, a) for t, a in pairs if len(t.names) == 1 and (t.kind == "none" or t.counts)]
    seen = {t.names[0] for t, _ in asked} | {_first(a) for _, a in asked if not a.failed}
    names = [n for n in SPECIAL if n in seen] + sorted(seen - set(SPECIAL))
    counts = np.zeros((len(names), len(names) + 1), dtype=int)
    for t, a in asked:
        column = -1 if a.failed else names.index(_first(a))
        counts[names.index(t.names[0]), column] += 1
    return names, counts


def _first(answer: Answer) -> str:
    """The most probable name of the verdict."""
    return max(answer.names, key=answer.of, default="none")


def draw_confusion(pairs: list[tuple[Truth, Answer]], path: Path) -> None:
    """Write the picture (PNG): shares of a row as shades, counts as numbers; none without cases."""
    from matplotlib.figure import Figure

    names, counts = confusion(pairs)
    if not names:
        return
    shares = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)
    size = 2.5 + 0.36 * len(names)
    figure = Figure(figsize=(size + 1.0, size), layout="constrained")
    axes = figure.subplots()
    axes.imshow(shares, cmap="Blues", vmin=0.0, vmax=1.0)
    for i, j in zip(*np.nonzero(counts), strict=True):
        dark = "white" if shares[i, j] > 0.5 else "black"
        axes.text(j, i, counts[i, j], ha="center", va="center", fontsize=7, color=dark)
    titles = [name.replace("_", " ") for name in names]
    axes.set_xticks(range(len(names) + 1), [*titles, "failed"], rotation=90, fontsize=8)
    axes.set_yticks(range(len(names)), titles, fontsize=8)
    axes.set(xlabel="said", ylabel="true")
    figure.savefig(path, dpi=150)
