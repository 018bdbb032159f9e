"""Headline and sentences of a diagnosis.

A cause is named only if it is likely and the stage that it acts in differs. Otherwise the sentence
states what differs, and what it may be. Figures are those of the tables beside the sentences; those
that were not determined are left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from statistics import NormalDist

from noise.base import SURE_90
from noise.diagnosis.outcome import SURE, Diagnosis, EffectFinding
from noise.diagnosis.words import (
    NOT_DETERMINED,
    PHASES,
    cause_of,
    frequency,
    gap_number,
    joined,
    number,
    p_number,
    parameter_name,
    percent,
)
from sim.effects import EFFECTS


def finding_of(diagnosis: Diagnosis, name: str) -> EffectFinding | None:
    """Return the finding about an effect, if there is one."""
    return next((effect for effect in diagnosis.effects if effect.name == name), None)


def stage_of_effect(diagnosis: Diagnosis, name: str) -> str:
    """Return the stage that an effect acts in; empty if it is unknown."""
    effect = finding_of(diagnosis, name) or EFFECTS.get(name)
    return "" if effect is None else str(effect.stage)


AGREES = 2.0
"""Largest gap of a recording that agrees with the rig file [-]; assumed. Of 480 simulated repeats
of ten quiet development cases of the second rig (seed 3), each against the other eleven of its
condition, 5 % have a larger one; of 66 recordings without a cause (quiet, seed 4) 3 %."""

_SHOWN_IN = {
    "drive": ("drive", "friction"),
    "friction": ("friction",),
    "structure": ("structure",),
    "radiation": ("radiation",),
    "measurement": ("measurement", "friction", "structure", "radiation"),
}
"""Stages in which an effect of each stage may show: the shaft's motion depends on the contact, and
an error of a sensor looks like one of the transfer path to it."""

_CANDIDATES = 3
"""Number of causes in a sentence if none is likely; assumed."""

_MAY_BE = {
    "none": "chance", "unknown": "something unknown", "parameters": "parameters that are off"
}  # fmt: skip

LIKELY = 0.5
"""Least probability of a cause that is named [-]: it is likelier than not."""

_NOT_AT_ALL = 0.5
"""p-value above which a stage does not differ at all [-]; assumed."""

_NOTHING = 0.005
"""Share below which a fit closes nothing [-]: it would be rounded to 0 %."""


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
        return "No cause to name" if _differs(diagnosis) else "No gap"
    if not is_named(diagnosis):
        return f"Something differs{_in_stage(diagnosis)}"
    if diagnosis.verdict == ("unknown",):
        return "Unknown cause"
    if diagnosis.verdict == ("parameters",):
        return "Parameters are off"
    return f"Missing: {joined([cause_of(name).name for name in diagnosis.verdict])}"


def answer(diagnosis: Diagnosis) -> list[str]:
    """Return all sentences of the answer.

    In order: dead or clipping channels, agreement with the rig file, verdict, location, equivalent
    effects. Recordings that cannot be of the rig have the reasons alone.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> answer(Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0))
    ['Recordings and simulation differ as repeats do: nothing is to be explained (0.90 times as much
      as repeats, p = 0.60).']
    """
    first = [f"{text[0].upper()}{text[1:]}." for text in (*diagnosis.bench, *diagnosis.faults)]
    if diagnosis.bench:
        return [*first, "No cause is looked for before that is put right."]
    sentences = [
        *first,
        agreement_sentence(diagnosis),
        verdict_sentence(diagnosis),
        location_sentence(diagnosis),
        *(
            f"These channels cannot tell {cause_of(one).name} from {cause_of(other).name}."
            for one, other in diagnosis.equivalent
        ),
    ]
    if diagnosis.verdict and not diagnosis.held_out:
        sentences.append(
            "Nothing has been fitted, so it is not known how much of the deviation this explains. "
            "A diagnosis without --quick fits it."
        )
    return [*filter(None, sentences)]


def agreement_sentence(diagnosis: Diagnosis) -> str:
    """Return how far the rig file describes the recordings; empty if that was not determined.

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
    'The rig file describes 1 of 2 recordings: the recordings deviate 1.1 to 6.1 times as much as
      repeat measurements do. Farthest is run02.wav, most in the torque (8.0 times). All recordings
      together deviate 0.9 times as much (p = 0.60).'
    """
    rows = diagnosis.agreement
    if not rows:
        return ""
    n, n_far = len(rows), sum(one.gap > AGREES for one in rows)
    start = "The rig file describes the rig"
    if n_far:
        start = f"The rig file describes {n - n_far or 'none'} of {n} recordings"
    elif diagnosis.verdict:
        start += " but for a difference that shows on a closer look"
    least, most = (gap_number(end(one.gap for one in rows)) for end in (min, max))
    reach = most if least == most else f"{least} to {most}"
    deviate = "the recording deviates" if n == 1 else "the recordings deviate"
    sentence = f"{start}: {deviate} {reach} times as much as repeat measurements do."
    if n_far:
        farthest = max(rows, key=lambda one: one.gap)
        sentence += f" Farthest is {farthest.recording}"
        if channels := farthest.channels:
            channel = max(channels, key=lambda name: channels[name])
            sentence += f", most in the {channel} ({gap_number(channels[channel])} times)"
        sentence += "."
    if diagnosis.verdict and diagnosis.p_value <= 1.0 and n > 1:
        sentence += (
            f" All recordings together deviate {gap_number(diagnosis.gap)} times as much "
            f"({p_number(diagnosis.p_value)})."
        )
    return sentence


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """Return the verdict as a sentence, with its probability.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> verdict_sentence(Diagnosis(("clipping",), (), None, {}, (), {"clipping": 0.96}, {}, "",
    ...                            (), 4.0, 1.0, 0.0, 1.0))
    'The simulation lacks clipping: ... cuts off the peaks of a channel (96 %).'
    """
    match diagnosis.verdict:
        case ():
            return _no_gap(diagnosis)
        case _ if not is_named(diagnosis):
            return _unlikely(diagnosis)
        case ("unknown",):
            return (
                f"Something differs{_in_stage(diagnosis)} and no known effect is likely: the cause "
                f"is unknown{_likely(diagnosis, 'unknown')}."
            )
        case ("parameters",):
            return _parameters(diagnosis)
        case (name,):
            cause = cause_of(name)
            return f"The simulation lacks {cause.name}: {cause.clause}{_likely(diagnosis, name)}."
    each = [f"{cause_of(name).name}{_likely(diagnosis, name, cause_of(name).clause)}"
            for name in diagnosis.verdict]  # fmt: skip
    return f"The simulation lacks {len(each)} effects: {joined(each)}."


def is_named(diagnosis: Diagnosis) -> bool:
    """Return whether a verdict is likely and agrees with the table of stages.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> is_named(Diagnosis(("clipping",), (), None, {}, (), {"clipping": 0.44}, {}, "", (), 4.0,
    ...                    1.0, 0.0, 1.0))
    False
    """
    chances = [diagnosis.probabilities.get(name, 1.0) for name in diagnosis.verdict]
    return min(chances, default=1.0) >= LIKELY and not _contradicted(diagnosis)


def _contradicted(diagnosis: Diagnosis) -> list[str]:
    """Return the stages of a verdict's effects in which nothing differs."""
    stages = []
    for name in diagnosis.verdict:
        stage = stage_of_effect(diagnosis, name)
        shown = [diagnosis.stages.get(among) for among in _SHOWN_IN.get(stage, ())]
        p_values = [one.p_value for one in shown if one is not None and one.gap > 0.0]
        if p_values and min(p_values) >= _NOT_AT_ALL:
            stages.append(stage)
    return list(dict.fromkeys(stages))


def _in_stage(diagnosis: Diagnosis) -> str:
    """Return the stage that differs; empty if none does significantly."""
    place = diagnosis.location
    return f" in {place.stage}" if place is not None and place.p_value <= SURE else ""


def _differs(diagnosis: Diagnosis) -> bool:
    """Return whether the gap is larger than that of repeats, whatever the verdict."""
    return (diagnosis.p_value <= SURE and diagnosis.gap > 1.0) or diagnosis.gap > AGREES


def _no_gap(diagnosis: Diagnosis) -> str:
    sentence = "Recordings and simulation differ as repeats do: nothing is to be explained"
    if _differs(diagnosis):
        sentence = (
            "Recordings and simulation differ by more than simulated repeats do, but no cause "
            "stands out"
        )
        chances = diagnosis.probabilities
        ranked = sorted(chances, key=lambda name: -chances[name])[:2]
        if ranked:
            sentence += f": it may be {joined([_possible(diagnosis, n) for n in ranked], 'or')}"
    if math.isfinite(diagnosis.gap):
        times = gap_number(diagnosis.gap, ".2f")
        sentence += f" ({times} times as much as repeats, {p_number(diagnosis.p_value)})"
    return f"{sentence}."


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
    parts = []
    for name, (low, high) in parameters_off(diagnosis.parameters).items():
        near, far, way = (low - 1.0, high - 1.0, "higher")
        if low <= 1.0:
            near, far, way = (1.0 - high, 1.0 - low, "lower")
        parts.append(
            f"{parameter_name(name)} comes out {100 * near:.2g} to {100 * far:.2g} % {way}"
        )
    which = f": {joined(parts)}" if parts else ""
    likely = _likely(diagnosis, "parameters")
    if not which and diagnosis.parameters:
        which = ": which of them, the fit does not tell"
    return f"Values of the rig file are off, rather than an effect missing{likely}{which}."


def _unlikely(diagnosis: Diagnosis) -> str:
    """Return possible causes if none is likely, or if its stage does not differ."""
    chances = {name: p for name, p in diagnosis.probabilities.items() if name != "none"}
    named = () if diagnosis.verdict == ("unknown",) else diagnosis.verdict
    ranked = sorted(chances, key=lambda name: (name not in named, -chances[name]))
    n = max(_CANDIDATES, len(diagnosis.verdict))
    listed = [_possible(diagnosis, name) for name in ranked[:n]]
    sentence = f"Something differs{_in_stage(diagnosis)}; it may be {joined(listed, 'or')}"
    if stages := _contradicted(diagnosis):
        does = "does" if len(stages) == 1 else "do"
        sentence += f", although {joined(stages)} {does} not differ beyond what repeats do"
    return f"{sentence}."


def _possible(diagnosis: Diagnosis, name: str) -> str:
    """Return a possible cause with its probability."""
    words = _MAY_BE.get(name) or cause_of(name).name
    return f"{words} ({percent(diagnosis.probabilities[name])})"


def _likely(diagnosis: Diagnosis, name: str, clause: str = "") -> str:
    """Return a clause and the probability of a cause in brackets; empty if neither is known."""
    known = diagnosis.probabilities.get(name)
    inside = "; ".join(filter(None, (clause, "" if known is None else percent(known))))
    return f" ({inside})" if inside else ""


def location_sentence(diagnosis: Diagnosis) -> str:
    """Return where the gap lies, and which other stages differ significantly; empty without a gap.

    Parameters
    ----------
    diagnosis : Diagnosis
    """
    place = diagnosis.location
    if place is None:
        return ""

    def row(stage: str) -> str:
        """Return a stage with its share of the gap and p-value as in the table."""
        finding = diagnosis.stages.get(stage)
        if finding is None:
            return f"in the {stage}"
        return f"in the {stage} ({percent(finding.share)} of the gap, {p_number(finding.p_value)})"

    low, high = place.band
    band = f"below {frequency(high)}" if low <= 0 else f"{frequency(low)} to {frequency(high)}"
    parts = [f"in the {joined(place.channels)}, {band}" if place.channels else band]
    if place.phase != "all":
        parts.append(PHASES.get(place.phase, f"in the phase {place.phase}"))
    if place.conditions != "all":
        limit = place.conditions.replace("speed_rad_s", "speed")
        parts.append(f"where {limit.replace('>=', '≥').replace('<=', '≤')} rad/s")
    verb = "shows" if place.p_value <= SURE else "may show"
    sentence = f"The gap {verb} {row(place.stage)}: {', '.join(parts)}."
    others = {
        name: one.share
        for name, one in diagnosis.stages.items()
        if name != place.stage and one.p_value <= SURE
    }
    if not others:
        return sentence
    also = joined([row(name) for name in sorted(others, key=lambda name: -others[name])])
    if place.p_value > SURE:
        return f"The gap shows {also}. It{sentence.removeprefix('The gap')}"
    return f"{sentence} It shows {also} as well."


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
    """
    sentences = []
    if finding.closed is not None:
        words = closed_words(finding, " of the deviation beyond that of repeats", "90 % interval ")
        low = finding.closed_low
        if low is not None and low <= _NOTHING < finding.closed:
            words += ", which may be nothing"
        sentences.append(f"{fit} explains {words}.")
    if finding.gap_before is not None and finding.gap_after is not None:
        if finding.closed is None:
            sentences.append(f"How much {fit[0].lower()}{fit[1:]} explains is not known.")
        before, after = gap_number(finding.gap_before, ".2f"), gap_number(finding.gap_after, ".2f")
        sentences.append(
            f"Held-out recordings deviate {before} times as much as repeats without it, {after} "
            "times with it."
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
