"""Files as data loggers write them, for the tests of their readers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from asammdf import MDF, Signal
from nptdms import ChannelObject, RootObject, TdmsWriter


@dataclass
class Wave:
    name: str
    unit: str
    samples: np.ndarray
    rate: float = 51200.0


def tdms(path: Path, *channels: tuple, root: dict[str, object] | None = None) -> Path:
    """Channels of one group: name, samples, properties."""
    with TdmsWriter(path) as file:
        objects = [ChannelObject("run", *channel) for channel in channels]
        file.write_segment([RootObject(root or {}), *objects])
    return path


def mdf(path: Path, *groups: list[Signal], unit: str = "s", sync: int = 1, root=None) -> Path:
    """Groups of signals, the unit of their master channels, and what that is (1 is time)."""
    with MDF(version="4.10") as file:
        for signals in groups:
            file.append(signals)
            master = file.groups[-1].channels[0]
            master.unit, master.sync_type = unit, sync
        for key, value in (root or {}).items():
            file.header._common_properties[key] = str(value)
        file.save(path, overwrite=True)
    return path


def hdf5(path: Path, *datasets: tuple, root: dict[str, object] | None = None) -> Path:
    """Datasets: name, numbers, attributes."""
    with h5py.File(path, "w", track_order=True) as file:
        file.attrs.update(root or {})
        for name, data, attributes in datasets:
            file.create_dataset(name, data=data).attrs.update(attributes)
    return path


def uff(path: Path, *functions: tuple, step: float = 1 / 51200, axis: str = "s") -> Path:
    """Datasets 58 in text: samples, unit, and where wanted data type, start, number of values."""
    text = ""
    for function in functions:
        samples, unit = function[:2]
        data_type, start, n = function[2:] or (0, 0.0, len(samples))
        text += "    -1\n    58\n" + "NONE\n" * 5
        text += f"{1:5}{0:10}{0:5}{0:10} {'A':>10}{1:10}{3:4} {'NONE':>10}{0:10}{0:4}\n"
        text += f"{4:10}{n:10}{1:10}{start:13.5e}{step:13.5e}{0:13.5e}\n"
        for kind, label in ((17, axis), (data_type, unit), (0, "NONE"), (0, "NONE")):
            text += f"{kind:10}{0:5}{0:5}{0:5} {'NONE':20} {label:20}\n"
        rows = [samples[i : i + 4] for i in range(0, len(samples), 4)]
        text += "".join("".join(f"{value:20.11e}" for value in row) + "\n" for row in rows)
        text += "    -1\n"
    path.write_bytes(text.encode("latin-1"))
    return path


def _tdms_of(path: Path, waves: list[Wave], root: dict[str, object] | None = None) -> Path:
    stated = [{"wf_increment": 1 / w.rate, "unit_string": w.unit} for w in waves]
    return tdms(
        path, *((w.name, w.samples, s) for w, s in zip(waves, stated, strict=True)), root=root
    )


def _mdf_of(path: Path, waves: list[Wave], root: dict[str, object] | None = None) -> Path:
    groups: dict[tuple[float, int], list[Signal]] = {}
    for w in waves:
        time = np.arange(w.samples.size) / w.rate
        one = Signal(w.samples, time, unit=w.unit, name=w.name)
        groups.setdefault((w.rate, w.samples.size), []).append(one)
    return mdf(path, *groups.values(), root=root)


def _hdf5_of(path: Path, waves: list[Wave], root: dict[str, object] | None = None) -> Path:
    stated = ((w.name, w.samples, {"unit": w.unit, "rate_Hz": w.rate}) for w in waves)
    return hdf5(path, *stated, root=root)


WRITERS = {".tdms": _tdms_of, ".mf4": _mdf_of, ".h5": _hdf5_of}
"""Of formats that state conditions, channel names and a rate for each channel."""
