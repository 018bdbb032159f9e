"""Reader of MDF4 files (ASAM MDF, test vehicles and benches): the channels of all groups.

The axis is the master channel of a group: time, an angle, a distance or an index. Files with
samples marked as invalid are refused.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.errors import RecordingError
from noise.recordings.formats import Format
from noise.recordings.formats.logged import Axis, LoggedChannel

_HEAD = 64  # bytes before the first block
_UNFINISHED = slice(60, 64)  # flags in the head of a file that was not finalised
_FIXED_LENGTH = 0  # type of a channel with plain values
_NUMBERS = range(6)  # data types: integers and floating-point values, both byte orders
_TO_TEXT = (7, 8, 9, 10)  # conversions from value or text to text
_QUANTITIES = ("", "time", "angle", "distance", "index")  # of a master channel


@contextmanager
def open_mdf(path: Path) -> Iterator[list[LoggedChannel]]:
    """Open an MDF4 file and yield its channels.

    Raises
    ------
    RecordingError
        The file has another version or is unfinished.
    """
    from asammdf import MDF

    _check_head(path)
    logging.getLogger("asammdf").addFilter(_refuse_truncated)
    # Given a path, the library maps the file into memory and fails on parts of large files.
    with path.open("rb") as stream, MDF(stream) as file:
        groups = range(len(file.groups))
        logged = [channel for group in groups for channel in _group(file, group)]
        yield logged


FORMAT = Format("MDF", (".mdf", ".mf4"), channels=open_mdf, library="asammdf", extra="mdf")


def _refuse_truncated(record: logging.LogRecord) -> bool:
    """Raise an error for a truncated file, of which the library only warns."""
    if "file size" in record.getMessage():
        raise ValueError(record.getMessage())
    return False


def _check_head(path: Path) -> None:
    """Refuse files that the library would convert or repair, as that alters the measurement."""
    with path.open("rb") as file:
        head = file.read(_HEAD)
    if head[:8] not in (b"MDF     ", b"UnFinMF ") or not head[8:9].isdigit():
        raise RecordingError(f"{path}: is no MDF file")
    if head[8:10] != b"4.":
        version = head[8:12].decode("latin-1")
        raise RecordingError(f"{path}: is an MDF file of version {version!r}, expected 4")
    if head[:8] == b"UnFinMF " or any(head[_UNFINISHED]):
        raise RecordingError(f"{path}: was not finished by the program that wrote it")


def _group(file: Any, group: int) -> list[LoggedChannel]:
    """Return the numeric channels of a group."""
    block = file.groups[group]
    n, master = int(block.channel_group.cycles_nr), file.masters_db.get(group)
    plain = [i for i, c in enumerate(block.channels) if i != master and _is_number(c)]
    if n == 0 or not plain:
        return []
    axes = []
    if master is not None:
        axes = [_axis(file, group, block.channels[master])]
    return [_channel(file, group, index, axes) for index in plain]


def _axis(file: Any, group: int, master: Any) -> Axis:
    """Return the axis of a group."""
    return Axis(
        times=lambda: np.asarray(file.get_master(group)),
        unit=_unit(master),
        quantity=dict(enumerate(_QUANTITIES)).get(int(master.sync_type)),
    )


def _channel(file: Any, group: int, index: int, axes: list[Axis]) -> LoggedChannel:
    """Return a channel of a group."""
    block = file.groups[group]
    channel = block.channels[index]

    def values() -> NDArray[np.generic]:
        samples, invalid = file.get(
            group=group, index=index, samples_only=True, ignore_invalidation_bits=False
        )
        if invalid is not None and np.any(invalid):
            first = int(np.argmax(invalid))
            raise RecordingError(f"channel {channel.name!r} is marked as invalid at sample {first}")
        return np.asarray(samples)

    conversion = channel.conversion
    to_text = conversion is not None and conversion.conversion_type in _TO_TEXT
    return LoggedChannel(
        name=str(channel.name),
        n_samples=int(block.channel_group.cycles_nr),
        values=values,
        axes=axes,
        unit=_unit(channel),  # the library applies the conversion
        problem="has a conversion of its values to text" * to_text,
    )


def _unit(channel: Any) -> str:
    """Return the unit of a channel, which its conversion may state."""
    return str(channel.unit or getattr(channel.conversion, "unit", "") or "")


def _is_number(channel: Any) -> bool:
    """Whether a channel holds plain numbers."""
    plain = channel.channel_type == _FIXED_LENGTH and channel.data_type in _NUMBERS
    return plain and not channel.component_addr
