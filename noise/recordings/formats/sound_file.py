"""Sound files (WAV, FLAC, AIFF, OGG, MP3), read to their end at any sample.

The sound library stops quietly where a file breaks off. A measurement cut short is not the
measurement, so the samples announced are counted against the samples found. Where a header does not
state the length, or a file holds sounds one after the other, `noise.recordings.formats.containers`
makes of it what the library reads whole.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from itertools import accumulate
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
    pieces_of,
    with_flac_length,
)

_BLOCK = 1 << 16  # samples a channel
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
    pieces, notes = pieces_of(path)
    with ExitStack() as stack:
        with _errors(path):
            sounds = [_opened(path, piece, stack) for piece in pieces]
        first = sounds[0]
        for sound in sounds:
            if (sound.samplerate, sound.channels) != (first.samplerate, first.channels):
                raise RecordingError(
                    f"{path}: holds sounds one after the other, of {first.channels} tracks at "
                    f"{first.samplerate} Hz and of {sound.channels} at {sound.samplerate} Hz; "
                    "save each as a file of its own"
                )
        yield RawRecording(
            n_channels=int(first.channels),
            n_samples=sum(int(sound.frames) for sound in sounds),
            rate=float(first.samplerate),
            fractional=first.subtype not in ("FLOAT", "DOUBLE"),
            description=bext_description(path),
            comment=first.comment,
            read=_reading(path, sounds),
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


def _reading(path: Path, sounds: Sequence[Any]) -> Read:
    """Give what reads sounds that follow one another; refused where one breaks off before."""
    ends = list(accumulate(int(sound.frames) for sound in sounds))
    positions = [0] * len(sounds)

    def block(i: int, start: int, n: int) -> NDArray[np.float64]:
        sound, position = sounds[i], positions[i]
        if start != position and sound.format in _EXACT:
            position = sound.seek(start)
        elif start < position:
            position = sound.seek(0)
        while position < start and (passed := len(sound.read(min(_BLOCK, start - position)))):
            position += passed
        found: NDArray[np.float64] = sound.read(n, dtype="float64", always_2d=True)
        positions[i] = position + len(found)
        return found

    def read(first: int, last: int) -> NDArray[np.float64]:
        samples, done = np.empty((sounds[0].channels, last - first)), first
        with _errors(path):
            for i, end in enumerate(ends):
                start = end - int(sounds[i].frames)
                while start <= done < min(end, last):
                    found = block(i, done - start, min(_BLOCK, min(end, last) - done))
                    if not len(found):
                        raise RecordingError(
                            f"{path}: is truncated; its header announces {ends[-1]} samples, "
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


def _opened(path: Path, piece: Piece, stack: ExitStack) -> Any:
    """Open a piece of a file, whose name the library takes in UTF-8 alone."""
    if flac_length(path, piece) == 0:
        with ExitStack() as counting:
            n = _count(path, _Quiet(counting.enter_context(PieceFile(path, piece))))
        piece = with_flac_length(path, piece, n)
    file: Any
    if piece == Piece(0, path.stat().st_size):
        file = path if os.name == "nt" else os.fsencode(path)
    else:
        file = stack.enter_context(PieceFile(path, piece))
    with path.open("rb") as start:
        known = (piece.head or start.read(4))[:4] in _OTHERS
    return stack.enter_context((soundfile.SoundFile if known else _Quiet)(file))


def _count(path: Path, sound: Any) -> int:
    """Decode a sound to its end."""
    n = 0
    try:
        while passed := len(sound.read(_BLOCK)):
            n += passed
    except soundfile.LibsndfileError as error:
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
