"""A recording described window by window, reading each of its samples once.

Blocks lie on a grid that begins with the recording, and pages hold three of them; so the same
numbers come out whether the recording is in memory or read from its file, and memory does not grow
with its length but for a few kilobytes a second that are kept of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.conditioning import USABLE_SHARE, WORKING_LIMIT
from features.named.prepared import ACOUSTIC_KINDS, prepare
from features.named.torque_features import TORQUE_FEATURES
from features.windows.blocks import FRAME_RATE, MARGIN, RATE, block_length, resampled_block
from features.windows.declared import WINDOW_FEATURES
from features.windows.table import HOP, LENGTH, WINDOW_NAMES, describe_windows, window_count
from models.errors import ParameterError
from noise.labels.levels import CellLevels

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from features.windows.blocks import Block
    from features.windows.table import WindowTable
    from noise.recordings.blocks import RecordingBlocks

__all__ = [
    "FEATURE_NAMES",
    "Described",
    "can_be_described",
    "describe",
    "segment_frequency",
    "tracks",
]

FEATURE_NAMES = (
    *(f"{kind}_{name}" for kind in ACOUSTIC_KINDS for name in WINDOW_NAMES),
    *(f"torque_{feature.name}" for feature in TORQUE_FEATURES),
)
"""Of a window of a recording; NaN for the kinds of channel that it does not have."""

_KINDS = (*ACOUSTIC_KINDS, "torque")

_LEAST_RATE = 1000.0
"""A recording sampled more slowly shows nothing of a noise [Hz]."""

_FADE = 0.01
"""The ends of a recording are faded in and out [s]: cut hum would click."""

_PERIODIC = 0.3
"""Least autocorrelation of an envelope for its period to be that of slips."""

_LEAST_BLOWS = math.log2(3.0 / 10.0)
"""Fewer blows a second tell no rate [octave re 10 Hz]."""

_COLUMN = {name: i for i, name in enumerate(FEATURE_NAMES)}
_DECLARED = {feature.name: feature for feature in WINDOW_FEATURES}

_BLOCKS_A_PAGE = 3

_FRAMES_A_HOP = round(HOP * FRAME_RATE)
_FRAMES_A_WINDOW = round(LENGTH * FRAME_RATE)


@dataclass(frozen=True, eq=False)
class Described:
    """What is known of a recording for labelling it.

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        By `FEATURE_NAMES` [unit of each feature].
    level : ndarray, shape (n_windows,)
        A-weighted power of the channel listened to, from 160 Hz to 7 kHz [dB re its unit].
    frames : ndarray of float32, shape (n_frames, n)
        Of that channel, as `features.windows.table.WindowTable` has them.
    cells : CellLevels
        Of that channel, all frequencies.
    """

    features: NDArray[np.float32]
    level: NDArray[np.float32]
    frames: NDArray[np.float32]
    cells: CellLevels


def can_be_described(blocks: RecordingBlocks) -> bool:
    """Whether a recording has a channel that noises show in, sampled fast enough."""
    return blocks.rate >= _LEAST_RATE and any(blocks.first(kind) is not None for kind in _KINDS)


def tracks(blocks: RecordingBlocks, *, per_track: bool) -> Iterator[tuple[str, RecordingBlocks]]:
    """Yield what is described on its own, with its name in the column ``channel``.

    Parameters
    ----------
    blocks : RecordingBlocks
    per_track : bool
        Whether each channel stands for itself, as the tracks of a plain sound file do.
    """
    if per_track and len(blocks.channels) > 1:
        for row in range(len(blocks.channels)):
            yield str(row + 1), blocks.track(row)
    else:
        yield "all", blocks


def describe(blocks: RecordingBlocks) -> Described:
    """Describe all windows of a recording.

    Parameters
    ----------
    blocks : RecordingBlocks
        With a channel of pressure, acceleration or torque, of which the first is listened to.

    Returns
    -------
    Described

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from noise.recordings.blocks import RecordingBlocks
    >>> hiss = np.random.default_rng(0).normal(size=(1, 48_000))
    >>> found = describe(RecordingBlocks.of(Recording(hiss, 48e3, (Channel("pressure"),))))
    >>> found.features.shape == (3, len(FEATURE_NAMES)), found.frames.shape[0]
    (True, 97)
    """
    rows = {kind: blocks.first(kind) for kind in _KINDS}
    channels = {kind: row for kind, row in rows.items() if row is not None}
    heard = next(iter(channels.values()))
    acoustic = [row for kind, row in channels.items() if kind in ACOUSTIC_KINDS]
    reader = _Reader(blocks, sorted({heard, *acoustic}), heard)
    # Filled page by page: a list of pages and what it is put together to would take twice as much.
    table = np.empty((reader.count, len(FEATURE_NAMES)), dtype=np.float32)
    levels, frames, n_frames = [], np.empty((0, 0), dtype=np.float32), 0
    for first, windows in reader.pages():
        own = reader.page(heard, first, windows)
        levels.append(own.level)
        if first == 0:
            more = len(own.frames) - windows * _FRAMES_A_HOP  # beyond the last window's hop
            most = reader.count * _FRAMES_A_HOP + max(more, _FRAMES_A_WINDOW)
            frames = np.empty((most, own.frames.shape[1]), dtype=np.float32)
        start = first * _FRAMES_A_HOP
        n_frames = start + len(own.frames)
        frames[start:n_frames] = own.frames
        parts = []
        for kind in ACOUSTIC_KINDS:
            if kind not in channels:
                parts.append(np.full((windows, len(WINDOW_NAMES)), np.nan, dtype=np.float32))
            else:
                row = channels[kind]
                described = own if row == heard else reader.page(row, first, windows)
                parts.append(described.features)
        parts.append(_torque(blocks, channels.get("torque"), first, windows))
        page = table[first : first + windows]
        np.concatenate(parts, axis=1, out=page)
        page[~np.isfinite(page)] = np.nan
    return Described(table, np.concatenate(levels), frames[:n_frames], reader.cells)


class _Reader:
    """Blocks and pages of some channels, one after the other."""

    def __init__(self, blocks: RecordingBlocks, rows: list[int], heard: int) -> None:
        self._blocks, self._rows, self._heard = blocks, rows, heard
        rate = blocks.rate
        self._useful = block_length(blocks.n_samples / rate)
        self._n = max(1, round(blocks.n_samples * RATE / rate))
        self.count = window_count(self._n)
        self._limit = min(WORKING_LIMIT, USABLE_SHARE * rate)
        self._held: dict[int, dict[int, Block]] = {}
        self.cells = CellLevels(rate, blocks.n_samples)

    def pages(self) -> Iterator[tuple[int, int]]:
        """Yield the first window of each page and their number."""
        a_page = round(_BLOCKS_A_PAGE * self._useful / HOP)
        for first in range(0, self.count, a_page):
            yield first, min(a_page, self.count - first)

    def page(self, row: int, first: int, windows: int) -> WindowTable:
        """Describe a page of a channel."""
        number = round(first * HOP) // self._useful
        start = number * self._useful * RATE
        size = min(self._n - start, round(((windows - 1) * HOP + LENGTH) * RATE))
        held = [
            self._block(i)[row]
            for i in range(number, number + math.ceil(size / (self._useful * RATE)))
        ]
        scale = max(block.scale for block in held)
        shares = [np.float32(block.scale / scale if scale > 0.0 else 0.0) for block in held]
        sound, high, top = (
            np.concatenate([part * factor for part, factor in zip(parts, factors, strict=True)])
            for parts, factors in (
                ([block.sound for block in held], shares),
                ([block.high for block in held], shares),
                ([block.top for block in held], [share**2 for share in shares]),
            )
        )
        frames = math.ceil(size * FRAME_RATE / RATE)
        limit = max(block.limit for block in held) or self._limit
        return describe_windows(
            sound[:size], high[:size], top[:frames], scale=scale, windows=windows, limit=limit
        )

    def _block(self, number: int) -> dict[int, Block]:
        """Return one block of all channels; the last few are kept."""
        if number not in self._held:
            for old in [old for old in self._held if old < number - _BLOCKS_A_PAGE]:
                del self._held[old]
            rate, n = self._blocks.rate, self._blocks.n_samples
            start = round((number * self._useful - MARGIN) * rate)
            length = round((self._useful + 2.0 * MARGIN) * rate)
            held = self._blocks.read(max(start, 0), min(start + length, n))
            begin = round(number * self._useful * rate)
            end = round((number + 1) * self._useful * rate)
            self.cells.add(begin, end, held[self._heard], max(start, 0))
            self._held[number] = {
                row: resampled_block(self._framed(held[row], start, length), rate, self._useful)
                for row in self._rows
            }
        return self._held[number]

    def _framed(self, samples: NDArray[np.float64], start: int, length: int) -> NDArray[np.float64]:
        """Put what there is of a block into zeros, faded where the recording begins and ends."""
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


def _torque(
    blocks: RecordingBlocks, row: int | None, first: int, windows: int
) -> NDArray[np.float32]:
    """Features of the torque in the windows of a page."""
    out = np.full((windows, len(TORQUE_FEATURES)), np.nan, dtype=np.float32)
    if row is None:
        return out
    for i in range(windows):
        start = round((first + i) * HOP * blocks.rate)
        end = min(start + round(LENGTH * blocks.rate), blocks.n_samples)
        try:
            signal = prepare(blocks.read(start, end)[row], blocks.rate, "torque")
            out[i] = [feature(signal) for feature in TORQUE_FEATURES]
        except ParameterError:  # too short to be described
            continue
    return out


def segment_frequency(features: NDArray[np.float32], label: str) -> float | None:
    """Return slip frequency of creak and squawk, else of the strongest line [Hz].

    Parameters
    ----------
    features : ndarray of float32, shape (n_windows, n_features)
        Of the segment's windows, by `FEATURE_NAMES` [unit of each feature].
    label : str

    Returns
    -------
    float or None
        [Hz], of the torque where there is one; ``None`` for ``none``, or where nothing is found.

    Examples
    --------
    >>> features = np.full((2, len(FEATURE_NAMES)), np.nan, dtype=np.float32)
    >>> features[:, FEATURE_NAMES.index("pressure_line_frequency")] = 1.0
    >>> features[:, FEATURE_NAMES.index("pressure_line_count")] = 1.0
    >>> segment_frequency(features, "squeal")
    2000.0
    """
    if label == "none":
        return None
    slips = label in ("creak", "squawk")
    torque = _median(features, "torque_fundamental" if slips else "torque_line_frequency")
    if torque is not None:
        return torque
    for kind in ("pressure", "acceleration"):
        found = None
        if label == "creak":
            found = _blow_rate(features, kind)
        if slips and found is None:
            found = _frequency(features, kind, "fundamental")
        if found is None:
            counted = features[features[:, _COLUMN[f"{kind}_line_count"]] > 0]
            found = _frequency(counted, kind, "line_frequency")
        if found is not None:
            return found
    return None


def _blow_rate(features: NDArray[np.float32], kind: str) -> float | None:
    """Rate of a creak's blows [Hz], of their period where most windows have one."""
    for part in ("high_", ""):
        strength = features[:, _COLUMN[f"{kind}_{part}period_strength"]]
        periodic = features[strength > _PERIODIC]
        if 2 * len(periodic) > len(features):
            return _frequency(periodic, kind, f"{part}period_rate")
    rate = features[:, _COLUMN[f"{kind}_high_blow_rate"]]
    return _frequency(features[rate > _LEAST_BLOWS], kind, "high_blow_rate")


def _frequency(features: NDArray[np.float32], kind: str, name: str) -> float | None:
    """Median of a window feature that counts in octaves [Hz]."""
    octave = _median(features, f"{kind}_{name}")
    return None if octave is None else _DECLARED[name].hertz(octave)


def _median(features: NDArray[np.float32], name: str) -> float | None:
    """Median of what is known of a column, in the column's unit."""
    values = features[:, _COLUMN[name]]
    values = values[np.isfinite(values)]
    return float(np.median(values)) if values.size else None
