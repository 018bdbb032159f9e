"""Reader of universal files (UFF, UNV): time functions of dataset 58 as channels."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from models.errors import RecordingError, naming
from models.transfer_functions.uff import (
    TIME_RESPONSE,
    UFF_ENDINGS,
    UffFunction,
    read_uff_functions,
)  # fmt: skip
from noise.recordings.formats import Format
from noise.recordings.formats.logged import Axis, LoggedChannel


@contextmanager
def open_universal_file(path: Path) -> Iterator[list[LoggedChannel]]:
    """Open a universal file and yield its time functions as channels.

    Raises
    ------
    RecordingError
        The file is damaged, or holds no time functions.
    """
    with naming("", RecordingError):
        functions = read_uff_functions(path, TIME_RESPONSE)
    if not functions:
        raise RecordingError(f"{path}: holds no time functions (dataset 58, function type 1)")
    yield [_channel(number, function) for number, function in enumerate(functions, start=1)]


FORMAT = Format("UFF", UFF_ENDINGS, channels=open_universal_file, library="pyuff", extra="uff")


def _channel(number: int, function: UffFunction) -> LoggedChannel:
    """Return a time function as a channel."""
    return LoggedChannel(
        name=function.name or f"function {number}",
        n_samples=function.y.size,
        values=lambda: function.y,
        axes=[Axis(times=lambda: function.x, unit="s", quantity="time")],
        unit=function.unclear or function.unit,  # values are in SI if the unit is known
        problem="is complex, expected real samples" if np.iscomplexobj(function.y) else "",
    )
