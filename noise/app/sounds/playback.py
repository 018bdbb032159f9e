"""What is heard of a recording, and how loud it is: samples to play, levels over time, in bands.

Samples are played by a page that has one gain for all calibrated sounds, so they are given as
floating-point numbers, in pascals where these are known. The meters are those of the label table.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.levels import a_weighted, fast_levels, sound_levels
from noise.app.sounds.stretch import number, read_stretch
from noise.audio.gain import LOUDNESS_BLOCK, loudness
from noise.audio.sound import playable
from noise.recordings.wav import wav_bytes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from noise.app.sounds.sound_cache import Track

    Query = Mapping[str, str]

__all__ = ["bands", "equal", "level_course", "wav"]

_RATE = 48000
"""Of samples to play [Hz]."""

_LONGEST = 600.0
"""Played from one answer [s]."""

_CELL = 0.01
"""Of levels over time: the largest in each is given [s]."""

_MOST_CELLS = 6000
"""Of one recording: where it is longer, so is a cell."""

_PIECE, _BEFORE, _AFTER = 60.0, 2.0, 0.2
"""Weighted at once, and what is read before and after it: a meter has forgotten what was 2 s ago,
which has fallen by 69 dB [s]."""

_LONGEST_BANDS = 120.0
"""Of a stretch whose bands are measured [s]."""


def wav(track: Track, query: Query) -> bytes:
    """Return a stretch as a WAV file of floats: pascals, or the channel's own unit."""
    stretch = read_stretch(query, track, _LONGEST)
    full_scale = number(query, "full_scale", 1.0, 1e-12, 1e12)
    sound = playable(track.read(stretch.first, stretch.last), track.rate, _RATE)
    return wav_bytes(sound / full_scale, _RATE, 32)


def level_course(track: Track) -> dict[str, object]:
    """Return the A-weighted level with the time weighting F, cell by cell."""
    cell = max(_CELL, track.duration / _MOST_CELLS)
    count = math.ceil(track.duration / cell)
    edges = np.minimum(np.rint(np.arange(count + 1) * cell * track.rate).astype(int), track.n)
    edges = np.unique(np.append(edges, track.n))
    levels: list[float] = []
    cells = max(1, round(_PIECE / cell))
    for at in range(0, edges.size - 1, cells):
        part = edges[at : at + cells + 1]
        first = max(0, int(part[0]) - round(_BEFORE * track.rate))
        last = min(track.n, int(part[-1]) + round(_AFTER * track.rate))
        weighted = a_weighted(track.read(first, last), track.rate)
        fast = fast_levels(weighted, track.rate, part - first, reference=track.reference)
        levels += fast.tolist()
    return {
        "cell_s": cell,
        "unit": _weighted(track),
        "levels": [_plain(level) for level in levels],
    }


def bands(track: Track, query: Query) -> dict[str, object]:
    """Return levels and third octaves of a stretch, as the tables have them."""
    stretch = read_stretch(query, track, _LONGEST_BANDS)
    signal = track.read(stretch.first, stretch.last)
    found = sound_levels(signal, track.rate, reference=track.reference)
    return {
        "start": stretch.start,
        "end": stretch.end,
        "unit": track.level_unit,
        "level": _plain(found.level),
        "level_a": _plain(found.level_a),
        "level_af_max": _plain(found.level_af_max),
        "third_octaves": {band: _plain(level) for band, level in found.third_octaves.items()},
    }


def equal(track: Track, query: Query) -> dict[str, object]:
    """Return the loudness of a stretch, and its peak, re one unit of its samples.

    The loudness is None for what is too short or too quiet to have one.
    """
    stretch = read_stretch(query, track, _LONGEST)
    sound = playable(track.read(stretch.first, stretch.last), track.rate, _RATE)
    peak = float(np.abs(sound).max(initial=0.0))
    known = None
    if peak > 0.0 and sound.size >= LOUDNESS_BLOCK * _RATE:
        # The gate is absolute, so it is put where a sound that just does not clip has it.
        known = _plain(loudness(sound / peak, _RATE) + 20.0 * math.log10(peak))
    return {"loudness": known, "peak": peak}


def _weighted(track: Track) -> str:
    return "dBFS(A)" if track.in_full_scale else track.level_unit.replace("dB", "dB(A)", 1)


def _plain(level: float) -> float | None:
    """Return a level as JSON can hold it; None for silence, and for what is not measured."""
    return round(level, 2) if math.isfinite(level) else None
