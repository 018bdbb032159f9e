"""Recordings too long to be held in memory: only what is looked at is read.

Reading a part gives the samples that reading the whole gives, bit for bit, so what is computed from
parts does not depend on how long the file is. Compressed sound that cannot be entered at a given
sample is decoded from its beginning; universal files, which are text, are read whole.
"""

from __future__ import annotations

from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.blocks import reader_of
from models.errors import RecordingError
from models.foreign_file import refusing
from models.recording import Channel, Recording
from noise.recordings.chunks import Chunks, to_units
from noise.recordings.decimation import decimated
from noise.recordings.files import MIN_SAMPLES, say_once
from noise.recordings.formats import HIGHEST_RATE, LOWEST_RATE, formats
from noise.recordings.formats.isolated import open_isolated
from noise.recordings.formats.sound_file import SoundReader
from noise.recordings.meaning import describe
from noise.recordings.unwrapping import find_turns

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from models.condition import Condition
    from noise.recordings.meaning import Meaning, PascalPerFullScale

__all__ = ["RecordingBlocks", "open_blocks"]

_LARGE = 64 << 20
"""Recordings of fewer bytes, as 64-bit samples, are read whole."""

_WIDER = 4
"""A logger's file of so many times fewer bytes is not looked at: 16 bits become 64."""


@dataclass(frozen=True, eq=False)
class RecordingBlocks:
    """A recording of which parts can be had.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz], at most `noise.recordings.decimation.HIGHEST_WORKED`.
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


@contextmanager
def open_blocks(
    path: str | os.PathLike[str], *, full_scale: PascalPerFullScale | None = None
) -> Iterator[RecordingBlocks | None]:
    """Open a recording that is better not read whole.

    Parameters
    ----------
    path : path-like
    full_scale : float or tuple of float, optional
        As for `noise.recordings.read_recording`.

    Yields
    ------
    RecordingBlocks or None
        None where it should be read whole: it is short, of a format that cannot be read in parts,
        or to be refused. Reading raises RecordingError where samples are missing or not finite.

    Raises
    ------
    RecordingError
        Its sidecar cannot be read, or contradicts it.

    Examples
    --------
    >>> with open_blocks("short.wav") as blocks:
    ...     blocks is None
    True
    """
    path = Path(path)
    with ExitStack() as stack:
        with refusing(str(path), "recording", RecordingError):
            blocks = _open(path, full_scale, stack)
        yield blocks


def _open(
    path: Path, full_scale: PascalPerFullScale | None, stack: ExitStack
) -> RecordingBlocks | None:
    of = formats().get(path.suffix.lower())
    if of is not None and of.read is None:
        return _open_logged(path, full_scale, stack)
    sound = _opened(path)
    if sound is None:
        return None
    stack.callback(sound.close)
    raw = sound.raw
    meaning = describe(path, raw, full_scale)

    def read_chunk(start: int, end: int) -> NDArray[np.float64]:
        samples = sound.read(start, end)
        to_units(path, samples, meaning.channels, raw.rate, start)
        return samples

    chunks = Chunks(read_chunk, sound.n_samples, len(meaning.channels))
    return _described(path, meaning, chunks.read, sound.n_samples, raw.rate)


def _described(
    path: Path,
    meaning: Meaning,
    read: Callable[[int, int], NDArray[np.float64]],
    n_samples: int,
    rate: float,
) -> RecordingBlocks:
    """Return samples in units as a recording, whose angles go on."""
    unwrapping = find_turns(meaning.channels, read, n_samples, meaning.calibrated)
    say_once(path, (*meaning.notes, *unwrapping.notes))

    def read_unwrapped(first: int, last: int) -> NDArray[np.float64]:
        samples = read(first, last)
        if unwrapping.jumps:
            samples = samples.copy()
            unwrapping.add(samples, first)
        return samples

    worked, n_samples, rate = decimated(read_unwrapped, n_samples, rate)
    return RecordingBlocks(
        rate, meaning.channels, meaning.condition, meaning.calibrated, path.name, n_samples, worked
    )


def _open_logged(
    path: Path, full_scale: PascalPerFullScale | None, stack: ExitStack
) -> RecordingBlocks | None:
    """Open a large file of a logger; None for any other."""
    try:
        if not path.is_file() or path.stat().st_size < _LARGE // _WIDER:
            return None
    except OSError:  # whoever reads it whole says what is wrong
        return None
    raw, n, read_rows = stack.enter_context(open_isolated(path))
    if 8 * n * len(raw.samples) < _LARGE or n < MIN_SAMPLES:
        return None
    meaning = describe(path, raw, full_scale)

    def read_chunk(start: int, end: int) -> NDArray[np.float64]:
        samples = read_rows(start, end)
        to_units(path, samples, meaning.channels, raw.rate, start)
        return samples

    chunks = Chunks(read_chunk, n, len(raw.samples))
    return _described(path, meaning, chunks.read, n, raw.rate)


def _opened(path: Path) -> SoundReader | None:
    """Return a large sound file that is sound, opened; None for any other."""
    if path.suffix.lower() not in formats():
        return None
    try:
        sound = SoundReader(path)
    except (OSError, RecordingError):
        return None  # whoever reads it whole says what is wrong
    large = 8 * sound.n_samples * len(sound.raw.samples) >= _LARGE
    if large and sound.n_samples >= MIN_SAMPLES and LOWEST_RATE <= sound.raw.rate <= HIGHEST_RATE:
        return sound
    sound.close()
    return None
