"""Settled part of recordings, without a start from rest, a run-up or a swing of the drive.

A settled recording is returned unchanged, bit for bit. The settled part of another has one of a few
lengths, so that recordings can share simulations and repeats of a condition stay comparable.

A start is a deviation from the later speed that exists at the beginning, ends, and is several times
larger than all later deviations. A speed that fluctuates throughout and a short dip in the middle
are not starts. The start is detected from the angle, which is read where it crosses the steps of
its converter, so that a coarse converter is as accurate as a fine one. A torque that rises from
zero shows a start from rest. Without an angle, the rate at which the torque rises while the contact
sticks shows the speed, because the rotation of the shaft twists the elastomer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from models.condition import known_condition
from models.recording import Recording
from noise.base.arrays import Array
from noise.diagnosis.evidence.channel_summary import segment_frequency
from noise.diagnosis.evidence.reconstruction import LEAD, TAIL
from noise.diagnosis.text.words import joined

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

_RISE, _STUCK, _STEEP = 5e-4, 0.02, 0.8
"""Interval over which the rise of a torque is taken [s], length of the window of such rises [s],
and quantile of the rises in a window [-]; assumed."""

_SMALLEST_RISE, _LARGER_RISE, _OVER_RISE = 0.12, 2.5, 0.05
"""Values of `_SMALLEST`, `_LARGER` and `_OVER` for the rise of a torque, which is less exact [-];
assumed."""

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
    rate, starts = recording.rate, [0.0]
    angle, torque = recording.first("angle"), recording.first("torque")
    if angle is not None:
        starts.append(_start_by_angle(recording.samples[angle], rate))
    if torque is not None:
        starts.append(_start_from_zero(recording.samples[torque], rate))
    if torque is not None and angle is None:
        starts.append(_start_by_sticking(recording.samples[torque], rate))
    return max(starts)


def _start_by_angle(angle: Array, rate: float) -> float:
    """Return the time at which the speed of an angle settles; 0 without a start [s]."""
    block = max(1, round(_BLOCK * rate))
    n = angle.size // block
    turned = angle * (1.0 if angle[-1] >= angle[0] else -1.0)
    means = _continuous(turned)[: n * block].reshape(n, block).mean(axis=1)
    if n < 8 * _LAG:
        return 0.0
    at = np.arange(n)
    after, before = np.minimum(at + _LAG, n - 1), np.maximum(at - _LAG, 0)
    speed = (means[after] - means[before]) / (after - before)
    settled = _settled(speed, round(_EARLY / _BLOCK), _OVER, _SMALLEST, _LARGER)
    return min((settled + _LAG) * block, angle.size) / rate if settled else 0.0


def _start_by_sticking(torque: Array, rate: float) -> float:
    """Return the time at which the rise of the torque in stick phases settles; 0 without one [s].

    The rise is proportional to the speed of the shaft. A high quantile of it is the rise in the
    stick phase, independent of the falls in between.
    """
    turned = torque * (1.0 if torque.mean() >= 0.0 else -1.0)
    lag, hop, length = (max(1, round(x * rate)) for x in (_RISE, _BLOCK, _STUCK))
    rises = turned[lag:] - turned[:-lag]
    if rises.size < 8 * length:
        return 0.0
    rise = np.quantile(sliding_window_view(rises, length)[::hop], _STEEP, axis=1)
    settled = _settled(rise, round(_EARLY / _BLOCK), _OVER_RISE, _SMALLEST_RISE, _LARGER_RISE)
    return min(settled * hop + length, torque.size) / rate if settled else 0.0


def _settled(values: Array, n_early: int, over: float, smallest: float, larger: float) -> int:
    """Return the index from which values agree with the late ones; 0 without a start."""
    first_late = round(_LATE * values.size)
    late = values[first_late:].mean()
    if late <= 0.0:
        return 0
    away = np.abs(values / late - 1.0)
    beyond = np.maximum.accumulate(away[::-1])[::-1]  # largest deviation from each index on
    settled = int(np.argmax(beyond <= max(over, 1.2 * beyond[first_late])))
    limit = max(smallest, larger * beyond[settled])
    if settled == 0 or away[:settled].max() < limit or away[:n_early].max() < 0.5 * limit:
        return 0
    return settled


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
        Durations that were cut off, one line per reason.
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
    (0.6, ('run: the first 0.4 s, in which the shaft comes to its speed, were left out',))
    """
    starts = [start_of(recording) for recording in recordings]
    refused = {
        i: f"the shaft comes to its speed only {start:.2g} s after the beginning, and "
        f"{shortest(recording.rate):.2g} s at least must be left"
        for i, (start, recording) in enumerate(zip(starts, recordings, strict=True))
        if start > recording.duration - shortest(recording.rate)
    }
    too_short = len(refused) == len(recordings)
    if too_short:
        refused = {}
    usable = [i for i in range(len(recordings)) if i not in refused]
    n_settled = {i: _n_settled(recordings[i], starts[i]) for i in usable}
    for repeats in _repeats(recordings, usable):
        fewest = min(n_settled[i] for i in repeats)
        if fewest >= _SHORTENED * max(n_settled[i] for i in repeats):
            n_settled |= dict.fromkeys(repeats, fewest)
    parts = []
    cut: dict[str, list[tuple[str, float]]] = {}
    for i in usable:
        recording = recordings[i]
        first = recording.samples.shape[1] - n_settled[i]
        parts.append(_from(recording, first))
        if first:
            why = "as much as of another recording of the same condition"
            if starts[i]:
                why = "in which the shaft comes to its speed"
                if too_short:
                    why += " and beyond which too little is left"
            name = recording.name or f"recording {i + 1}"
            cut.setdefault(why, []).append((name, first / recording.rate))
    return tuple(parts), tuple(_cut_note(why, each) for why, each in cut.items()), refused


def _cut_note(why: str, cut: Sequence[tuple[str, float]]) -> str:
    """Return a note on the durations that were cut off for one reason [s]."""
    names = [name for name, _ in cut]
    which = joined(names) if len(names) <= _MOST_NAMED else f"{len(names)} recordings"
    ends = dict.fromkeys(f"{end(seconds for _, seconds in cut):.2g}" for end in (min, max))
    return f"{which}: the first {' to '.join(ends)} s, {why}, were left out"


def _n_settled(recording: Recording, start: float) -> int:
    """Return the number of samples of the settled part after a start [s]."""
    n = int(recording.samples.shape[1])
    if start == 0.0:
        return n
    left = recording.duration - start
    rounded = _LENGTHS * float(np.floor((left - RINGING) / _LENGTHS + 1e-6))
    return min(n, math.ceil(max(rounded, shortest(recording.rate)) * recording.rate))


def _repeats(recordings: Sequence[Recording], usable: Sequence[int]) -> list[list[int]]:
    """Return groups of indices of recordings with the same stated condition, rate and length."""
    groups: dict[tuple[object, ...], list[int]] = {}
    for i in usable:
        r, c = recordings[i], known_condition(recordings[i].condition)
        stated = (c.speed, c.interference, c.support_stiffness, r.rate, r.samples.shape[1])
        groups.setdefault(stated, []).append(i)
    return list(groups.values())


def _from(recording: Recording, first: int) -> Recording:
    """Return the part of a recording from a sample on, with its angle starting at zero."""
    if first == 0:
        return recording
    samples = recording.samples[:, first:].copy()
    for row, channel in enumerate(recording.channels):
        if channel.kind == "angle":
            samples[row] -= samples[row, 0]
    return replace(recording, samples=samples)
