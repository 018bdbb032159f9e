"""Sentences of a diagnosis for the terminal and the top of the report.

A sentence takes stage, channel and figure from one row of a table. Figures that were not determined
are left out.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

from noise.diagnosis.outcome import SHOWN_IN, SURE, Agreement, Diagnosis, EffectFinding, Location
from noise.diagnosis.text.verdict_sentences import (
    AGREES,
    NOT_AT_ALL,
    far_ones,
    verdict_sentence,
)
from noise.diagnosis.text.words import (
    NOT_DETERMINED,
    PHASES,
    begins,
    cause_of,
    evidence,
    frequency,
    gap_number,
    joined,
    number,
    p_number,
    parameter_name,
    percent,
    stages_acting,
)
from sim.effects import EFFECTS

_COLUMNS = {
    "speed_rad_s": ("speed", "rad/s"),
    "interference_mm": ("interference", "mm"),
    "support_stiffness_Nm_rad": ("support stiffness", "Nm/rad"),
    "temperature_C": ("temperature", "degree C"),
}

_NOTHING = 0.005
"""Share below which a fit closes nothing [-]: it would be rounded to 0 %."""

_MOST_NAMED = 4
"""Most recordings that a sentence names; assumed."""

_AS_REPEATS = "times as much as repeat measurements do"


def answer(diagnosis: Diagnosis) -> list[str]:
    """Return all sentences of the answer.

    In order: dead or clipping channels, agreement with the rig file, verdict, location, remainder,
    equivalent effects. Recordings that cannot be of the rig have the reasons alone.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> answer(Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0))
    ['Recordings and simulation differ no more than repeats do: there is nothing to explain (0.90
      times as much as repeats, p = 0.60).']
    """
    first = [f"{text[0].upper()}{text[1:]}." for text in (*diagnosis.bench, *diagnosis.faults)]
    if diagnosis.bench:
        return [*first, "No cause is looked for before that is put right."]
    sentences = [
        *first,
        agreement_sentence(diagnosis),
        verdict_sentence(diagnosis),
        location_sentence(diagnosis),
        remainder_sentence(diagnosis),
        *(
            f"These channels cannot tell {cause_of(one).name} from {cause_of(other).name}."
            for one, other in diagnosis.equivalent
        ),
        _unfitted(diagnosis),
    ]
    return [*filter(None, sentences)]


def agreement_sentence(diagnosis: Diagnosis) -> str:
    """Return whether the rig file describes the rig, and where it does not.

    Parameters
    ----------
    diagnosis : Diagnosis

    Returns
    -------
    str
        Empty if that was not determined.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from noise.diagnosis.outcome import Agreement
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> slow = Agreement("run01.wav", 1.0, 2.79e-4, 1.1, {"torque": 0.9, "pressure": 1.3})
    >>> fast = Agreement("run02.wav", 4.0, 2.79e-4, 6.1, {"torque": 8.0, "pressure": 1.2})
    >>> agreement_sentence(replace(nothing, agreement=(slow,)))
    'The rig file describes the rig: the recording deviates 1.1 times as much as repeat measurements
      do.'
    >>> agreement_sentence(replace(nothing, verdict=("unknown",), agreement=(slow, fast)))
    'The rig file describes the rig at 1 of 2 recordings, not above 1 rad/s: there it deviates
      up to 6.1 times as much as repeat measurements do, most in the torque (8.0 times). All
      recordings together deviate 0.9 times as much (p = 0.60).'
    """
    rows = diagnosis.agreement
    if not rows:
        return ""
    far, n = far_ones(diagnosis), len(rows)
    reach = _reach(one.gap for one in rows)
    deviate = f"{'the recording deviates' if n == 1 else f'its {n} recordings deviate'} {reach}"
    most = _channel_that_deviates_most(far)
    if not diagnosis.verdict and far:  # single recordings may deviate by chance
        roughly = " only roughly" if len(far) == n else ""
        worst = max(far, key=lambda one: one.gap)
        at_most = _channel_that_deviates_most([worst])
        return (
            f"The rig file describes the rig{roughly}: {deviate} {_AS_REPEATS}. {worst.recording} "
            f"deviates {gap_number(worst.gap)} times as much{at_most}; another recording of its "
            "condition shows whether that is chance."
        )
    together = ""
    if diagnosis.verdict and diagnosis.p_value <= 1.0:
        together = (
            f" All recordings together deviate {gap_number(diagnosis.gap)} times as much "
            f"({p_number(diagnosis.p_value)})."
        )
    if not far:
        closer = " but for a difference that shows only on a closer look"
        start = f"The rig file describes the rig{closer if diagnosis.verdict else ''}"
        return f"{start}: {deviate} {_AS_REPEATS}.{together}"
    if len(far) == n:
        start = "The rig file does not describe the rig"
        return f"{start}: {deviate} {_AS_REPEATS}{most}.{together}"
    return (
        f"The rig file describes the rig at {n - len(far)} of {n} recordings, not {_where(rows)}: "
        f"there it deviates up to {gap_number(max(one.gap for one in far))} {_AS_REPEATS}{most}."
        f"{together}"
    )


def _reach(gaps: Iterable[float]) -> str:
    known = [*gaps]
    least, most = gap_number(min(known)), gap_number(max(known))
    return most if least == most else f"{least} to {most}"


def _channel_that_deviates_most(rows: Sequence[Agreement]) -> str:
    """Return the channel in which recordings deviate most, and how much."""
    most: dict[str, float] = {}
    for row in rows:
        for name, gap in row.channels.items():
            most[name] = max(gap, most.get(name, 0.0))
    if not most:
        return ""
    name = max(most, key=lambda name: most[name])
    reach = _reach(row.channels[name] for row in rows if name in row.channels)
    return f", most in the {name} ({reach} times)"


def _where(rows: Sequence[Agreement]) -> str:
    """Return the conditions of the recordings that deviate, or their names."""
    for key, scale, unit in (("speed", 1.0, "rad/s"), ("interference", 1e3, "mm")):
        far, near = (
            [abs(scale * getattr(one, key)) for one in rows if (one.gap > AGREES) == away]
            for away in (True, False)
        )
        if min(far) > max(near):
            return f"above {max(near):.3g} {unit}"
        if max(far) < min(near):
            return f"below {min(near):.3g} {unit}"
    names = [one.recording for one in rows if one.gap > AGREES]
    if len(names) > _MOST_NAMED:
        return f"at {len(names)} others"
    return f"at {joined(names)}"


def location_sentence(diagnosis: Diagnosis) -> str:
    """Return where the gap lies; empty without a gap.

    Parameters
    ----------
    diagnosis : Diagnosis

    Returns
    -------
    str
        First the stage that differs significantly, then the one that a named effect acts in, then
        others with more of the gap than one of these.
    """
    place, acting = diagnosis.location, stages_acting(diagnosis)
    if place is None:
        return ""
    row, likeness = _row_words(diagnosis, place.stage), evidence(place.p_value)
    where = _place_words(diagnosis, place)
    other = _other_stage(diagnosis, place)
    beside = _other_words(diagnosis, place, other) if other else []
    further = _further_words(diagnosis, [place.stage, *filter(None, [other])])
    if place.p_value <= SURE:
        start = "The gap begins in the"
        if not begins(diagnosis):
            start = f"As what acts in the {joined(acting)} can, the gap shows in the"
        first = f"{start} {place.stage} ({row}): {where}; {likeness}."
        return " ".join([first, *beside, *further])
    if other and place.stage in acting:
        names = joined([cause_of(name).name for name in diagnosis.verdict])
        acts = f"{names} acts" if len(diagnosis.verdict) == 1 else f"of {names} one acts"
        last = f"{acts} in the {place.stage} ({row}): {where}; {likeness} there."
        return " ".join([*beside, f"{last[0].upper()}{last[1:]}", *further])
    most = "If anywhere, the gap shows" if further else "The gap shows most"
    most = "It may show" if beside else most
    last = f"{most} in the {place.stage} ({row}): {where}; though {likeness} there."
    return " ".join([*beside, last, *further])


def _further_words(diagnosis: Diagnosis, named: Sequence[str]) -> list[str]:
    """Return sentences on stages with more of the gap than one that other sentences name."""
    least = min(diagnosis.stages[n].share if n in diagnosis.stages else math.inf for n in named)
    larger = {
        name: stage
        for name, stage in diagnosis.stages.items()
        if name not in named and stage.share > least and stage.p_value < NOT_AT_ALL
    }
    order = sorted(larger, key=lambda name: -larger[name].share)
    sentences = []
    for is_sure, words in ((True, "It shows {} as well."), (False, "What shows {} is uncertain.")):
        among = [name for name in order if (larger[name].p_value <= SURE) == is_sure]
        if among:
            rows = [f"in the {name} ({_row_words(diagnosis, name)})" for name in among]
            sentences.append(words.format(joined(rows)))
    return sentences


def _other_stage(diagnosis: Diagnosis, place: Location) -> str:
    """Return the other stage with most of the gap that differs significantly, or nothing."""
    sure = place.p_value <= SURE
    own = diagnosis.stages.get(place.stage)
    least = own.share if sure and own is not None else -1.0
    shares = {
        name: stage.share
        for name, stage in diagnosis.stages.items()
        if name != place.stage and stage.p_value <= SURE and stage.share > least
    }
    return max(shares, key=lambda name: shares[name], default="")


def _other_words(diagnosis: Diagnosis, place: Location, other: str) -> list[str]:
    """Return sentences on a stage that differs more than that of the named effects."""
    row = _row_words(diagnosis, other)
    sure = place.p_value <= SURE
    first = f"{'Most of it' if sure else 'The gap'} shows in the {other} ({row})"
    if spot := next((one for one in diagnosis.differences if one.stage == other), None):
        first += f": {_channels_and_band(spot)}"
    acting = stages_acting(diagnosis)
    if not acting or other in acting:
        return [f"{first}."]
    if other in SHOWN_IN.get(place.stage, ()):
        return [f"{first}, as it can where something acts in the {place.stage}."]
    names = joined([cause_of(name).name for name in diagnosis.verdict])
    fitted = {one.name for one in diagnosis.effects if one.closed is not None}
    if diagnosis.remainder is not None:
        meaning = "The fit leaves a gap, so something else may be missing there."
    elif fitted >= set(diagnosis.verdict):
        meaning = "The fit explains that as well."
    else:
        meaning = f"Only a fit tells whether {names} explains that as well."
    return [f"{first}.", meaning]


def _row_words(diagnosis: Diagnosis, stage: str) -> str:
    """Return share of the gap and p-value of a stage as in the table."""
    row = diagnosis.stages.get(stage)
    if row is None:
        return p_number(diagnosis.location.p_value if diagnosis.location else math.nan)
    return f"{percent(row.share)} of the gap, {p_number(row.p_value)}"


def _channels_and_band(place: Location) -> str:
    low, high = place.band
    band = f"below {frequency(high)}" if low <= 0 else f"{frequency(low)} to {frequency(high)}"
    return ", ".join([*([f"in the {joined(place.channels)}"] if place.channels else []), band])


def _place_words(diagnosis: Diagnosis, place: Location) -> str:
    parts = [_channels_and_band(place)]
    if place.phase != "all":
        parts.append(PHASES.get(place.phase, f"in the phase {place.phase}"))
    if place.conditions != "all":
        parts.append(f"where {_conditions(place.conditions)}")
    elif len(far_ones(diagnosis)) == len(diagnosis.agreement):  # else it shows at some of them
        parts.append("in all conditions")
    return ", ".join(parts)


def _conditions(limits: str) -> str:
    """Return conditions with names and units of quantities for those of columns."""
    for column, (name, unit) in _COLUMNS.items():
        limits = re.sub(rf"\b{column} *([<>=]+) *([\w.+-]+)", rf"{name} \1 \2 {unit}", limits)
    return limits.replace(">=", "\N{GREATER-THAN OR EQUAL TO}").replace(
        "<=", "\N{LESS-THAN OR EQUAL TO}"
    )


def remainder_sentence(diagnosis: Diagnosis) -> str:
    """Return what the fit of a verdict leaves; empty if that is within the scatter of repeats.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from noise.diagnosis.outcome import Remainder
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> left = Remainder(3.04, ("torque",), (100.0, 450.0))
    >>> remainder_sentence(replace(nothing, verdict=("partial_slip",), remainder=left))
    'With it held-out recordings still deviate 3.0 times as much as repeats do, most in the torque
      from 100 Hz to 450 Hz. It acts in another way than was tried, or something else is missing as
      well.'
    """
    left = diagnosis.remainder
    if left is None or diagnosis.verdict == ("unknown",):
        return ""
    where = f"most in the {joined(left.channels)}"
    if len(left.channels) == 1:
        where += f" from {frequency(left.band[0])} to {frequency(left.band[1])}"
    them, meaning = "them", "They act in another way than was tried, or something else"
    if diagnosis.verdict == ("parameters",):
        them, meaning = "refitted parameters", "Something else"
    elif len(diagnosis.verdict) == 1:
        them, meaning = "it", "It acts in another way than was tried, or something else"
    return (
        f"With {them} held-out recordings still deviate {gap_number(left.gap)} times as much as "
        f"repeats do, {where}. {meaning} is missing as well."
    )


def closed_words(finding: EffectFinding | None, of: str = "", interval: str = "") -> str:
    """Return the share of the gap that a fit with an effect closes, with its 90 % interval.

    Both are limited to 100 %: more would only reflect the uncertainty of the floor.

    Parameters
    ----------
    finding : EffectFinding or None
    of, interval : str
        Text behind the share, and before the interval.

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


def fit_sentence(finding: EffectFinding, fit: str = "The fit") -> str:
    """Return how far a fit with an effect closes the gap; empty if that was not determined.

    Parameters
    ----------
    finding : EffectFinding
    fit : str
        Name of the fit.

    Examples
    --------
    >>> from noise.diagnosis.outcome import EffectFinding
    >>> fit_sentence(EffectFinding("mains_hum", "measurement", 0.9, gap_before=4.9, gap_after=1.1,
    ...                            closed=0.96, closed_low=0.91, closed_high=0.99))
    'The fit explains 96 % of the deviation beyond that of repeats (90 % interval 91 % to 99 %).
      Held-out recordings deviate 4.90 times as much as repeats without it, 1.10 times with it.'
    >>> fit_sentence(EffectFinding("mains_hum", "measurement", 0.9, gap_before=1.9, gap_after=2.3,
    ...                            closed=-0.4))
    'The fit explains nothing of the deviation beyond that of repeats. Held-out recordings deviate
      1.90 times as much as repeats without it, 2.30 times with it.'
    """
    sentences = []
    if finding.closed is not None:
        words = closed_words(finding, " of the deviation beyond that of repeats", "90 % interval ")
        sentences.append(f"{fit} explains {words}.")
    if finding.gap_before is not None and finding.gap_after is not None:
        if finding.closed is None:
            sentences.append(f"How much {fit[0].lower()}{fit[1:]} explains is not known.")
        before, after = gap_number(finding.gap_before, ".2f"), gap_number(finding.gap_after, ".2f")
        hardly = "hardly " if finding.closed is None else ""
        sentences.append(
            f"Held-out recordings {hardly}deviate {before} times as much as repeats without it, "
            f"{after} times with it."
        )
    return " ".join(sentences)


def strength_words(finding: EffectFinding) -> str:
    """Return the interval of an effect's strength, with its unit and the form that was fitted.

    Examples
    --------
    >>> from noise.diagnosis.outcome import EffectFinding
    >>> strength_words(EffectFinding("slip_pulse", "structure", 0.9, {"form": "exponential"},
    ...                              (68.01, 161.1)))
    'amplitude 68 to 161 N (form exponential)'
    """
    if finding.strength is None:
        return NOT_DETERMINED
    low, high = (number(end, ".3g") for end in finding.strength)
    if finding.name not in EFFECTS:
        return f"{low} to {high}"
    effect = EFFECTS[finding.name]
    form = finding.parameters.get("form", effect.forms[0])
    unit = effect.parameters[effect.strength].unit if form in effect.forms else ""
    words = f"{parameter_name(effect.strength)} {low} to {high} {unit}".strip()
    return f"{words} (form {parameter_name(str(form))})" if len(effect.forms) > 1 else words


def strength_sentence(finding: EffectFinding) -> str:
    """Return the strength of a fitted effect; empty if it was not determined.

    Examples
    --------
    >>> from noise.diagnosis.outcome import EffectFinding
    >>> strength_sentence(EffectFinding("slip_pulse", "structure", 0.9, {"form": "exponential"},
    ...                                 (68.01, 161.1)))
    "Slip pulse as fitted: amplitude 68 to 161 N (form exponential), a 90 % interval that allows
      for other forms. The effect's other numbers can shift it further."
    """
    if finding.strength is None:
        return ""
    name = cause_of(finding.name).name
    return (
        f"{name[0].upper()}{name[1:]} as fitted: {strength_words(finding)}, a 90 % interval that "
        "allows for other forms. The effect's other numbers can shift it further."
    )


def _unfitted(diagnosis: Diagnosis) -> str:
    if not diagnosis.verdict or diagnosis.held_out:
        return ""
    return (
        "Nothing has been fitted, so it is not known how much of the deviation this explains. "
        "A diagnosis without --quick fits it."
    )
