"""Reader of TDMS files (LabVIEW, FlexLogger): the channels of all groups.

The axis comes from the waveform properties (``wf_increment``, ``wf_start_offset``,
``wf_start_time``, ``wf_xname``, ``wf_xunit_string``) or from a channel ``time`` in the same group.
Units are in ``unit_string`` (or ``NI_UnitDescription``).
Unknown types of scale are refused, because the library would return unscaled samples. Index files
are ignored: they are redundant or wrong.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from models.errors import RecordingError
from models.units import split_unit
from noise.recordings.formats import Format
from noise.recordings.formats.logged import Axis, LoggedChannel, is_time

_UNSET_STEPS = (0.0, 1.0)  # default steps that LabVIEW writes
_UNITS = ("unit_string", "NI_UnitDescription", "unit", "units")
_UNSET_BEGIN = np.datetime64("1904-01-01")
_SECOND = np.timedelta64(1, "s")
_SCALE_TYPE = "_Scale_Type"
_SCALES = (
    *("Linear", "Polynomial", "Table", "Add", "Subtract", "AdvancedAPI"),
    *("RTD", "Strain", "Thermistor", "Thermocouple"),
)


@contextmanager
def open_tdms(path: Path) -> Iterator[list[LoggedChannel]]:
    """Open a TDMS file and yield its channels.

    Raises
    ------
    RecordingError
        The file is truncated, or a channel has an unknown scale.
    """
    from nptdms import TdmsFile

    with path.open("rb") as stream, TdmsFile.open(stream) as file:
        if file.file_status.incomplete_final_segment:
            raise RecordingError(f"{path}: is truncated; its last segment goes on")
        groups = [[c for c in g.channels() if _holds(path, c)] for g in file.groups()]
        begins = {_begin(channel) for group in groups for channel in group}
        logged: list[LoggedChannel] = []
        for group in groups:
            clocks = [c for c in group if is_time(c.name, _stated_unit(c))]
            logged += [
                _channel(channel, [c for c in clocks if len(c) == len(channel)], begins)
                for channel in group
                if channel not in clocks and channel.dtype.kind != "M"
            ]
        yield logged


FORMAT = Format("TDMS", (".tdms",), channels=open_tdms, library="nptdms", extra="tdms")


def _holds(path: Path, channel: Any) -> bool:
    """Whether a channel holds numbers or times; refuse an unknown scale."""
    if not len(channel) or channel.data_type is None or channel.dtype.kind not in "iufM":
        return False
    for key, value in channel.properties.items():
        if key.endswith(_SCALE_TYPE) and value not in _SCALES:
            raise RecordingError(
                f"{path}: channel {channel.name!r} has scale type {str(value)!r}, expected "
                f"{', '.join(_SCALES)}"
            )
    return True


def _channel(channel: Any, clocks: list[Any], begins: set[Any]) -> LoggedChannel:
    """Return a channel with the axes of its waveform and of time channels."""
    return LoggedChannel(
        name=channel.name,
        n_samples=len(channel),
        values=lambda: np.asarray(channel[:]),
        axes=[_waveform(channel, begins), *map(_clock, clocks)],
        packing=channel.properties,
        integers=np.dtype(channel.dtype).kind in "iu",
        unit=_stated_unit(channel),
    )


def _stated_unit(channel: Any) -> str:
    """Return the unit of a channel; empty if not stated."""
    return next((str(channel.properties[k]) for k in _UNITS if k in channel.properties), "")


def _begin(channel: Any) -> Any:
    """Return the date and time at which a waveform begins; None if not set."""
    begin = channel.properties.get("wf_start_time")
    return None if begin == _UNSET_BEGIN else begin


def _waveform(channel: Any, begins: set[Any]) -> Axis:
    """Return the axis that the properties of a waveform state."""
    stated = channel.properties
    step, start = stated.get("wf_increment"), stated.get("wf_start_offset")
    if step is None or step in _UNSET_STEPS:
        step = start = None
    elif len(begins) > 1:  # channels start at different times, so all need one
        begin, first = _begin(channel), min(begins - {None})
        start = None if begin is None else (begin - first) / _SECOND + (start or 0.0)
    unit, quantity = stated.get("wf_xunit_string"), stated.get("wf_xname")
    return Axis(start=start, step=step, unit=unit, quantity=quantity)


def _clock(channel: Any) -> Axis:
    """Return the axis of a channel of time stamps."""
    values = np.asarray(channel[:])
    if values.dtype.kind == "M":
        values, unit = (values - np.datetime64(0, "s")) / _SECOND, "s"
    else:
        unit = _stated_unit(channel) or split_unit(channel.name)[1]
    return Axis(times=lambda: values, unit=unit, quantity="time")
