"""The segments of a TDMS file, walked before the library is let in.

The library reads a file that breaks off as if it ended there. A measurement cut short is not the
measurement, so every segment must end where it says.

Source: NI, "The NI TDMS File Format": the lead-in of a segment.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from models.errors import RecordingError

if TYPE_CHECKING:
    from pathlib import Path

    from noise.recordings.formats.bounded import BoundedFile

__all__ = ["check_tdms_segments"]

_LEAD_IN = 28  # bytes: tag, table of contents, version, next segment, raw data
_BIG_ENDIAN = 1 << 6  # in the table of contents, for the rest of the lead-in
_UNFINISHED = 0xFFFFFFFFFFFFFFFF  # left by a program that could not go back and fill it in
_VERSIONS = (4712, 4713)


def check_tdms_segments(path: Path, file: BoundedFile) -> None:
    """Refuse a TDMS file whose segments do not fill it exactly.

    Parameters
    ----------
    path : Path
        For messages.
    file : BoundedFile
        Left at its start.

    Raises
    ------
    RecordingError
        It is no TDMS file, breaks off, or its segments contradict each other.
    """
    start = 0
    while start < file.size:
        file.seek(start)
        lead_in = file.read(_LEAD_IN)
        if lead_in[:4] != b"TDSm":
            known = "is no TDMS file" if start == 0 else f"byte {start} starts no segment"
            raise RecordingError(f"{path}: {known}; 'TDSm' expected")
        if len(lead_in) < _LEAD_IN:
            raise RecordingError(f"{path}: is truncated in the lead-in of a segment")
        order = ">" if int.from_bytes(lead_in[4:8], "little") & _BIG_ENDIAN else "<"
        version, length, raw = struct.unpack(f"{order}IQQ", lead_in[8:])
        if version not in _VERSIONS:
            raise RecordingError(f"{path}: is of TDMS version {version}, expected 4712 or 4713")
        end = start + _LEAD_IN + length
        if length == _UNFINISHED or end > file.size:
            raise RecordingError(f"{path}: is truncated; the segment at byte {start} goes on")
        if raw > length:
            raise RecordingError(f"{path}: segment at byte {start}: samples start after its end")
        start = end
    file.seek(0)
