"""Recordings of which parts can be had, and their channels piece by piece."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.recording import Channel, Recording

Read = Callable[[int, int], "NDArray[np.float64]"]
"""From first and last sample of a channel to those between them, shape (n,)."""

_PIECE = 1 << 17
"""Samples of a piece."""


class Blocks(Protocol):
    """A recording on disk, such as `noise.recordings.blocks.RecordingBlocks`."""

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""

    @property
    def channels(self) -> tuple[Channel, ...]:
        """What it holds."""

    @property
    def condition(self) -> Condition:
        """Operating condition."""

    @property
    def calibrated(self) -> bool:
        """Whether samples are in physical units."""

    @property
    def name(self) -> str:
        """What it is called."""

    @property
    def n_samples(self) -> int:
        """Of each channel."""

    @property
    def read(self) -> Callable[[int, int], NDArray[np.float64]]:
        """From first and last sample to those between them, shape (n_channels, n)."""

    def first(self, kind: str) -> int | None:
        """Row of the first channel of a kind."""


def n_samples_of(recording: Recording | Blocks) -> int:
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


def reader_of(recording: Recording | Blocks, row: int) -> Read:
    """Return what gives a part of a channel, from first and last sample.

    Parameters
    ----------
    recording : Recording or Blocks
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
