"""Calibration of a sensor: conversion of readings into values of the quantity.

A table of readings is interpolated linearly. Readings beyond its ends by up to a twentieth of its
span (noise, or a last step of the load) are extrapolated linearly; readings further out are
refused. A line, defined by sensitivity and offset, is valid everywhere.

In a rig file a table is a CSV file with a column of readings and one of values, as in Appendices B
and C of the thesis (``reading_mV,torque_Nm``), or two lists of these names. A line is
``{ sensitivity = 12.19, offset = 0.4222, reading = "mV" }``, the regression (C3) of the same data:
reading = offset + sensitivity * value.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.errors import ParameterError
from models.foreign_file import LARGEST_TEXT, reading
from models.schema import as_text, did_you_mean, number, refuse_unknown
from models.show import short_repr

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

READING_UNITS = {"V": ("voltage", 1.0), "mV": ("voltage", 1e-3), "counts": ("counts", 1.0)}
"""Units of readings: dimension, and size of the unit in it."""

_MARGIN = 0.05
"""Share of a table's span by which readings may lie outside."""


@short_repr
@dataclass(frozen=True)
class Calibration:
    """Calibration curve from readings to values.

    Parameters
    ----------
    readings : tuple of float
        Rising [`unit`].
    values : tuple of float
        One value per reading [unit of the channel].
    unit : str
        Unit of the readings, one of `READING_UNITS`; empty for the numbers of a file.
    bounded : bool
        Whether it is valid between its readings only, as a table is.
    source : str
        Name of the curve in messages.

    Examples
    --------
    >>> import numpy as np
    >>> cell = Calibration.line(12.19, 0.4222, "mV")
    >>> cell.of(np.array([0.4222, 122.3222])).round(9)
    array([ 0., 10.])
    """

    readings: tuple[float, ...]
    values: tuple[float, ...]
    unit: str = ""
    bounded: bool = True
    source: str = "its calibration"

    @classmethod
    def line(cls, sensitivity: float, offset: float = 0.0, unit: str = "") -> Calibration:
        """Return the line ``reading = offset + sensitivity * value``.

        Parameters
        ----------
        sensitivity : float
            Sensitivity, not 0 [`unit` per unit of the channel].
        offset : float
            Reading at a value of 0 [`unit`].
        unit : str
            Unit of the readings.
        """
        ends = sorted([(offset, 0.0), (offset + sensitivity, 1.0)])
        readings, values = zip(*ends, strict=True)
        return cls(readings, values, unit, bounded=False)

    @property
    def gain(self) -> float:
        """Mean slope [unit of the channel per `unit`]."""
        return (self.values[-1] - self.values[0]) / (self.readings[-1] - self.readings[0])

    def in_units_of(self, size: float) -> Calibration:
        """Return the calibration for readings in units of another size [`unit`]."""
        ends = sorted(zip((x / size for x in self.readings), self.values, strict=True))
        readings, values = zip(*ends, strict=True)
        return replace(self, readings=readings, values=values, unit="")

    def beyond(self, readings: NDArray[np.float64]) -> float:
        """Return the distance of readings outside the curve, as a share of its span [-].

        Parameters
        ----------
        readings : ndarray, shape (n,)
            [`unit`]
        """
        if not self.bounded or not readings.size:
            return 0.0
        low, high = self.readings[0], self.readings[-1]
        out = max(low - float(readings.min()), float(readings.max()) - high)
        return max(0.0, out / (high - low))

    def of(self, readings: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values of readings.

        Parameters
        ----------
        readings : ndarray, shape (n,)
            [`unit`]

        Returns
        -------
        ndarray, shape (n,)
            [unit of the channel]

        Raises
        ------
        ParameterError
            Readings lie outside a table by more than a twentieth of its span.
        """
        import numpy as np  # not imported by `--help`, which reads rig files

        if self.beyond(readings) > _MARGIN:
            low, high = self.readings[0], self.readings[-1]
            worst = readings[np.argmax(np.maximum(low - readings, readings - high))]
            raise ParameterError(
                f"reads {worst:g}, outside of {self.source} ({low:g} to {high:g}) by "
                f"more than {_MARGIN:.0%} of its span; calibrate over the range that is recorded"
            )
        x, y = np.array(self.readings), np.array(self.values)
        slope = np.diff(y) / np.diff(x)
        piece = np.clip(np.searchsorted(x, readings) - 1, 0, slope.size - 1)
        return np.asarray(y[piece] + slope[piece] * (readings - x[piece]))


VALUE_COLUMNS = {
    "torque": "torque_Nm",
    "acceleration": "acceleration_m_s2",
    "pressure": "pressure_Pa",
    "angle": "angle_rad",
    "speed": "speed_rad_s",
    "force": "force_N",
}
"""Name of the column of values by kind of channel."""

_READING_COLUMNS = {"reading": "", **{f"reading_{unit}": unit for unit in READING_UNITS}}

_FEWEST = 3
"""Fewest rows of a table."""


def read_calibration(entry: Any, kind: str, folder: Path, where: str) -> Calibration:
    """Read the calibration of a kind of channel.

    Parameters
    ----------
    entry : str or mapping
        Entry of the TOML file: the name of a table's file, or a line.
    kind : str
    folder : Path
        Folder of the rig file, to which names of files are relative.
    where : str
        Name of the entry in messages.

    Raises
    ------
    ParameterError
        The entry cannot be used.

    Examples
    --------
    >>> from pathlib import Path
    >>> read_calibration({"sensitivity": 0.101}, "angle", Path(), "rig, angle").gain
    9.900990099009901
    """
    if isinstance(entry, str):
        from models.foreign_table import read_table

        path = folder / entry
        where = f"{where}: {path}"
        with reading(path, "CSV table", where=where, largest=LARGEST_TEXT):
            table = read_table(path)
        names = (
            "_".join(filter(None, both)) for both in zip(table.names, table.units, strict=True)
        )
        columns = dict(zip(names, table.values.T.tolist(), strict=True))
        return _curve(columns, kind, where, path.name)
    if not isinstance(entry, Mapping):
        raise ParameterError(
            f'{where} = {entry!r} must be the name of a table, "cell.csv", or a line, '
            "{ sensitivity = 12.19, offset = 0.4222 }"
        )
    if VALUE_COLUMNS[kind] in entry:
        return _curve(entry, kind, where, "its table")
    refuse_unknown(entry, {"sensitivity", "offset", "reading"}, where)
    sensitivity = number(entry, "sensitivity", where, low=-math.inf)
    offset = number({"offset": 0.0, **entry}, "offset", where, low=-math.inf)
    if offset + sensitivity == offset:
        raise ParameterError(
            f"{where}: sensitivity = {sensitivity:g} is too small; give readings per unit"
        )
    unit = as_text(entry.get("reading", ""), "reading", where)
    if unit and unit not in READING_UNITS:
        raise ParameterError(
            f"{where}: reading = {unit!r} must be one of {', '.join(READING_UNITS)}"
        )
    return Calibration.line(sensitivity, offset, unit)


def _curve(columns: Mapping[str, Any], kind: str, where: str, source: str) -> Calibration:
    """Return the calibration curve of a table's columns."""
    value = VALUE_COLUMNS[kind]
    units = [name for name in columns if name in _READING_COLUMNS]
    if value not in columns or len(units) != 1:
        expected = (value, *_READING_COLUMNS)
        hints = (did_you_mean(name, expected) for name in columns if name not in expected)
        raise ParameterError(
            f"{where}: has the columns {', '.join(columns) or 'none'}, expected {value} and one of "
            f"{', '.join(_READING_COLUMNS)}{next(filter(None, hints), '')}"
        )
    try:
        points = sorted(zip(*(map(float, columns[x]) for x in (value, units[0])), strict=True))
    except (TypeError, ValueError):
        points = [(math.nan, math.nan)]
    if not all(math.isfinite(x) for point in points for x in point):
        raise ParameterError(
            f"{where}: {value} and {units[0]} must be finite numbers, as many of each"
        )
    if len(points) < _FEWEST:
        raise ParameterError(
            f"{where}: has {len(points)} rows, and a table {_FEWEST} or more; two readings are a "
            "line: { sensitivity = ..., offset = ... }"
        )
    _check_monotonic(points, value, where)
    points.sort(key=lambda point: point[1])
    values, readings = zip(*points, strict=True)
    return Calibration(readings, values, _READING_COLUMNS[units[0]], source=source)


def _check_monotonic(points: list[tuple[float, float]], name: str, where: str) -> None:
    """Raise if the readings are not strictly monotonic over the values."""
    sign = math.copysign(1.0, points[-1][1] - points[0][1])
    for (low, before), (high, after) in pairwise(points):
        if low == high:
            raise ParameterError(f"{where}: {name} = {low:g} is in it twice; give its mean once")
        if sign * (after - before) <= 0.0:
            raise ParameterError(
                f"{where}: from {name} = {low:g} to {high:g} the reading goes from {before:g} to "
                f"{after:g}, elsewhere the other way; a reading must have one value"
            )


def calibration_table(calibration: Calibration, kind: str) -> dict[str, Any]:
    """Return the rig file's entry of a calibration, for a kind of channel.

    Examples
    --------
    >>> calibration_table(Calibration.line(0.25, -0.5, "V"), "angle")
    {'sensitivity': 0.25, 'offset': -0.5, 'reading': 'V'}
    """
    if calibration.bounded:
        name = next(n for n, unit in _READING_COLUMNS.items() if unit == calibration.unit)
        readings, values = list(calibration.readings), list(calibration.values)
        return {name: readings, VALUE_COLUMNS[kind]: values}
    sensitivity = 1.0 / calibration.gain
    line = {
        "sensitivity": sensitivity,
        "offset": calibration.readings[0] - sensitivity * calibration.values[0],
    }
    return line | ({"reading": calibration.unit} if calibration.unit else {})
