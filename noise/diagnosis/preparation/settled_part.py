"""The settled part of recordings: a start from rest, a run-up or a swing of the drive is left out.

What is settled stays to the bit. What is left of the rest has one of a few lengths, so that what is
simulated for one recording serves for others, and repeats of a condition stay comparable.

When the shaft of a recording has come to its speed: after a start from rest, a run-up, a swing.

A start is a deviation of the speed from what it is later that is there at the beginning, ends, and
is several times larger than whatever the speed does afterwards. A speed that fluctuates all the
time is none, nor is a short dip in the middle. The shaft's angle tells it, read where it crosses
the steps of its converter, so that a coarse one tells as much as a fine one. A torque that rises
from zero tells a start from rest, and where there is no angle, how fast it rises while the contact
sticks tells the rest: the elastomer is twisted as the shaft turns.
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
"""Of which an angle is averaged [s], and blocks to either side that a speed is the slope of;
assumed."""

_LATE = 0.6
"""Share of a recording after which a start is over [-]; assumed."""

_EARLY = 0.08
"""Within which a start shows [s]; a quarter of the slowest swing of a controller and more;
assumed."""

_SMALLEST, _LARGER = 0.04, 4.0
"""Deviation of the speed that is a start [-], and how many times what comes after it at least;
assumed."""

_OVER = 0.012
"""Deviation of the speed that is none any more [-]; assumed."""

_RISE, _STUCK, _STEEP = 5e-4, 0.02, 0.8
"""Over which a torque rises [s], how long that is looked at [s], and what share is exceeded [-];
assumed."""

_SMALLEST_RISE, _LARGER_RISE, _OVER_RISE = 0.12, 2.5, 0.05
"""As of the speed, which a torque tells less exactly [-]; assumed."""

_FEWEST_LEVELS = 8
"""Of an angle that is read between them; assumed."""

_FROM_ZERO = 0.25
"""Share of its lowest torque later at which the torque of a shaft that starts from rest begins;
assumed."""


def start_of(recording: Recording) -> float:
    """Return when the shaft of a recording has come to its speed; 0 where it always has [s].

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
    """When a torque has come to rise as fast as it does later: while it sticks, as the shaft turns.

    What is seldom exceeded is the rate of rise in the stick phase, whatever falls in between.
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
    """Return from where on values are what they are late; 0 where they do not begin otherwise."""
    first_late = round(_LATE * values.size)
    late = values[first_late:].mean()
    if late <= 0.0:
        return 0
    away = np.abs(values / late - 1.0)
    beyond = np.maximum.accumulate(away[::-1])[::-1]  # the largest from each on
    settled = int(np.argmax(beyond <= max(over, 1.2 * beyond[first_late])))
    limit = max(smallest, larger * beyond[settled])
    if settled == 0 or away[:settled].max() < limit or away[:n_early].max() < 0.5 * limit:
        return 0
    return settled


def _continuous(angle: Array) -> Array:
    """Angle between the steps of its converter: straight from where it crosses one to the next.

    How many samples lie below a step is when it is crossed, however often noise makes it be.
    """
    levels, count = np.unique(angle, return_counts=True)
    if levels.size > 0.5 * angle.size or levels.size < _FEWEST_LEVELS:
        return angle
    crossed = np.cumsum(count)[:-1] - 0.5
    between = 0.5 * (levels[1:] + levels[:-1])
    first, last = np.polyfit(crossed[:3], between[:3], 1), np.polyfit(crossed[-3:], between[-3:], 1)
    at = np.arange(angle.size)
    found = np.interp(at, crossed, between)
    before, after = at < crossed[0], at > crossed[-1]
    found[before], found[after] = np.polyval(first, at[before]), np.polyval(last, at[after])
    return np.asarray(found)


def _start_from_zero(torque: Array, rate: float) -> float:
    """When a torque that begins at zero has come to where it stays."""
    turned = torque * (1.0 if torque.mean() >= 0.0 else -1.0)
    late = turned[round(_LATE * turned.size) :]
    lowest = float(np.quantile(late, 0.01))
    n = max(1, round(1e-3 * rate))
    if lowest <= 0.0 or np.abs(turned[:n]).mean() > _FROM_ZERO * lowest:
        return 0.0
    return float(np.argmax(turned >= lowest)) / rate


_SHORTEST = LEAD + TAIL + 0.1
"""Shorter recordings show too few cycles [s]."""

_PATH_ENDS = 0.09
"""Without its ends a recording has at least one segment of the spectra of
`noise.diagnosis.evidence.path_summary` [s]."""

RINGING = 0.06
"""In which a clamp that rings has come to rest after the speed has [s]: three time constants of the
thesis's, 2 J_C / c."""

_LENGTHS = 0.05
"""Parts have lengths in such steps [s]: what is simulated for one then serves for others;
assumed."""

_MOST_NAMED = 6
"""Recordings that a note names; assumed."""

_SHORTENED = 0.5
"""Share that a recording keeps at least where it is shortened to the length of its repeat;
assumed."""


def shortest(rate: float) -> float:
    """Return how long a recording is at least that can be compared [s].

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
    """Leave out the start of recordings.

    Parameters
    ----------
    recordings : sequence of Recording
        With speed, interference and support stiffness in their conditions.

    Returns
    -------
    parts : tuple of Recording
        What is settled is itself; repeats of a condition are of one length.
    notes : tuple of str
        What was left out, a line each.
    refused : dict of int to str
        Why nothing is left of a recording, by place; empty where that is so of all.

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
    kept = [i for i in range(len(recordings)) if i not in refused]
    n_kept = {i: _n_kept(recordings[i], starts[i]) for i in kept}
    for alike in _repeats(recordings, kept):
        fewest = min(n_kept[i] for i in alike)
        if fewest >= _SHORTENED * max(n_kept[i] for i in alike):
            n_kept |= dict.fromkeys(alike, fewest)
    parts = []
    cut: dict[str, list[tuple[str, float]]] = {}
    for i in kept:
        recording = recordings[i]
        first = recording.samples.shape[1] - n_kept[i]
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
    """Say of recordings how much was cut off for one reason [s]."""
    names = [name for name, _ in cut]
    which = joined(names) if len(names) <= _MOST_NAMED else f"{len(names)} recordings"
    ends = dict.fromkeys(f"{end(seconds for _, seconds in cut):.2g}" for end in (min, max))
    return f"{which}: the first {' to '.join(ends)} s, {why}, were left out"


def _n_kept(recording: Recording, start: float) -> int:
    """Count the samples that are kept of a recording."""
    n = int(recording.samples.shape[1])
    if start == 0.0:
        return n
    left = recording.duration - start
    rounded = _LENGTHS * float(np.floor((left - RINGING) / _LENGTHS + 1e-6))
    return min(n, math.ceil(max(rounded, shortest(recording.rate)) * recording.rate))


def _repeats(recordings: Sequence[Recording], kept: Sequence[int]) -> list[list[int]]:
    """Places of recordings whose conditions were stated alike."""
    alike: dict[tuple[object, ...], list[int]] = {}
    for i in kept:
        r, c = recordings[i], known_condition(recordings[i].condition)
        stated = (c.speed, c.interference, c.support_stiffness, r.rate, r.samples.shape[1])
        alike.setdefault(stated, []).append(i)
    return list(alike.values())


def _from(recording: Recording, first: int) -> Recording:
    """Return a recording from a sample on, its angle from zero."""
    if first == 0:
        return recording
    samples = recording.samples[:, first:].copy()
    for row, channel in enumerate(recording.channels):
        if channel.kind == "angle":
            samples[row] -= samples[row, 0]
    return replace(recording, samples=samples)
