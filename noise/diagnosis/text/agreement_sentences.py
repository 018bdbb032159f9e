"""Whether a rig file describes its rig, and where not: the first thing that a diagnosis says."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from noise.diagnosis.findings import Agreement
from noise.diagnosis.text.words import floors, frequency, joined, p_number

if TYPE_CHECKING:
    from noise.diagnosis.outcome import Diagnosis


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
    >>> from noise.diagnosis.findings import Agreement
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> nothing = Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0)
    >>> slow = Agreement("run01.wav", 1.0, 2.79e-4, 1.1, {"torque": 0.9, "pressure": 1.3})
    >>> fast = Agreement("run02.wav", 4.0, 2.79e-4, 6.1, {"torque": 8.0, "pressure": 1.2})
    >>> agreement_sentence(replace(nothing, agreement=(slow,)))
    'The rig file describes the rig: the recording deviates 1.1 times as much as repeat measurements
      do.'
    >>> agreement_sentence(replace(nothing, verdict=("unknown",), agreement=(slow, fast)))
    'The rig file describes the rig at 1 of 2 recordings, not above 1 rad/s: there it deviates
      up to 6.1 times as much as repeat measurements do, in the torque (together 0.9 floors,
      p = 0.60).'
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
    return f" (together {floors(diagnosis.gap)} floors, {p_number(diagnosis.p_value)})"


def remainder_sentence(diagnosis: Diagnosis) -> str:
    """Say what the fit of a verdict leaves; empty where that is no more than repeats differ by.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from noise.diagnosis.findings import Remainder
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
