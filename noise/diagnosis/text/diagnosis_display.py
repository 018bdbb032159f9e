"""Display of a diagnosis: the answer in sentences, the stages, and how probable each cause is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.drawing import BLUE, GREY, axes_or_new
from models.html_table import html_table
from noise.diagnosis.text.sentences import location_sentence
from noise.diagnosis.text.verdict_sentences import headline, verdict_sentence
from noise.diagnosis.text.words import STAGES, cause_of, floors, p_number, percent

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from noise.diagnosis.outcome import Diagnosis

__all__ = ["diagnosis_html", "draw_causes"]

_SHOWN = 10
"""Causes that are drawn and listed, the most probable; assumed."""


def diagnosis_html(diagnosis: Diagnosis) -> str:
    """Return a diagnosis as two tables: the answer, and the stages.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> "No gap" in diagnosis_html(nothing)
    True
    """
    likely = ", ".join(
        f"{cause_of(name).name} {percent(chance)}" for name, chance in _most_probable(diagnosis)
    )
    facts = [
        ["verdict", verdict_sentence(diagnosis)],
        ["where", location_sentence(diagnosis)],
        ["gap", f"{floors(diagnosis.gap)} floors; "
                f"{p_number(diagnosis.p_value)}"],
        ["causes", likely],
        ["to measure next", diagnosis.next_measurement],
        *(["note", note] for note in diagnosis.notes),
    ]  # fmt: skip
    stages = [
        [f"{name} ({STAGES[name]})" if name in STAGES else name, floors(stage.gap),
         percent(stage.share), p_number(stage.p_value)]
        for name, stage in diagnosis.stages.items()
    ]  # fmt: skip
    answer = html_table(headline(diagnosis), [row for row in facts if row[1]])
    if not stages or diagnosis.bench:
        return answer
    header = ["stage", "gap", "share of the gap", "chance between repeats"]
    return answer + html_table("Gap by stage", stages, header=header)


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
    causes = _most_probable(diagnosis)
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


def _most_probable(diagnosis: Diagnosis) -> list[tuple[str, float]]:
    return sorted(diagnosis.probabilities.items(), key=lambda item: -item[1])[:_SHOWN]
