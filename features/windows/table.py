# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""All features of the windows that begin in a part of a signal.

Windows of half a second begin every quarter of a second. The signal continues for half a second
after the start of the last window, so that parts have windows across their borders.

The features of a window with a squeal of 0.2 s would describe its onset, its end and the quiet
around it, like those of a background sound. So a short event is extended by reflection until it
fills the window. An event is a stretch that stands out from its surroundings in a half octave,
including the gaps between the blows of a creak. Events that fill a window, or are as short as a
blow, are not extended.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from features.table import WINDOW_FEATURES
from features.windows.blocks import FRAME_RATE, RATE
from features.windows.frames import FRAME_COLUMNS, Course, Frames, describe_frames
from features.windows.lines import Lines, segments_of
from features.windows.rhythm import ENVELOPE_RATE, envelope, rhythm_of
from models.compilation import COMPILED

LENGTH = 0.5
"""Duration of a window [s]."""

HOP = 0.25
"""Hop of windows [s]."""

_LEAST_FRAMES = 3

WINDOW_NAMES = tuple(feature.name for feature in WINDOW_FEATURES)
"""Names of the columns of `WindowTable.features`, from `features.table.WINDOW_FEATURES`."""


@dataclass(frozen=True, eq=False)
class WindowTable:
    """Features of the windows in a part of a signal, and its frames.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        By `WINDOW_NAMES`, each in its declared [unit]; NaN where undefined.
    level : ndarray of float32, shape (n_windows,)
        Level of each window [dB re the unit of the signal].
    frames : ndarray of float32, shape (n_frames, n_columns + n_bands)
        By `features.windows.frames.FRAME_COLUMNS`, then the bands, both re the signal's [unit].
    """

    features: NDArray[np.float32]
    level: NDArray[np.float32]
    frames: NDArray[np.float32]


def window_count(n: int) -> int:
    """Return the number of windows in `n` samples at 16 kHz; the last has half its length at least.

    Examples
    --------
    >>> window_count(16_000), window_count(100)
    (3, 1)
    """
    return max(1, -(-(n - round(HOP * RATE)) // round(HOP * RATE)))


def describe_windows(
    sound: NDArray[np.float32],
    high: NDArray[np.float32],
    *,
    scale: float,
    windows: int,
    limit: float,
) -> WindowTable:
    """Return the features of the windows that begin in a part of a signal.

    Parameters
    ----------
    sound, high : ndarray of float32, shape (n,)
        As in `features.windows.blocks.Block`, up to the end of the last window or of the
        recording.
    scale : float
        Unit of the two [unit of the signal].
    windows : int
        Number of windows.
    limit : float
        Upper frequency limit [Hz].

    Returns
    -------
    WindowTable

    Examples
    --------
    >>> hiss = np.random.default_rng(0).normal(size=16_000).astype(np.float32)
    >>> describe_windows(hiss, hiss, scale=1.0, windows=3, limit=7e3).features.shape[0]
    3
    """
    frames, power, half = describe_frames(sound, limit), envelope(sound), round(HOP * RATE)
    features = np.empty((windows, len(WINDOW_NAMES)), dtype=np.float32)
    which, *edges = events_within(frames.bands, np.arange(windows) * HOP)
    if which.size:
        # Neighbouring windows often contain the same event.
        events, of_event = np.unique(edges, axis=1, return_inverse=True)
        longer = prolonged((sound, high), events[0], events[1], 2 * half)
        inside, numbers = describe_frames(longer[0], limit), np.arange(events.shape[1])
        parts = _parts(longer, inside, envelope(longer[0]), numbers, _APART, limit)
        features[which] = _columns(parts, numbers.size)[of_event.reshape(-1)]
    rest = np.setdiff1d(np.arange(windows), which)
    whole = (rest + 2) * half <= sound.size
    # Only the last window may be shorter.
    for numbers in filter(len, (rest[whole], rest[~whole])):
        parts = _parts((sound, high), frames, power, numbers, _OVERLAPPING, limit)
        features[numbers] = _columns(parts, numbers.size)
    unit = 20.0 * np.log10(max(scale, 1e-300))
    level = _means(power, windows, round(HOP * ENVELOPE_RATE))
    values = np.concatenate([frames.values, frames.bands], axis=1)
    values[:, 0] += unit
    values[:, len(FRAME_COLUMNS) :] += unit
    return WindowTable(features, (10.0 * np.log10(level + 1e-20) + unit).astype(np.float32), values)


_FRAMES, _SEGMENTS, _POWERS = 47, 3, 2000
"""Numbers of frames, long spectra and envelope samples per window."""

_OVERLAPPING, _APART = (25, 2, 1000), (_FRAMES, _SEGMENTS, _POWERS)
"""Their hops between windows, in a sound and for windows in separate rows."""


def _parts(
    sounds: tuple[NDArray[np.float32], NDArray[np.float32]],
    frames: Frames,
    power: NDArray[np.float32],
    numbers: NDArray[np.int64],
    hops: tuple[int, int, int],
    limit: float,
) -> dict[str, Any]:
    """Return the parts of `features.table` for windows of equal length, by name.

    Frames and power are those of the sound; `numbers` are the indices of the windows.
    """
    sound, high = sounds
    segments, blows = segments_of(sound), envelope(high)

    def rows(kind: int, length: int, count: int) -> NDArray[np.int64]:
        first = numbers * hops[kind]
        return np.asarray(first[:, None] + np.arange(min(length, count - int(first[-1]))))

    of_frames = rows(0, _FRAMES, len(frames.values))
    of_power = rows(2, _POWERS, power.size)
    return {
        "course": Course(
            *(np.take(x.T, of_frames.T, axis=1) for x in (frames.values, frames.bands))
        )
        if of_frames.shape[1] >= _LEAST_FRAMES
        else None,
        "lines": Lines(segments, rows(1, _SEGMENTS, len(segments)), limit),
        "rhythm": rhythm_of(power[of_power]),
        "high": rhythm_of(blows[of_power]),
    }


def _columns(parts: dict[str, Any], count: int) -> NDArray[np.float32]:
    """Return the features of `count` windows as columns."""
    out = np.empty((count, len(WINDOW_FEATURES)), dtype=np.float32)
    for column, feature in enumerate(WINDOW_FEATURES):
        out[:, column] = feature.of(parts)
    return out


def _means(power: NDArray[np.float32], windows: int, hop: int) -> NDArray[np.float32]:
    """Return the mean power of each window from the sums of its two halves."""
    padded = np.zeros((windows + 1) * hop, dtype=np.float32)
    padded[: min(power.size, padded.size)] = power[: padded.size]
    halves = padded.reshape(windows + 1, hop).sum(axis=1)
    counts = np.clip(power.size - np.arange(windows) * hop, 1, 2 * hop)
    return np.asarray((halves[:-1] + halves[1:]) / counts, dtype=np.float32)


_SEARCH = 32
"""Samples in which a peak is searched: a period of 500 Hz."""

_BEFORE, _AFTER = 75, 125
"""Frames of the surroundings before and after the start of a window."""

_FLOOR = 0.2
"""Quantile of the levels of the surroundings that is their floor [-]."""

_RANGE_DB = 80.0
"""Maximum range of the floor below the loudest frame of a window [dB]."""

_RISE_DB = 8.0
"""Minimum level of an event above the floor [dB]."""

_DROP_DB = 14.0
"""Range of an event below its loudest frame [dB]."""

_GAP = 18
"""Maximum number of frames between blows of a creak."""

_LEAST, _MOST = 8, 40
"""Minimum and maximum number of frames of an extended event."""

_FROM_FIRST, _FROM_LAST = 0.024, 0.008
"""Offsets from the starts of the first and last frame of an event to its start and end [s]: a frame
of 32 ms stands out as soon as a third of it does."""


def events_within(
    bands: NDArray[np.float32], start: NDArray[np.floating]
) -> tuple[NDArray[np.intp], NDArray[np.int64], NDArray[np.int64]]:
    """Return the windows that are partly filled by an event.

    Parameters
    ----------
    bands : ndarray of float32, shape (n_frames, n_bands)
        Levels in half octaves [dB], from `features.windows.frames.describe_frames`; silence is
        assumed before and after.
    start : ndarray, shape (n_windows,)
        Start of each window [s].

    Returns
    -------
    which : ndarray of int, shape (n_events,)
        Windows with such an event; the longest one in each.
    begin, end : ndarray of int, shape (n_events,)
        First sample and end of the event at `features.windows.blocks.RATE`.

    Examples
    --------
    >>> bands = np.full((200, 11), -60.0, dtype=np.float32)
    >>> bands[110:130, 5] = -10.0
    >>> which, begin, end = events_within(bands, np.arange(7) * 0.25)
    >>> which.tolist(), (begin / RATE).round(2).tolist(), (end / RATE).round(2).tolist()
    ([3, 4], [1.12, 1.12], [1.3, 1.3])
    """
    first = np.round(start * FRAME_RATE).astype(np.int64)
    silence = np.full((_AFTER + _FRAMES, bands.shape[1]), -200.0, dtype=np.float32)
    around = np.concatenate([silence[:_BEFORE], bands, silence]).T
    size = _BEFORE + _AFTER
    context = np.lib.stride_tricks.sliding_window_view(around, size, axis=1)[:, first]
    inside = slice(_BEFORE, _BEFORE + _FRAMES)
    rank = int(_FLOOR * (size - 1))
    floor = np.partition(context, rank, axis=2)[:, :, rank]
    floor = np.maximum(floor, context[:, :, inside].max(axis=(0, 2)) - _RANGE_DB)
    above = (context - floor[:, :, None]).max(axis=0)
    ends = np.zeros((len(first), 2), dtype=np.int64)
    highest = above[:, inside].max(axis=1)
    _longest(above, highest, np.minimum(len(bands) - first, _FRAMES), ends)
    which = np.flatnonzero(ends[:, 1])
    begin, end = (ends[which] + (first[which] - _BEFORE)[:, None]).T
    hop = RATE // FRAME_RATE
    return (
        which,
        begin * hop + round(_FROM_FIRST * RATE),
        end * hop + round(_FROM_LAST * RATE),
    )


@njit(cache=True, **COMPILED)
def _longest(above, highest, inside, ends) -> None:
    """Fill in first and last frame of the longest event in each window, if there is one."""
    for w in range(above.shape[0]):
        start, stop = _BEFORE, _BEFORE + inside[w] - 1
        if highest[w] < _RISE_DB:
            continue
        least = max(_RISE_DB, highest[w] - _DROP_DB)
        longest, first, last = -1, -1, -1
        for i in range(above.shape[1] + 1):
            if i < above.shape[1] and above[w, i] < least:
                continue
            if first >= 0 and (i == above.shape[1] or i - last > _GAP):
                a, b = min(max(first, start), stop), min(max(last, start), stop)
                if b - a > longest:
                    longest = b - a
                    # As much of it as fits into a window, including the part in this window.
                    ends[w, 0] = max(first, b - _FRAMES)
                    ends[w, 1] = min(last, ends[w, 0] + _FRAMES)
                first = -1
            if first < 0:
                first = i
            last = i
        if not _LEAST <= longest <= _MOST:
            ends[w] = 0


def prolonged(
    parts: Sequence[NDArray[np.float32]],
    begin: NDArray[np.int64],
    end: NDArray[np.int64],
    length: int,
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return events extended by reflection to the length of a window.

    Parameters
    ----------
    parts : sequence of two ndarrays of float32
        Sound and high part, as in `features.windows.table.describe_windows`.
    begin, end : ndarray of int, shape (n_events,)
        Samples of the sound.
    length : int
        Length of a window [samples].

    Returns
    -------
    sound, high : ndarray of float32, shape (n_events, length)
        In the unit of the parts, such as [Pa].

    Examples
    --------
    >>> tone = np.cos(np.pi / 4 * np.arange(8000)).astype(np.float32)
    >>> longer = prolonged((tone, tone), np.array([317]), np.array([1700]), 8000)
    >>> np.allclose(longer[0][0], tone)
    True
    """
    # A tone that is reflected at a peak has no jump of phase.
    peaks = [
        (a + _highest(parts[0][a : a + _SEARCH]), b - _highest(parts[0][b - _SEARCH : b][::-1]))
        for a, b in zip(begin.tolist(), np.minimum(end, len(parts[0])).tolist(), strict=True)
    ]
    begin, end = np.array(peaks, dtype=np.int64).reshape(-1, 2).T
    sound, high = (part[_mirrored(begin, end, length, len(part))] for part in parts)
    return sound, high


def _mirrored(
    begin: NDArray[np.int64], end: NDArray[np.int64], length: int, n: int
) -> NDArray[np.int64]:
    """Return indices that run to and fro between `begin` and `end` or `n`, a row per event."""
    period = np.maximum(2 * (np.minimum(end, n) - begin - 1), 1)[:, None]
    step = np.arange(length) % period
    return np.asarray(begin[:, None] + np.minimum(step, period - step))


def _highest(samples: NDArray[np.float32]) -> int:
    return int(np.abs(samples).argmax())
