"""Headline and verdict of a diagnosis.

A cause is named only if it is likely and the stage that it acts in differs. Otherwise the sentence
states what differs, and what it may be.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from statistics import NormalDist

from noise.base import SURE_90
from noise.diagnosis.outcome import SHOWN_IN, SURE, Agreement, Diagnosis
from noise.diagnosis.text.words import (
    PHASES,
    cause_of,
    chance,
    evidence,
    finding_of,
    frequency,
    gap_number,
    joined,
    p_number,
    parameter_name,
    percent,
    stage_of_effect,
)

AGREES = 2.0
"""Largest gap of a recording that agrees with the rig file [-]; assumed. Of 480 simulated repeats
of ten quiet development cases of the second rig (seed 3), each against the other eleven of its
condition, 5 % have a larger one; of 66 recordings without a cause (quiet, seed 4) 3 %."""

_MOST_PARAMETERS = 3
"""Most parameters that a sentence names; assumed."""

_CANDIDATES = 3
"""Number of causes in a sentence if none is likely; assumed."""

_MAY_BE = {"unknown": "something unknown", "parameters": "parameters that are off"}

_LIKELY = 0.5
"""Least probability of a cause that is named [-]: it is likelier than not."""

_MOSTLY = 0.5
"""Closed share of the gap above which no second cause is suspected [-]; assumed."""

NOT_AT_ALL = 0.5
"""p-value above which a stage does not differ at all [-]; assumed."""


def far_ones(diagnosis: Diagnosis) -> list[Agreement]:
    """Return the recordings that deviate more than repeat measurements do.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> far_ones(Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0))
    []
    """
    return [one for one in diagnosis.agreement if one.gap > AGREES]


def headline(diagnosis: Diagnosis) -> str:
    """Return the verdict in a few words.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> headline(Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0))
    'No gap'
    """
    if diagnosis.bench:
        return "Not this rig as it is described"
    if not diagnosis.verdict:
        return "No cause to name" if differs(diagnosis) else "No gap"
    if not is_named(diagnosis):
        return f"Something differs{_in_stage(diagnosis)}"
    if diagnosis.verdict == ("unknown",):
        return "Unknown cause"
    if diagnosis.verdict == ("parameters",):
        return "Parameters are off"
    names = [cause_of(name).name for name in diagnosis.verdict]
    finding = finding_of(diagnosis, diagnosis.verdict[0])
    if diagnosis.remainder is not None and finding is not None:
        closed = finding.closed_by_effect
        if closed is not None and closed < _MOSTLY:
            names.append("something else")
    return f"Missing: {joined(names)}"


def is_named(diagnosis: Diagnosis) -> bool:
    """Return whether a verdict is likely and agrees with the table of stages.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> is_named(Diagnosis(("clipping",), (), None, {}, (), {"clipping": 0.44}, {}, "", (), 4.0,
    ...                    1.0, 0.0, 1.0))
    False
    """
    if not diagnosis.verdict:
        return True
    chances = [diagnosis.probabilities.get(name, 1.0) for name in diagnosis.verdict]
    return min(chances) >= _LIKELY and not _contradicted(diagnosis)


def _contradicted(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return the stages of a verdict's effects in which nothing differs."""
    stages = []
    for name in diagnosis.verdict:
        stage = stage_of_effect(diagnosis, name)
        shown = [diagnosis.stages.get(among) for among in SHOWN_IN.get(stage, ())]
        p_values = [one.p_value for one in shown if one is not None and one.gap > 0.0]
        if p_values and min(p_values) >= NOT_AT_ALL:
            stages.append(stage)
    return tuple(dict.fromkeys(stages))


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """Return the verdict as a sentence, with its probability.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> verdict_sentence(Diagnosis(("clipping",), (), None, {}, (), {"clipping": 0.96}, {}, "",
    ...                            (), 4.0, 1.0, 0.0, 1.0))
    'The simulation lacks clipping: ... cuts off the peaks of a channel (very likely, 96 %).'
    """
    match diagnosis.verdict:
        case ():
            return _no_gap(diagnosis)
        case _ if not is_named(diagnosis):
            return _unlikely(diagnosis)
        case ("unknown",):
            return _unknown(diagnosis)
        case ("parameters",):
            return _parameters(diagnosis)
        case (name,):
            cause = cause_of(name)
            return f"The simulation lacks {cause.name}: {cause.clause}{_likely(diagnosis, name)}."
    each = [f"{cause_of(name).name}{_likely(diagnosis, name, cause_of(name).clause)}"
            for name in diagnosis.verdict]  # fmt: skip
    count = {2: "two", 3: "three"}.get(len(each), str(len(each)))
    return f"The simulation lacks {count} effects: {joined(each)}."


def _in_stage(diagnosis: Diagnosis) -> str:
    """Return the stage that differs; empty if none does significantly."""
    place = diagnosis.location
    return f" in {place.stage}" if place is not None and place.p_value <= SURE else ""


def differs(diagnosis: Diagnosis) -> bool:
    """Return whether the gap is larger than that of repeats, whatever the verdict.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> differs(Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 2.4, 1.0, 2e-4, 1.0))
    True
    """
    return diagnosis.p_value <= SURE or diagnosis.gap > AGREES


def _no_gap(diagnosis: Diagnosis) -> str:
    agreed = "Recordings and simulation differ no more than repeats do: there is nothing to explain"
    if differs(diagnosis):
        agreed = (
            "Recordings and simulation differ by more than simulated repeats do, but not as any "
            "cause would have it"
        )
    elif diagnosis.gap > diagnosis.floor and math.isfinite(diagnosis.p_value):
        agreed = (
            "Recordings and simulation differ a little more than repeats do on average, but "
            f"{evidence(diagnosis.p_value)}: nothing is to be explained"
        )
    elif far_ones(diagnosis):
        agreed = (
            "Single recordings deviate more than repeats do, which may be chance; taken together, "
            "they differ as repeats do: nothing is to be explained"
        )
    figures = []
    if math.isfinite(diagnosis.gap):
        figures.append(f"{gap_number(diagnosis.gap, '.2f')} times as much as repeats")
    if math.isfinite(diagnosis.p_value):
        figures.append(p_number(diagnosis.p_value))
    sentence = f"{agreed} ({', '.join(figures)})." if figures else f"{agreed}."
    chances = diagnosis.probabilities
    if chances.get("none", 1.0) < _LIKELY:
        first = max((n for n in chances if n != "none"), key=lambda name: chances[name])
        sentence += (
            f" That is {percent(chances['none'])} likely only; if anything, it is "
            f"{cause_of(first).name} ({percent(chances[first])})."
        )
    return sentence


def parameters_off(
    intervals: Mapping[str, tuple[float, float]],
) -> dict[str, tuple[float, float]]:
    """Return the refitted parameters that differ from the rig file.

    Each interval is widened so that all of them together hold at 90 % (Bonferroni).

    Parameters
    ----------
    intervals : mapping of str to (float, float)
        90 % interval of each parameter over that of the rig file [-].

    Examples
    --------
    >>> parameters_off({"damping": (1.02, 1.1)})
    {'damping': (1.02, 1.1)}
    >>> parameters_off({"damping": (0.95, 1.05), "elastomer_inertia": (0.87, 0.998)})
    {}
    """
    wider = NormalDist().inv_cdf(1.0 - 0.05 / max(1, len(intervals))) / SURE_90
    off = {}
    for name, (low, high) in intervals.items():
        if not 0.0 < low <= high < math.inf:
            continue
        middle, half = 0.5 * math.log(low * high), 0.5 * math.log(high / low)
        if abs(middle) > wider * half:
            off[name] = (low, high)
    return off


def _parameters(diagnosis: Diagnosis) -> str:
    start = (
        f"No effect is missing; values of the rig file are off{_likely(diagnosis, 'parameters')}"
    )
    off = parameters_off(diagnosis.parameters)
    if not off:
        return f"{start}."
    furthest = sorted(off, key=lambda name: -abs(sum(off[name]) / 2.0 - 1.0))[:_MOST_PARAMETERS]
    parts = [f"{parameter_name(name)} comes out {_departure(*off[name])}" for name in furthest]
    more = len(off) - len(furthest)
    if more:
        parts.append(f"{more} more")
    return f"{start}: {joined(parts)}."


def _departure(low: float, high: float) -> str:
    """Return how far an interval that excludes 1 lies from it, the nearer end first."""
    if low > 1.0:
        return f"{100 * (low - 1.0):.2g} to {100 * (high - 1.0):.2g} % higher"
    return f"{100 * (1.0 - high):.2g} to {100 * (1.0 - low):.2g} % lower"


def _unknown(diagnosis: Diagnosis) -> str:
    start = f"Something differs{_in_stage(diagnosis)}"
    place = diagnosis.location
    if place is not None and place.p_value <= SURE:
        low, high = place.band
        if low > 0.0:
            start += f" between {frequency(low)} and {frequency(high)}"
        if place.phase in PHASES:
            start += f" {PHASES[place.phase]}"
    closed = max((one.closed_by_effect or 0.0 for one in diagnosis.effects), default=0.0)
    none = "none of the known effects looks like it"
    if any(one.gap_after is not None for one in diagnosis.effects) and closed < _MOSTLY:
        none = "none of the known effects closes it"
    return f"{start}; {none}: the cause is unknown{_likely(diagnosis, 'unknown')}."


def _unlikely(diagnosis: Diagnosis) -> str:
    """Return possible causes if none is likely, or if its stage does not differ."""
    chances = {name: p for name, p in diagnosis.probabilities.items() if name != "none"}
    named = () if diagnosis.verdict == ("unknown",) else diagnosis.verdict
    ranked = sorted(chances, key=lambda name: (name not in named, -chances[name]))
    n = max(_CANDIDATES, len(diagnosis.verdict))
    listed = [f"{_MAY_BE.get(name) or cause_of(name).name} ({percent(chances[name])})"
              for name in ranked[:n]]  # fmt: skip
    sentence = f"Something differs{_in_stage(diagnosis)}; it may be {joined(listed, 'or')}"
    if stages := _contradicted(diagnosis):
        does = "does" if len(stages) == 1 else "do"
        sentence += f", although {joined(stages)} {does} not differ beyond what repeats do"
    return f"{sentence}."


def _likely(diagnosis: Diagnosis, name: str, clause: str = "") -> str:
    """Return a clause and the probability of a cause in brackets; empty if neither is known."""
    known = diagnosis.probabilities.get(name)
    if known is None:
        finding = finding_of(diagnosis, name)
        known = None if finding is None else finding.probability
    likely = "" if known is None or not 0.0 <= known <= 1.0 else chance(known)
    inside = "; ".join(filter(None, (clause, likely)))
    return f" ({inside})" if inside else ""
