"""Sound files (WAV, FLAC, AIFF, OGG, MP3), read to their end at any sample.

The sound library reads the first sound of a file and stops quietly where it breaks off. A
measurement cut short is not the measurement, so the samples announced are counted against those
that there are, and a file of several sounds is refused. Where a recorder did not come to
write the length of a WAV file, the library is given the file with its true length. Formats that
cannot be entered at any sample (OGG, MP3, FLAC from a pipe) are decoded as a whole.
"""

from __future__ import annotations

import os
import re
import struct
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

_BLOCK = 1 << 16  # samples a channel
_RIFF = (b"RIFF", b"RF64", b"BW64")  # tech.ebu.ch/docs/tech/tech3306.pdf, ITU-R BS.2088
_CHUNKED = (*_RIFF, b"RIFX", b"FORM")
_MOST_CHUNKS = 100_000  # what holds more was made to be walked for ever
_NO_SIZE = 0xFFFFFFFF
_UNFINISHED = (0, _NO_SIZE, 0x7FFFFFFF, 0x80000000, 0x7FFFF000)
"""Sizes of samples that recorders write before they know better (the last ones: arecord, SoX)."""

_DESCRIPTION_BYTES = 256  # EBU Tech 3285, first field of the chunk
_STARTS = [
    re.compile(re.escape(mark))
    for mark in (b"OggS\0\2", b"fLaC\0\0\0\x22", b"Xing\0\0\0", b"Info\0\0\0")
]
"""What a stream of Ogg or FLAC, or an MP3 that states its length, has once near its beginning.

One by one, as a pattern of several is ten times as slow.
"""


@contextmanager
def open_sound_file(path: Path) -> Iterator[RawRecording]:
    """Open a sound file, which is not empty.

    Raises
    ------
    RecordingError
        The file is no sound file, is damaged, holds several sounds, or ends before its header says;
        also by reading it.

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
        with path.open("rb") as opened:
            content = stack.enter_context(_Content(opened.fileno(), 0, access=ACCESS_COPY))
        chunked = content[:4] in _CHUNKED
        patched, note = _completed(path, content) if chunked else (False, "")
        # The library takes names in UTF-8 alone.
        file: Any = content if patched else path if os.name == "nt" else os.fsencode(path)
        stated = [] if chunked else _starts(path, content)
        with _errors(path):
            sound = stack.enter_context(soundfile.SoundFile(file))
            n_samples = int(sound.frames)
            read = _reading(path, sound)
            if not (chunked or _flac_length(content)):
                samples = _decoded(file)
                if samples.shape[1] < n_samples and stated and content[:4] != b"fLaC":
                    raise _truncated(path, n_samples, samples.shape[1])
                n_samples = samples.shape[1]
                read = lambda first, last: samples[:, first:last].astype(np.float64)  # noqa: E731
        yield RawRecording(
            n_channels=int(sound.channels),
            n_samples=n_samples,
            rate=float(sound.samplerate),
            fractional=sound.subtype not in ("FLOAT", "DOUBLE"),
            description=_description(content) if chunked else "",
            comment=sound.comment,
            read=read,
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
    """A file in memory, where what it lacks can be added; nothing leads beyond its end."""

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> None:
        """Go to a byte."""
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self.tell(), os.SEEK_END: len(self)}[whence]
        super().seek(min(max(0, base + offset), len(self)))


@contextmanager
def _errors(path: Path) -> Iterator[None]:
    try:
        yield
    except soundfile.LibsndfileError as error:
        reason = error.error_string.rstrip(".")
        raise RecordingError(f"{path}: is damaged or no sound file ({reason})") from error


def _starts(path: Path, content: mmap) -> list[int]:
    """Where streams begin that state their length; refused where there are several."""
    found = chain.from_iterable(islice(mark.finditer(content), 2) for mark in _STARTS)
    starts = sorted(one.start() for one in found)
    if starts[1:]:
        raise RecordingError(
            f"{path}: a second sound begins at byte {starts[1]}; save each as its own"
        )
    return starts


def _flac_length(content: mmap) -> int:
    """Return how many samples a stream of FLAC states (RFC 9639), 0 if none or no FLAC."""
    head = content[:26].ljust(26, b"\0")
    stated = (head[21] & 0x0F) << 32 | int.from_bytes(head[22:26], "big")
    return stated if head[:4] == b"fLaC" else 0


class _Stream(soundfile.SoundFile):  # type: ignore[misc]  # the library has no types
    """A sound that is read from its beginning to its end."""

    def seekable(self) -> bool:
        """Say no: else the place is set anew after each block, and MP3 clicks there."""
        return False


def _decoded(file: Any) -> NDArray[np.float32]:
    """Decode a sound to its end, shape (n_channels, n); MP3 may break off within its last frame."""
    parts: list[NDArray[np.float32]] = []
    with _Stream(file) as sound:
        try:
            while len(part := sound.read(_BLOCK, dtype="float32", always_2d=True)):
                parts.append(part)
        except soundfile.LibsndfileError:
            if not (parts and sound.format == "MP3"):
                raise
    return np.concatenate(parts).T if parts else np.zeros((1, 0), np.float32)


def _reading(path: Path, sound: Any) -> Read:
    """Give what reads a sound that can be entered at any sample."""

    def read(first: int, last: int) -> NDArray[np.float64]:
        with _errors(path):
            sound.seek(first)
            samples: NDArray[np.float64] = sound.read(last - first, "float64", always_2d=True)
        if len(samples) < last - first:
            raise _truncated(path, int(sound.frames), first + len(samples))
        return samples.T

    return read


def _truncated(path: Path, announced: int, found: int) -> RecordingError:
    return RecordingError(
        f"{path}: is truncated; its header announces {announced} samples, {found} can be read"
    )


# RIFF and AIFF


class _Chunk(NamedTuple):
    """One chunk: its four-letter name, where its content starts, and its announced size [byte]."""

    name: bytes
    start: int
    size: int

    @property
    def end(self) -> int:
        """Where the next one begins."""
        return self.start + self.size + self.size % 2


def _chunks(content: mmap) -> Iterator[_Chunk]:
    """Walk the chunks of a file, up to where none begins."""
    order: Any = "big" if content[:4] in (b"RIFX", b"FORM") else "little"
    at, long_data = 12, 0
    for _ in range(_MOST_CHUNKS):
        name, size = content[at : at + 4], int.from_bytes(content[at + 4 : at + 8], order)
        if at + 8 > len(content) or not all(0x20 <= byte < 0x7F for byte in name):
            return
        if name == b"ds64":
            # A 64-bit file puts the true size of its samples here, and -1 where it belongs.
            long_data = int.from_bytes(content[at + 16 : at + 24], "little")
        if name == b"data" and size == _NO_SIZE and long_data not in (0, (1 << 64) - 1):
            size = long_data
        yield (chunk := _Chunk(name, at + 8, size))
        at = chunk.end


def _completed(path: Path, content: mmap) -> tuple[bool, str]:
    """Write in memory what a header lacks; return whether it does, and what to note."""
    end, tag = len(content), content[:4]
    found = list(_chunks(content))
    at = next((i for i, one in enumerate(found) if one.name in (b"data", b"SSND")), None)
    if at is None:
        return False, ""
    data, last = found[at], found[-1]
    n = end - data.start
    followed = last is not data and last.end in (end, end + 1)  # by chunks up to the end
    open_end = data.size > n if data.size else n > 0 and not followed
    if tag in _RIFF and data.size in _UNFINISHED and open_end:
        for one in found[:at]:
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
    for one in found[at + 1 :]:
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
    """Return the description in the ``bext`` chunk of a WAV file, empty where it has none."""
    for chunk in _chunks(content):
        if chunk.name == b"bext":
            text = content[chunk.start : chunk.start + min(chunk.size, _DESCRIPTION_BYTES)]
            return text.partition(b"\0")[0].decode("latin-1").strip()
    return ""
