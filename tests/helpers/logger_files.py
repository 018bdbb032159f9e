"""Files as data loggers write them, for the tests of their readers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import h5py
import numpy as np
from asammdf import MDF, Signal
from nptdms import ChannelObject, RootObject, TdmsWriter

if TYPE_CHECKING:
    from pathlib import Path


@dataclass
class Wave:
    name: str
    unit: str
    samples: np.ndarray
    rate: float = 51200.0


def write_tdms(path: Path, waves: list[Wave], conditions: dict[str, object] | None = None) -> Path:
    with TdmsWriter(path) as file:
        root = RootObject(conditions or {})
        objects = [
            ChannelObject(
                "run", w.name, w.samples, {"wf_increment": 1 / w.rate, "unit_string": w.unit}
            )
            for w in waves
        ]
        file.write_segment([root, *objects])
    return path


def write_mdf(path: Path, waves: list[Wave], conditions: dict[str, object] | None = None) -> Path:
    with MDF(version="4.10") as file:
        for rate in dict.fromkeys((w.rate, w.samples.size) for w in waves):
            together = [w for w in waves if (w.rate, w.samples.size) == rate]
            time = np.arange(together[0].samples.size) / together[0].rate
            file.append([Signal(w.samples, time, unit=w.unit, name=w.name) for w in together])
        for key, value in (conditions or {}).items():
            file.header._common_properties[key] = str(value)
        file.save(path, overwrite=True)
    return path


def write_hdf5(path: Path, waves: list[Wave], conditions: dict[str, object] | None = None) -> Path:
    with h5py.File(path, "w", track_order=True) as file:
        file.attrs.update(conditions or {})
        for w in waves:
            dataset = file.create_dataset(w.name, data=w.samples)
            dataset.attrs["unit"] = w.unit
            dataset.attrs["rate_Hz"] = w.rate
    return path


WRITERS = {".tdms": write_tdms, ".mf4": write_mdf, ".h5": write_hdf5}
