# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Short events in windows: detection, and extension to the length of a window.

The features of a window with a squeal of 0.2 s would describe its onset, its end and the quiet
around it, like those of a background sound. So the event is extended by reflection until it fills
the window. An event is a stretch that stands out from its surroundings in a half octave, including
the gaps between the blows of a creak. Events that fill a window, or are as short as a blow, are not
extended.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from features.windows.blocks import FRAME_RATE, RATE
from models.compilation import COMPILED

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

_OF_WINDOW = 47
"""Number of whole frames in a window."""

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
    silence = np.full((_AFTER + _OF_WINDOW, bands.shape[1]), -200.0, dtype=np.float32)
    around = np.concatenate([silence[:_BEFORE], bands, silence]).T
    size = _BEFORE + _AFTER
    context = np.lib.stride_tricks.sliding_window_view(around, size, axis=1)[:, first]
    inside = slice(_BEFORE, _BEFORE + _OF_WINDOW)
    rank = int(_FLOOR * (size - 1))
    floor = np.partition(context, rank, axis=2)[:, :, rank]
    floor = np.maximum(floor, context[:, :, inside].max(axis=(0, 2)) - _RANGE_DB)
    above = (context - floor[:, :, None]).max(axis=0)
    ends = np.zeros((len(first), 2), dtype=np.int64)
    highest = above[:, inside].max(axis=1)
    _longest(above, highest, np.minimum(len(bands) - first, _OF_WINDOW), ends)
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
                    ends[w, 0] = max(first, b - _OF_WINDOW)
                    ends[w, 1] = min(last, ends[w, 0] + _OF_WINDOW)
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
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """Return events extended by reflection to the length of a window.

    Parameters
    ----------
    parts : sequence of three ndarrays of float32
        Sound, high part and top, as in `features.windows.table.describe_windows`.
    begin, end : ndarray of int, shape (n_events,)
        Samples of the sound.
    length : int
        Length of a window [samples].

    Returns
    -------
    sound, high, top : ndarray of float32
        Of shape (n_events, length) twice and (n_events, n_frames, 2), in the unit of the parts,
        such as [Pa].

    Examples
    --------
    >>> tone = np.cos(np.pi / 4 * np.arange(8000)).astype(np.float32)
    >>> top = np.zeros((50, 2), dtype=np.float32)
    >>> longer = prolonged((tone, tone, top), np.array([317]), np.array([1700]), 8000)
    >>> np.allclose(longer[0][0], tone), longer[2].shape
    (True, (1, 50, 2))
    """
    hop = RATE // FRAME_RATE
    # A tone that is reflected at a peak has no jump of phase.
    peaks = [
        (a + _highest(parts[0][a : a + _SEARCH]), b - _highest(parts[0][b - _SEARCH : b][::-1]))
        for a, b in zip(begin.tolist(), np.minimum(end, len(parts[0])).tolist(), strict=True)
    ]
    begin, end = np.array(peaks, dtype=np.int64).reshape(-1, 2).T
    first = begin // hop
    sound, high = (part[_mirrored(begin, end, length, len(part))] for part in parts[:2])
    last = np.maximum(end // hop, first + 2)
    return sound, high, parts[2][_mirrored(first, last, length // hop, len(parts[2]))]


def _mirrored(
    begin: NDArray[np.int64], end: NDArray[np.int64], length: int, n: int
) -> NDArray[np.int64]:
    """Return indices that run to and fro between `begin` and `end` or `n`, a row per event."""
    period = np.maximum(2 * (np.minimum(end, n) - begin - 1), 1)[:, None]
    step = np.arange(length) % period
    return np.asarray(begin[:, None] + np.minimum(step, period - step))


def _highest(samples: NDArray[np.float32]) -> int:
    return int(np.abs(samples).argmax())
