"""Start of a recording, in which the shaft comes to its speed, and the settled part after it.

A start is a deviation from the later speed that exists at the beginning, ends, and is several times
larger than all later deviations. It is detected from the angle, which is read where it crosses the
steps of its converter, so that a coarse converter is as accurate as a fine one. A torque that rises
from zero shows a start from rest.

A settled recording is returned unchanged, bit for bit. The settled part of another has one of a few
lengths, so that recordings can share simulations and repeats of a condition stay comparable.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from models.condition import known_condition
from models.recording import Recording
from noise.base.arrays import Array
from noise.diagnosis.evidence.channel_summary import segment_frequency
from noise.diagnosis.evidence.reconstruction import LEAD, TAIL
from noise.diagnosis.words import joined

_BLOCK, _LAG = 5e-3, 2
"""Length of the blocks over which an angle is averaged [s], and number of blocks on either side for
the slope that is the speed; assumed."""

_LATE = 0.6
"""Share of a recording after which every start has ended [-]; assumed."""

_EARLY = 0.08
"""Time from the beginning within which a start is visible [s], at least a quarter of the slowest
swing of a controller; assumed."""

_SMALLEST, _LARGER = 0.04, 4.0
"""Least relative deviation of the speed in a start, and its least ratio to later deviations [-];
assumed."""

_OVER = 0.012
"""Largest relative deviation of a settled speed [-]; assumed."""

_FEWEST_LEVELS = 8
"""Least number of converter levels of an angle for interpolation between them; assumed."""

_FROM_ZERO = 0.25
"""Largest initial torque of a start from rest, as a share of the lowest later torque [-];
assumed."""


def start_of(recording: Recording) -> float:
    """Return the time at which the shaft of a recording reaches its speed; 0 without a start [s].

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> even = np.linspace(0.0, 1.0, 30_000)[None]
    >>> start_of(Recording(even, 30e3, (Channel("angle"),)))
    0.0
    """
    by_angle = by_torque = 0.0
    if (row := recording.first("angle")) is not None:
        by_angle = _start_by_angle(recording.samples[row], recording.rate)
    if (row := recording.first("torque")) is not None:
        by_torque = _start_from_zero(recording.samples[row], recording.rate)
    return max(by_angle, by_torque)


def _start_by_angle(angle: Array, rate: float) -> float:
    """Return the time at which the speed of an angle settles; 0 without a start [s]."""
    block = max(1, round(_BLOCK * rate))
    n = angle.size // block
    if n < 8 * _LAG:
        return 0.0
    turned = _continuous(angle * (1.0 if angle[-1] >= angle[0] else -1.0))
    means = turned[: n * block].reshape(n, block).mean(axis=1)
    at = np.arange(n)
    after, before = np.minimum(at + _LAG, n - 1), np.maximum(at - _LAG, 0)
    speed = (means[after] - means[before]) / (after - before)
    first_late = round(_LATE * n)
    late = speed[first_late:].mean()
    if late <= 0.0:
        return 0.0
    away = np.abs(speed / late - 1.0)
    beyond = np.maximum.accumulate(away[::-1])[::-1]  # largest deviation from each block on
    settled = int(np.argmax(beyond <= max(_OVER, 1.2 * beyond[first_late])))
    limit = max(_SMALLEST, _LARGER * beyond[settled])
    early = away[: round(_EARLY / _BLOCK)].max()
    if settled == 0 or away[:settled].max() < limit or early < 0.5 * limit:
        return 0.0
    return min((settled + _LAG) * block, angle.size) / rate


def _continuous(angle: Array) -> Array:
    """Return an angle interpolated linearly between the crossings of its converter's levels.

    The number of samples below a level is the time of its crossing, even if noise crosses it
    several times.
    """
    levels, count = np.unique(angle, return_counts=True)
    if levels.size > 0.5 * angle.size or levels.size < _FEWEST_LEVELS:
        return angle
    crossed = np.cumsum(count)[:-1] - 0.5
    between = 0.5 * (levels[1:] + levels[:-1])
    first, last = np.polyfit(crossed[:3], between[:3], 1), np.polyfit(crossed[-3:], between[-3:], 1)
    at = np.arange(angle.size)
    smooth = np.interp(at, crossed, between)
    before, after = at < crossed[0], at > crossed[-1]
    smooth[before], smooth[after] = np.polyval(first, at[before]), np.polyval(last, at[after])
    return np.asarray(smooth)


def _start_from_zero(torque: Array, rate: float) -> float:
    """Return the time at which a torque that begins at zero reaches its later range [s].

    The result is 0 if the torque does not begin at zero.
    """
    turned = torque * (1.0 if torque.mean() >= 0.0 else -1.0)
    late = turned[round(_LATE * turned.size) :]
    lowest = float(np.quantile(late, 0.01))
    n = max(1, round(1e-3 * rate))
    if lowest <= 0.0 or np.abs(turned[:n]).mean() > _FROM_ZERO * lowest:
        return 0.0
    return float(np.argmax(turned >= lowest)) / rate


_SHORTEST = LEAD + TAIL + 0.1
"""Least duration with enough cycles [s]."""

_PATH_ENDS = 0.09
"""Duration of the ends that `evidence.channel_summary` omits before it takes spectra
of segments [s]."""

RINGING = 0.06
"""Decay time of a ringing clamp after the speed has settled [s]: three time constants 2 J_C / c of
the thesis's clamp."""

_LENGTHS = 0.05
"""Step of the durations of settled parts [s], so that recordings share simulations; assumed."""

_MOST_NAMED = 6
"""Largest number of recordings that a note names; assumed."""

_SHORTENED = 0.5
"""Least share of a recording that remains if it is shortened to the length of its repeat [-];
assumed."""


def shortest(rate: float) -> float:
    """Return the least duration of a recording for a comparison [s].

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].

    Examples
    --------
    >>> round(shortest(30e3), 2), round(shortest(12e3), 2)
    (0.17, 0.26)
    """
    return max(_SHORTEST, _PATH_ENDS + segment_frequency(rate)[0] / rate)


def settled_parts(
    recordings: Sequence[Recording],
) -> tuple[tuple[Recording, ...], tuple[str, ...], dict[int, str]]:
    """Return recordings without their starts.

    Parameters
    ----------
    recordings : sequence of Recording
        Recordings with speed, interference and support stiffness in their conditions.

    Returns
    -------
    parts : tuple of Recording
        Settled parts; a settled recording is unchanged, and repeats of a condition have one length.
    notes : tuple of str
        What was cut off, in one line; empty if nothing was.
    refused : dict of int to str
        Reason why a recording has no settled part, by index; empty if no recording has one.

    Examples
    --------
    >>> from models.condition import KnownCondition
    >>> from models.recording import Channel, Recording
    >>> speed = np.minimum(np.arange(30_000) / 9e3, 1.0)  # of 1 rad/s, reached after 0.3 s
    >>> at = KnownCondition(1.0, 0.279e-3, 3745.0)
    >>> run = Recording(np.cumsum(speed)[None] / 30e3, 30e3, (Channel("angle"),), at, name="run")
    >>> parts, notes, _ = settled_parts([run])
    >>> round(parts[0].duration, 3), notes
    (0.6, ('run: the first 0.4 s at most, in which the shaft comes to its speed, were left out',))
    """
    starts = [start_of(recording) for recording in recordings]
    refused = {
        i: f"the shaft comes to its speed only {start:.2g} s after the beginning, and "
        f"{shortest(recording.rate):.2g} s at least must be left"
        for i, (start, recording) in enumerate(zip(starts, recordings, strict=True))
        if start > recording.duration - shortest(recording.rate)
    }
    if len(refused) == len(recordings):
        refused = {}
    n_settled = {
        i: _n_settled(recording, starts[i])
        for i, recording in enumerate(recordings)
        if i not in refused
    }
    repeats: dict[tuple[object, ...], list[int]] = {}
    for i in n_settled:
        recording, at = recordings[i], known_condition(recordings[i].condition)
        stated = (at.speed, at.interference, at.support_stiffness)
        alike = (*stated, recording.rate, recording.samples.shape[1])
        repeats.setdefault(alike, []).append(i)
    for places in repeats.values():
        fewest = min(n_settled[i] for i in places)
        if fewest >= _SHORTENED * max(n_settled[i] for i in places):
            n_settled |= dict.fromkeys(places, fewest)
    parts, cut, longest = [], [], 0.0
    for i, n in n_settled.items():
        recording = recordings[i]
        first = recording.samples.shape[1] - n
        parts.append(_from(recording, first))
        if first:
            cut.append(recording.name or f"recording {i + 1}")
            longest = max(longest, first / recording.rate)
    if not cut:
        return tuple(parts), (), refused
    which = joined(cut) if len(cut) <= _MOST_NAMED else f"{len(cut)} recordings"
    note = (
        f"{which}: the first {longest:.2g} s at most, in which the shaft comes to its speed, were "
        "left out"
    )
    return tuple(parts), (note,), refused


def _n_settled(recording: Recording, start: float) -> int:
    """Return the number of samples of the settled part after a start [s]."""
    n = int(recording.samples.shape[1])
    if start == 0.0:
        return n
    left = recording.duration - start
    rounded = _LENGTHS * float(np.floor((left - RINGING) / _LENGTHS + 1e-6))
    return min(n, math.ceil(max(rounded, shortest(recording.rate)) * recording.rate))


def _from(recording: Recording, first: int) -> Recording:
    """Return the part of a recording from a sample on, with its angle starting at zero."""
    if first == 0:
        return recording
    samples = recording.samples[:, first:].copy()
    for row, channel in enumerate(recording.channels):
        if channel.kind == "angle":
            samples[row] -= samples[row, 0]
    return replace(recording, samples=samples)
