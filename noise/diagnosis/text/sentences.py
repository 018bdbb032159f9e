"""A diagnosis in sentences: what the command prints and the report begins with.

Only what the data hold is said. A figure that was not determined is left out of a sentence, never
replaced by a cautious phrase that reads like a finding.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from noise.diagnosis.text.words import (
    NOT_DETERMINED,
    cause_of,
    chance,
    evidence,
    frequency,
    joined,
    p_number,
    percent,
)

if TYPE_CHECKING:
    from noise.diagnosis.outcome import Diagnosis, EffectFinding

__all__ = [
    "answer",
    "closed_sentence",
    "closed_words",
    "equivalence_sentences",
    "finding_of",
    "headline",
    "location_sentence",
    "parameter_name",
    "verdict_sentence",
]

_PHASES = {
    "stick": "while the contact sticks",
    "slip": "while the contact slips",
    "cycle": "in the stick-slip cycle as a whole",
}
_COLUMNS = {
    "speed_rad_s": ("speed", "rad/s"),
    "interference_mm": ("interference", "mm"),
    "support_stiffness_Nm_rad": ("support stiffness", "Nm/rad"),
    "temperature_C": ("temperature", "degree C"),
}
_COUNTS = {2: "two", 3: "three"}
_MOST_PARAMETERS = 3


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
    match diagnosis.verdict:
        case ():
            return "No gap"
        case ("parameters",):
            return "Parameters are off"
        case ("unknown",):
            return "Unknown cause"
    return f"Missing: {joined([cause_of(name).name for name in diagnosis.verdict])}"


def answer(diagnosis: Diagnosis) -> list[str]:
    """Return all sentences of the answer: verdict, location, what cannot be told apart.

    Before all, which channels are dead or clip; of recordings that cannot be of their rig, why not.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> answer(Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0))
    ['Recordings and simulation differ no more than repeats do: there is nothing to explain (gap
      0.9, floor 1, p = 0.60).']
    """
    found = [f"{text[0].upper()}{text[1:]}." for text in (*diagnosis.bench, *diagnosis.faults)]
    if diagnosis.bench:
        return [*found, "No cause is looked for before that is put right."]
    sentences = [*found, verdict_sentence(diagnosis), location_sentence(diagnosis)]
    return [*filter(None, sentences), *equivalence_sentences(diagnosis)]


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
        case ("parameters",):
            return _parameters(diagnosis)
        case ("unknown",):
            return (
                "Something makes the difference that is in no library of effects: its cause is "
                f"unknown{_bracketed(diagnosis, 'unknown')}."
            )
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


def location_sentence(diagnosis: Diagnosis) -> str:
    """Return where the simulation goes wrong first; empty where there is no gap."""
    place = diagnosis.location
    if place is None:
        return ""
    low, high = place.band
    parts = [f"The gap begins in the {place.stage}"]
    if place.channels:
        parts.append(f"in the channel{'s'[: len(place.channels) > 1]} {joined(place.channels)}")
    parts.append(
        f"below {frequency(high)}" if low <= 0 else f"{frequency(low)} to {frequency(high)}"
    )
    if place.phase != "all":
        parts.append(_PHASES.get(place.phase, f"in the phase {place.phase}"))
    everywhere = place.conditions == "all"
    parts.append("in all conditions" if everywhere else f"where {_conditions(place.conditions)}")
    return f"{', '.join(parts)}; {evidence(place.p_value)} ({p_number(place.p_value)})."


def closed_words(finding: EffectFinding | None, of: str = "", interval: str = "") -> str:
    """Return how much of the gap a fit with an effect closes, with the 90 % interval.

    Parameters
    ----------
    finding : EffectFinding or None
    of, interval : str
        What stands behind the share, and before the interval.

    Examples
    --------
    >>> from noise.diagnosis.outcome import EffectFinding
    >>> closed_words(EffectFinding("mains_hum", "measurement", 0.9, closed=0.96, closed_low=0.91,
    ...                            closed_high=0.99))
    '96 % (91 % to 99 %)'
    """
    if finding is None or finding.closed is None:
        return NOT_DETERMINED
    words = f"{percent(finding.closed)}{of}"
    if finding.closed_low is None or finding.closed_high is None:
        return words
    return f"{words} ({interval}{percent(finding.closed_low)} to {percent(finding.closed_high)})"


def closed_sentence(finding: EffectFinding) -> str:
    """Return how far a fit with an effect closes the gap; empty where that is not determined.

    Examples
    --------
    >>> from noise.diagnosis.outcome import EffectFinding
    >>> closed_sentence(EffectFinding("mains_hum", "measurement", 0.9, closed=0.96, closed_low=0.91,
    ...                               closed_high=0.99))
    'The fit closes 96 % of the closable gap (90 % interval 91 % to 99 %).'
    """
    if finding.closed is None:
        return ""
    words = closed_words(finding, " of the closable gap", "90 % interval ")
    if finding.closed_by_effect is not None:
        words += f", and {percent(finding.closed_by_effect)} of what refitted parameters leave"
    return f"The fit closes {words}."


def equivalence_sentences(diagnosis: Diagnosis) -> list[str]:
    """Return one sentence for each pair of effects that the channels cannot tell apart."""
    return [
        f"These channels cannot tell {cause_of(one).name} from {cause_of(other).name}."
        for one, other in diagnosis.equivalent
    ]


def finding_of(diagnosis: Diagnosis, name: str) -> EffectFinding | None:
    """Return what was found about an effect, None where nothing was."""
    return next((effect for effect in diagnosis.effects if effect.name == name), None)


def parameter_name(name: str) -> str:
    """Return a parameter's name in words.

    Examples
    --------
    >>> parameter_name("elastomer_stiffness")
    'elastomer stiffness'
    """
    return name.replace("_", " ")


def _no_gap(diagnosis: Diagnosis) -> str:
    agreed = "Recordings and simulation differ no more than repeats do: there is nothing to explain"
    known = []
    if math.isfinite(diagnosis.gap) and math.isfinite(diagnosis.floor):
        known.append(f"gap {diagnosis.gap:.2g}, floor {diagnosis.floor:.2g}")
    if math.isfinite(diagnosis.p_value):
        known.append(p_number(diagnosis.p_value))
    return f"{agreed} ({', '.join(known)})." if known else f"{agreed}."


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


def _conditions(limits: str) -> str:
    """Replace names of columns by words, with the unit behind the number."""
    for column, (name, unit) in _COLUMNS.items():
        limits = re.sub(rf"\b{column} *([<>=]+) *([\w.+-]+)", rf"{name} \1 \2 {unit}", limits)
    return limits.replace(">=", "\N{GREATER-THAN OR EQUAL TO}").replace(
        "<=", "\N{LESS-THAN OR EQUAL TO}"
    )


def _likely(diagnosis: Diagnosis, name: str) -> str:
    known = diagnosis.probabilities.get(name)
    if known is None:
        finding = finding_of(diagnosis, name)
        known = None if finding is None else finding.probability
    return "" if known is None or not 0.0 <= known <= 1.0 else chance(known)


def _bracketed(diagnosis: Diagnosis, name: str) -> str:
    likely = _likely(diagnosis, name)
    return f" ({likely})" if likely else ""
