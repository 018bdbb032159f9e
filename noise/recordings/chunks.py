"""Samples of a long file chunk by chunk, of which the last ones are kept."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from noise.recordings.meaning import check_finite

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from models.recording import Channel

__all__ = ["Chunks", "to_units"]

_CHUNK = 8 << 20
"""What is read at once [byte of 64-bit samples]."""


class Chunks:
    """Samples of a file of which parts are wanted that is read chunk by chunk.

    Parameters
    ----------
    read_chunk : callable
        From first and last sample to those between them, shape (n_rows, n).
    n_samples, n_rows : int

    Examples
    --------
    >>> ones = np.ones((1, 480))
    >>> Chunks(lambda first, last: ones[:, first:last], 480, 1).read(10, 30).shape
    (1, 20)
    """

    def __init__(
        self, read_chunk: Callable[[int, int], NDArray[np.float64]], n_samples: int, n_rows: int
    ) -> None:
        self._n_samples = n_samples
        self._length = length = max(1, _CHUNK // (8 * n_rows))
        self._chunk = lru_cache(maxsize=2)(
            lambda number: read_chunk(number * length, min((number + 1) * length, n_samples))
        )

    def read(self, first: int, last: int) -> NDArray[np.float64]:
        """Return the samples between two, shape (n_rows, n)."""
        last = min(last, self._n_samples)
        parts = []
        for number in range(first // self._length, math.ceil(last / self._length)):
            start = number * self._length
            parts.append(self._chunk(number)[:, max(0, first - start) : last - start])
        return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)


def to_units(
    path: Path,
    samples: NDArray[np.float64],
    channels: tuple[Channel, ...],
    rate: float,
    start: int,
) -> None:
    """Bring samples to the units of their channels, in place.

    Parameters
    ----------
    path : Path
        For messages.
    samples : ndarray, shape (n_channels, n)
        Fractions of full scale before, in the unit of each channel afterwards.
    channels : tuple of Channel
    rate : float
        Sampling rate [Hz].
    start : int
        Number of the first sample in its file.

    Raises
    ------
    RecordingError
        A sample is not finite.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # found and refused below
        for channel, row in zip(channels, samples, strict=True):
            row *= channel.full_scale
    check_finite(path, samples, rate, channels, start)
