"""Sound files (WAV, FLAC, AIFF, OGG, MP3), read to their end at any sample.

The sound library stops quietly where a file breaks off. A measurement cut short is not the
measurement, so the samples announced are counted against the samples found. Where a header does not
state the length, `noise.recordings.formats.containers` makes of it what the library reads whole.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import soundfile
from numpy.typing import NDArray

from models.errors import RecordingError
from noise.recordings.formats import Format, RawRecording, Read
from noise.recordings.formats.containers import (
    Piece,
    PieceFile,
    bext_description,
    flac_length,
    sound_of,
    with_flac_length,
)

_BLOCK, _FEW = 1 << 16, 1 << 12  # samples a channel
_OTHERS = (b"RIFF", b"RIFX", b"RF64", b"FORM", b"fLaC", b"OggS")
"""How files begin that are no MP3, whatever they are called."""

_EXACT = ("WAV", "WAVEX", "RF64", "AIFF", "FLAC")
"""Formats of the sound library that can be entered at any sample; of others, what comes before is
decoded."""


@contextmanager
def open_sound_file(path: Path) -> Iterator[RawRecording]:
    """Open a sound file.

    Raises
    ------
    RecordingError
        The file is no sound file, is damaged, or ends before its header says; also by reading it.

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
    piece, notes = sound_of(path)
    with ExitStack() as stack:
        with _errors(path):
            sound, n_samples = _opened(path, piece, stack)
        yield RawRecording(
            n_channels=int(sound.channels),
            n_samples=n_samples,
            rate=float(sound.samplerate),
            fractional=sound.subtype not in ("FLOAT", "DOUBLE"),
            description=bext_description(path),
            comment=sound.comment,
            read=_reading(path, sound, n_samples),
            notes=tuple(notes),
        )


FORMAT = Format(
    "sound",
    (
        *(".wav", ".wave", ".bwf", ".bw64", ".rf64", ".aif", ".aiff"),
        *(".flac", ".mp3", ".oga", ".ogg", ".opus"),
    ),
    open=open_sound_file,
)


def _reading(path: Path, sound: Any, n_samples: int) -> Read:
    """Give what reads a sound; refused where it breaks off before its end."""
    position = 0

    def block(start: int, n: int) -> NDArray[np.float64]:
        nonlocal position
        if start != position and sound.format in _EXACT:
            position = sound.seek(start)
        elif start < position:
            position = sound.seek(0)
        while position < start and (passed := len(sound.read(min(_BLOCK, start - position)))):
            position += passed
        found: NDArray[np.float64] = sound.read(n, dtype="float64", always_2d=True)
        position += len(found)
        return found

    def read(first: int, last: int) -> NDArray[np.float64]:
        samples, done = np.empty((sound.channels, last - first)), first
        with _errors(path):
            while done < last:
                found = block(done, min(_BLOCK, last - done))
                if not len(found):
                    raise RecordingError(
                        f"{path}: is truncated; its header announces {n_samples} samples, "
                        f"{done} can be read"
                    )
                samples[:, done - first : done - first + len(found)] = found.T
                done += len(found)
        return samples

    return read


@contextmanager
def _errors(path: Path) -> Iterator[None]:
    try:
        yield
    except soundfile.LibsndfileError as error:
        reason = error.error_string.rstrip(".")
        raise RecordingError(f"{path}: is damaged or no sound file ({reason})") from error


def _opened(path: Path, piece: Piece, stack: ExitStack) -> tuple[Any, int]:
    """Open the sound of a file, whose name the library takes in UTF-8 alone; tell its length."""
    n_samples = None
    if piece.unknown or flac_length(path, piece) == 0:
        with PieceFile(path, piece) as counted:
            n_samples = _count(path, _Quiet(counted), piece)
        if not piece.unknown:
            piece = with_flac_length(path, piece, n_samples)
    file: Any
    if piece == Piece(0, path.stat().st_size):
        file = path if os.name == "nt" else os.fsencode(path)
    else:
        file = stack.enter_context(PieceFile(path, piece))
    with path.open("rb") as start:
        known = (piece.head or start.read(4))[:4] in _OTHERS
    sound = stack.enter_context((soundfile.SoundFile if known else _Quiet)(file))
    return sound, int(sound.frames) if n_samples is None else n_samples


def _count(path: Path, sound: Any, piece: Piece) -> int:
    """Decode a sound to its end; one of unknown length may break off within its last frame."""
    n = 0
    try:
        while passed := len(sound.read(_FEW if piece.unknown else _BLOCK)):
            n += passed
    except soundfile.LibsndfileError as error:
        if not (piece.unknown and n):
            raise RecordingError(
                f"{path}: does not say how long it is, and breaks off after {n} samples "
                f"({n / sound.samplerate:.6g} s; {error.error_string.rstrip('.')})"
            ) from None
    finally:
        sound.close()
    return n


class _Quiet(soundfile.SoundFile):  # type: ignore[misc]  # the library has no types
    """MP3, whose library (mpg123) prints what it thinks of a file: that goes nowhere."""

    def __init__(self, file: object) -> None:
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
