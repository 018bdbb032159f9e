"""MPEG audio (ISO 11172-3, 13818-3): frames that follow one another, and how many there are.

The sound library takes the length from a header for players, which is a frame without sound at the
beginning, and estimates it where there is none. Here the frames are counted.
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from models.errors import RecordingError

_SYNC = re.compile(rb"\xff[\xe2-\xff][\x10-\xef]")  # how a frame may begin
_MOST_TRIES = 200_000  # at places where none does: what holds as many is no sound
_MOST_RUN = 3
"""Frames that must follow one another where nothing else says that one begins."""

_RATES = (44100, 48000, 32000)  # [Hz], halved and quartered in versions 2 and 2.5
_LAYER_3 = (0, 32, 40, 48, 56, 64, 80, 96, 112, 128, 160, 192, 224, 256, 320)
_LOW = (0, 8, 16, 24, 32, 40, 48, 56, 64, 80, 96, 112, 128, 144, 160)
_BIT_RATES = {
    (1, 1): tuple(range(0, 449, 32)),
    (1, 2): (0, 32, 48, 56, 64, 80, 96, 112, 128, 160, 192, 224, 256, 320, 384),
    (1, 3): _LAYER_3,
    (2, 1): (0, 32, 48, 56, 64, 80, 96, 112, 128, 144, 160, 176, 192, 224, 256),
    (2, 2): _LOW,
    (2, 3): _LOW,
}
"""[kbit/s], by version and layer."""


class _Frame(NamedTuple):
    """A frame of MPEG audio: what all of a sound share, its bytes, and its header for players."""

    kind: tuple[int, int, int, bool]
    size: int
    info: int


@lru_cache(maxsize=1 << 12)
def _frame(head: bytes) -> _Frame | None:
    """Read the four bytes that a frame begins with."""
    bits = int.from_bytes(head, "big")
    version, layer = bits >> 19 & 3, 4 - (bits >> 17 & 3)
    bit_rate, rate = bits >> 12 & 15, bits >> 10 & 3
    if bits >> 21 != 0x7FF or version == 1 or layer == 4 or bit_rate in (0, 15) or rate == 3:
        return None
    hertz = _RATES[rate] >> {3: 0, 2: 1, 0: 2}[version]
    bits_s = 1000 * _BIT_RATES[1 if version == 3 else 2, layer][bit_rate]
    padding, mono = bits >> 9 & 1, bits >> 6 & 3 == 3
    if layer == 1:
        size = 4 * (12 * bits_s // hertz + padding)
    else:
        size = (72 if layer == 3 and version != 3 else 144) * bits_s // hertz + padding
    info = 4 + ((17 if mono else 32) if version == 3 else (9 if mono else 17))
    return _Frame((version, layer, rate, mono), size, info)


@dataclass
class _Stream:
    """Frames that follow one another, with what a header for players announces of them."""

    start: int
    end: int
    info: bytes = b""
    announced: int | None = None
    n_frames: int = 0


def mpeg_sounds(path: Path, data: bytes) -> list[tuple[int, int, bytes]]:
    """Find the sounds in a file of MPEG audio.

    Parameters
    ----------
    path : Path
        Named in messages.
    data : bytes
        All of it.

    Returns
    -------
    list of (int, int, bytes)
        First and last byte (exclusive) of each, and a header for players that states its length.

    Raises
    ------
    RecordingError
        There is none, or its header announces more than there is.
    """
    streams: list[_Stream] = []
    at, kind = 0, None
    tries, lost = 0, False
    begins = True  # a stream: at first, after a tag, and where the kind of frames changes
    while 0 <= at <= len(data) - 4:
        if tag := _tag_bytes(data, at):
            at, begins = at + tag, True
            continue
        frame = _frame(data[at : at + 4])
        if frame is None or ((lost or frame.kind != kind) and not _run(data, at, frame)):
            lost = True
            found = _SYNC.search(data, at + 1)
            tries += 1
            if found is None or tries > _MOST_TRIES:
                break
            at = found.start()
            continue
        if at + frame.size > len(data):
            break
        begins |= frame.kind != kind
        kind, lost = frame.kind, False
        stop = at + frame.size
        if (info := _info(data[at:stop], frame)) is not None:
            streams.append(_Stream(stop, stop, *info))
        else:
            if begins or streams[-1].n_frames == streams[-1].announced:
                streams.append(_Stream(at, at))
            streams[-1].n_frames += 1
            streams[-1].end = stop
        at, begins = stop, False
    streams = [one for one in streams if one.n_frames or one.announced]
    if not streams or tries > _MOST_TRIES:
        raise RecordingError(f"{path}: is damaged or no sound file (Format not recognised)")
    for one in streams:
        if one.announced is not None and one.announced > one.n_frames + 1:  # some count the header
            raise RecordingError(
                f"{path}: is truncated; its header announces {one.announced} frames, "
                f"{one.n_frames} can be read"
            )
    return [(one.start, one.end, _player_head(one, data)) for one in streams]


def _run(data: bytes, at: int, frame: _Frame) -> bool:
    """Whether further frames of its kind follow, up to the end of the data or a tag."""
    for _ in range(_MOST_RUN):
        at += frame.size
        if at >= len(data) or _tag_bytes(data, at):
            return True
        following = _frame(data[at : at + 4])
        if following is None or following.kind != frame.kind:
            return False
        frame = following
    return True


def id3_bytes(head: bytes) -> int:
    """Size of an ID3v2 tag with this head, 0 where it is none."""
    if head[:3] != b"ID3" or len(head) < 10 or any(byte > 0x7F for byte in head[6:10]):
        return 0
    size = head[6] << 21 | head[7] << 14 | head[8] << 7 | head[9]
    return 10 + size + 10 * bool(head[5] & 0x10)


def _tag_bytes(data: bytes, at: int) -> int:
    """Size of a tag (ID3, APE) at a place, 0 where there is none."""
    head = data[at : at + 3]
    if head == b"ID3":
        return id3_bytes(data[at : at + 10])
    if head == b"TAG":
        return 128
    if head == b"APE" and data[at : at + 8] == b"APETAGEX":
        return 32 + int.from_bytes(data[at + 12 : at + 16], "little")
    return 0


def _info(data: bytes, frame: _Frame) -> tuple[bytes, int | None] | None:
    """Read a header for players (Xing, Info, VBRI) and the frames it announces; None for sound."""
    if frame.kind[1] == 3 and data[frame.info : frame.info + 4] in (b"Xing", b"Info"):
        flags, n = struct.unpack(">II", data[frame.info + 4 : frame.info + 12].ljust(8, b"\0"))
        return (data, n) if flags & 1 else (b"", None)
    if data[36:40] == b"VBRI":
        return b"", int.from_bytes(data[50:54], "big")
    return None


def _player_head(stream: _Stream, data: bytes) -> bytes:
    """Header for players with the number of frames counted; a plain one where there was none."""
    head = bytearray(stream.info)
    if not head:
        bits = int.from_bytes(data[stream.start : stream.start + 4], "big")
        bits = bits & 0xFFFF0DFF | 0x00019000  # without checksum and padding, of a middle bit rate
        head[:] = bits.to_bytes(4, "big")
        frame = _frame(bytes(head))
        if frame is None or frame.kind[1] != 3:
            return b""  # in layers 1 and 2, which do not vary, there are none
        head += bytes(frame.size - 4)
        head[frame.info : frame.info + 8] = struct.pack(">4sI", b"Info", 1)
    else:
        frame = _frame(bytes(head[:4]))
    if frame is not None:
        head[frame.info + 8 : frame.info + 12] = stream.n_frames.to_bytes(4, "big")
    return bytes(head)
