"""Samples of a long file chunk by chunk, of which the last ones are kept."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import soundfile

from models.errors import RecordingError
from noise.recordings.meaning import check_finite

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from models.recording import Channel

__all__ = ["Chunks", "SoundSamples", "to_units"]

_CHUNK = 8 << 20
"""What is read at once [byte of 64-bit samples]."""

_EXACT = ("WAV", "WAVEX", "RF64", "AIFF", "FLAC")
"""Formats of the sound library that can be entered at any sample."""


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


class SoundSamples:
    """Samples of a sound file from a place on, in the units of its channels.

    Parameters
    ----------
    path : Path
    sound : soundfile.SoundFile
    channels : tuple of Channel
    """

    def __init__(self, path: Path, sound: Any, channels: tuple[Channel, ...]) -> None:
        self._path, self._sound, self._channels = path, sound, channels
        self._position = 0

    def read(self, start: int, end: int) -> NDArray[np.float64]:
        """Return the samples between two, shape (n_channels, n)."""
        try:
            if start != self._position:
                self._go_to(start)
            block = self._sound.read(end - start, dtype="float64", always_2d=True)
        except soundfile.LibsndfileError as error:
            reason = error.error_string.rstrip(".")
            raise RecordingError(f"{self._path}: is damaged ({reason})") from error
        self._position = start + len(block)
        if len(block) < end - start:
            raise RecordingError(
                f"{self._path}: is truncated; its header announces {self._sound.frames} samples, "
                f"{self._position} can be read"
            )
        samples = np.ascontiguousarray(block.T)
        to_units(self._path, samples, self._channels, float(self._sound.samplerate), start)
        return samples

    def _go_to(self, sample: int) -> None:
        if self._sound.format in _EXACT:
            self._sound.seek(sample)
            return
        if sample < self._position:
            self._sound.seek(0)
            self._position = 0
        while self._position < sample:
            passed = len(self._sound.read(min(1 << 16, sample - self._position)))
            if not passed:
                return
            self._position += passed


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
