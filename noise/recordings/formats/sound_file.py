"""Reader of sound files (WAV, FLAC, AIFF, OGG, MP3) with random access and checks of completeness.

libsndfile reads the first sound of a file and stops silently where it is truncated. So the
announced number of samples is checked, and files of several sounds are refused. The header of a WAV
whose recorder was switched off is completed in memory, and an MP3 without a header is decoded once
to count its samples.
"""

from __future__ import annotations

import io
import os
import struct
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from mmap import ACCESS_COPY, mmap
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import soundfile
from numpy.typing import NDArray

from models.errors import RecordingError
from noise.recordings.formats import Format, RawRecording, Read

_BLOCK, _FEW = 1 << 16, 1 << 12  # samples per channel
_CHUNKED = (b"RIFF", b"RIFX", b"RF64", b"FORM")  # EBU Tech 3285 and 3306; AIFF
_MOST_CHUNKS = 100_000  # more are only in files that are made to exhaust a reader
_NO_SIZE = 0xFFFFFFFF
_NO_LENGTH = 1 << 62  # samples; the library counts more where a FLAC states no length
_UNFINISHED = (0, _NO_SIZE, 0x7FFFFFFF, 0x80000000, 0x7FFFF000)
"""Placeholders that recorders write for the size of the samples (the last ones: arecord, SoX)."""

_DESCRIPTION_BYTES = 256  # EBU Tech 3285, first field of the chunk
_STARTS = (b"OggS\0\2", b"fLaC\0\0\0\x22", b"Xing\0\0\0", b"Info\0\0\0")
"""Start markers of Ogg and FLAC streams and of MP3 headers with a length; each occurs once."""

_SECOND = "a second sound begins at byte {}; save each as its own"

_LENGTH_FACTOR = 100
"""Factor on the size of an MP3 without a length. The library estimates a length from the size and
the first frames, of 8 to 320 kbit/s, and would stop there."""

_SEEKABLE = ("WAV", "WAVEX", "RF64", "AIFF", "FLAC")
"""Formats with exact random access; others are decoded from the beginning."""


@contextmanager
def open_sound_file(path: Path) -> Iterator[RawRecording]:
    """Open a sound file that is not empty.

    Yields
    ------
    RawRecording

    Raises
    ------
    RecordingError
        The file is no sound file, is damaged, holds several sounds, or is truncated; also when
        samples are read.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "tone.flac"
    ...     soundfile.write(path, np.full(480, 0.5), 48000)
    ...     with open_sound_file(path) as raw:
    ...         samples = raw.whole()
    >>> samples.shape, raw.rate, raw.fractional, float(samples[0, 0])
    ((1, 480), 48000.0, True, 0.5)
    """
    with ExitStack() as stack:
        with path.open("rb") as file:
            content = stack.enter_context(_Content(file.fileno(), 0, access=ACCESS_COPY))
        chunked = content[:4] in _CHUNKED
        chunks = list(_chunks(content)) if chunked else []
        finished, note = _check_chunks(path, content, chunks)
        has_length = chunked or _has_length(path, content)
        # As bytes, since the library encodes names in UTF-8, which fails for some.
        source: Any = path if os.name == "nt" else os.fsencode(path)
        if not finished:
            source = content
        elif not has_length:
            source = stack.enter_context(_Extended(path))
        with _errors(path):
            n_samples = None if has_length else _mp3_length(path)
            sound = stack.enter_context(_Continuous(source))
        n_samples = int(sound.frames) if n_samples is None else n_samples
        if n_samples > _NO_LENGTH:
            raise RecordingError(f"{path}: does not state its length; store it anew, as by ffmpeg")
        yield RawRecording(
            n_channels=int(sound.channels),
            n_samples=n_samples,
            rate=float(sound.samplerate),
            fractional=sound.subtype not in ("FLOAT", "DOUBLE"),
            description=_description(content, chunks),
            comment=sound.comment,
            read=_reading(path, sound, n_samples),
            notes=(note,) if note else (),
        )


FORMAT = Format(
    "sound",
    (
        *(".wav", ".wave", ".bwf", ".rf64", ".aif", ".aiff"),
        *(".flac", ".mp3", ".oga", ".ogg", ".opus"),
    ),
    open=open_sound_file,
)


class _Content(mmap):
    """Memory map of a file whose header can be completed; seeking is limited to its size."""

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> None:
        """Set the position."""
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self.tell(), os.SEEK_END: len(self)}[whence]
        super().seek(min(max(0, base + offset), len(self)))


class _Continuous(soundfile.SoundFile):  # type: ignore[misc]  # the library has no types
    """Sound file that is read on without seeking, which makes MP3 click between blocks."""

    def seekable(self) -> bool:
        """Return False, as otherwise soundfile seeks after each block."""
        return False


class _Extended(io.FileIO):
    """File that claims to be longer than it is, with zeros after its end."""

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Set the position."""
        if whence == os.SEEK_END:
            whence, offset = os.SEEK_SET, offset + _LENGTH_FACTOR * os.fstat(self.fileno()).st_size
        return super().seek(offset, whence)

    def readinto(self, buffer: Any) -> int:
        """Read bytes into a buffer; zeros where the library looks for a tag at the end."""
        if self.tell() > os.fstat(self.fileno()).st_size:
            view = memoryview(buffer).cast("B")
            view[:] = bytes(len(view))
            self.seek(len(view), os.SEEK_CUR)
            return len(view)
        return super().readinto(buffer) or 0


@contextmanager
def _errors(path: Path) -> Iterator[None]:
    """Convert errors of the library into RecordingError."""
    try:
        yield
    except soundfile.LibsndfileError as error:
        reason = error.error_string.rstrip(".")
        raise RecordingError(f"{path}: is damaged or no sound file ({reason})") from error


def _has_length(path: Path, content: mmap) -> bool:
    """Whether a stream states its length, as all but MP3 do; refuse a second stream."""
    starts: list[int] = []
    for mark in _STARTS:
        start = content.find(mark)
        while start >= 0 and len(starts) < 2:
            starts.append(start)
            start = content.find(mark, start + 1)
    if len(starts) > 1:
        raise RecordingError(f"{path}: {_SECOND.format(max(starts))}")
    return bool(starts) or b"VBRI" in content[:_FEW]


def _mp3_length(path: Path) -> int:
    """Count the samples of an MP3 by decoding it; it may end within a frame."""
    n = 0
    with _Extended(path) as extended, _Continuous(extended) as sound:
        try:
            while count := len(sound.read(_FEW)):
                n += count
        except soundfile.LibsndfileError:
            if not n:
                raise
    return n


def _reading(path: Path, sound: Any, n_samples: int) -> Read:
    """Return a function that reads samples and refuses a truncated sound."""
    position = 0

    def block(start: int, n: int) -> NDArray[np.float64]:
        nonlocal position
        if start != position and sound.format in _SEEKABLE:
            position = sound.seek(start)
        elif start < position:
            position = sound.seek(0)
        while position < start and (passed := len(sound.read(min(_BLOCK, start - position)))):
            position += passed
        frames: NDArray[np.float64] = sound.read(n, dtype="float64", always_2d=True)
        position += len(frames)
        return frames

    def read(first: int, last: int) -> NDArray[np.float64]:
        samples, at = np.empty((sound.channels, last - first)), first
        with _errors(path):
            while at < last:
                frames = block(at, min(_BLOCK, last - at))
                if not len(frames):
                    raise RecordingError(
                        f"{path}: is truncated; its header announces {n_samples} samples, "
                        f"{at} can be read"
                    )
                samples[:, at - first : at - first + len(frames)] = frames.T
                at += len(frames)
        return samples

    return read


class _Chunk(NamedTuple):
    """Chunk of a file: four-letter name, start of the content, and announced size [byte]."""

    name: bytes
    start: int
    size: int

    @property
    def end(self) -> int:
        """Start of the next chunk [byte]."""
        return self.start + self.size + self.size % 2


def _chunks(content: mmap) -> Iterator[_Chunk]:
    """Yield the chunks of a file up to the first invalid one."""
    order: Any = "big" if content[:4] in (b"RIFX", b"FORM") else "little"
    at, long_data = 12, 0
    for _ in range(_MOST_CHUNKS):
        name, size = content[at : at + 4], int.from_bytes(content[at + 4 : at + 8], order)
        if at + 8 > len(content) or not all(0x20 <= byte < 0x7F for byte in name):
            return
        if name == b"ds64":
            # 64-bit files state the size of the samples here, and -1 in the data chunk.
            long_data = int.from_bytes(content[at + 16 : at + 24], "little")
        if name == b"data" and size == _NO_SIZE and long_data not in (0, (1 << 64) - 1):
            size = long_data
        yield (chunk := _Chunk(name, at + 8, size))
        at = chunk.end


def _check_chunks(path: Path, content: mmap, chunks: list[_Chunk]) -> tuple[bool, str]:
    """Check that the samples of a file of chunks are complete, and complete its header in memory.

    Return whether the header was finished, and a note.
    """
    at = next((i for i, one in enumerate(chunks) if one.name in (b"data", b"SSND")), None)
    if at is None:
        return True, ""
    end, data, last = len(content), chunks[at], chunks[-1]
    n = end - data.start
    followed = last is not data and last.end in (end, end + 1)  # chunks up to the end of the file
    open_end = data.size > n if data.size else n > 0 and not followed
    if content[:4] == b"RIFF" and data.size in _UNFINISHED and open_end:
        content[data.start - 4 : data.start] = struct.pack("<I", min(n, _NO_SIZE))
        return (
            False,
            f"the recorder did not finish the header; the {n} bytes that follow it are read",
        )
    if data.size > n:
        raise RecordingError(
            f"{path}: is truncated; its header announces {data.size - n} bytes of samples more "
            f"than the {n} that there are"
        )
    second = next((one for one in chunks[at + 1 :] if one.name in _CHUNKED), None)
    if second is not None:
        raise RecordingError(f"{path}: {_SECOND.format(second.start - 8)}")
    rest = end - last.start - last.size
    note = f"{rest} bytes after the end that the header states are not read"
    return True, note * (rest > 0 and any(content[-rest:][: 1 << 20]))


def _description(content: mmap, chunks: list[_Chunk]) -> str:
    """Return the description in the ``bext`` chunk of a WAV file; empty if there is none."""
    for chunk in chunks:
        if chunk.name == b"bext":
            text = content[chunk.start : chunk.start + min(chunk.size, _DESCRIPTION_BYTES)]
            return text.partition(b"\0")[0].decode("latin-1").strip()
    return ""
