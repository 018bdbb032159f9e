"""Recordings of which parts can be had, in memory or on disk, and their channels piece by piece.

Reading a part gives the samples that reading the whole gives, bit for bit, so what is computed from
parts does not depend on how long a recording is.

Windows, filters and transforms grow with the sampling rate, and at 10 MHz half a second is as much
as minutes of sound. Above 400 kHz every so many samples are therefore made one, through a filter
without delay.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.recording import Channel, Recording

Read = Callable[[int, int], NDArray[np.float64]]
"""From first and last sample to those between them, shape (n,) or (n_channels, n)."""

_PIECE = 1 << 17
"""Samples of a piece."""

HIGHEST_WORKED = 400e3
"""Rates above it are brought below it [Hz]; measuring cards for sound reach 384 kHz."""

_REACH = 10
"""Samples of the result that the filter reaches to either side."""

_PASS_BAND = 0.8
"""Where the filter has fallen to half, over half of the new rate."""


@dataclass(frozen=True, eq=False)
class RecordingBlocks:
    """A recording of which parts can be had.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz], at most `HIGHEST_WORKED`.
    channels : tuple of Channel
    condition : Condition
    calibrated : bool
    name : str
        These as in `models.recording.Recording`.
    n_samples : int
        Of each channel.
    read : callable
        From first and last sample to the samples between them, shape (n_channels, n).

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
        """Return a recording in memory as one of which parts can be had."""
        if isinstance(recording, RecordingBlocks):
            return recording
        read, n_samples, rate = decimated(
            lambda first, last: recording.samples[:, first:last],
            recording.samples.shape[1],
            recording.rate,
        )
        return cls(
            rate, recording.channels, recording.condition, recording.calibrated, recording.name,
            n_samples, read,
        )  # fmt: skip

    def cut(self, first: int, last: int) -> Recording:
        """Return the part from sample `first` up to `last`."""
        samples = self.read(first, last)
        return Recording(
            samples, self.rate, self.channels, self.condition, self.calibrated, self.name
        )

    def part(self, first: int, last: int) -> RecordingBlocks:
        """Return the same part as a recording of its own, which is read when it is looked at."""
        last = min(last, self.n_samples)
        return replace(
            self,
            n_samples=last - first,
            read=lambda start, end: self.read(first + start, min(first + end, last)),
        )

    def pieces(self, first: int, last: int, length: int) -> Iterator[Recording]:
        """Go through a part in pieces of `length` samples, the last of which may be shorter."""
        for start in range(first, last, length):
            yield self.cut(start, min(start + length, last))

    def first(self, kind: str) -> int | None:
        """Row of the first channel of a kind; ``None`` where there is none."""
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


def n_samples_of(recording: Recording | RecordingBlocks) -> int:
    """Return how many samples each channel of a recording has.

    Examples
    --------
    >>> from models.recording import Channel
    >>> n_samples_of(Recording(np.zeros((1, 480)), 48e3, (Channel("pressure"),)))
    480
    """
    if isinstance(recording, Recording):
        return int(recording.samples.shape[1])
    return recording.n_samples


def reader_of(recording: Recording | RecordingBlocks, row: int) -> Read:
    """Return what gives a part of a channel, from first and last sample.

    Parameters
    ----------
    recording : Recording or RecordingBlocks
    row : int
        Of the channel.

    Returns
    -------
    callable
        Gives arrays of shape (last - first,) [unit of the channel].

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
        # No more at once of the other channels than has to be.
        kept = np.empty(last - first)
        for start in range(first, last, _PIECE):
            end = min(start + _PIECE, last)
            kept[start - first : end - first] = recording.read(start, end)[row]
        return kept

    return read


def in_pieces(read: Read, n_samples: int, length: int = _PIECE) -> Iterator[NDArray[np.float64]]:
    """Go through a channel piece by piece.

    Parameters
    ----------
    read : callable
        Of `reader_of`.
    n_samples : int
        Of the channel.
    length : int
        Samples of a piece; the last may be shorter.

    Yields
    ------
    ndarray, shape (n,)
        [unit of the channel]

    Examples
    --------
    >>> ones = np.ones(480)
    >>> [piece.size for piece in in_pieces(lambda first, last: ones[first:last], 480, 200)]
    [200, 200, 80]
    """
    for first in range(0, n_samples, length):
        yield read(first, min(first + length, n_samples))


def decimated(read: Read, n_samples: int, rate: float) -> tuple[Read, int, float]:
    """Bring a recording to a rate that can be worked with.

    Parameters
    ----------
    read : callable
        From first and last sample to the samples between them, shape (n_channels, n) [unit of
        each channel].
    n_samples : int
        Of each channel.
    rate : float
        [Hz]

    Returns
    -------
    read : callable
    n_samples : int
    rate : float
        [Hz]; all three as they were, up to `HIGHEST_WORKED`.

    Examples
    --------
    >>> ones = np.ones((1, 10_000))
    >>> read, n, rate = decimated(lambda first, last: ones[:, first:last], 10_000, 1e6)
    >>> n, round(rate), np.allclose(read(100, 110), 1.0)
    (3334, 333333, True)
    """
    every = math.ceil(rate / HIGHEST_WORKED)
    if every <= 1:
        return read, n_samples, rate
    n = -(-n_samples // every)

    def read_decimated(first: int, last: int) -> NDArray[np.float64]:
        from scipy.signal import upfirdn

        last = min(last, n)
        taps, reach = _taps(every), _REACH * every
        start, end = first * every - reach, (last - 1) * every + reach + 1
        there = read(max(start, 0), min(end, n_samples))
        missing = (max(0, -start), max(0, end - n_samples))
        padded = np.pad(there, ((0, 0), missing), mode="edge")
        filtered = upfirdn(taps, padded, 1, every, axis=1)
        return np.ascontiguousarray(filtered[:, 2 * _REACH : 2 * _REACH + last - first])

    return read_decimated, n, rate / every


@lru_cache(maxsize=8)
def _taps(every: int) -> NDArray[np.float64]:
    from scipy.signal import firwin

    return np.asarray(firwin(2 * _REACH * every + 1, _PASS_BAND / every, window=("kaiser", 8.0)))
