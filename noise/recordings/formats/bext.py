"""Chunks of a RIFF file: what the sound library passes over.

Sound level meters write the value of full scale into the ``bext`` chunk of a broadcast WAV file
(EBU Tech 3285), which the sound library does not hand out; and it reads a file that breaks off in
its samples as if it ended there. Both answers lie in the list of chunks, which is walked here
without trust: whatever cannot be followed ends the walk, and judging the file is left to the
library.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, BinaryIO

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["Chunk", "bext_description", "chunks", "missing_bytes"]

_DESCRIPTION_BYTES = 256  # EBU Tech 3285, first field of the chunk
_LENGTH_UNKNOWN = 0xFFFFFFFF  # left by programs that could not go back and fill it in
_SAMPLE_CHUNKS = (b"data", b"SSND")  # RIFF, AIFF


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
