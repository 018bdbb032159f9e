"""TDMS files (LabVIEW, FlexLogger) as raw samples: the channels of all groups.

The sampling rate is the waveform property ``wf_increment``, or comes from a channel ``time`` of the
same group, in seconds; units are in ``unit_string`` (or ``NI_UnitDescription``), conditions among
the properties of the file. A scale that the library does not know is refused, since it would hand
out unscaled samples in its place. An index file beside the samples is not looked at: it repeats
what the file says, or contradicts it.
"""

from __future__ import annotations

import math
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from models.errors import RecordingError
from noise.recordings.formats.logged import LoggedChannel
from noise.recordings.formats.sampling import even_rate, whole_rate

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["open_tdms"]

_BIG_ENDIAN = 1 << 6  # in the table of contents, which itself is little-endian
_VERSIONS = (4712, 4713)
_STEP = "wf_increment"
_TIMES = ("time", "t", "time_s")
_UNITS = ("unit_string", "NI_UnitDescription", "unit", "units")
_SCALE_TYPE = "_Scale_Type"
_SCALES = (
    *("Linear", "Polynomial", "Table", "Add", "Subtract", "AdvancedAPI"),
    *("RTD", "Strain", "Thermistor", "Thermocouple"),
)


@contextmanager
def open_tdms(path: Path) -> Iterator[tuple[list[LoggedChannel], Mapping[str, object]]]:
    """Give the channels of a TDMS file and its properties.

    Raises
    ------
    RecordingError
        The file breaks off, or a channel announces what cannot be.
    """
    from nptdms import TdmsFile

    _check_head(path)
    with path.open("rb") as stream, TdmsFile.open(stream) as file:
        if file.file_status.incomplete_final_segment:
            raise RecordingError(f"{path}: is truncated; its last segment goes on")
        logged = []
        for group in file.groups():
            channels = [c for c in group.channels() if _numeric(path, c)]
            times = next((c for c in channels if c.name.lower() in _TIMES), None)
            for channel in channels:
                found = _channel(path, channel, times)
                if channel is not times and found is not None:
                    logged.append(found)
        yield logged, file.properties


def _check_head(path: Path) -> None:
    with path.open("rb") as file:
        tag, contents, version = file.read(4), file.read(4), file.read(4)
    if tag != b"TDSm":
        raise RecordingError(f"{path}: is no TDMS file; 'TDSm' expected")
    big = int.from_bytes(contents, "little") & _BIG_ENDIAN
    number = int.from_bytes(version, "big" if big else "little")
    if number not in _VERSIONS:
        raise RecordingError(f"{path}: is of TDMS version {number}, expected 4712 or 4713")


def _numeric(path: Path, channel: Any) -> bool:
    """Whether a channel holds real numbers; refused where it announces more than the file has."""
    where = f"{path}: channel {channel.name!r}"
    n = len(channel)
    if n == 0 or channel.data_type is None or channel.data_type.nptype is None:
        scaler = n > 0 and bool(getattr(channel, "_scaler_data_types", None))
        if not scaler:
            return False
    size = path.stat().st_size
    if n > size:
        raise RecordingError(f"{where} announces {n} samples in a file of {size} bytes")
    if np.dtype(channel.dtype).kind not in "iuf":
        return False
    for key, value in channel.properties.items():
        if key.endswith(_SCALE_TYPE) and value not in _SCALES:
            raise RecordingError(
                f"{where} has scale type {str(value)!r}, expected {', '.join(_SCALES)}"
            )
    return True


def _channel(path: Path, channel: Any, times: Any) -> LoggedChannel | None:
    """Describe a channel of the file; None where no sampling rate belongs to it."""
    where = f"{path}: channel {channel.name!r}"
    step = channel.properties.get(_STEP)
    n = len(channel)
    if step is not None:
        number = float(step)
        rate = whole_rate(1.0 / number if number else number, where)
    elif times is not None and len(times) == n:
        stamps = np.asarray(times[:])
        rate = even_rate(n, lambda a, b: stamps[a:b], f"{path}: channel {times.name!r}")
    else:
        return None
    unit = next((str(channel.properties[k]) for k in _UNITS if k in channel.properties), "")
    return LoggedChannel(channel.name, unit, n, rate, _in_order(channel))


def _in_order(channel: Any) -> Callable[[int, int], NDArray[np.generic]]:
    """Give samples as they come: the library reads a chunk again for each part of it asked for.

    Whoever goes back begins with the first chunk again.
    """
    chunks: Iterator[NDArray[np.generic]] = iter(())
    rest: NDArray[np.generic] = np.empty(0)
    position = math.inf

    def read(start: int, stop: int) -> NDArray[np.generic]:
        nonlocal chunks, rest, position
        if start < position:
            chunks = (np.asarray(chunk[:]) for chunk in channel.data_chunks())
            rest, position = np.empty(0), 0
        while position + rest.size < start:
            position += rest.size
            following = next(chunks, None)
            if following is None:
                return np.empty(0)
            rest = following
        rest = rest[start - int(position) :]
        position = stop
        parts, missing = [], stop - start
        while missing > 0:
            if rest.size == 0:
                following = next(chunks, None)
                if following is None:
                    break
                rest = following
            parts.append(rest[:missing])
            missing -= parts[-1].size
            rest = rest[parts[-1].size :]
        return np.concatenate(parts) if parts else rest

    return read
