"""All features of the windows that begin in some seconds of signal, side by side.

Windows of half a second begin every quarter of a second. The signal goes on for half a second after
the last of them begins, so that what is cut into such chunks has windows across the cuts.

An event that fills a part of a window only is described as if it went on
(`features.windows.events`): its edges, and what surrounds it, say nothing of what sounds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from features.windows.blocks import FRAME_RATE, RATE
from features.windows.declared import TOP_FEATURES, WINDOW_FEATURES
from features.windows.events import events_within, prolonged
from features.windows.frames import FRAME_COLUMNS, Frames, describe_frames, trajectory_features
from features.windows.rhythm import ENVELOPE_RATE, envelope, rhythm_features
from features.windows.spectra import SEGMENT_HOP, long_spectra
from features.windows.tones import tone_features

LENGTH = 0.5
"""Of a window [s]."""

HOP = 0.25
"""From the beginning of a window to that of the next [s]."""

_LEAST_FRAMES = 3

_FRAMES_OF = round(LENGTH * FRAME_RATE) - 3
"""Frames that lie in a window as a whole."""

_FLUX = FRAME_COLUMNS.index("flux")

WINDOW_NAMES = tuple(feature.name for feature in WINDOW_FEATURES)
"""Of the columns of `WindowTable.features`, by `features.windows.declared.WINDOW_FEATURES`."""


@dataclass(frozen=True, eq=False)
class WindowTable:
    """Windows of some seconds of signal, and the frames that they are made of.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        By `WINDOW_NAMES`, each in its declared [unit]; NaN where undefined.
    level : ndarray of float32, shape (n_windows,)
        Power of each window [dB re the signal's unit].
    frames : ndarray of float32, shape (n_frames, n_columns + n_bands)
        By `features.windows.frames.FRAME_COLUMNS`, then the bands, both re the signal's [unit].
    """

    features: NDArray[np.float32]
    level: NDArray[np.float32]
    frames: NDArray[np.float32]


def window_count(n: int) -> int:
    """Return how many windows begin in `n` samples at 16 kHz: the last holds half its length.

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
    """Describe the windows that begin in some seconds of signal.

    Parameters
    ----------
    sound, high : ndarray of float32, shape (n,)
        As `features.windows.blocks.Block` has them, with what follows as far as the last window
        reaches and the recording goes.
    top : ndarray of float32, shape (n_frames, 2)
        As of `features.windows.blocks.Block` too.
    scale : float
        Unit of the three [unit of the signal].
    windows : int
        How many begin in them.
    limit : float
        Frequency up to which it is described [Hz].

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
    start = np.arange(windows) * HOP
    frames = describe_frames(sound, limit)
    power = envelope(sound)
    features = _features(frames, power, (sound, high, top), start, limit)
    which, begin, end = events_within(frames.bands, start)
    if which.size:
        longer = prolonged((sound, high, top), begin, end, round(LENGTH * RATE))
        apart = np.arange(which.size) * LENGTH
        of_events = describe_frames(longer[0], limit)
        # The first frame of an event has none before it.
        at = np.round(apart * FRAME_RATE).astype(np.int64)
        of_events.values[at, _FLUX] = of_events.values[at + 1, _FLUX]
        features[which] = _features(of_events, envelope(longer[0]), longer, apart, limit)
    unit = 20.0 * np.log10(max(scale, 1e-300))
    level = _means(power, windows, round(HOP * ENVELOPE_RATE))
    values = np.concatenate([frames.values, frames.bands], axis=1)
    values[:, 0] += unit
    values[:, len(FRAME_COLUMNS) :] += unit
    return WindowTable(features, (10.0 * np.log10(level + 1e-20) + unit).astype(np.float32), values)


def _features(
    frames: Frames,
    power: NDArray[np.float32],
    parts: tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]],
    start: NDArray[np.floating],
    limit: float,
) -> NDArray[np.float32]:
    """Return the features of windows that begin at `start` [s] in sound, its high part and top."""
    sound, high, top = parts
    count = len(frames.values)
    first = np.minimum(np.round(start * FRAME_RATE).astype(np.int64), count - 1)
    last = np.minimum(first + _FRAMES_OF, count)
    spectra = max(1, -(-(sound.size - SEGMENT_HOP) // SEGMENT_HOP))
    of_spectra = np.minimum((start * (RATE // SEGMENT_HOP)).astype(np.int64), spectra - 1)
    until = np.minimum(of_spectra + 3, spectra)
    blows = envelope(high)
    begin = np.minimum((start * ENVELOPE_RATE).astype(np.int64), power.size)
    end = np.minimum(begin + round(LENGTH * ENVELOPE_RATE), power.size)
    return np.concatenate(
        [
            trajectory_features(frames, first, last),
            tone_features(long_spectra(sound, spectra), of_spectra, until, limit),
            rhythm_features(power, begin, end),
            rhythm_features(blows, begin, end),
            _tops(top, power, blows, np.round(start * FRAME_RATE).astype(np.int64)),
        ],
        axis=1,
    )


def _tops(
    top: NDArray[np.float32],
    power: NDArray[np.float32],
    blows: NDArray[np.float32],
    first: NDArray[np.int64],
) -> NDArray[np.float32]:
    per_frame = ENVELOPE_RATE // FRAME_RATE
    n = min(len(top), power.size // per_frame)
    out = np.full((first.size, len(TOP_FEATURES)), np.nan, dtype=np.float32)
    length = round(LENGTH * FRAME_RATE)
    below = power[: n * per_frame].reshape(n, per_frame).mean(axis=1)
    high = blows[: n * per_frame].reshape(n, per_frame).mean(axis=1)
    columns = np.stack([below, high, top[:n, 0], top[:n, 1]], axis=1)
    whole = first + length <= n
    if whole.any():
        rows = np.lib.stride_tricks.sliding_window_view(columns, length, axis=0)[first[whole]]
        out[whole] = _top_features(rows)
    for w in np.flatnonzero(~whole & (n - first >= _LEAST_FRAMES)).tolist():
        out[w] = _top_features(columns[first[w] :].T[None])[0]
    return out


def _top_features(rows: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return `TOP_FEATURES` from power below 7 kHz, above 2 kHz and in the two bands.

    Rows are of shape (n_windows, 4, n_frames).
    """
    sums = rows.sum(axis=2)
    total = np.where(sums[:, 0] > 0.0, sums[:, 0], np.float32(np.nan))
    shares = 10.0 * np.log10(np.maximum(sums[:, 1:] / total[:, None], np.float32(1e-6)))
    a, b = np.sqrt(rows[:, 2]), np.sqrt(rows[:, 1])
    a = a - a.mean(axis=1, keepdims=True)
    b = b - b.mean(axis=1, keepdims=True)
    spread = np.sqrt((a * a).sum(axis=1) * (b * b).sum(axis=1))
    together = (a * b).sum(axis=1) / np.where(spread > 0.0, spread, np.float32(np.nan))
    return np.stack([shares[:, 1], shares[:, 2], together, shares[:, 0]], axis=1)


def _means(power: NDArray[np.float32], windows: int, hop: int) -> NDArray[np.float32]:
    """Mean power of each window from the sums of its two halves."""
    padded = np.zeros((windows + 1) * hop, dtype=np.float32)
    padded[: min(power.size, padded.size)] = power[: padded.size]
    halves = padded.reshape(windows + 1, hop).sum(axis=1)
    counts = np.clip(power.size - np.arange(windows) * hop, 1, 2 * hop)
    return np.asarray((halves[:-1] + halves[1:]) / counts, dtype=np.float32)
