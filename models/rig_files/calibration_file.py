"""The ``calibration`` of a channel in a rig file: a table of readings, or a line.

A table is a CSV file of two columns, the reading and the value, as Appendices B and C of the thesis
tabulate them, ``reading_mV,torque_Nm``; or stands in the rig file itself, as lists of these names.
A line is ``{ sensitivity = 12.19, offset = 0.4222, reading = "mV" }``, the regression (C3) of the
same: the reading is the offset and the sensitivity times the value.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from itertools import pairwise, zip_longest
from typing import TYPE_CHECKING, Any

from models.calibration import READING_UNITS, Calibration
from models.checks import a_number, a_text, meant, refuse_unknown
from models.errors import ParameterError
from models.foreign_file import LARGEST_TEXT, reading

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["VALUE_COLUMNS", "calibration_text", "read_calibration", "read_table"]

VALUE_COLUMNS = {
    "torque": "torque_Nm",
    "acceleration": "acceleration_m_s2",
    "pressure": "pressure_Pa",
    "angle": "angle_rad",
    "speed": "speed_rad_s",
    "force": "force_N",
}
"""Name of the column of values, by kind of channel."""

_READING_COLUMNS = {"reading": "", **{f"reading_{unit}": unit for unit in READING_UNITS}}

_FEWEST = 3
"""Rows of a table."""


def read_calibration(given: Any, kind: str, folder: Path, where: str) -> Calibration:
    """Read the calibration of a kind of channel.

    Parameters
    ----------
    given : str or mapping
        As the TOML file holds it: the name of a table's file, or a line.
    kind : str
    folder : Path
        Of the rig file; names of files are relative to it.
    where : str
        What messages call the entry.

    Raises
    ------
    ParameterError
        It cannot be used.

    Examples
    --------
    >>> from pathlib import Path
    >>> read_calibration({"sensitivity": 0.101}, "angle", Path(), "rig, angle").gain
    9.900990099009901
    """
    if isinstance(given, str):
        return read_table(folder / given, kind, where)
    if not isinstance(given, Mapping):
        raise ParameterError(
            f'{where} = {given!r} must be the name of a table, "cell.csv", or a line, '
            "{ sensitivity = 12.19, offset = 0.4222 }"
        )
    if VALUE_COLUMNS[kind] in given:
        columns = [given[name] if isinstance(given[name], list) else [] for name in given]
        rows = zip_longest(*columns, fillvalue="")
        lines = [(n, [str(cell) for cell in row]) for n, row in enumerate(rows, start=1)]
        return _curve(list(given), lines, kind, where, "its table")
    refuse_unknown(given, {"sensitivity", "offset", "reading"}, where)
    sensitivity = a_number(given, "sensitivity", where, low=-math.inf)
    offset = a_number({"offset": given.get("offset", 0.0)}, "offset", where, low=-math.inf)
    if offset + sensitivity == offset:
        raise ParameterError(
            f"{where}: sensitivity = {sensitivity:g} tells nothing; give readings per unit"
        )
    unit = a_text(given.get("reading", ""), "reading", where)
    if unit and unit not in READING_UNITS:
        raise ParameterError(
            f"{where}: reading = {unit!r} must be one of {', '.join(READING_UNITS)}"
        )
    return Calibration.line(sensitivity, offset, unit)


def read_table(path: Path, kind: str, where: str) -> Calibration:
    """Read a table of readings and values of a kind of channel.

    Parameters
    ----------
    path : Path
    kind : str
    where : str
        What messages call the entry.

    Raises
    ------
    ParameterError
        The file cannot be read, or is no curve that can be turned round.
    """
    where = f"{where}: {path}"
    with reading(path, "CSV table", where=where, largest=LARGEST_TEXT):
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = csv.reader(file)
            lines = [(rows.line_num, [cell.strip() for cell in row]) for row in rows if any(row)]
        columns = lines[0][1] if lines else []
        return _curve(columns, lines[1:], kind, where, path.name)


def _curve(
    columns: list[str], lines: list[tuple[int, list[str]]], kind: str, where: str, source: str
) -> Calibration:
    """Make a curve of the lines of a table, each with its number."""
    value = VALUE_COLUMNS[kind]
    units = [name for name in columns if name in _READING_COLUMNS]
    if value not in columns or len(units) != 1:
        known = (value, *_READING_COLUMNS)
        hints = (meant(name, known) for name in columns if name not in known)
        raise ParameterError(
            f"{where}: has the columns {', '.join(columns) or 'none'}, expected {value} and one of "
            f"{', '.join(_READING_COLUMNS)}{next(filter(None, hints), '')}"
        )
    places = (columns.index(value), columns.index(units[0]))
    points = sorted(_point(cells, places, f"{where}, line {n}") for n, cells in lines)
    if len(points) < _FEWEST:
        raise ParameterError(
            f"{where}: has {len(points)} rows, and a table {_FEWEST} or more; two readings are a "
            "line: { sensitivity = ..., offset = ... }"
        )
    _check_monotonic(points, value, where)
    points.sort(key=lambda point: point[1])
    values, readings = zip(*points, strict=True)
    return Calibration(readings, values, _READING_COLUMNS[units[0]], source=source)


def _point(cells: list[str], places: tuple[int, int], where: str) -> tuple[float, float]:
    """Value and reading of a row."""
    try:
        value, reading = (float(cells[place]) for place in places)
    except (ValueError, IndexError):
        value = reading = math.nan
    if not (math.isfinite(value) and math.isfinite(reading)):
        raise ParameterError(f"{where} is {','.join(cells)!r}, expected two numbers")
    return value, reading


def _check_monotonic(points: list[tuple[float, float]], name: str, where: str) -> None:
    """Refuse readings that do not rise, or do not fall, from value to value."""
    sign = math.copysign(1.0, points[-1][1] - points[0][1])
    for (low, before), (high, after) in pairwise(points):
        if low == high:
            raise ParameterError(f"{where}: {name} = {low:g} is in it twice; give its mean once")
        if sign * (after - before) <= 0.0:
            raise ParameterError(
                f"{where}: from {name} = {low:g} to {high:g} the reading goes from {before:g} to "
                f"{after:g}, elsewhere the other way; a reading must tell one value"
            )


def calibration_text(calibration: Calibration, kind: str) -> str:
    """Write a calibration as the value of its kind in a rig file.

    Examples
    --------
    >>> calibration_text(Calibration.line(0.101, -0.0007, "V"), "angle")
    '{ sensitivity = 0.101, offset = -0.0007, reading = "V" }'
    """
    if calibration.bounded:
        name = next(n for n, unit in _READING_COLUMNS.items() if unit == calibration.unit)
        readings, values = list(calibration.readings), list(calibration.values)
        return f"{{ {name} = {readings}, {VALUE_COLUMNS[kind]} = {values} }}"
    sensitivity = 1.0 / calibration.gain
    offset = calibration.readings[0] - sensitivity * calibration.values[0]
    unit = f', reading = "{calibration.unit}"' if calibration.unit else ""
    return f"{{ sensitivity = {sensitivity:.9g}, offset = {offset:.9g}{unit} }}"
