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
from features.windows.spectra import segments_of
from features.windows.tones import tone_features

LENGTH = 0.5
"""Of a window [s]."""

HOP = 0.25
"""From the beginning of a window to that of the next [s]."""

_LEAST_FRAMES = 3

_FRAMES_OF = round(LENGTH * FRAME_RATE) - 3
"""Frames that lie in a window as a whole."""

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
    frames = describe_frames(sound, limit)
    power = envelope(sound)
    features = np.empty((windows, len(WINDOW_NAMES)), dtype=np.float32)
    which, *edges = events_within(frames.bands, np.arange(windows) * HOP)
    if which.size:
        # Neighbouring windows often hold the same event.
        events, of_event = np.unique(edges, axis=1, return_inverse=True)
        longer = prolonged((sound, high, top), *events, round(LENGTH * RATE))
        numbers = np.arange(events.shape[1])
        frames_inside = describe_frames(longer[0], limit)
        power_inside = envelope(longer[0])
        features[which] = _features(longer, frames_inside, power_inside, numbers, _APART, limit)[
            of_event.reshape(-1)
        ]
    rest = np.setdiff1d(np.arange(windows), which)
    if rest.size:
        features[rest] = _features((sound, high, top), frames, power, rest, _OVERLAPPING, limit)
    unit = 20.0 * np.log10(max(scale, 1e-300))
    level = _means(power, windows, round(HOP * ENVELOPE_RATE))
    values = np.concatenate([frames.values, frames.bands], axis=1)
    values[:, 0] += unit
    values[:, len(FRAME_COLUMNS) :] += unit
    return WindowTable(features, (10.0 * np.log10(level + 1e-20) + unit).astype(np.float32), values)


_OVERLAPPING, _APART = (25, 2, 1000, 25), (_FRAMES_OF, 3, 2000, 50)
"""Frames, long spectra, samples of the envelope and values of the top from one window to the next:
by half a window in a sound, by a whole one where each window is a row of its own."""


def _features(
    parts: tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]],
    frames: Frames,
    power: NDArray[np.float32],
    windows: NDArray[np.int64],
    hops: tuple[int, int, int, int],
    limit: float,
) -> NDArray[np.float32]:
    """Return the features of windows by number in sound, its high part and top.

    Its frames and envelope are those of the sound.
    """
    sound, high, top = parts
    segments, blows = segments_of(sound), envelope(high)
    # What lies behind the end of the sound is not there.
    at, segment, begin = (
        np.minimum(windows * hop, max(count - 1, 0))
        for hop, count in zip(hops, (len(frames.values), len(segments), power.size), strict=False)
    )
    last = np.minimum(begin + round(LENGTH * ENVELOPE_RATE), power.size)
    return np.concatenate(
        [
            trajectory_features(frames, at, np.minimum(at + _FRAMES_OF, len(frames.values))),
            tone_features(segments, segment, np.minimum(segment + 3, len(segments)), limit),
            rhythm_features(power, begin, last),
            rhythm_features(blows, begin, last),
            _tops(top.reshape(-1, top.shape[-1]), power, blows, windows * hops[3]),
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
    below, high = (
        part[: n * per_frame].reshape(n, per_frame).mean(axis=1) for part in (power, blows)
    )
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
