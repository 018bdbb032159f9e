"""The verdict of a diagnosis in words, and whether the rig file describes its rig.

A cause is the headline only where it is likely and the stage that it acts in differs; otherwise it
is said what differs, and what it may be.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from noise.diagnosis.outcome import SHOWN_IN, SURE, Agreement, Diagnosis
from noise.diagnosis.text.words import (
    PHASES,
    cause_of,
    chance,
    finding_of,
    floors,
    frequency,
    joined,
    p_number,
    parameter_name,
    percent,
    stage_of_effect,
)

AGREES = 2.0
"""Floors up to which a recording agrees with the rig file; assumed. Of 480 simulated repeats of ten
quiet development cases of the second rig (seed 3), each against the other eleven of its condition,
5 % are farther off; of 66 recordings without a cause (quiet, seed 4) 3 %."""

_LIKE_THE_MOST = 0.5
"""Share of the largest distance from which on channels are named beside the farthest [-];
assumed."""

_MOST_NAMED = 4
"""Recordings that are named in a sentence; assumed."""

_AS_REPEATS = "times as much as repeat measurements do"


def agreement_sentence(diagnosis: Diagnosis) -> str:
    """Say whether the rig file describes the rig, at which conditions and in which channels not.

    Parameters
    ----------
    diagnosis : Diagnosis

    Returns
    -------
    str
        Empty where that was not determined.

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
      up to 6.1 times as much as repeat measurements do, in the torque (all recordings together:
      0.9 floors, p = 0.60).'
    """
    found = diagnosis.agreement
    if not found:
        return ""
    far, n = far_ones(diagnosis), len(found)
    which = "the recording deviates" if n == 1 else f"its {n} recordings deviate"
    reach = _reach(found)
    if not far:
        start = "The rig file describes the rig"
        if diagnosis.verdict:
            start += " but for a difference that shows only on a closer look"
        return f"{start}: {which} {reach} {_AS_REPEATS}{_whole(diagnosis)}."
    channels = f", in the {joined(_channels(far))}" if _channels(far) else ""
    if not diagnosis.verdict:  # what one recording does may be chance, and together it is
        roughly = " only roughly" if len(far) == n else ""
        farthest = max(far, key=lambda one: one.gap).recording
        return (
            f"The rig file describes the rig{roughly}: {which} {reach} {_AS_REPEATS}, {farthest} "
            f"most{channels}. Another recording of its condition shows whether that is chance."
        )
    if len(far) == n:
        return (
            f"The rig file does not describe the rig: {which} {reach} {_AS_REPEATS}"
            f"{channels}{_whole(diagnosis)}."
        )
    return (
        f"The rig file describes the rig at {n - len(far)} of {n} recordings, not "
        f"{_where(found)}: there it deviates up to {floors(max(one.gap for one in far))} "
        f"{_AS_REPEATS}{channels}{_whole(diagnosis)}."
    )


def far_ones(diagnosis: Diagnosis) -> list[Agreement]:
    """Return the recordings that deviate more than repeat measurements do.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> far_ones(Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0))
    []
    """
    return [one for one in diagnosis.agreement if one.gap > AGREES]


def _whole(diagnosis: Diagnosis) -> str:
    """Say how large the gap of all recordings is; without a verdict, that says it."""
    if not diagnosis.verdict or not math.isfinite(diagnosis.p_value):
        return ""
    return (
        f" (all recordings together: {floors(diagnosis.gap)} floors, {p_number(diagnosis.p_value)})"
    )


def remainder_sentence(diagnosis: Diagnosis) -> str:
    """Say what the fit of a verdict leaves; empty where that is no more than repeats differ by.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from noise.diagnosis.outcome import Remainder
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> left = Remainder(3.04, ("torque",), (100.0, 450.0))
    >>> remainder_sentence(replace(nothing, verdict=("partial_slip",), remainder=left))
    'With it the gap is still 3.0 floors, most in the torque from 100 Hz to 450 Hz. It acts in
      another way than was tried, or something else is missing as well.'
    """
    left = diagnosis.remainder
    if left is None or diagnosis.verdict == ("unknown",):
        return ""
    where = f"most in the {joined(left.channels)}"
    if len(left.channels) == 1:
        low, high = left.band
        where += f" from {frequency(low)} to {frequency(high)}"
    if diagnosis.verdict == ("parameters",):
        return (
            f"With refitted parameters the gap is still {floors(left.gap)} floors, {where}. "
            "Something else is missing as well."
        )
    them, acts = ("it", "It acts") if len(diagnosis.verdict) == 1 else ("them", "They act")
    return (
        f"With {them} the gap is still {floors(left.gap)} floors, {where}. {acts} in another way "
        "than was tried, or something else is missing as well."
    )


def _reach(found: Sequence[Agreement]) -> str:
    least, most = (floors(end(one.gap for one in found)) for end in (min, max))
    return most if least == most else f"{least} to {most}"


def _channels(far: Sequence[Agreement]) -> list[str]:
    """Channels in which recordings are about as far off as anywhere, the farthest first."""
    most = {
        name: max(one.channels.get(name, 0.0) for one in far)
        for name in dict.fromkeys(name for one in far for name in one.channels)
    }
    worst = max(most.values(), default=0.0)
    return [
        name
        for name in sorted(most, key=lambda name: -most[name])
        if most[name] >= max(_LIKE_THE_MOST * worst, AGREES)
    ]


def _where(found: Sequence[Agreement]) -> str:
    """Conditions that part the recordings which are far off from the others, or their names."""
    for key, scale, unit in (("speed", 1.0, "rad/s"), ("interference", 1e3, "mm")):
        far, near = (
            [abs(scale * getattr(one, key)) for one in found if (one.gap > AGREES) == away]
            for away in (True, False)
        )
        if min(far) > max(near):
            return f"above {max(near):.3g} {unit}"
        if max(far) < min(near):
            return f"below {min(near):.3g} {unit}"
    names = [one.recording for one in found if one.gap > AGREES]
    if len(names) > _MOST_NAMED:
        return f"at {len(names)} others"
    return f"at {joined(names)}"


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
    if diagnosis.gap > diagnosis.floor:
        agreed = (
            "Recordings and simulation differ by more than repeats do on average, which may be "
            "chance: nothing is to be explained"
        )
    elif far_ones(diagnosis):
        agreed = (
            "Single recordings deviate more than repeats do, which may be chance; taken together, "
            "they differ as repeats do: nothing is to be explained"
        )
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
