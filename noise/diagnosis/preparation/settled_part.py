"""The settled part of recordings: a start from rest, a run-up or a swing of the drive is left out.

A start is a deviation of the speed from what it is later that is there at the beginning, ends, and
is several times larger than whatever the speed does afterwards. A speed that fluctuates all the
time therefore stays as it is, and so does a short dip in the middle. The shaft's angle tells it;
where there is none, a torque that rises from zero tells a start from rest, and the rate of slips
the rest. The angle is read where it crosses the steps of its converter, so that a coarse one tells
as much as a fine one.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from models.condition import known_condition
from noise.diagnosis.evidence.channel_summary import segment_frequency
from noise.diagnosis.evidence.reconstruction import LEAD, TAIL

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from models.recording import Recording

__all__ = ["settled_parts", "shortest", "start_of"]

_SHORTEST = LEAD + TAIL + 0.1
"""Shorter recordings show too few cycles [s]."""

_PATH_ENDS = 0.09
"""Without its ends a recording has at least one segment of the spectra of
`noise.diagnosis.evidence.path_summary` [s]."""

RINGING = 0.06
"""In which a clamp that rings has come to rest after the speed has [s]: three time constants of the
thesis's, 2 J_C / c."""

_BLOCK, _LAG = 5e-3, 2
"""Of which an angle is averaged [s], and blocks to either side that a speed is the slope of."""

_LATE = 0.6
"""Share of a recording after which a start is over [-]."""

_EARLY = 0.08
"""Within which a start shows [s]; a quarter of the slowest swing of a controller and more."""

_SMALLEST, _LARGER = 0.04, 4.0
"""Deviation of the speed that is a start [-], and how many times what comes after it at least."""

_OVER = 0.012
"""Deviation of the speed that is none any more [-]."""

_FEWEST_LEVELS = 8
"""Of an angle that is read between them."""

_FROM_ZERO = 0.25
"""Share of its lowest torque later at which the torque of a shaft that starts from rest begins."""

_LENGTHS = 0.05
"""Parts have lengths in such steps [s]: what is simulated for one then serves for others."""

_SHORTENED = 0.5
"""Share that a recording keeps at least where it is shortened to the length of its repeat."""


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
    parts, notes = [], []
    for i in kept:
        recording = recordings[i]
        first = recording.samples.shape[1] - n_kept[i]
        parts.append(_from(recording, first))
        if first:
            why = "as it is of another recording of its condition"
            if starts[i]:
                why = "in which the shaft comes to its speed"
                if too_short:
                    why += " and beyond which too little is left"
            name = recording.name or f"recording {i + 1}"
            notes.append(f"{name}: the first {first / recording.rate:.2g} s, {why}, were left out")
    return tuple(parts), tuple(notes), refused


def start_of(recording: Recording) -> float:
    """Return when the shaft of a recording has come to its speed; 0 where it always has [s].

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> even = np.linspace(0.0, 1.0, 30_000)[None]
    >>> start_of(Recording(even, 30e3, (Channel("angle"),)))
    0.0
    """
    row = recording.first("angle")
    found = 0.0 if row is None else _start_by_angle(recording.samples[row], recording.rate)
    row = recording.first("torque")
    if row is not None:
        found = max(found, _start_by_torque(recording.samples[row], recording.rate))
    return found


def _start_by_angle(angle: NDArray[np.float64], rate: float) -> float:
    block = max(1, round(_BLOCK * rate))
    n = angle.size // block
    turned = angle * (1.0 if angle[-1] >= angle[0] else -1.0)
    means = _continuous(turned)[: n * block].reshape(n, block).mean(axis=1)
    if n < 8 * _LAG:
        return 0.0
    at = np.arange(n)
    after, before = np.minimum(at + _LAG, n - 1), np.maximum(at - _LAG, 0)
    speed = (means[after] - means[before]) / (after - before)
    late = speed[round(_LATE * n) :].mean()
    if late <= 0.0:
        return 0.0
    away = np.abs(speed / late - 1.0)
    beyond = np.maximum.accumulate(away[::-1])[::-1]  # the largest from each block on
    usual = beyond[round(_LATE * n)]
    settled = int(np.argmax(beyond <= max(_OVER, 1.2 * usual)))
    early = away[: max(1, round(_EARLY / _BLOCK))].max()
    largest = away[:settled].max(initial=0.0)
    limit = max(_SMALLEST, _LARGER * beyond[settled])
    if settled == 0 or largest < limit or early < 0.5 * limit:
        return 0.0
    return min((settled + _LAG) * block, angle.size) / rate


def _continuous(angle: NDArray[np.float64]) -> NDArray[np.float64]:
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


def _start_by_torque(torque: NDArray[np.float64], rate: float) -> float:
    """When a torque that begins at zero has come to where it stays."""
    turned = torque * (1.0 if torque.mean() >= 0.0 else -1.0)
    late = turned[round(_LATE * turned.size) :]
    lowest = float(np.quantile(late, 0.01))
    n = max(1, round(1e-3 * rate))
    if lowest <= 0.0 or np.abs(turned[:n]).mean() > _FROM_ZERO * lowest:
        return 0.0
    return float(np.argmax(turned >= lowest)) / rate


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
