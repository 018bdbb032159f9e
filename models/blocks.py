"""Recordings that are read in parts, from memory or disk.

A part has bit for bit the samples of the whole, so results that are computed from parts do not
depend on the length of a recording.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.recording import Channel, Recording

Read = Callable[[int, int], NDArray[np.float64]]
"""Function of first and last sample that returns the samples, shape (n,) or (n_channels, n)."""

_PIECE = 1 << 17
"""Samples of a piece."""


@dataclass(frozen=True, eq=False)
class RecordingBlocks:
    """Recording that is read in parts.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    channels : tuple of Channel
    condition : Condition
    calibrated : bool
    name : str
        As in `models.recording.Recording`.
    n_samples : int
        Samples of each channel.
    read : callable
        Function of first and last sample that returns the samples, shape (n_channels, n).

    Examples
    --------
    >>> turning = Recording(np.array([[0.0, 1.0, 2.0, 3.0]]), 2.0, (Channel("angle"),))
    >>> RecordingBlocks.of(turning).cut(1, 3).samples
    array([[1., 2.]])
    """

    rate: float
    channels: tuple[Channel, ...]
    condition: Condition
    calibrated: bool
    name: str
    n_samples: int
    read: Callable[[int, int], NDArray[np.float64]]

    @classmethod
    def of(cls, recording: Recording | RecordingBlocks) -> RecordingBlocks:
        """Return a recording in memory as one that is read in parts."""
        if isinstance(recording, RecordingBlocks):
            return recording
        return cls(
            recording.rate, recording.channels, recording.condition, recording.calibrated,
            recording.name, recording.n_samples,
            lambda first, last: recording.samples[:, first:last],
        )  # fmt: skip

    def cut(self, first: int, last: int) -> Recording:
        """Return the part from sample `first` up to `last`."""
        samples = self.read(first, last)
        return Recording(
            samples, self.rate, self.channels, self.condition, self.calibrated, self.name
        )

    def part(self, first: int, last: int) -> RecordingBlocks:
        """Return the part from sample `first` up to `last` without reading it."""
        last = min(last, self.n_samples)
        return replace(
            self,
            n_samples=last - first,
            read=lambda start, end: self.read(first + start, min(first + end, last)),
        )

    def pieces(self, first: int, last: int, length: int) -> Iterator[Recording]:
        """Yield a part in pieces of `length` samples, the last of which may be shorter."""
        for start in range(first, last, length):
            yield self.cut(start, min(start + length, last))

    def first(self, kind: str) -> int | None:
        """Return the row of the first channel of a kind; ``None`` if there is none."""
        rows = (row for row, channel in enumerate(self.channels) if channel.kind == kind)
        return next(rows, None)

    def track(self, row: int) -> RecordingBlocks:
        """Return one channel as a recording of its own."""
        channel, read = self.channels[row], reader_of(self, row)
        return replace(
            self,
            channels=(replace(channel, name=channel.kind),),
            read=lambda first, last: read(first, last)[np.newaxis],
        )


def reader_of(recording: Recording | RecordingBlocks, row: int) -> Read:
    """Return the function that reads a part of a channel, from first and last sample.

    Parameters
    ----------
    recording : Recording or RecordingBlocks
    row : int
        Row of the channel.

    Returns
    -------
    callable
        Returns arrays of shape (last - first,) [unit of the channel].

    Examples
    --------
    >>> from models.recording import Channel
    >>> run = Recording(np.zeros((1, 480)), 48e3, (Channel("pressure"),))
    >>> reader_of(run, 0)(10, 30).size
    20
    """
    if isinstance(recording, Recording):
        return lambda first, last: recording.samples[row, first:last]

    def read(first: int, last: int) -> NDArray[np.float64]:
        last = min(last, recording.n_samples)
        if last - first <= _PIECE:
            return np.asarray(recording.read(first, last)[row])
        # In pieces, since the other channels are read as well.
        samples = np.empty(last - first)
        for start in range(first, last, _PIECE):
            end = min(start + _PIECE, last)
            samples[start - first : end - first] = recording.read(start, end)[row]
        return samples

    return read
