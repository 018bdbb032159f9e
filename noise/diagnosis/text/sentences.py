"""A diagnosis in sentences: what the command prints and the report begins with.

Only what the data hold is said. A figure that was not determined is left out of a sentence, never
replaced by a cautious phrase that reads like a finding.
"""

from __future__ import annotations

import re

from noise.diagnosis.outcome import SHOWN_IN, SURE, Diagnosis, EffectFinding
from noise.diagnosis.text.verdict_sentences import (
    agreement_sentence,
    far_ones,
    remainder_sentence,
    verdict_sentence,
)
from noise.diagnosis.text.words import (
    NOT_DETERMINED,
    PHASES,
    begins,
    cause_of,
    evidence,
    floors,
    frequency,
    joined,
    p_number,
    percent,
    stages_acting,
)

_COLUMNS = {
    "speed_rad_s": ("speed", "rad/s"),
    "interference_mm": ("interference", "mm"),
    "support_stiffness_Nm_rad": ("support stiffness", "Nm/rad"),
    "temperature_C": ("temperature", "degree C"),
}


_NOTHING = 0.005
"""Share up to which a fit closes nothing [-]: it would be rounded to 0 %."""


def answer(diagnosis: Diagnosis) -> list[str]:
    """Return all sentences of the answer.

    Whether the rig file describes the rig, the verdict, where, what is left, what cannot be told
    apart.

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
    sentences = [
        *found,
        agreement_sentence(diagnosis),
        verdict_sentence(diagnosis),
        location_sentence(diagnosis),
        remainder_sentence(diagnosis),
        *equivalence_sentences(diagnosis),
        _unfitted(diagnosis),
    ]
    return [*filter(None, sentences)]


def location_sentence(diagnosis: Diagnosis) -> str:
    """Return where the simulation goes wrong first; empty where there is no gap."""
    place = diagnosis.location
    if place is None:
        return ""
    low, high = place.band
    sure = not place.p_value > SURE
    start = "The gap begins" if begins(diagnosis) else "It shows" if sure else "It shows most"
    parts = [f"{start} in the {place.stage}"]
    if sure and not begins(diagnosis):
        parts[0] += f", as what acts in the {joined(stages_acting(diagnosis))} can"
    if place.channels:
        parts.append(f"in the channel{'s'[: len(place.channels) > 1]} {joined(place.channels)}")
    parts.append(
        f"below {frequency(high)}" if low <= 0 else f"{frequency(low)} to {frequency(high)}"
    )
    if place.phase != "all":
        parts.append(PHASES.get(place.phase, f"in the phase {place.phase}"))
    if place.conditions != "all":
        parts.append(f"where {_conditions(place.conditions)}")
    elif len(far_ones(diagnosis)) == len(diagnosis.agreement):  # else it shows at some of them
        parts.append("in all conditions")
    though = "" if sure else "though there alone "
    said = f"{', '.join(parts)}; {though}{evidence(place.p_value)} ({p_number(place.p_value)})."
    return f"{said} {_surer(diagnosis)}".strip()


def _explained(diagnosis: Diagnosis) -> bool:
    """Whether fits of what is named leave no more than repeats differ by."""
    fitted = {one.name for one in diagnosis.effects if one.closed is not None}
    return diagnosis.remainder is None and bool(fitted) and fitted >= set(diagnosis.verdict)


def _surer(diagnosis: Diagnosis) -> str:
    """Say which stage differs surely where that of the named effects does not."""
    place, acting = diagnosis.location, stages_acting(diagnosis)
    if place is None or place.stage not in acting or place.p_value <= SURE:
        return ""
    others = {
        stage: found.p_value
        for stage, found in diagnosis.stages.items()
        if stage != place.stage and found.p_value <= SURE
    }
    if not others:
        return ""
    shown = SHOWN_IN.get(place.stage, ())
    surest = min(others, key=lambda stage: (stage not in shown, others[stage]))
    said = f"What differs surely is the {surest} ({p_number(others[surest])})"
    if surest in shown:
        return f"{said}, as it can where something acts in the {place.stage}."
    if surest in acting:
        return f"{said}."
    if _explained(diagnosis):
        return f"{said}, which the fit explains as well."
    return f"{said}, in which nothing acts that is named: something else may be missing there too."


def closed_words(finding: EffectFinding | None, of: str = "", interval: str = "") -> str:
    """Return how much of the gap a fit with an effect closes, with the 90 % interval.

    Share and interval end at all of it: what is beyond says only that the floor is unsure as well.

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
    if finding.closed <= _NOTHING:
        return f"nothing{of}"
    words = f"{percent(min(finding.closed, 1.0))}{of}"
    if finding.closed_low is None or finding.closed_high is None:
        return words
    low, high = (percent(min(end, 1.0)) for end in (finding.closed_low, finding.closed_high))
    return f"{words} ({interval}{low} to {high})" if low != high else words


def closed_sentence(finding: EffectFinding) -> str:
    """Return how far a fit with an effect closes the gap; empty where that is not determined.

    Examples
    --------
    >>> from noise.diagnosis.outcome import EffectFinding
    >>> closed_sentence(EffectFinding("mains_hum", "measurement", 0.9, closed=0.96, closed_low=0.91,
    ...                               closed_high=0.99))
    'The fit explains 96 % of the deviation (90 % interval 91 % to 99 %).'
    >>> closed_sentence(EffectFinding("mains_hum", "measurement", 0.9, gap_before=1.9,
    ...                               gap_after=2.3, closed=-0.4))
    'The fit explains nothing of the deviation: held-out recordings deviate by 1.9 floors without
      it, by 2.3 with it.'
    """
    before, after = floors(finding.gap_before), floors(finding.gap_after)
    if finding.closed is None:
        if finding.gap_before is None or finding.gap_after is None:
            return ""
        return (
            "How much the fit explains is not known: held-out recordings hardly deviate without it "
            f"({before} floors; {after} with it)."
        )
    words = closed_words(finding, " of the deviation", "90 % interval ")
    if finding.closed <= _NOTHING:
        if finding.gap_before is not None and finding.gap_after is not None:
            words += (
                f": held-out recordings deviate by {before} floors without it, by {after} with it"
            )
    elif finding.closed_by_effect is not None:
        share = finding.closed_by_effect
        left = percent(min(share, 1.0)) if share > _NOTHING else "nothing"
        words += f", and {left} of what refitted parameters leave unexplained"
    return f"The fit explains {words}."


def equivalence_sentences(diagnosis: Diagnosis) -> list[str]:
    """Return one sentence for each pair of effects that the channels cannot tell apart."""
    return [
        f"These channels cannot tell {cause_of(one).name} from {cause_of(other).name}."
        for one, other in diagnosis.equivalent
    ]


def _unfitted(diagnosis: Diagnosis) -> str:
    if not diagnosis.verdict or diagnosis.held_out:
        return ""
    return "Nothing has been fitted, so it is not known whether an effect explains the deviation."


def _conditions(limits: str) -> str:
    """Replace names of columns by words, with the unit behind the number."""
    for column, (name, unit) in _COLUMNS.items():
        limits = re.sub(rf"\b{column} *([<>=]+) *([\w.+-]+)", rf"{name} \1 \2 {unit}", limits)
    return limits.replace(">=", "\N{GREATER-THAN OR EQUAL TO}").replace(
        "<=", "\N{LESS-THAN OR EQUAL TO}"
    )
