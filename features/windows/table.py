"""All features of the windows that begin in a part of a signal.

Windows of half a second begin every quarter of a second. The signal continues for half a second
after the start of the last window, so that parts have windows across their borders.

A short event in a window is extended before it is described (`features.windows.events`), so that
its edges and surroundings do not affect the features.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from features.table import WINDOW_FEATURES
from features.windows.blocks import FRAME_RATE, RATE
from features.windows.events import events_within, prolonged
from features.windows.frames import FRAME_COLUMNS, Course, Frames, describe_frames
from features.windows.lines import Lines, segments_of
from features.windows.rhythm import ENVELOPE_RATE, envelope, rhythm_of

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
    top: NDArray[np.float32],
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
    top : ndarray of float32, shape (n_frames, 2)
        As in `features.windows.blocks.Block`.
    scale : float
        Unit of the three [unit of the signal].
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
    >>> nothing = np.full((100, 2), np.nan, dtype=np.float32)
    >>> describe_windows(hiss, hiss, nothing, scale=1.0, windows=3, limit=7e3).features.shape[0]
    3
    """
    frames, power, half = describe_frames(sound, limit), envelope(sound), round(HOP * RATE)
    features = np.empty((windows, len(WINDOW_NAMES)), dtype=np.float32)
    which, *edges = events_within(frames.bands, np.arange(windows) * HOP)
    if which.size:
        # Neighbouring windows often contain the same event.
        events, of_event = np.unique(edges, axis=1, return_inverse=True)
        longer = prolonged((sound, high, top), events[0], events[1], 2 * half)
        inside, numbers = describe_frames(longer[0], limit), np.arange(events.shape[1])
        parts = _parts(longer, inside, envelope(longer[0]), numbers, _APART, limit)
        features[which] = _columns(parts, numbers.size)[of_event.reshape(-1)]
    rest = np.setdiff1d(np.arange(windows), which)
    whole = (rest + 2) * half <= sound.size
    # Only the last window may be shorter.
    for numbers in filter(len, (rest[whole], rest[~whole])):
        parts = _parts((sound, high, top), frames, power, numbers, _OVERLAPPING, limit)
        features[numbers] = _columns(parts, numbers.size)
    unit = 20.0 * np.log10(max(scale, 1e-300))
    level = _means(power, windows, round(HOP * ENVELOPE_RATE))
    values = np.concatenate([frames.values, frames.bands], axis=1)
    values[:, 0] += unit
    values[:, len(FRAME_COLUMNS) :] += unit
    return WindowTable(features, (10.0 * np.log10(level + 1e-20) + unit).astype(np.float32), values)


_FRAMES, _SEGMENTS, _POWERS, _TOPS = 47, 3, 2000, 50
"""Numbers of frames, long spectra, envelope samples and values above 7 kHz per window."""

_OVERLAPPING, _APART = (25, 2, 1000, 25), (_FRAMES, _SEGMENTS, _POWERS, _TOPS)
"""Their hops between windows, in a sound and for windows in separate rows."""


def _parts(
    sounds: tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]],
    frames: Frames,
    power: NDArray[np.float32],
    numbers: NDArray[np.int64],
    hops: tuple[int, int, int, int],
    limit: float,
) -> dict[str, Any]:
    """Return the parts of `features.table` for windows of equal length, by name.

    Frames and power are those of the sound; `numbers` are the indices of the windows.
    """
    sound, high, top = sounds
    segments, blows = segments_of(sound), envelope(high)
    above = _above(top.reshape(-1, top.shape[-1]), power, blows)

    def rows(kind: int, length: int, count: int) -> NDArray[np.int64]:
        first = numbers * hops[kind]
        return np.asarray(first[:, None] + np.arange(min(length, count - int(first[-1]))))

    of_frames = rows(0, _FRAMES, len(frames.values))
    of_power, size = rows(2, _POWERS, power.size), min(power.size, _POWERS)
    of_above = rows(3, _TOPS, len(above))
    return {
        "course": Course(
            *(np.take(x.T, of_frames.T, axis=1) for x in (frames.values, frames.bands))
        )
        if of_frames.shape[1] >= _LEAST_FRAMES
        else None,
        "lines": Lines(segments, rows(1, _SEGMENTS, len(segments)), limit),
        "rhythm": rhythm_of(power[of_power], size),
        "high": rhythm_of(blows[of_power], size),
        "top": Top(above[of_above]) if of_above.shape[1] >= _LEAST_FRAMES else None,
    }


def _columns(parts: dict[str, Any], count: int) -> NDArray[np.float32]:
    """Return the features of `count` windows as columns."""
    out = np.empty((count, len(WINDOW_FEATURES)), dtype=np.float32)
    for column, feature in enumerate(WINDOW_FEATURES):
        out[:, column] = feature.of(parts)
    return out


def _above(
    top: NDArray[np.float32], power: NDArray[np.float32], blows: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return the power below 7 kHz, above 2 kHz and in the two bands every 10 ms."""
    each = ENVELOPE_RATE // FRAME_RATE
    n = min(len(top), power.size // each)
    means = [part[: n * each].reshape(n, each).mean(axis=1) for part in (power, blows)]
    return np.stack([*means, *top[:n].T], axis=1)


class Top:
    """Features of the power above 7 kHz in windows, for `features.table`.

    Parameters
    ----------
    above : ndarray of float32, shape (n_windows, n, 4)
        Power below 7 kHz, above 2 kHz and in two bands above 7 kHz [unit^2].

    Examples
    --------
    >>> Top(np.ones((1, 50, 4), dtype=np.float32)).shares.tolist()
    [[0.0], [0.0], [0.0]]
    """

    def __init__(self, above: NDArray[np.float32]) -> None:
        rows = np.ascontiguousarray(above.transpose(0, 2, 1))
        sums = rows.sum(axis=2)
        total = np.where(sums[:, 0] > 0.0, sums[:, 0], np.float32(np.nan))
        self.shares = 10.0 * np.log10(np.maximum(sums[:, 1:] / total[:, None], np.float32(1e-6))).T
        a, b = np.sqrt(rows[:, 2]), np.sqrt(rows[:, 1])
        a = a - a.mean(axis=1, keepdims=True)
        b = b - b.mean(axis=1, keepdims=True)
        spread = np.sqrt((a * a).sum(axis=1) * (b * b).sum(axis=1))
        self.together = (a * b).sum(axis=1) / np.where(spread > 0.0, spread, np.float32(np.nan))


def _means(power: NDArray[np.float32], windows: int, hop: int) -> NDArray[np.float32]:
    """Return the mean power of each window from the sums of its two halves."""
    padded = np.zeros((windows + 1) * hop, dtype=np.float32)
    padded[: min(power.size, padded.size)] = power[: padded.size]
    halves = padded.reshape(windows + 1, hop).sum(axis=1)
    counts = np.clip(power.size - np.arange(windows) * hop, 1, 2 * hop)
    return np.asarray((halves[:-1] + halves[1:]) / counts, dtype=np.float32)
