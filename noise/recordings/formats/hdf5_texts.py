"""Lengths of the texts among an HDF5 object's attributes, read before the library reads the texts.

A text of variable length stands elsewhere in the file; its attribute holds the length and where.
The library sets aside the length, up to 4 GB, and looks for the text then. It offers no way to ask
first, so the attributes are found in the object's header here. What cannot be followed is left to
the library, which refuses it.

Source: HDF5 File Format Specification 3.0: object headers (IV.A.1), attribute message (IV.A.2.m),
global heap (III.E).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from noise.recordings.formats.bounded import BoundedFile

__all__ = ["check_texts"]

_ATTRIBUTE, _CONTINUATION = 0x0C, 0x10  # types of messages
_VARIABLE_LENGTH = 9  # class of a datatype
_ADDRESS = 8  # bytes
_HEAP_HEAD = 16  # bytes, of a collection and of each text in it
_MOST_BLOCKS = 1000  # of one header


def check_texts(path: Path, file: BoundedFile, address: int) -> None:
    """Refuse an object that has an attribute with a text longer than the file.

    Parameters
    ----------
    path : Path
        For messages.
    file : BoundedFile
        Its addresses are 8 bytes long and count from its start.
    address : int
        Of the object's header.

    Raises
    ------
    RecordingError
        A text is announced that cannot be there.
    """
    for message in _attributes(file, address):
        text = _text(message)
        length, heap = _number(text, 0, 4), _number(text, 4, _ADDRESS)
        if length > file.size:
            raise RecordingError(f"{path}: is damaged (an attribute announces {length} bytes)")
        if length and not _heap_ends(file, heap):
            raise RecordingError(f"{path}: is damaged (the texts at byte {heap} do not end)")


def _attributes(file: BoundedFile, address: int) -> Iterator[bytes]:
    """Attribute messages of the object header at an address, through all of its blocks."""
    head = _at(file, address, 40)
    if head[:4] == b"OHDR" and len(head) == 40:
        flags = head[5]
        start = 6 + (16 if flags & 0x20 else 0) + (4 if flags & 0x10 else 0)
        width = 1 << (flags & 3)
        size = int.from_bytes(head[start : start + width], "little")
        long_head, blocks = 6 if flags & 4 else 4, [(address + start + width, size)]
    else:
        flags, long_head = -1, 8
        blocks = [(address + 16, int.from_bytes(head[8:12], "little"))]
    for begin, size in blocks:
        block, position = _at(file, begin, size), 0
        while position + long_head <= len(block):
            kind = block[position] if flags >= 0 else _number(block, position, 2)
            length = _number(block, position + (1 if flags >= 0 else 2), 2)
            content = block[position + long_head : position + long_head + length]
            position += long_head + length
            if kind == _ATTRIBUTE:
                yield content
            elif kind == _CONTINUATION and len(blocks) < _MOST_BLOCKS:
                # In the later version a block opens with its own signature.
                signature = 4 if flags >= 0 else 0
                size = _number(content, _ADDRESS, _ADDRESS) - signature
                blocks.append((_number(content, 0, _ADDRESS) + signature, max(0, size)))


def _heap_ends(file: BoundedFile, address: int) -> bool:
    """Whether a collection of texts can be passed through, each text leading on to the next."""
    head = _at(file, address, _HEAP_HEAD)
    size = _number(head, 8, 8)
    if head[:4] != b"GCOL" or not _HEAP_HEAD <= size <= file.size - address:
        return False
    collection, position = _at(file, address, size), _HEAP_HEAD
    while position + _HEAP_HEAD <= size:
        index, length = _number(collection, position, 2), _number(collection, position + 8, 8)
        # The free space at the end is object 0, whose length counts its own head.
        step = length if index == 0 else _HEAP_HEAD + length + -length % 8
        if step < _HEAP_HEAD or position + step > size:
            return False
        position += step
    return True


def _text(message: bytes) -> bytes:
    """Where an attribute's text is and how long, nothing for another datatype."""
    version = _number(message, 0, 1)
    sizes = [_number(message, at, 2) for at in (2, 4, 6)]  # name, datatype, dataspace
    if version == 1:
        sizes = [size + -size % 8 for size in sizes]
    start = 9 if version == 3 else 8
    datatype = _number(message, start + sizes[0], 1) & 0x0F
    at = start + sum(sizes)
    return message[at : at + 16] if datatype == _VARIABLE_LENGTH else b""


def _number(data: bytes, start: int, size: int) -> int:
    return int.from_bytes(data[start : start + size], "little")


def _at(file: BoundedFile, start: int, size: int) -> bytes:
    file.seek(min(start, file.size))
    return file.read(size)
