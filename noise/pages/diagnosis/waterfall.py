"""The gap as a waterfall: nominal model, parameters refitted, effect put in, what is left.

All its figures come from one fit and the same held-out recordings, because steps of different
recordings do not add up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from noise.diagnosis.fit.closing import CLOSABLE
from noise.diagnosis.gap.distance import closed_fraction
from noise.diagnosis.text.found import finding_of
from noise.diagnosis.text.sentences import closed_sentence
from noise.diagnosis.text.words import cause_of, joined, percent
from noise.pages.engine.ticks import round_ticks

if TYPE_CHECKING:
    from noise.diagnosis.findings import EffectFinding
    from noise.diagnosis.outcome import Diagnosis

__all__ = ["Bar", "Waterfall", "waterfall"]

_TICKS = 6
_SAME = 1e-9


@dataclass(frozen=True)
class Bar:
    """One bar, between two gaps.

    Parameters
    ----------
    label : str
    low, high : float
        Ends of the bar, in floors.
    kind : str
        ``whole``, ``closed``, ``opened`` or ``left``.
    words : str
        Its figure.
    """

    label: str
    low: float
    high: float
    kind: str
    words: str


@dataclass(frozen=True)
class Waterfall:
    """Bars from the nominal gap to what is left of it.

    Parameters
    ----------
    bars : tuple of Bar
    floor : float
        What repeats differ by, a gap [-].
    top : float
        End of the axis, a gap [-].
    ticks : tuple of float
        Gaps along it [-].
    words : str
        How much is closed, with its interval.
    """

    bars: tuple[Bar, ...]
    floor: float
    top: float
    ticks: tuple[float, ...]
    words: str


def waterfall(diagnosis: Diagnosis) -> Waterfall | None:
    """Return the bars of a diagnosis; None where there is no gap, or none was determined.

    Examples
    --------
    >>> from noise.diagnosis.findings import EffectFinding
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> hum = EffectFinding("mains_hum", "measurement", 0.9, gap_before=7.7, gap_recalibrated=4.1,
    ...                     gap_after=1.3, gap_floor=1.0, closed=0.955)
    >>> found = waterfall(Diagnosis(("mains_hum",), (), None, {}, (hum,), {}, {}, "", (), 7.7, 1.0,
    ...                             0.0, 1.0))
    >>> [(bar.label, bar.low, bar.high) for bar in found.bars if bar.kind == "closed"]
    [('refitted parameters', 4.1, 7.7), ('with mains hum', 1.3, 4.1)]
    """
    if not diagnosis.verdict:
        return None
    fitted = _fitted(diagnosis)
    before = diagnosis.gap if fitted is None else _known(fitted.gap_before, diagnosis.gap)
    floor = diagnosis.floor if fitted is None else _known(fitted.gap_floor, diagnosis.floor)
    if not (math.isfinite(before) and math.isfinite(floor)):
        return None
    bars = [Bar("nominal model", 0.0, before, "whole", f"{before:.2f}")]
    gap, closed = before, None
    if fitted is not None and fitted.gap_recalibrated is not None:
        bars.append(_step("refitted parameters", gap, fitted.gap_recalibrated))
        gap = fitted.gap_recalibrated
    if (
        fitted is not None and fitted.gap_after is not None
        and diagnosis.verdict != ("parameters",)
    ):  # fmt: skip
        bars.append(_step(_effect_label(diagnosis, fitted), gap, fitted.gap_after))
        gap, closed = fitted.gap_after, closed_sentence(fitted)
        if diagnosis.verdict == ("unknown",):
            tried = joined([cause_of(name).name for name in (fitted.name, *fitted.fitted_with)])
            best = f"The best fit that was tried, with {tried}, closes"
            closed = closed.replace("The fit closes", best, 1)
    if len(bars) > 1:
        bars.append(Bar("what is left", 0.0, gap, "left", f"{gap:.2f}"))
    top = 1.04 * max(floor, *(bar.high for bar in bars))
    words = closed if closed is not None else _closed_so_far(before, gap, floor, len(bars) > 1)
    ticks = tuple(round_ticks(0.0, top, _TICKS))
    undetermined = "How much of the gap can be closed was not determined."
    if before - floor < CLOSABLE:
        undetermined = "On these recordings the gap is hardly larger than the floor."
    return Waterfall(tuple(bars), floor, top, ticks, words or undetermined)


def _fitted(diagnosis: Diagnosis) -> EffectFinding | None:
    """Return the fit to show: of the verdict's effects, else of any, the one that closes most."""
    named = [finding_of(diagnosis, name) for name in diagnosis.verdict]
    among = [finding for finding in named if finding is not None]
    if diagnosis.verdict in {("parameters",), ("unknown",)}:
        among = list(diagnosis.effects)
    known = [finding for finding in among if finding.gap_recalibrated is not None]
    after = [finding for finding in among if finding.gap_after is not None]
    if after:
        return min(after, key=lambda finding: finding.gap_after or 0.0)
    return known[0] if known else None


def _effect_label(diagnosis: Diagnosis, fitted: EffectFinding) -> str:
    if diagnosis.verdict == ("unknown",):
        return "best fit tried"
    together = [
        name
        for name in diagnosis.verdict
        if (finding := finding_of(diagnosis, name)) is not None
        and finding.gap_after is not None
        and abs(finding.gap_after - (fitted.gap_after or 0.0)) < _SAME
    ]
    if 1 < len(together) == len(diagnosis.verdict):
        return "with both effects" if len(together) == 2 else "with all effects"
    return f"with {joined([cause_of(name).name for name in together])}"


def _step(label: str, before: float, after: float) -> Bar:
    change = f"{after - before:+.2f}".replace("-", "\N{MINUS SIGN}")
    kind = "closed" if after <= before else "opened"
    return Bar(label, min(before, after), max(before, after), kind, f"{change}, to {after:.2f}")


def _closed_so_far(before: float, gap: float, floor: float, fitted: bool) -> str:
    if before <= floor:
        return "The nominal gap is no larger than the floor, so there is nothing to close."
    if not fitted:
        return ""
    share = percent(closed_fraction(before, gap, floor))
    return f"Refitted parameters close {share} of the closable gap."


def _known(value: float | None, otherwise: float) -> float:
    return otherwise if value is None else value
