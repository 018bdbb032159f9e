"""Reader of hammer hits from recordings with a force channel or tables of numbers.

A table (NPY or CSV) has time [s], force [N] and response as three rows or three columns, as its
shape tells. Headings of a CSV file may state other units.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from features.modal.hammer import Hit
from models.errors import ParameterError, RecordingError, naming
from models.foreign_file import (
    LARGEST_TEXT,
    ForeignTable,
    read_array,
    read_table,
    reading,
    refusing,
)
from models.recording import Channel
from models.units import CHANNEL_UNITS, quantity_of_unit
from noise.recordings import find_recordings, read_recording
from noise.recordings.files import MIN_SAMPLES
from noise.recordings.formats import check_rate, formats
from noise.recordings.formats.logged import even_step, whole_rate

RESPONSES = ("acceleration", "pressure")
"""Default channels of the response, in order of preference."""

_TABLES = (".csv", ".npy")

_UNEVEN = 0.1  # tolerance of time stamps with few digits [sampling intervals]
_ROUNDING = 1e-5  # relative tolerance of a sampling rate from such time stamps

_ROLES = ("time", "force", "response")


def find_hits(paths: Iterable[Path]) -> list[Path]:
    """Return the files of hits: named files, and sorted tables and recordings of named folders.

    Raises
    ------
    ParameterError
        A path does not exist, or a folder holds no hits.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     for name in ("hit-2.npy", "hit-1.npy", "notes.txt"):
    ...         (Path(folder) / name).touch()
    ...     [path.name for path in find_hits([Path(folder)])]
    ['hit-1.npy', 'hit-2.npy']
    """
    hits: list[Path] = []
    for path in paths:
        if not path.is_dir():
            hits += [file for file, _ in find_recordings(path)]
            continue
        inside = [file for file in path.iterdir() if file.suffix.lower() in {*_TABLES, *formats()}]
        if not inside:
            raise ParameterError(f"{path}: there are no hits in it")
        hits += sorted(inside)
    return hits


def read_hit(
    path: Path, *, response: str | None = None, arm: float | None = None
) -> tuple[Hit, str]:
    """Read a hammer hit.

    Parameters
    ----------
    path : Path
        Table (``.npy`` or ``.csv``) or recording.
    response : str, optional
        Channel of the response in a recording, or quantity of the response in a table (default:
        acceleration, or pressure if a recording has no acceleration).
    arm : float, optional
        Lever arm [m] that turns the force into a torque.

    Returns
    -------
    hit : Hit
        Its force is in N, or in N m with an `arm`.
    unit : str
        Unit of the response.

    Raises
    ------
    RecordingError
        The file cannot be read, or a channel is missing.
    ParameterError
        `response` is not the name of a channel.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "hit.npy"
    ...     np.save(path, np.stack([np.arange(100) / 25.6e3, np.ones(100), np.zeros(100)]))
    ...     hit, unit = read_hit(path, arm=0.05)
    >>> hit.rate, float(hit.force[0]), unit
    (25600.0, 0.05, 'm/s^2')
    """
    wanted = Channel(response or RESPONSES[0])
    if path.suffix.lower() in _TABLES:
        with refusing(str(path), "table of numbers", RecordingError):
            (time, force, values), kind = _table(path)
            rate = _rate(path, time)
        if response is not None and kind not in ("", wanted.kind):
            raise RecordingError(f"{path}: its response is {kind}, not {wanted.kind}")
        unit = CHANNEL_UNITS[kind or wanted.kind]
    else:
        recording = read_recording(path)
        if not recording.calibrated:
            raise RecordingError(f"{path}: is not calibrated; a hit needs forces in N")
        rows = [row for kind in RESPONSES if (row := recording.first(kind)) is not None]
        name = response or (recording.channel_names[rows[0]] if rows else RESPONSES[0])
        with naming(f"{path}: ", RecordingError):
            force, values = recording["force"], recording[name]
        rate, unit = recording.rate, Channel(name).unit
    return Hit(force * (1.0 if arm is None else arm), values, rate, str(path)), unit


def _table(path: Path) -> tuple[NDArray[np.float64], str]:
    """Return time, force and response in SI, shape (3, n), and the stated kind of response."""
    kind = ""
    with reading(path, "table of numbers", error=RecordingError, largest=LARGEST_TEXT):
        if path.suffix.lower() == ".npy":
            values = read_array(path)
        else:
            table = read_table(path)
            values = table.values
            if values.shape[1] == len(_ROLES):
                values, kind = _in_si(path, table)
    if values.ndim != 2 or len(_ROLES) not in values.shape:
        raise RecordingError(
            f"{path}: has shape {np.shape(values)}, expected three rows or columns: time, force, "
            "response; between commas, numbers need a decimal point"
        )
    if values.dtype.kind not in "iuf":
        raise RecordingError(f"{path}: holds {values.dtype}, expected real numbers")
    rows: NDArray[np.float64] = (values if values.shape[0] == 3 else values.T).astype(np.float64)
    if rows.shape[1] < MIN_SAMPLES:
        raise RecordingError(
            f"{path}: holds {rows.shape[1]} samples, expected at least {MIN_SAMPLES}"
        )
    for name, row in zip(_ROLES, rows, strict=True):
        if not np.isfinite(row).all():
            first = int(np.argmin(np.isfinite(row)))
            raise RecordingError(
                f"{path}: {name} is {row[first]} at sample {first}, expected finite numbers"
            )
    return rows, kind


def _in_si(path: Path, table: ForeignTable) -> tuple[NDArray[np.float64], str]:
    """Return the columns of a table in SI, and the stated kind of response."""
    columns, quantity = [], ""
    expected = (("time",), ("force",), RESPONSES)
    headings = zip(table.names, table.units, table.values.T, expected, strict=True)
    for name, unit, column, allowed in headings:
        quantity, factor = quantity_of_unit(unit) or ("", 1.0)
        if unit and quantity not in allowed:
            raise RecordingError(
                f"{path}: column {name!r} is {quantity or 'in'} {unit!r}, expected time, force and "
                "acceleration or pressure in this order, in units such as s, N, m/s^2, g, Pa"
            )
        columns.append(factor * column)
    return np.column_stack(columns), quantity


def _rate(path: Path, time: NDArray[np.float64]) -> float:
    """Return the sampling rate [Hz] of evenly spaced time stamps [s]."""
    try:
        _, step = even_step(time, _UNEVEN)
    except RecordingError:
        raise RecordingError(
            f"{path}: time does not rise evenly; expected time in s, force, response in this order"
        ) from None
    rate = whole_rate(1.0 / step, _ROUNDING)
    check_rate(rate, str(path))
    return rate
