"""HDF5 files as raw samples: each one-dimensional dataset of numbers is a channel.

HDF5 fixes no layout, so the plainest one is read: datasets named as they like with an attribute
``unit`` (or ``units``), at any depth, and the sampling rate as an attribute of the dataset or of
one of its groups (``rate_Hz``, ``rate``, ``fs``, ``sampling_rate``, ``sample_rate``,
``sampling_frequency``, or the step ``dt``), or else as a dataset ``time`` beside them, in seconds.
Conditions are attributes of the file. Datasets kept in other files are not followed.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from models.errors import RecordingError
from noise.recordings.formats.logged import LoggedChannel
from noise.recordings.formats.sampling import even_rate, whole_rate
from noise.recordings.formats.stated_condition import CONDITIONS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["open_hdf5"]

_RATES = ("rate_Hz", "rate", "fs", "sampling_rate", "sample_rate", "sampling_frequency")
_STEP = "dt"
_TIMES = ("time", "t", "time_s")
_UNITS = ("unit", "units", "unit_str")
_DENSEST = 1032  # bytes a byte: what deflate reaches at best
_LONGEST = 1 << 16  # of the text of an attribute [byte]
_ALLOWANCE = 1 << 20  # of a chunk that is larger than its data [byte]


@contextmanager
def open_hdf5(path: Path) -> Iterator[tuple[list[LoggedChannel], Mapping[str, object]]]:
    """Give the channels of an HDF5 file, by name, and the conditions among its attributes.

    Raises
    ------
    RecordingError
        A dataset or an attribute is not what it announces.
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
            if _last(dataset) not in _TIMES and dataset.size > 0
        ]
        properties = {key: _attribute(path, file, key) for key in CONDITIONS}
        yield [channel for channel in logged if channel is not None], properties


def _channel(path: Path, dataset: Any) -> LoggedChannel | None:
    """Describe a dataset as a channel; None where no sampling rate belongs to it."""
    where = f"{path}: channel {_last(dataset)!r}"
    _check_size(path, where, dataset)
    rate = _rate(path, where, dataset)
    units = (_attribute(path, dataset, key) for key in _UNITS)
    unit = next((_text(value) for value in units if value is not None), "")
    if rate is None:
        return None
    return LoggedChannel(_last(dataset), unit, int(dataset.size), rate, _reading(dataset))


def _reading(dataset: Any) -> Callable[[int, int], NDArray[np.generic]]:
    def read(start: int, stop: int) -> NDArray[np.generic]:
        return np.asarray(dataset[start:stop])

    return read


def _check_size(path: Path, where: str, dataset: Any) -> None:
    """Refuse a dataset whose numbers are not in this file, or cannot all be."""
    if dataset.is_virtual or dataset.external:
        raise RecordingError(f"{where} is kept in another file; copy it into this one")
    stored = int(dataset.id.get_storage_size())
    if int(dataset.nbytes) > _DENSEST * stored or stored > path.stat().st_size:
        raise RecordingError(
            f"{where} announces {dataset.size} samples, of which {stored} bytes are stored"
        )
    chunk = int(np.prod(dataset.chunks or (0,), dtype=np.float64)) * dataset.dtype.itemsize
    if chunk > int(dataset.nbytes) + _ALLOWANCE:
        raise RecordingError(f"{where} is stored in chunks of {chunk} bytes, more than it holds")


def _holders(dataset: Any) -> list[Any]:
    """List a dataset and its groups, innermost first."""
    holders = [dataset, dataset.parent]
    while holders[-1].name != "/":
        holders.append(holders[-1].parent)
    return holders


def _attribute(path: Path, item: Any, key: str) -> object:
    """Value of an attribute of one element, None where there is none.

    Its size is asked for first: the library sets aside what a damaged header announces.
    """
    import h5py

    if key not in item.attrs:
        return None
    entry = item.attrs.get_id(key)
    number, text = entry.dtype.kind in "iuf", h5py.check_string_dtype(entry.dtype) is not None
    single = entry.get_space().get_simple_extent_npoints() == 1
    if not single or not (number or text) or entry.dtype.itemsize > _LONGEST:
        raise RecordingError(f"{path}: attribute {key!r} of {item.name!r} is no single value")
    value = item.attrs[key]
    return value.reshape(-1)[0] if isinstance(value, np.ndarray) else value


def _rate(path: Path, where: str, dataset: Any) -> float | None:
    holders = _holders(dataset)
    for holder in holders:
        for key in (*_RATES, _STEP):
            value = _attribute(path, holder, key)
            if value is None:
                continue
            if not isinstance(value, np.number):
                raise RecordingError(f"{where}: {key} is {value!r}, expected a number")
            number = float(value)
            return whole_rate(1.0 / number if key == _STEP and number else number, where)
    for group in holders[1:]:
        times = next((group[name] for name in _TIMES if name in group), None)
        if times is not None and times.shape == dataset.shape and times.dtype.kind in "iuf":
            _check_size(path, f"{where}: time", times)
            return even_rate(int(times.size), _reading(times), where)
    return None


def _last(dataset: Any) -> str:
    return str(dataset.name).rpartition("/")[2]


def _text(value: object) -> str:
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return str(value)
