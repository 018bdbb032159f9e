"""Universal files (UFF, UNV) as raw samples: their time functions, dataset 58.

Channels follow from the units that the file labels, since its data types are often left general.
Units beside SI (g, degrees, kPa) are turned into it, for the label says what they are; one that is
no channel's is refused, because a guess would look like a measurement.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError, RecordingError
from models.recording import Channel
from models.transfer_functions.uff import TIME_RESPONSE, UffFunction, read_uff_functions
from models.units import kind_of_unit, known_units
from noise.recordings.files import RawSamples

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["read_universal_file"]


def read_universal_file(path: Path) -> RawSamples:
    """Read all time functions of a universal file as channels.

    Parameters
    ----------
    path : Path
        An existing file.

    Returns
    -------
    RawSamples
        Channels named by their kind, in the order of the file; samples in SI.

    Raises
    ------
    RecordingError
        The file is damaged, holds no time functions, or these differ in rate or length, or have
        units that are no channel's; or pyuff is not installed.
    """
    functions = _functions(path)
    if not functions:
        raise RecordingError(f"{path}: holds no time functions (dataset 58, function type 1)")
    rows, channels = [], []
    seen: Counter[str] = Counter()
    first = functions[0]
    for number, function in enumerate(functions, start=1):
        kind, factor = _kind(function, f"{path}: function {number} {function.name!r}")
        if function.y.size != first.y.size or not np.allclose(function.x, first.x, rtol=1e-9):
            raise RecordingError(
                f"{path}: function {number} {function.name!r} has other times than the first; "
                "channels of a recording must be sampled together"
            )
        seen[kind] += 1
        rows.append(factor * function.y.real)
        channels.append(Channel(kind if seen[kind] == 1 else f"{kind}_{seen[kind]}"))
    return RawSamples(
        samples=np.array(rows, dtype=np.float64),
        rate=_rate(path, first),
        fractional=False,
        channels=tuple(channels),
    )


def _functions(path: Path) -> list[UffFunction]:
    try:
        return read_uff_functions(path, TIME_RESPONSE)
    except ParameterError as error:
        raise RecordingError(str(error)) from None


def _kind(function: UffFunction, where: str) -> tuple[str, float]:
    """Kind of channel, and the factor that turns its samples into SI."""
    if np.iscomplexobj(function.y):
        raise RecordingError(f"{where} is complex, expected real samples")
    if function.unclear:
        raise RecordingError(f"{where} has unit {function.unclear}")
    found = kind_of_unit(function.unit)
    if found is None:
        raise RecordingError(f"{where} has unit {function.unit!r}, expected {known_units()}")
    return found


def _rate(path: Path, function: UffFunction) -> float:
    steps = np.diff(function.x)
    if steps.size == 0 or not np.allclose(steps, steps[0], rtol=1e-3, atol=0.0) or steps[0] <= 0:
        raise RecordingError(f"{path}: time does not rise evenly")
    rate = float((function.x.size - 1) / (function.x[-1] - function.x[0]))
    whole = round(rate)
    return float(whole) if abs(whole - rate) < 1e-6 * rate else rate
