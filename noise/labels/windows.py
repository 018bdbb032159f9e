"""Features of all windows of a recording, computed page by page.

Blocks lie on a grid from the start of the recording, and a page has three blocks. So features are
the same from memory and from a file, and memory does not grow with the duration.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from features.kernels.conditioning import USABLE_SHARE, WORKING_LIMIT
from features.prepared import ACOUSTIC_KINDS, prepare
from features.table import KINDS, feature_names, features_of
from features.windows.blocks import FRAME_RATE, MARGIN, RATE, Block, block_length, resampled_block
from features.windows.table import (
    HOP,
    LENGTH,
    WINDOW_NAMES,
    WindowTable,
    describe_windows,
    window_count,
)
from models.errors import ParameterError
from models.recording import RecordingBlocks
from noise.classifier.model import Classifier

FEATURE_NAMES = (
    *(f"{kind}_{name}" for kind in ACOUSTIC_KINDS for name in WINDOW_NAMES),
    *(f"torque_{name}" for name in feature_names("torque")),
)
"""Names of the features of a window; features of missing kinds of channel are NaN."""

_LEAST_RATE = 1000.0
"""Minimum sampling rate of a recording to be described [Hz]."""

_FADE = 0.01
"""Duration of the fades at the ends of a recording, against clicks of a cut hum [s]."""

_BLOCKS_A_PAGE = 3

FRAMES_A_HOP = round(HOP * FRAME_RATE)
"""Frames per hop of windows."""


def columns_of(classifier: Classifier) -> list[int]:
    """Return the columns of the features of a classifier in `FEATURE_NAMES`.

    Raises
    ------
    ParameterError
        The classifier has features that do not exist.

    Examples
    --------
    >>> from noise.classifier.model import load_classifier
    >>> len(columns_of(load_classifier())) <= len(FEATURE_NAMES)
    True
    """
    if unknown := [name for name in classifier.feature_names if name not in FEATURE_NAMES]:
        raise ParameterError(
            f"classifier: feature {str(unknown[0])[:60]!r} does not exist; train it anew"
        )
    return [FEATURE_NAMES.index(name) for name in classifier.feature_names]


@dataclass(frozen=True, eq=False)
class WindowFeatures:
    """Features of the windows of a recording, and its frames.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        By `FEATURE_NAMES` [unit of each feature], or results computed from them.
    level : ndarray, shape (n_windows,)
        A-weighted level of the main channel, from 160 Hz to 7 kHz [dB re its unit].
    frames : ndarray of float32, shape (n_frames, n)
        Frames of the main channel, as in `features.windows.table.WindowTable`.
    """

    features: NDArray[Any]
    level: NDArray[np.float32]
    frames: NDArray[np.float32]


def has_window_channel(blocks: RecordingBlocks) -> bool:
    """Whether a recording has a channel with window features, at a sufficient sampling rate."""
    return blocks.rate >= _LEAST_RATE and any(blocks.first(kind) is not None for kind in KINDS)


def tracks(blocks: RecordingBlocks, *, per_track: bool) -> Iterator[tuple[str, RecordingBlocks]]:
    """Yield the tracks to be described separately, with their names in the column ``channel``.

    Parameters
    ----------
    blocks : RecordingBlocks
    per_track : bool
        Whether each channel is a track, as in a plain sound file.
    """
    if per_track and len(blocks.channels) > 1:
        for row in range(len(blocks.channels)):
            yield str(row + 1), blocks.track(row)
    else:
        yield "all", blocks


def window_features(
    blocks: RecordingBlocks,
    reduced: Callable[[NDArray[np.float32]], NDArray[Any]] = lambda features: features,
) -> WindowFeatures:
    """Return the features of all windows of a recording.

    Parameters
    ----------
    blocks : RecordingBlocks
        With a channel of pressure, acceleration or torque; the first of these is the main one.
    reduced : callable
        Function from the features of some windows, shape (n, n_features), to a row of results for
        each.

    Returns
    -------
    WindowFeatures

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from models.recording import RecordingBlocks
    >>> hiss = np.random.default_rng(0).normal(size=(1, 48_000))
    >>> found = window_features(RecordingBlocks.of(Recording(hiss, 48e3, (Channel("pressure"),))))
    >>> found.features.shape == (3, len(FEATURE_NAMES)), found.frames.shape[0]
    (True, 97)
    """
    resampled = _Resampled(blocks)
    features, levels, frames = [], [], []
    a_page = round(_BLOCKS_A_PAGE * resampled.useful / HOP)
    for first in range(0, resampled.n_windows, a_page):
        windows = min(a_page, resampled.n_windows - first)
        tables = {row: resampled.table(row, first, windows) for row in resampled.rows}
        missing = np.full((windows, len(WINDOW_NAMES)), np.nan, dtype=np.float32)
        parts = [
            missing if (row := blocks.first(kind)) is None else tables[row].features
            for kind in ACOUSTIC_KINDS
        ]
        of_page = np.concatenate(
            [*parts, _torque(blocks, first, windows)], axis=1, dtype=np.float32
        )
        of_page[~np.isfinite(of_page)] = np.nan
        features.append(reduced(of_page))
        levels.append(tables[resampled.main].level)
        # Frames in two pages are taken from the later page.
        last = first + windows == resampled.n_windows
        frames.append(tables[resampled.main].frames[: None if last else windows * FRAMES_A_HOP])
    return WindowFeatures(np.concatenate(features), np.concatenate(levels), np.concatenate(frames))


class _Resampled:
    """Channels of a recording at the common rate, of which pages of windows are described."""

    def __init__(self, blocks: RecordingBlocks) -> None:
        rows = {kind: row for kind in KINDS if (row := blocks.first(kind)) is not None}
        self.main = next(iter(rows.values()))
        self.rows = sorted({self.main, *(rows[kind] for kind in ACOUSTIC_KINDS if kind in rows)})
        self.useful = block_length(blocks.n_samples / blocks.rate)
        self._blocks, self._n = blocks, max(1, round(blocks.n_samples * RATE / blocks.rate))
        self.n_windows = window_count(self._n)
        self._limit = min(WORKING_LIMIT, USABLE_SHARE * blocks.rate)
        self._resampled: dict[int, dict[int, Block]] = {}

    def table(self, row: int, first: int, windows: int) -> WindowTable:
        """Return the features of one page of a channel."""
        number = round(first * HOP) // self.useful
        start = number * self.useful * RATE
        size = min(self._n - start, round(((windows - 1) * HOP + LENGTH) * RATE))
        held = [
            self._block(i)[row]
            for i in range(number, number + math.ceil(size / (self.useful * RATE)))
        ]
        scale = max(block.scale for block in held)
        shares = [np.float32(block.scale / scale if scale > 0.0 else 0.0) for block in held]
        sound, high = (
            np.concatenate([part * share for part, share in zip(parts, shares, strict=True)])[:size]
            for parts in ([block.sound for block in held], [block.high for block in held])
        )
        limit = max(block.limit for block in held) or self._limit
        return describe_windows(sound, high, scale=scale, windows=windows, limit=limit)

    def _block(self, number: int) -> dict[int, Block]:
        """Return one block of all channels, from a cache of the last few."""
        if number not in self._resampled:
            for old in [old for old in self._resampled if old < number - _BLOCKS_A_PAGE]:
                del self._resampled[old]
            rate, n = self._blocks.rate, self._blocks.n_samples
            start = round((number * self.useful - MARGIN) * rate)
            length = round((self.useful + 2.0 * MARGIN) * rate)
            held = self._blocks.read(max(start, 0), min(start + length, n))
            self._resampled[number] = {
                row: resampled_block(self._framed(held[row], start, length), rate, self.useful)
                for row in self.rows
            }
        return self._resampled[number]

    def _framed(self, samples: NDArray[np.float64], start: int, length: int) -> NDArray[np.float64]:
        """Return a block padded with zeros, with fades at the ends of the recording."""
        if samples.size == length and start > 0 and start + length < self._blocks.n_samples:
            return samples
        whole = np.zeros(length)
        first = max(0, -start)
        part = whole[first : first + samples.size]
        np.subtract(samples, samples.mean(), out=part)
        fade = min(round(_FADE * self._blocks.rate), self._blocks.n_samples // 10)
        ramp = 0.5 - 0.5 * np.cos(np.pi * (np.arange(fade) + 0.5) / max(fade, 1))
        if start <= 0:
            part[:fade] *= ramp
        if start + length >= self._blocks.n_samples:
            part[part.size - fade :] *= ramp[::-1]
        return whole


def _torque(blocks: RecordingBlocks, first: int, windows: int) -> NDArray[np.float32]:
    """Return the features of the torque in the windows of a page."""
    features, row = features_of("torque"), blocks.first("torque")
    out = np.full((windows, len(features)), np.nan, dtype=np.float32)
    if row is None:
        return out
    for i in range(windows):
        start = round((first + i) * HOP * blocks.rate)
        end = min(start + round(LENGTH * blocks.rate), blocks.n_samples)
        try:
            signal = prepare(blocks.read(start, end)[row], blocks.rate, "torque")
            out[i] = [feature(signal) for feature in features]
        except ParameterError:  # too short to be described
            continue
    return out
