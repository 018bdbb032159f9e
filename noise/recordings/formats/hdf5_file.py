"""Reader of HDF5 files: each one-dimensional numeric dataset is a channel.

HDF5 does not prescribe a layout. Datasets may have any name and depth, with an attribute ``unit``
(or ``units``). The sampling rate is an attribute of the dataset or of one of its groups
(``rate_Hz``, ``rate``, ``fs``, ``sampling_rate``, ``sample_rate``, ``sampling_frequency``, or the
step ``dt``), or follows from a dataset ``time`` in the same group. The start is ``t0``, ``start``
or ``start_s``, the unit of the axis ``x_unit``. Packed numbers have ``scale_factor`` and
``add_offset``. External datasets are not read.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.errors import RecordingError
from models.units import split_unit
from noise.recordings.formats import Format
from noise.recordings.formats.logged import (
    PACKING,
    Axis,
    LoggedChannel,
    factor_and_offset,
    is_time,
)

_RATES = ("rate_Hz", "rate", "fs", "sampling_rate", "sample_rate", "sampling_frequency")
_STEPS = ("dt", "sampling_interval")
_STARTS = ("t0", "start", "start_s", "start_time")
_AXIS_UNITS = ("x_unit", "xunit", "x_units", "axis_unit")
_UNITS = ("unit", "units", "unit_str")
_DENSEST = 1032  # largest compression ratio of deflate


@contextmanager
def open_hdf5(path: Path) -> Iterator[list[LoggedChannel]]:
    """Open an HDF5 file and yield its channels.

    Raises
    ------
    RecordingError
        A dataset is incomplete, or an attribute has an invalid value.
    """
    import h5py

    with h5py.File(path, "r", locking=False) as file:
        datasets: list[Any] = []

        def collect(_: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and item.ndim == 1 and item.dtype.kind in "iuf":
                datasets.append(item)

        file.visititems(collect)
        logged = [
            _channel(path, dataset)
            for dataset in datasets
            if dataset.size > 0 and not is_time(_last(dataset), _text(path, dataset, _UNITS))
        ]
        yield logged


FORMAT = Format("HDF5", (".h5", ".hdf5"), channels=open_hdf5, library="h5py", extra="hdf5")


def _channel(path: Path, dataset: Any) -> LoggedChannel:
    """Return a dataset as a channel."""
    _check_size(path, dataset)
    return LoggedChannel(
        name=_last(dataset),
        n_samples=int(dataset.size),
        values=partial(_values, dataset),
        axes=_axes(path, dataset),
        packing=_attributes(path, dataset, PACKING),
        integers=dataset.dtype.kind in "iu",
        unit=_text(path, dataset, _UNITS),
    )


def _axes(path: Path, dataset: Any) -> list[Axis]:
    """Return the axes that the dataset, or else the innermost of its groups, states."""
    scales = [str(scale.name).rpartition("/")[2] for scale in dataset.dims[0].values()]
    quantity = dataset.dims[0].label or next(iter(scales), None)
    axes: list[Axis] = []
    holder = dataset
    while True:
        unit = _text(path, holder, _AXIS_UNITS)
        numbers = {
            key: _number(path, dataset, key, value)
            for key, value in _attributes(path, holder, (*_RATES, *_STEPS, *_STARTS)).items()
        }
        steps = [
            1.0 / numbers[key] if key in _RATES else numbers[key]
            for key in (*_RATES, *_STEPS)
            if numbers.get(key)
        ]
        starts = [numbers[key] for key in _STARTS if key in numbers]
        axes += [
            Axis(start=start, step=step, unit=unit, quantity=quantity)
            for start, step in zip_longest(starts, steps)
        ]
        if holder is not dataset:
            axes += _time_beside(path, holder, dataset)
        if holder.name == "/" or any(axis.step or axis.times for axis in axes):
            return axes
        holder = holder.parent


def _number(path: Path, dataset: Any, key: str, value: object) -> float:
    """Return the value of an attribute as a number."""
    if not isinstance(value, np.number):
        raise RecordingError(
            f"{path}: channel {_last(dataset)!r}: {key} is {value!r}, expected a number"
        )
    return float(value)


def _time_beside(path: Path, group: Any, dataset: Any) -> Iterator[Axis]:
    """Yield axes of time stamps in a group that have the length of a dataset."""
    for name in group:
        times: Any = group.get(name) if is_time(name, None) else None
        if getattr(times, "shape", None) == dataset.shape and times.dtype.kind in "iuf":
            unit = _text(path, times, _UNITS) or split_unit(name)[1]
            if not is_time(name, unit):
                continue
            _check_size(path, times)
            packing = factor_and_offset(_attributes(path, times, PACKING))
            yield Axis(times=partial(_values, times, *packing), unit=unit, quantity="time")


def _values(dataset: Any, factor: float = 1.0, offset: float = 0.0) -> NDArray[np.generic]:
    """Read a dataset and unpack its values."""
    values = np.asarray(dataset[:])
    return values if (factor, offset) == (1.0, 0.0) else factor * values + offset


def _check_size(path: Path, dataset: Any) -> None:
    """Refuse a dataset that announces more numbers than the file can hold."""
    stored = int(dataset.id.get_storage_size())
    if int(dataset.nbytes) > _DENSEST * stored or stored > path.stat().st_size:
        raise RecordingError(
            f"{path}: channel {_last(dataset)!r} announces {dataset.size} samples, of which "
            f"{stored} bytes are stored in this file"
        )


def _attributes(path: Path, item: Any, keys: tuple[str, ...]) -> dict[str, object]:
    """Return the existing attributes among some keys, regardless of case."""
    names = {name.lower(): name for name in item.attrs}
    return {key: _attribute(path, item, names[key.lower()]) for key in keys if key.lower() in names}


def _attribute(path: Path, item: Any, key: str) -> object:
    """Return an attribute that is a single value."""
    value = item.attrs[key]
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.reshape(-1)[0]
    if not isinstance(value, str | bytes | np.number | np.bool_):
        raise RecordingError(f"{path}: attribute {key!r} of {item.name!r} is no single value")
    return value


def _last(dataset: Any) -> str:
    """Return the last part of the name of a dataset."""
    return str(dataset.name).rpartition("/")[2]


def _text(path: Path, item: Any, keys: tuple[str, ...]) -> str:
    """Return the first existing attribute among some keys as text; empty if there is none."""
    value = next(iter(_attributes(path, item, keys).values()), "")
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
