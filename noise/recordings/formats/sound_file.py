"""Reader of sound files (WAV, FLAC, AIFF, OGG, MP3) with random access and checks of completeness.

libsndfile reads the first sound of a file and stops silently where it is truncated. So the
announced number of samples is checked, and files of several sounds are refused. If the header lacks
the length (a WAV recorder that was switched off, FLAC from a pipe, MP3 without a header), it is
completed in memory.
"""

from __future__ import annotations

import io
import os
import re
import struct
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from itertools import chain, islice
from mmap import ACCESS_COPY, mmap
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import soundfile
from numpy.typing import NDArray

from models.errors import RecordingError
from noise.recordings.formats import Format, RawRecording, Read

_BLOCK, _FEW = 1 << 16, 1 << 12  # samples per channel
_RIFF = (b"RIFF", b"RF64", b"BW64")  # tech.ebu.ch/docs/tech/tech3306.pdf, ITU-R BS.2088
_CHUNKED = (*_RIFF, b"RIFX", b"FORM")
_MOST_CHUNKS = 100_000  # more are only in files that are made to exhaust a reader
_NO_SIZE = 0xFFFFFFFF
_UNFINISHED = (0, _NO_SIZE, 0x7FFFFFFF, 0x80000000, 0x7FFFF000)
"""Placeholders that recorders write for the size of the samples (the last ones: arecord, SoX)."""

_DESCRIPTION_BYTES = 256  # EBU Tech 3285, first field of the chunk
_STARTS = [
    re.compile(re.escape(mark))
    for mark in (b"OggS\0\2", b"fLaC\0\0\0\x22", b"Xing\0\0\0", b"Info\0\0\0")
]
"""Start markers of Ogg and FLAC streams and of MP3 headers with a length; each occurs once.

Separate patterns, because one pattern of alternatives is ten times slower.
"""

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
        patched, note = _completed(path, content) if chunked else (False, "")
        with _errors(path):
            sound, n_samples = _opened(path, content, stack, patched=patched)
        yield RawRecording(
            n_channels=int(sound.channels),
            n_samples=n_samples,
            rate=float(sound.samplerate),
            fractional=sound.subtype not in ("FLOAT", "DOUBLE"),
            description=_description(content) if chunked else "",
            comment=sound.comment,
            read=_reading(path, sound, n_samples),
            notes=tuple(filter(None, [note])),
        )


FORMAT = Format(
    "sound",
    (
        *(".wav", ".wave", ".bwf", ".bw64", ".rf64", ".aif", ".aiff"),
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


@contextmanager
def _errors(path: Path) -> Iterator[None]:
    """Convert errors of the library into RecordingError."""
    try:
        yield
    except soundfile.LibsndfileError as error:
        reason = error.error_string.rstrip(".")
        raise RecordingError(f"{path}: is damaged or no sound file ({reason})") from error


def _opened(path: Path, content: mmap, stack: ExitStack, *, patched: bool) -> tuple[Any, int]:
    """Open a sound and return it with its number of samples."""
    # As bytes, since the library encodes names in UTF-8, which fails for some.
    file: Any = content if patched else path if os.name == "nt" else os.fsencode(path)
    if content[:4] in _CHUNKED:
        sound = stack.enter_context(soundfile.SoundFile(file))
        return sound, int(sound.frames)
    matches = chain.from_iterable(islice(mark.finditer(content), 2) for mark in _STARTS)
    starts = sorted(match.start() for match in matches)
    if starts[1:]:
        raise RecordingError(
            f"{path}: a second sound begins at byte {starts[1]}; save each as its own"
        )
    if content[:4] == b"OggS" or (content[:4] == b"fLaC" and _flac_length(content)):
        sound = stack.enter_context(soundfile.SoundFile(file))
        return sound, int(sound.frames)
    if content[:4] == b"fLaC":
        with _Quiet(file) as sound:
            n_samples = _count(path, sound, _BLOCK)
        content[21] |= n_samples >> 32
        content[22:26] = (n_samples & 0xFFFFFFFF).to_bytes(4, "big")
        return stack.enter_context(soundfile.SoundFile(content)), n_samples
    if starts or b"VBRI" in content[:_FEW]:
        sound = stack.enter_context(_Quiet(file))
        return sound, int(sound.frames)
    with _Extended(path) as extended, _Quiet(extended) as sound:
        n_samples = _count(path, sound, _FEW)
    return stack.enter_context(_Quiet(stack.enter_context(_Extended(path)))), n_samples


def _flac_length(content: mmap) -> int:
    """Return the stated number of samples of a FLAC stream (RFC 9639), 0 if unknown."""
    head = content[:26].ljust(26, b"\0")
    return (head[21] & 0x0F) << 32 | int.from_bytes(head[22:26], "big")


def _count(path: Path, sound: Any, n_at_once: int) -> int:
    """Count the samples of a sound by decoding it; an MP3 may end within a frame."""
    n = 0
    try:
        while passed := len(sound.read(n_at_once)):
            n += passed
    except soundfile.LibsndfileError as error:
        if not (n and sound.format == "MP3"):
            raise RecordingError(
                f"{path}: does not state its length, and breaks off after {n} samples "
                f"({n / sound.samplerate:.6g} s; {error.error_string.rstrip('.')})"
            ) from None
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


# RIFF and AIFF


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


def _completed(path: Path, content: mmap) -> tuple[bool, str]:
    """Complete an unfinished header in memory; return whether it changed, and a note."""
    end, tag = len(content), content[:4]
    chunks = list(_chunks(content))
    at = next((i for i, one in enumerate(chunks) if one.name in (b"data", b"SSND")), None)
    if at is None:
        return False, ""
    data, last = chunks[at], chunks[-1]
    n = end - data.start
    followed = last is not data and last.end in (end, end + 1)  # chunks up to the end of the file
    open_end = data.size > n if data.size else n > 0 and not followed
    if tag in _RIFF and data.size in _UNFINISHED and open_end:
        for one in chunks[:at]:
            if one.name == b"ds64":
                content[one.start : one.start + 24] = struct.pack("<QQQ", end - 8, n, 0)
        if tag == b"RIFF":
            content[data.start - 4 : data.start] = struct.pack("<I", min(n, _NO_SIZE))
        else:
            content[:4] = b"RF64"
        return (
            True,
            f"the recorder did not finish the header; the {n} bytes that follow it are read",
        )
    if data.size > n:
        raise RecordingError(
            f"{path}: is truncated; its header announces {data.size - n} bytes of samples more "
            f"than the {n} that there are"
        )
    for one in chunks[at + 1 :]:
        if one.name in _RIFF:
            raise RecordingError(
                f"{path}: a second sound begins at byte {one.start - 8}; save each as its own"
            )
    if tag == b"BW64":
        content[:4] = b"RF64"
    rest = end - last.start - last.size
    note = f"{rest} bytes after the end that the header states are not read"
    return tag == b"BW64", note * (rest > 0 and any(content[-rest:][: 1 << 20]))


def _description(content: mmap) -> str:
    """Return the description in the ``bext`` chunk of a WAV file; empty if there is none."""
    for chunk in _chunks(content):
        if chunk.name == b"bext":
            text = content[chunk.start : chunk.start + min(chunk.size, _DESCRIPTION_BYTES)]
            return text.partition(b"\0")[0].decode("latin-1").strip()
    return ""


# MP3; its library (mpg123) prints warnings on standard error


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


class _Quiet(soundfile.SoundFile):  # type: ignore[misc]  # the library has no types
    """Sound file that suppresses the output of the library."""

    def __init__(self, file: object) -> None:
        with _silence():
            super().__init__(file)

    def seekable(self) -> bool:
        """Return False: otherwise soundfile seeks after each block, and MP3 clicks there."""
        return False

    def read(self, *args: Any, **kwargs: Any) -> Any:
        """Read samples."""
        with _silence():
            return super().read(*args, **kwargs)


_silencing = threading.Lock()


@contextmanager
def _silence() -> Iterator[None]:
    """Redirect standard error to the null device for libraries that bypass Python."""
    with _silencing:
        try:
            stderr = os.dup(2)
        except OSError:  # it is closed
            yield
            return
        null_device = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null_device, 2)
        try:
            yield
        finally:
            os.dup2(stderr, 2)
            os.close(stderr)
            os.close(null_device)
