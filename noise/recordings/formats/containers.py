"""Containers of sound: chunks of RIFF, pages of Ogg, streams of FLAC and MPEG, with their length.

The sound library reads the first sound of a file and takes its length from the header; where that
has none, it estimates it from the size of the file (MP3), gives up (FLAC) or finds no samples (a
WAV file whose recorder was switched off before it could fill in the sizes). So each file becomes a
piece that the library reads to its end, and a file of several sounds is refused. Nothing in a file
is trusted: a walk ends where it cannot be followed, and judging what is left is the library's.
"""

from __future__ import annotations

import io
import os
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from models.errors import RecordingError

_RIFF = (b"RIFF", b"RF64", b"BW64")
_SAMPLE_CHUNKS = (b"data", b"SSND")  # RIFF, AIFF
_MOST_CHUNKS = 100_000  # what holds more was made to be walked for ever
_NO_SIZE = 0xFFFFFFFF
_UNFINISHED = (0, _NO_SIZE, 0x7FFFFFFF, 0x80000000, 0x7FFFF000)
"""Sizes of samples that recorders write before they know better (the last ones: arecord, SoX)."""

_DESCRIPTION_BYTES = 256  # EBU Tech 3285, first field of the chunk
_FLAC = b"fLaC\x00\x00\x00\x22"  # with the head of the block that always comes first
_MPEG = re.compile(rb"\xff[\xe2-\xff][\x10-\xef]")  # how a frame of MP3 may begin
_PLAYERS = re.compile(_MPEG.pattern + rb".(?:(?:.{9}|.{17}|.{32})(?:Xing|Info)|.{32}VBRI)", re.S)
"""A frame of MP3 without sound, in which the length stands; files that were joined have several."""

_MOST_BEFORE = 1 << 11  # bytes from what may be a frame to it
_NO_LENGTH = 100
"""Times its size that an MP3 without a length is given out to have: the library estimates a length
from the size and the first frames, of 8 to 320 kbit/s, and reads no further than that."""


@dataclass(frozen=True)
class Piece:
    """Part of a file that is one sound for the library.

    Parameters
    ----------
    start, end : int
        Of its bytes in the file.
    head : bytes
        Stands before them.
    unknown : bool
        Whether its length has to be counted.
    """

    start: int
    end: int
    head: bytes = b""
    unknown: bool = False


class PieceFile(io.RawIOBase):
    """A piece as a file to read from.

    Parameters
    ----------
    path : Path
    piece : Piece
    """

    def __init__(self, path: Path, piece: Piece) -> None:
        self._file = path.open("rb")
        self._piece, self._at = piece, 0
        self._size = len(piece.head) + piece.end - piece.start
        self._stated = self._size * (_NO_LENGTH if piece.unknown else 1)

    def readable(self) -> bool:
        """Say yes."""
        return True

    seekable = readable

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a byte."""
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._stated}[whence]
        self._at = max(0, base + offset)
        return self._at

    def tell(self) -> int:
        """Return the number of the next byte."""
        return self._at

    def readinto(self, buffer: object) -> int:
        """Read as many bytes as fit."""
        view = memoryview(buffer).cast("B")  # type: ignore[arg-type]  # a writable buffer
        if self._at >= self._size + _NO_LENGTH:  # of an unknown length, where a tag would stand
            view[:] = bytes(len(view))
            return len(view)
        n, head = min(len(view), max(0, self._size - self._at)), self._piece.head
        known = head[self._at : self._at + n]
        self._file.seek(self._piece.start + max(0, self._at - len(head)))
        data = known + self._file.read(n - len(known))
        view[: len(data)] = data
        self._at += len(data)
        return len(data)

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        super().close()


def sound_of(path: Path) -> tuple[Piece, list[str]]:
    """Find the one sound in a file.

    Parameters
    ----------
    path : Path
        A file that is not empty.

    Returns
    -------
    piece : Piece
        A FLAC stream that does not state its length has none here either, see `with_flac_length`.
    notes : list of str
        What should be known of it.

    Raises
    ------
    RecordingError
        There are several, it ends before its header says, or it holds what cannot be told apart.
    """
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        file.seek(id3_bytes(file.read(10)))
        magic = file.read(4)
        file.seek(0)
        if magic in (*_RIFF, b"RIFX", b"FORM"):
            return _riff_sound(path, file, size)
        if magic == b"OggS":
            starts = _ogg_starts(file.read())
        elif magic == b"fLaC":
            starts = _places(file, _FLAC) or [0]
        else:
            return _mpeg_sound(path, file.read()), []
    if len(starts) > 1:
        raise _several(path, starts[1])
    return Piece(starts[0], size), []


def _several(path: Path, at: int) -> RecordingError:
    return RecordingError(f"{path}: a second sound begins at byte {at}; save each as its own")


def _mpeg_sound(path: Path, data: bytes) -> Piece:
    """MP3 from its first frame on; what states no length is counted."""
    tag = id3_bytes(data[:10])
    first = _MPEG.search(data, tag)
    if first is None:
        raise RecordingError(f"{path}: is damaged or no sound file (Format not recognised)")
    lengths = [found.start() for found in _PLAYERS.finditer(data, tag)]
    if lengths[1:] or (lengths and lengths[0] > first.start() + _MOST_BEFORE):
        raise _several(path, lengths[-1])
    return Piece(lengths[0] if lengths else first.start(), len(data), unknown=not lengths)


def id3_bytes(head: bytes) -> int:
    """Size of an ID3v2 tag with this head, 0 where it is none."""
    if head[:3] != b"ID3" or len(head) < 10 or any(byte > 0x7F for byte in head[6:10]):
        return 0
    size = head[6] << 21 | head[7] << 14 | head[8] << 7 | head[9]
    return 10 + size + 10 * bool(head[5] & 0x10)


def _places(file: BinaryIO, sign: bytes) -> list[int]:
    """Find all places of a sign in a file of any size."""
    found, tail, before = [], b"", 0
    while block := file.read(1 << 18):
        data = tail + block
        found += [before + match.start() for match in re.finditer(re.escape(sign), data)]
        tail = data[1 - len(sign) :]
        before += len(data) - len(tail)
    return found


# RIFF: https://tech.ebu.ch/docs/tech/tech3285.pdf, tech3306.pdf (RF64), ITU-R BS.2088 (BW64)


@dataclass(frozen=True)
class Chunk:
    """One chunk: its four-letter name, where its content starts, and its announced size [byte]."""

    name: bytes
    start: int
    size: int


def chunks(file: BinaryIO) -> Iterator[Chunk]:
    """Walk the chunks of a RIFF, RIFX, RF64, BW64 or AIFF file; nothing for any other.

    The byte that makes an odd size even is missing in files of some programs.

    Examples
    --------
    >>> list(chunks(io.BytesIO(b"RIFF....WAVEfmt " + bytes([2, 0, 0, 0]) + b"xxdata")))
    [Chunk(name=b'fmt ', start=20, size=2)]
    """
    head = file.read(12)
    if head[:4] in (*_RIFF, b"RIFX", b"FORM"):
        yield from _walk(file, len(head), "big" if head[:4] in (b"RIFX", b"FORM") else "little")


def _walk(file: BinaryIO, position: int, order: str) -> Iterator[Chunk]:
    """Go from chunk to chunk up to where none begins."""
    end = file.seek(0, os.SEEK_END)
    long_data: int | None = None
    for _ in range(_MOST_CHUNKS):
        file.seek(position)
        name, size = _chunk_head(file.read(8), order)
        if not name:
            return
        if name == b"ds64":
            # A 64-bit file puts the true size of its samples here, and -1 where it belongs.
            long_data = int.from_bytes(file.read(16)[8:], "little")
        if name == b"data" and size == _NO_SIZE and long_data not in (None, 0, (1 << 64) - 1):
            size = long_data or 0
        yield Chunk(name, position + 8, size)
        position += 8 + size
        if size % 2:
            file.seek(position)
            field = file.read(9)
            unpadded, padded = (_chunk_head(field[i:], order) for i in (0, 1))
            lacks = unpadded[0] and position + 8 + unpadded[1] <= end
            position += not (lacks and not (padded[0] and position + 9 + padded[1] <= end))


def _chunk_head(field: bytes, order: str) -> tuple[bytes, int]:
    """Name and size in the first eight bytes; no name where they are no head of a chunk."""
    name = field[:4]
    if len(field) < 8 or not all(0x20 <= byte < 0x7F for byte in name):
        return b"", 0
    return name, int.from_bytes(field[4:8], order)  # type: ignore[arg-type]


def bext_description(path: Path) -> str:
    """Read the description in the ``bext`` chunk of a WAV file, empty where it has none."""
    with path.open("rb") as file:
        end = os.fstat(file.fileno()).st_size
        for chunk in chunks(file):
            if chunk.name == b"data" and _is_unfinished(file, chunk, end):
                break
            if chunk.name == b"bext":
                file.seek(chunk.start)
                text = file.read(min(chunk.size, _DESCRIPTION_BYTES))
                return text.partition(b"\0")[0].decode("latin-1").strip()
    return ""


def _riff_sound(path: Path, file: BinaryIO, end: int) -> tuple[Piece, list[str]]:
    tag = file.read(4)
    file.seek(0)
    before: list[Chunk] = []
    walk = chunks(file)
    data = None
    for chunk in walk:
        if chunk.name in _SAMPLE_CHUNKS:
            data = chunk
            break
        before.append(chunk)
    if data is None:
        return Piece(0, end), []
    if tag in _RIFF and _is_unfinished(file, data, end):
        n = end - data.start
        note = f"the recorder did not finish the header; the {n} bytes that follow it are read"
        return Piece(data.start, end, _head(file, before, n)), [note]
    if missing := max(0, data.start + data.size - end):
        raise RecordingError(
            f"{path}: is truncated; its header announces {missing} bytes of samples more than "
            f"the {end - data.start} that there are"
        )
    last = data
    for last in walk:
        if last.name in _RIFF:
            raise _several(path, last.start - 8)
    rest = end - last.start - last.size
    file.seek(last.start + last.size)
    notes = []
    if rest > 0 and any(file.read(1 << 20)):
        notes = [f"{rest} bytes after the end that the header states are not read"]
    padded = all(
        one.start + one.size + one.size % 2 + 8 == following.start
        for one, following in zip(before, [*before[1:], data], strict=True)
    )
    if tag == b"BW64" or (tag in _RIFF and not padded):
        stop = data.start + data.size
        return Piece(data.start, stop, _head(file, before, data.size)), notes
    return Piece(0, end), notes


def _is_unfinished(file: BinaryIO, data: Chunk, end: int) -> bool:
    """Whether a size of samples was never filled in: no chunks lead from there to the end."""
    if data.size not in _UNFINISHED or data.start >= end:
        return False
    if data.size:
        return data.start + data.size > end
    *_, last = (data, *_walk(file, data.start, "little"))
    stop = last.start + last.size
    return last is data or stop > end or stop + last.size % 2 < end


def _head(file: BinaryIO, before: list[Chunk], n: int) -> bytes:
    """Header of a 64-bit WAV file with the chunks before the samples, and `n` bytes of these."""
    kept = b""
    for chunk in before:
        if chunk.name not in (b"ds64", b"JUNK", b"junk"):
            file.seek(chunk.start)
            content = file.read(min(chunk.size, 1 << 24))
            content += bytes(len(content) % 2)
            kept += struct.pack("<4sI", chunk.name, len(content)) + content
    sizes = struct.pack("<4sIQQQI", b"ds64", 28, 4 + 36 + len(kept) + 8 + n, n, 0, 0)
    data = struct.pack("<4sI", b"data", _NO_SIZE)
    return struct.pack("<4sI4s", b"RF64", _NO_SIZE, b"WAVE") + sizes + kept + data


# Ogg (RFC 3533)


def _ogg_starts(data: bytes) -> list[int]:
    """Find where the streams begin that follow one another in a file."""
    starts, beginning, at = [], False, 0
    while (at := data.find(b"OggS", at)) >= 0 and at + 27 <= len(data):
        first = bool(data[at + 5] & 2)
        if first and not beginning:
            starts.append(at)
        beginning = first
        n = data[at + 26]
        at += 27 + n + sum(data[at + 27 : at + 27 + n])
    return starts or [0]


# FLAC (RFC 9639)


def flac_length(path: Path, piece: Piece) -> int | None:
    """Return how many samples a stream of FLAC states, 0 if unknown; None for another file."""
    with path.open("rb") as file:
        file.seek(piece.start)
        head = file.read(42)
    if head[:8] != _FLAC or len(head) < 42:
        return None
    return (head[21] & 0x0F) << 32 | int.from_bytes(head[22:26], "big")


def with_flac_length(path: Path, piece: Piece, n_samples: int) -> Piece:
    """Return a stream of FLAC that states how long it is."""
    with path.open("rb") as file:
        file.seek(piece.start)
        head = bytearray(file.read(42))
    head[21] |= n_samples >> 32
    head[22:26] = (n_samples & 0xFFFFFFFF).to_bytes(4, "big")
    return Piece(piece.start + len(head), piece.end, bytes(head))
