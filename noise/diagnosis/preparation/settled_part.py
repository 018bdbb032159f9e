"""The settled part of recordings: a start from rest, a run-up or a swing of the drive is left out.

What is settled stays to the bit. What is left of the rest has one of a few lengths, so that what is
simulated for one recording serves for others, and repeats of a condition stay comparable.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from models.condition import known_condition
from noise.diagnosis.evidence.bands import segment_frequency
from noise.diagnosis.evidence.reconstruction import LEAD, TAIL
from noise.diagnosis.preparation.start import start_of
from noise.diagnosis.text.words import joined

if TYPE_CHECKING:
    from models.recording import Recording


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
