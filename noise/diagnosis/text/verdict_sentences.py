"""The verdict of a diagnosis in a few words and in a sentence.

A cause is the headline only where it is likely and the stage that it acts in differs; otherwise it
is said what differs, and what it may be.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from noise.diagnosis.findings import SHOWN_IN, SURE
from noise.diagnosis.text.agreement_sentences import AGREES
from noise.diagnosis.text.found import PHASES, finding_of, parameter_name, stage_of_effect
from noise.diagnosis.text.words import cause_of, chance, frequency, joined, p_number, percent

if TYPE_CHECKING:
    from noise.diagnosis.outcome import Diagnosis


_COUNTS = {2: "two", 3: "three"}
_MOST_PARAMETERS = 3
"""Parameters that are named in a sentence; assumed."""

_CANDIDATES = 3
"""Causes that are named where none is likely; assumed."""

_MAY_BE = {"unknown": "something unknown", "parameters": "parameters that are off"}

_LIKELY = 0.5
"""Probability from which on a cause is named first [-]: it is likelier than not."""

_MOSTLY = 0.5
"""Share of the gap from which on what is left is no second cause [-]; assumed."""

_NOT_AT_ALL = 0.5
"""p-value from which on a difference is none to speak of [-]; assumed."""


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
    """Tell whether a verdict is likely, and agrees with what is said of its stage.

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
    return min(chances) >= _LIKELY and not contradicted(diagnosis)


def contradicted(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Stages of a verdict's effects, where nothing that these show in differs at all."""
    stages = []
    for name in diagnosis.verdict:
        stage = stage_of_effect(diagnosis, name)
        found = [diagnosis.stages.get(among) for among in SHOWN_IN.get(stage, ())]
        seen = [one.p_value for one in found if one is not None and one.gap > 0.0]
        if seen and min(seen) >= _NOT_AT_ALL:
            stages.append(stage)
    return tuple(dict.fromkeys(stages))


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """Return the verdict as a sentence, with how likely it is.

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
            chances = _bracketed(diagnosis, name)
            return f"The simulation lacks {cause.name}: {cause.clause}{chances}."
    each = []
    for name in diagnosis.verdict:
        cause, likely = cause_of(name), _likely(diagnosis, name)
        each.append(f"{cause.name} ({cause.clause}{f'; {likely}' if likely else ''})")
    count = _COUNTS.get(len(each), str(len(each)))
    return f"The simulation lacks {count} effects: {joined(each)}."


def _in_stage(diagnosis: Diagnosis) -> str:
    """Name the stage that differs; empty where none surely does."""
    place = diagnosis.location
    return f" in {place.stage}" if place is not None and place.p_value <= SURE else ""


def differs(diagnosis: Diagnosis) -> bool:
    """Tell whether a gap is larger than that of repeats, whatever is said of causes.

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
    known = []
    if math.isfinite(diagnosis.gap) and math.isfinite(diagnosis.floor):
        known.append(f"gap {diagnosis.gap:.2g}, floor {diagnosis.floor:.2g}")
    if math.isfinite(diagnosis.p_value):
        known.append(p_number(diagnosis.p_value))
    said = f"{agreed} ({', '.join(known)})." if known else f"{agreed}."
    chances = diagnosis.probabilities
    if chances.get("none", 1.0) < _LIKELY:
        first = max((n for n in chances if n != "none"), key=lambda name: chances[name])
        said += (
            f" That is {percent(chances['none'])} likely only; if anything, it is "
            f"{cause_of(first).name} ({percent(chances[first])})."
        )
    return said


def _parameters(diagnosis: Diagnosis) -> str:
    start = (
        f"No effect is missing; values of the rig file are off{_bracketed(diagnosis, 'parameters')}"
    )
    off = {
        name: interval
        for name, interval in diagnosis.parameters.items()
        if interval[0] > 1.0 or interval[1] < 1.0
    }
    if not off:
        return f"{start}."
    furthest = sorted(off, key=lambda name: -abs(sum(off[name]) / 2.0 - 1.0))[:_MOST_PARAMETERS]
    said = [f"{parameter_name(name)} comes out {_departure(*off[name])}" for name in furthest]
    more = len(off) - len(furthest)
    if more:
        said.append(f"{more} more")
    return f"{start}: {joined(said)}."


def _departure(low: float, high: float) -> str:
    """Say how far an interval that excludes one lies from it, the nearer end first."""
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
    return f"{start}; {none}: the cause is unknown{_bracketed(diagnosis, 'unknown')}."


def _unlikely(diagnosis: Diagnosis) -> str:
    """Say what may be the cause where none is likely, or where its stage does not differ."""
    chances = {name: p for name, p in diagnosis.probabilities.items() if name != "none"}
    named = () if diagnosis.verdict == ("unknown",) else diagnosis.verdict
    ranked = sorted(chances, key=lambda name: (name not in named, -chances[name]))
    n = max(_CANDIDATES, len(diagnosis.verdict))
    listed = [f"{_MAY_BE.get(name) or cause_of(name).name} ({percent(chances[name])})"
              for name in ranked[:n]]  # fmt: skip
    said = f"Something differs{_in_stage(diagnosis)}; it may be {joined(listed, 'or')}"
    if stages := contradicted(diagnosis):
        does = "does" if len(stages) == 1 else "do"
        said += f", although {joined(stages)} {does} not differ beyond what repeats do"
    return f"{said}."


def _likely(diagnosis: Diagnosis, name: str) -> str:
    known = diagnosis.probabilities.get(name)
    if known is None:
        finding = finding_of(diagnosis, name)
        known = None if finding is None else finding.probability
    return "" if known is None or not 0.0 <= known <= 1.0 else chance(known)


def _bracketed(diagnosis: Diagnosis, name: str) -> str:
    likely = _likely(diagnosis, name)
    return f" ({likely})" if likely else ""
