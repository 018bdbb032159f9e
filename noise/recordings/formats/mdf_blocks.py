"""The blocks of an MDF4 file, walked before the library is let in.

An MDF4 file is a graph of blocks that point at each other by file position. The library follows
the pointers in good faith: two groups that name each other as the next are read for ever, and a
header that announces 10^15 records is given the memory for them. So the graph is walked here first:
every block must lie within the file, every list must end, and the records announced must be there.

Source: ASAM MDF 4.2 (block header, order of links); the names of the links are the standard's.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, NoReturn

from models.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from noise.recordings.formats.bounded import BoundedFile

__all__ = ["COMMENT_LINK", "check_mdf_blocks"]

_HEAD = struct.Struct("<4s4xQQ")  # name, length, number of links
_FIRST = 64  # position of the HD block
_LINKS_OF_A_HEADER, _COMMENT = 6, 5
COMMENT_LINK = (_FIRST + _HEAD.size + 8 * _COMMENT, _FIRST + _HEAD.size + 8 * (_COMMENT + 1))
"""First byte of the header's link to its comment, and the one behind it."""
_UNFINISHED = slice(60, 64)  # flags of what was still to be done
_DENSEST = 1032  # bytes a byte: what deflate reaches at best
_DEEPEST = 50  # nested compositions or conversions

_NEXT = {b"##HD": (0, 1, 2, 3, 4), b"##DG": (0, 1, 2), b"##CG": (0, 1), b"##CN": (0, 1, 5)}
_NEXT |= {b"##FH": (0,), b"##AT": (0,), b"##CH": (0, 1), b"##EV": (0,), b"##HL": (0,)}
"""Name of a block -> its links that go on, each to a block of its own."""
_ALL_LINKS = (b"##DL", b"##LD")
_CONVERSION = 4  # link of a CN block; conversions are shared, and refer to conversions
_REFERENCES = 4  # first link of a CC block to what it refers to
_SIGNAL_DATA = 5
_DATA_OF_A_GROUP = 2


@dataclass(frozen=True)
class _Block:
    name: bytes
    start: int
    length: int
    links: tuple[int, ...]

    @property
    def content(self) -> int:
        return self.start + _HEAD.size + 8 * len(self.links)


def check_mdf_blocks(path: Path, file: BoundedFile) -> str:
    """Refuse an MDF file that cannot be followed, or announces more than it holds.

    Parameters
    ----------
    path : Path
        For messages.
    file : BoundedFile
        Left at its start.

    Returns
    -------
    str
        Comment of the file, empty where it has none.

    Raises
    ------
    RecordingError
        It is no MDF4 file, was not finished, or its blocks contradict each other.
    """
    head = file.read(_FIRST)
    if head[:8] not in (b"MDF     ", b"UnFinMF ") or not head[8:9].isdigit():
        raise RecordingError(f"{path}: is no MDF file")
    if head[8:10] != b"4.":
        version = head[8:12].decode("latin-1")
        raise RecordingError(f"{path}: is an MDF file of version {version!r}, expected 4")
    if head[:8] == b"UnFinMF " or any(head[_UNFINISHED]):
        raise RecordingError(f"{path}: was not finished by the program that wrote it")
    walk = _Walk(path, file)
    if walk.block(_FIRST).name != b"##HD" or len(walk.block(_FIRST).links) != _LINKS_OF_A_HEADER:
        raise RecordingError(f"{path}: is damaged (byte {_FIRST} starts no header block)")
    walk.check()
    comment = walk.text(walk.block(_FIRST).links[_COMMENT])
    file.seek(0)
    return comment


class _Walk:
    """One pass over the blocks of a file."""

    def __init__(self, path: Path, file: BoundedFile) -> None:
        self.path, self.file = path, file
        self.size = file.size
        self.seen: set[int] = set()
        self.sound: set[int] = set()  # conversions already followed to their ends

    def check(self) -> None:
        """Follow all lists to their ends."""
        waiting = [_FIRST]
        while waiting:
            block = self.block(waiting.pop())
            if block.start in self.seen:
                self._refuse(f"block {block.name!r} at byte {block.start} is pointed at twice")
            self.seen.add(block.start)
            for number, link in enumerate(block.links):
                if link and number in self._followed(block):
                    waiting.append(link)
                elif link and number == _CONVERSION and block.name == b"##CN":
                    self._conversion(link, ())
                elif link:
                    self.block(link)
            if block.name == b"##DG":
                self._records(block)

    def text(self, start: int) -> str:
        """Text of a TX or MD block, empty for none."""
        if start == 0:
            return ""
        block = self.block(start)
        content = self._bytes(block.content, block.start + block.length - block.content)
        return content.partition(b"\0")[0].decode("utf-8", "replace")

    def _followed(self, block: _Block) -> tuple[int, ...]:
        if block.name in _ALL_LINKS:
            return tuple(range(len(block.links)))
        followed = _NEXT.get(block.name, ())
        if block.name == b"##DG":
            return tuple(n for n in followed if n != _DATA_OF_A_GROUP)  # by `_records`
        if block.name == b"##CN":
            return tuple(n for n in followed if n != _SIGNAL_DATA)
        return followed

    def block(self, start: int) -> _Block:
        """Head and links of the block at a byte of the file."""
        head = self._bytes(start, _HEAD.size)
        name, length, n_links = _HEAD.unpack(head)
        if not name.startswith(b"##") or length < _HEAD.size or start + length > self.size:
            self._refuse(f"byte {start} starts no block that lies within the file")
        if n_links > (length - _HEAD.size) // 8:
            self._refuse(f"block {name!r} at byte {start} announces {n_links} links, too many")
        links = struct.unpack(f"<{n_links}Q", self._bytes(start + _HEAD.size, 8 * n_links))
        return _Block(name, start, length, links)

    def _bytes(self, start: int, size: int) -> bytes:
        if start + size > self.size:
            self._refuse(f"is truncated; a block points at byte {start} of {self.size}")
        self.file.seek(start)
        return self.file.read(size)

    def _conversion(self, start: int, above: tuple[int, ...]) -> None:
        if start in self.sound:
            return
        if start in above or len(above) > _DEEPEST:
            self._refuse(f"conversion at byte {start} refers to itself")
        block = self.block(start)
        if block.name == b"##CC":
            for link in block.links[_REFERENCES:]:
                if link:
                    self._conversion(link, (*above, start))
        self.sound.add(start)

    def _records(self, group: _Block) -> None:
        """Compare the records that a data group announces with the bytes that hold them."""
        if len(group.links) < 4:
            self._refuse(f"data group at byte {group.start} has {len(group.links)} links, not 4")
        stored = sum(self._data(group.links[_DATA_OF_A_GROUP]))
        announced, passed, link = 0, set[int](), group.links[1]
        while link:
            if link in passed:
                self._refuse(f"channel group at byte {link} is pointed at twice")
            passed.add(link)
            block = self.block(link)
            record = struct.unpack("<QQHHIII", self._bytes(block.content, 32))
            n, sample_bytes, invalid_bytes = record[1], record[5], record[6]
            if not record[2] & 1:  # text of variable length counts its bytes elsewhere
                announced += n * max(1, sample_bytes + invalid_bytes)
            link = block.links[0] if block.links else 0
        if announced > stored:
            self._refuse(
                f"is truncated; a data group announces {announced} bytes of records, "
                f"{stored} are stored"
            )

    def _data(self, link: int) -> Iterator[int]:
        """Sizes of the pieces that hold a group's records, unpacked [byte]."""
        waiting = [link] if link else []
        while waiting:
            block = self.block(waiting.pop())
            if block.start in self.seen:
                self._refuse(f"block {block.name!r} at byte {block.start} is pointed at twice")
            self.seen.add(block.start)
            if block.name == b"##DZ":
                unpacked, packed = struct.unpack("<QQ", self._bytes(block.content + 8, 16))
                if unpacked > _DENSEST * (packed + 1) or packed > block.length:
                    self._refuse(f"block at byte {block.start} announces {unpacked} bytes")
                yield unpacked
            elif block.name in (*_ALL_LINKS, b"##HL"):
                waiting += [following for following in block.links if following]
            else:
                yield block.start + block.length - block.content

    def _refuse(self, reason: str) -> NoReturn:
        raise RecordingError(f"{self.path}: is damaged ({reason})")
