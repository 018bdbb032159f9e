"""What is seen of a stretch of sound: its outline, its spectrogram, a line in it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.app.sounds.stretch import number, read_stretch
from noise.audio.spectrogram import HIGHEST, LOWEST, Grid, spectrogram as levels_of, strongest_line

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from noise.app.sounds.sound_cache import Track

    Query = Mapping[str, str]
    Facts = dict[str, object]

__all__ = ["line", "outline", "spectrogram"]

_STEP = 0.5
"""Of levels in bytes [dB]."""

_ROUND = 5.0
"""The level of the highest byte is a multiple of it [dB]."""

_WINDOW = (0.01, 0.04)
"""Shortest and longest frame, where none is asked for [s]."""

_COLUMNS = 8.0
"""That a frame covers in between [-]."""

_SHORTEST, _LONGEST = 64, 1 << 15
"""Of frames [samples]."""

_NEAR = 0.03
"""How far from the cursor a line is looked for, at least [ratio of frequencies]."""


def outline(track: Track, query: Query) -> tuple[Facts, NDArray[np.float32]]:
    """Return the lowest and the highest sample in each column, shape (2, width)."""
    stretch = read_stretch(query, track)
    width = min(stretch.n, int(number(query, "width", 1000, 1, 4000)))
    edges = np.linspace(stretch.first, stretch.last, width + 1).astype(int)
    ends = np.empty((2, width), np.float32)
    columns = max(1, (1 << 22) * width // stretch.n)  # read at once
    for column in range(0, width, columns):
        part = edges[column : column + columns + 1]
        samples = track.read(int(part[0]), int(part[-1]))
        for row, extreme in enumerate((np.minimum, np.maximum)):
            ends[row, column : column + columns] = extreme.reduceat(samples, part[:-1] - part[0])
    facts: Facts = {"start": stretch.start, "end": stretch.end, "unit": track.unit}
    return facts, ends


def spectrogram(track: Track, query: Query) -> tuple[Facts, NDArray[np.uint8]]:
    """Return levels in steps, the highest frequency first, shape (height, width)."""
    stretch = read_stretch(query, track)
    lowest, highest = _frequencies(track, query)
    width = int(number(query, "width", 1000, 16, 4000))
    height = int(number(query, "height", 256, 16, 1024))
    length = _frame(track, query, stretch.n / width)
    grid = Grid(stretch.first, stretch.last, width, height, lowest, highest, length, padding=2)
    levels = levels_of(track.read, track.n, track.rate, track.reference, grid)
    top = _ROUND * math.ceil(float(levels.max()) / _ROUND)
    floor = top - 255 * _STEP
    facts: Facts = {
        "start": stretch.start,
        "end": stretch.end,
        "low": lowest,
        "high": highest,
        "width": width,
        "height": height,
        "floor": floor,
        "step": _STEP,
        "unit": track.level_unit,
        "window_s": length / track.rate,
    }
    return facts, np.clip(np.rint((levels - floor) / _STEP), 0, 255).astype(np.uint8)


def line(track: Track, query: Query) -> Facts:
    """Return the strongest line near a moment and a frequency, measured in one frame."""
    lowest, highest = _frequencies(track, query)
    time = number(query, "time", 0.0, 0.0, track.duration)
    frequency = number(query, "frequency", 1000.0, lowest, highest)
    length = _frame(track, query, number(query, "column", 0.01, 0.0, 1e6) * track.rate)
    near = max(_NEAR * frequency, 2.0 * track.rate / length)
    found = strongest_line(
        track.read,
        track.n,
        track.rate,
        track.reference,
        middle=round(time * track.rate),
        length=length,
        low=frequency - near,
        high=frequency + near,
    )
    if found is None:
        return {"frequency_hz": None, "level_db": None}
    return {"frequency_hz": found.frequency, "level_db": found.level}


def _frequencies(track: Track, query: Query) -> tuple[float, float]:
    nyquist = 0.5 * track.rate
    highest = number(query, "high", min(HIGHEST, nyquist), 0.0, nyquist)
    lowest = number(query, "low", min(LOWEST, 0.01 * highest), 0.0, nyquist)
    if not 0.0 < lowest < highest:
        raise ParameterError(f"low {lowest:g} Hz: must be above zero and below high {highest:g} Hz")
    return lowest, highest


def _frame(track: Track, query: Query, column: float) -> int:
    """Return the power of two that is nearest to what is asked for [samples]."""
    shortest, longest = (seconds * track.rate for seconds in _WINDOW)
    found = min(max(_COLUMNS * column, shortest), longest)
    wanted = number(query, "window", found / track.rate, 1e-6, 1e3) * track.rate
    return 1 << round(math.log2(min(max(wanted, _SHORTEST), _LONGEST)))
