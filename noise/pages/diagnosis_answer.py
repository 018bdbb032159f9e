"""The answer of a diagnosis as its page shows it: stages, causes, parameters, places, waterfall.

All is in words and shares of a width, ready for the template. Here is decided what a reader sees
first and what waits in the details; the template only lays it out. All figures of the waterfall
come from one fit and the same held-out recordings, because steps of different recordings do not add
up.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from noise.diagnosis.findings import SURE, Agreement, EffectFinding, HypothesisFinding, Location
from noise.diagnosis.fit.closing import CLOSABLE
from noise.diagnosis.gap.distance import closed_fraction
from noise.diagnosis.gap.signature import KINDS
from noise.diagnosis.text.found import begins, finding_of, parameter_name, stage_of_effect
from noise.diagnosis.text.sentences import closed_sentence, closed_words
from noise.diagnosis.text.verdict_sentences import is_named
from noise.diagnosis.text.words import (
    NOT_DETERMINED,
    STAGES,
    cause_of,
    evidence,
    floors,
    joined,
    number,
    p_number,
    percent,
)
from noise.pages.cards import round_ticks
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from noise.diagnosis.outcome import Diagnosis


_PASSED_ON = {
    "drive": "speed",
    "friction": "torque",
    "structure": "acceleration",
    "radiation": "pressure",
}
_MOST_PLACES = 12
_LIKELY_ENOUGH = 0.05
_FEWEST, _MOST = 3, 6
_BESIDE_EFFECTS = ("none", "parameters", "unknown")
_LEAST_REACH = 0.05  # of the axis of relative parameters, to either side of 1


@dataclass(frozen=True)
class StageBox:
    """A stage of the chain as it is drawn.

    Parameters
    ----------
    name, what : str
    gap, p_value, words : str
        `words` says what the p-value means; empty where it was not determined.
    share : str
        Of the whole gap.
    guilty : bool
        Whether the gap begins here, as far as that is sure.
    differs : bool
        Whether the p-value is 0.05 or below.
    causes : tuple of str
        Effects of the verdict that act here.
    passes_on : str
        What the next stage receives; empty at the last.
    """

    name: str
    what: str
    gap: str
    p_value: str
    words: str
    share: str
    guilty: bool
    differs: bool
    causes: tuple[str, ...]
    passes_on: str

    @property
    def height(self) -> int:
        """Of its box in a column [px]: two lines, and one for each remark."""
        remarks = self.guilty + len(self.causes)
        return 56 + 20 * remarks + (4 if remarks else 0)


@dataclass(frozen=True)
class CauseRow:
    """A candidate cause: in words, how likely, how far it closes the gap, how strong it is."""

    name: str
    clause: str
    stage: str
    probability: float
    chance: str
    named: bool
    closed: str
    by_effect: str
    strength: str
    fitted: bool
    gaps: tuple[str, str, str, str]
    parameters: tuple[str, ...]


@dataclass(frozen=True)
class ParameterRow:
    """A refitted parameter: its interval in words, and where it lies on a common axis [%]."""

    name: str
    interval: str
    words: str
    start: float
    width: float
    one: float
    off: bool


def stage_boxes(diagnosis: Diagnosis) -> tuple[StageBox, ...]:
    """Return the chain from drive to measurement.

    Examples
    --------
    >>> from noise.diagnosis.findings import StageFinding
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> found = {"drive": StageFinding(1.04, 0.02, 0.4)}
    >>> boxes = stage_boxes(Diagnosis((), (), None, found, (), {}, {}, "", (), 1.0, 1.0, 0.6, 1.0))
    >>> [(box.name, box.gap) for box in boxes][:2]
    [('drive', '1.04'), ('friction', 'not determined')]
    """
    boxes, place = [], diagnosis.location
    named = diagnosis.verdict if is_named(diagnosis) else ()
    acting = {name: stage_of_effect(diagnosis, name) for name in named}
    for name, what in STAGES.items():
        finding = diagnosis.stages.get(name)
        if finding is not None and finding.gap == 0.0:  # nothing of it was recorded
            finding = None
        p_value = math.nan if finding is None else finding.p_value
        boxes.append(
            StageBox(
                name=name,
                what=what,
                gap=floors(None if finding is None else finding.gap, ".2f"),
                p_value=p_number(p_value) if math.isfinite(p_value) else "",
                words=evidence(p_value) if math.isfinite(p_value) else "",
                share=percent(None if finding is None else finding.share),
                guilty=begins(diagnosis) and place is not None and place.stage == name,
                differs=p_value <= SURE,
                causes=tuple(cause_of(c).name for c, stage in acting.items() if stage == name),
                passes_on=_PASSED_ON.get(name, ""),
            )
        )
    return tuple(boxes)


def cause_rows(diagnosis: Diagnosis) -> tuple[tuple[CauseRow, ...], tuple[CauseRow, ...]]:
    """Return the causes that are worth a look, and all others, the most probable first.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> chances = {"none": 0.9, "parameters": 0.06, "mains_hum": 0.02, "clipping": 0.01}
    >>> likely, others = cause_rows(
    ...     Diagnosis((), (), None, {}, (), chances, {}, "", (), 1.0, 1.0, 0.6, 1.0))
    >>> [row.name for row in likely], [row.name for row in others]
    (['no gap', 'parameters', 'mains hum'], ['clipping'])
    """
    chances: dict[str, float] = dict(diagnosis.probabilities)
    for effect in diagnosis.effects:
        chances.setdefault(effect.name, effect.probability)
    verdict = diagnosis.verdict
    order = sorted(chances, key=lambda name: (name not in verdict, -chances[name]))
    rows = [_cause_row(diagnosis, name, chances[name]) for name in order]
    n = sum(row.probability >= _LIKELY_ENOUGH or row.named for row in rows)
    n = min(max(n, _FEWEST), max(_MOST, len(verdict)))
    return tuple(rows[:n]), tuple(rows[n:])


def agreement_rows(agreement: Sequence[Agreement]) -> tuple[tuple[str, ...], ...]:
    """Return how far each recording is off: name, speed, interference, whole gap, each channel's.

    Examples
    --------
    >>> from noise.diagnosis.findings import Agreement
    >>> agreement_rows([Agreement("run01.wav", 2.5, 2.79e-4, 1.2, {"torque": 0.9})])
    (('run01.wav', '2.5', '0.279', '1.2', '0.9', 'not recorded', 'not recorded'),)
    """
    return tuple(
        (
            one.recording, f"{one.speed:g}", f"{1e3 * one.interference:.3g}", floors(one.gap),
            *(floors(one.channels[k]) if k in one.channels else "not recorded" for k in KINDS),
        )
        for one in agreement
    )  # fmt: skip


def hypothesis_rows(hypotheses: Sequence[HypothesisFinding]) -> tuple[tuple[str, ...], ...]:
    """Return hypotheses: causes in words, probability, gap that is left with them.

    Examples
    --------
    >>> from noise.diagnosis.findings import HypothesisFinding
    >>> hypothesis_rows([HypothesisFinding(("clipping", "mains_hum"), 0.42, 1.2)])
    (('clipping and mains hum', '42 %', '1.2'),)
    """
    return tuple(
        (
            joined([cause_of(name).name for name in one.causes or ("none",)]),
            percent(one.probability),
            "not fitted" if one.gap is None else floors(one.gap),
        )
        for one in hypotheses
    )


def parameter_rows(intervals: Mapping[str, tuple[float, float]]) -> tuple[ParameterRow, ...]:
    """Return refitted parameters on a common axis about 1.

    Examples
    --------
    >>> (row,) = parameter_rows({"kinetic_torque": (1.02, 1.1)})
    >>> row.words, row.off, row.one, round(row.start), round(row.width)
    ('differs', True, 50.0, 59, 36)
    """
    ends = [abs(end - 1.0) for interval in intervals.values() for end in interval]
    reach = 1.1 * max([_LEAST_REACH, *ends])
    rows = []
    for name, (low, high) in intervals.items():
        off = low > 1.0 or high < 1.0
        rows.append(
            ParameterRow(
                name=parameter_name(name),
                interval=f"{low:.3f} to {high:.3f}",
                words="differs" if off else "agrees with the rig file",
                start=50.0 * (1.0 + (low - 1.0) / reach),
                width=50.0 * (high - low) / reach,
                one=50.0,
                off=off,
            )
        )
    return tuple(rows)


def place_rows(places: Sequence[Location]) -> tuple[tuple[str, ...], ...]:
    """Return the places that differ most surely: stage, channel, where in it, conditions, p-value.

    Examples
    --------
    >>> from noise.diagnosis.findings import Location
    >>> place_rows([Location("friction", ("torque",), (0.0, 1800.0), "stick", "all", 0.004)])
    (('friction', 'torque', 'stick', 'all', 'p = 0.0040'),)
    """
    return tuple(
        (
            place.stage,
            ", ".join(place.channels),
            place.phase if place.phase != "all" else f"{place.band[0]:g} to {place.band[1]:g} Hz",
            place.conditions.replace("speed_rad_s", "speed [rad/s]"),
            p_number(place.p_value),
        )
        for place in places[:_MOST_PLACES]
    )


def _cause_row(diagnosis: Diagnosis, name: str, probability: float) -> CauseRow:
    finding, cause = finding_of(diagnosis, name), cause_of(name)
    gaps = (None,) * 4 if finding is None else (
        finding.gap_before, finding.gap_recalibrated, finding.gap_after, finding.gap_floor,
    )  # fmt: skip
    beside, fitted = name in _BESIDE_EFFECTS, any(gap is not None for gap in gaps)
    return CauseRow(
        name=cause.name,
        clause=cause.clause,
        stage="" if beside else stage_of_effect(diagnosis, name),
        probability=probability,
        chance=percent(probability),
        named=name in (diagnosis.verdict or ("none",)) and is_named(diagnosis),
        closed="" if beside else closed_words(finding) if fitted else "not fitted",
        by_effect=percent(None if finding is None else finding.closed_by_effect),
        strength="" if beside or finding is None or not fitted else _strength(finding),
        fitted=fitted,
        gaps=(number(gaps[0]), number(gaps[1]), number(gaps[2]), number(gaps[3])),
        parameters=() if finding is None else _fitted(finding),
    )


def _strength(finding: EffectFinding) -> str:
    if finding.strength is None:
        return NOT_DETERMINED
    low, high = (number(end, ".3g") for end in finding.strength)
    if finding.name not in EFFECTS:
        return f"{low} to {high}"
    effect = EFFECTS[finding.name]
    if not _known_form(finding):
        of = "of a gross one" if "strength" in finding.parameters else "of what was estimated"
        return f"{low} to {high} {of}"
    unit = effect.parameters[effect.strength].unit
    return f"{parameter_name(effect.strength)} {low} to {high} {unit}".strip()


def _known_form(finding: EffectFinding) -> bool:
    """Tell whether a fit has a form of the simulator's own, whose numbers have its units."""
    if finding.name not in EFFECTS:
        return False
    return (
        finding.parameters.get("form", EFFECTS[finding.name].forms[0])
        in EFFECTS[finding.name].forms
    )


def _fitted(finding: EffectFinding) -> tuple[str, ...]:
    known = EFFECTS[finding.name].parameters if _known_form(finding) else {}
    words = []
    for name, value in finding.parameters.items():
        text = value if isinstance(value, str) else number(value, ".3g")
        unit = known[name].unit if name in known else ""
        words.append(f"{parameter_name(name)} {text} {unit}".strip())
    return tuple(words)


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
    fitted = _shown_fit(diagnosis)
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


def _shown_fit(diagnosis: Diagnosis) -> EffectFinding | None:
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
