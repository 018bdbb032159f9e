"""Sound files (WAV, FLAC, AIFF, OGG, MP3) as raw samples.

The sound library stops quietly where a file breaks off. A measurement cut short is not the
measurement, so the samples announced are counted against the samples found. Samples are copied
block by block into the one array that is returned, so that reading takes the memory of the result
and no more.

Two things the library passes over stand in the list of chunks of a RIFF file: where the samples end
that its header announces, and the description (``bext`` chunk of a broadcast WAV file, EBU Tech
3285), in which sound level meters write the value of full scale. The list is walked without trust:
whatever cannot be followed ends the walk, and judging the file is left to the library.
"""

from __future__ import annotations

import os
import threading
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
import soundfile

from models.errors import RecordingError
from noise.recordings.files import RawSamples

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = [
    "DENSEST", "Chunk", "bext_description", "chunks", "missing_bytes", "open_sound",
    "read_sound_file",
]  # fmt: skip

_BLOCK = 1 << 16  # samples a channel
DENSEST = 8192
"""Samples a byte at most: FLAC holds silence in about 10 bytes a block of 65535 samples."""

_DESCRIPTION_BYTES = 256  # EBU Tech 3285, first field of the chunk
_LENGTH_UNKNOWN = 0xFFFFFFFF  # left by programs that could not go back and fill it in
_SAMPLE_CHUNKS = (b"data", b"SSND")  # RIFF, AIFF
_OTHERS = (b"RIFF", b"RIFX", b"RF64", b"FORM", b"fLaC", b"OggS")
"""How files begin that are no MP3, whatever they are called."""


def read_sound_file(path: Path) -> RawSamples:
    """Read all samples of a sound file.

    Parameters
    ----------
    path : Path
        An existing file.

    Returns
    -------
    RawSamples

    Raises
    ------
    RecordingError
        The file is no sound file, is damaged, or ends before its header says.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "tone.flac"
    ...     soundfile.write(path, np.full(480, 0.5), 48000)
    ...     raw = read_sound_file(path)
    >>> raw.samples.shape, raw.rate, raw.fractional, float(raw.samples[0, 0])
    ((1, 480), 48000.0, True, 0.5)
    """
    if missing := missing_bytes(path):
        raise RecordingError(
            f"{path}: is truncated; its header announces {missing} bytes of samples more than "
            f"there are"
        )
    try:
        with open_sound(path) as sound:
            return RawSamples(
                samples=_samples(path, sound),
                rate=float(sound.samplerate),
                fractional=sound.subtype not in ("FLOAT", "DOUBLE"),
                description=bext_description(path),
                comment=sound.comment,
            )
    except soundfile.LibsndfileError as error:
        reason = error.error_string.rstrip(".")
        raise RecordingError(f"{path}: is damaged or no sound file ({reason})") from error


def open_sound(path: Path) -> Any:
    """Open a sound file whatever its name, of which the library takes texts in UTF-8 alone.

    Raises
    ------
    soundfile.LibsndfileError
        It is none.
    """
    with path.open("rb") as file:
        known = file.read(4) in _OTHERS
    kind = soundfile.SoundFile if known else _Quiet
    return kind(path if os.name == "nt" else os.fsencode(path))


class _Quiet(soundfile.SoundFile):  # type: ignore[misc]  # the library has no types
    """MP3, whose library (mpg123) prints what it thinks of a file: that goes nowhere."""

    def __init__(self, file: str | bytes | Path) -> None:
        with _silence():
            super().__init__(file)

    def seekable(self) -> bool:
        """Say no: else the place is set anew after each block, and MP3 clicks there."""
        return False

    def read(self, *given: Any, **named: Any) -> Any:
        """Read samples."""
        with _silence():
            return super().read(*given, **named)


_silencing = threading.Lock()


@contextmanager
def _silence() -> Iterator[None]:
    """Close standard error to libraries that write past Python."""
    with _silencing:
        try:
            kept = os.dup(2)
        except OSError:  # it is closed
            yield
            return
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            os.close(nowhere)


def _samples(path: Path, sound: Any) -> NDArray[np.float64]:
    announced = int(sound.frames)
    if announced > DENSEST * path.stat().st_size:
        raise RecordingError(
            f"{path}: its header announces {announced} samples, more than a file of this size holds"
        )
    samples = np.empty((int(sound.channels), announced))
    read = 0
    while len(samples) == 1 and read < announced:  # without a copy
        found = len(sound.read(out=samples[0, read : read + _BLOCK]))
        if not found:
            break
        read += found
    while len(block := sound.read(_BLOCK, dtype="float64", always_2d=True)):
        samples[:, read : read + len(block)] = block.T
        read += len(block)
    if read < announced:
        raise RecordingError(
            f"{path}: is truncated; its header announces {announced} samples, {read} can be read"
        )
    return samples


@dataclass(frozen=True)
class Chunk:
    """One chunk: its four-letter name, where its content starts, and its announced size [byte]."""

    name: bytes
    start: int
    size: int


def chunks(file: BinaryIO) -> Iterator[Chunk]:
    """Walk the chunks of a RIFF, RIFX, RF64, BW64 or AIFF file; nothing for any other.

    Examples
    --------
    >>> import io
    >>> list(chunks(io.BytesIO(b"RIFF....WAVEfmt " + bytes([2, 0, 0, 0]) + b"xxdata")))
    [Chunk(name=b'fmt ', start=20, size=2)]
    """
    head = file.read(12)
    if head[:4] not in (b"RIFF", b"RIFX", b"RF64", b"BW64", b"FORM"):
        return
    little = head[:4] not in (b"RIFX", b"FORM")
    long_data: int | None = None
    position = len(head)
    while True:
        file.seek(position)
        field = file.read(8)
        name = field[:4]
        if len(field) < 8 or not all(0x20 <= byte < 0x7F for byte in name):
            return
        size = int.from_bytes(field[4:], "little" if little else "big")
        if name == b"ds64":
            # A 64-bit file puts the true size of its samples here, and -1 where it belongs.
            long_data = int.from_bytes(file.read(16)[8:], "little")
        if name == b"data" and size == _LENGTH_UNKNOWN and long_data is not None:
            size = long_data
        yield Chunk(name, position + 8, size)
        position += 8 + size + size % 2


def bext_description(path: Path) -> str:
    """Read the description in the ``bext`` chunk of a WAV file, empty where it has none."""
    with path.open("rb") as file:
        for chunk in chunks(file):
            if chunk.name == b"bext":
                file.seek(chunk.start)
                text = file.read(min(chunk.size, _DESCRIPTION_BYTES))
                return text.partition(b"\0")[0].decode("latin-1").strip()
    return ""


def missing_bytes(path: Path) -> int:
    """How many bytes of samples the header announces beyond the end of the file; 0 if complete."""
    with path.open("rb") as file:
        end = os.fstat(file.fileno()).st_size
        for chunk in chunks(file):
            if chunk.name in _SAMPLE_CHUNKS:
                known = chunk.size != _LENGTH_UNKNOWN
                return max(0, chunk.start + chunk.size - end) if known else 0
    return 0
