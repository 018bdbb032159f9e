"""Display of a diagnosis: the answer in sentences, the stages, and how probable each cause is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.drawing import BLUE, GREY, axes_or_new
from noise.diagnosis.text.verdict_sentences import headline
from noise.diagnosis.text.words import cause_of, percent

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from noise.diagnosis.outcome import Diagnosis

_SHOWN = 10
"""Causes that are drawn and listed, the most probable; assumed."""


def draw_causes(diagnosis: Diagnosis, ax: Axes | None = None) -> Axes:
    """Draw how probable each cause is, those of the verdict in blue, the most probable on top.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> [tick.get_text() for tick in draw_causes(nothing, Figure().subplots()).get_yticklabels()]
    ['no gap']
    """
    causes = sorted(diagnosis.probabilities.items(), key=lambda item: -item[1])[:_SHOWN]
    named = diagnosis.verdict or ("none",)
    with axes_or_new(ax) as axes:
        axes.barh(
            [cause_of(name).name for name, _ in causes],
            [100.0 * probability for _, probability in causes],
            color=[BLUE if name in named else GREY for name, _ in causes],
        )
        for row, (_, probability) in enumerate(causes):
            axes.text(100.0 * probability + 1.0, row, percent(probability), va="center")
        axes.set_ylim(len(causes) - 0.5, -0.5)
        axes.set_xlim(0.0, 112.0)
        axes.set_xticks(range(0, 101, 20))
        axes.set_xlabel("Probability of being at work [%]")
        axes.set_title(headline(diagnosis), loc="left")
    return axes
