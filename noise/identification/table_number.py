"""Measured numbers of a rig: what a table of measurements holds beside or instead of recordings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.condition import FIXED
from models.errors import ParameterError
from models.foreign_file import refusing
from models.show import short_repr
from noise.base.tables import read_table
from noise.identification.quantities import QUANTITIES

COLUMNS = (
    "item", "value", "unit", "interference_mm", "support_stiffness_Nm_rad", "speed_rad_s",
    "error_percent",
)  # fmt: skip
"""Of a table; speed only where an item has one, the error if it is known."""

_ERROR = 5.0
"""Standard error of a number that states none [%]; assumed."""

_AROUND = (0.4, 1.6)
_N_SPEEDS = 16
"""Speeds tried about a critical one, over it."""


@short_repr
@dataclass(frozen=True)
class TableNumber:
    """A measured number.

    Parameters
    ----------
    item : str
        Of `noise.identification.quantities.QUANTITIES`.
    value : float
        As measured [the item's unit].
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    speeds : tuple of float
        At which the rig is run for it [rad/s].
    weight : float
        Of its misfit [-], one over its relative standard error in a table that was read.
    group : str
        Numbers of a group count by the root mean square of their misfits, one without by itself.
    """

    item: str
    value: float
    interference: float
    support_stiffness: float
    speeds: tuple[float, ...] = ()
    weight: float = 1.0
    group: str = ""

    def misfit(self, found: float) -> float:
        """Distance of what a rig gives from what was measured, both in the item's unit [-]."""
        return QUANTITIES[self.item].misfit(found, self.value)

    def __str__(self) -> str:
        fixed = self.support_stiffness == FIXED
        support = "fixed" if fixed else f"{self.support_stiffness:.0f} Nm/rad"
        return f"{self.item} at {1e3 * self.interference:.3f} mm, {support}"


def read_numbers(path: Path) -> tuple[TableNumber, ...]:
    r"""Read a table of measured numbers.

    Parameters
    ----------
    path : Path
        CSV, JSON Lines or Parquet with the columns `COLUMNS`.

    Raises
    ------
    ParameterError
        A row cannot be used; the message names file, row and column.
    RecordingError
        It is no table.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "measured.csv"
    ...     _ = path.write_text(
    ...         "item,value,unit,interference_mm,support_stiffness_Nm_rad,speed_rad_s\n"
    ...         "slip_frequency,155,Hz,0.279,fixed,1\n")
    ...     [(str(number), number.value, number.speeds) for number in read_numbers(path)]
    [('slip_frequency at 0.279 mm, fixed', 155.0, (1.0,))]
    """
    _, rows = read_table(path)
    if not rows:
        raise ParameterError(f"{path}: holds no row; columns are {', '.join(COLUMNS)}")
    with refusing(str(path), "table of numbers"):
        return tuple(_number(row, f"{path}: row {i}") for i, row in enumerate(rows, start=1))


def _number(row: Mapping[str, object], where: str) -> TableNumber:
    item = str(row.get("item") or "").strip()
    quantity = QUANTITIES.get(item)
    if quantity is None:
        from models.schema import did_you_mean

        raise ParameterError(
            f"{where}: item {item!r} is unknown{did_you_mean(item, QUANTITIES)}; there are "
            f"{', '.join(QUANTITIES)}"
        )
    unit = str(row.get("unit") or "").strip()
    if unit != quantity.unit:
        raise ParameterError(f"{where}: unit {unit!r} of {item} must be {quantity.unit!r}")
    value = _positive(row, "value", where)
    interference = 1e-3 * _positive(row, "interference_mm", where)
    support = str(row.get("support_stiffness_Nm_rad") or "").strip()
    stiffness = FIXED if support == "fixed" else _positive(row, "support_stiffness_Nm_rad", where)
    speeds: tuple[float, ...] = ()
    if quantity.at_a_speed:
        speeds = (_positive(row, "speed_rad_s", where),)
    elif quantity.needs_runs:
        speeds = tuple(np.geomspace(_AROUND[0] * value, _AROUND[1] * value, _N_SPEEDS).tolist())
    stated = str(row.get("error_percent") or "").strip()
    error = 0.01 * (_positive(row, "error_percent", where) if stated else _ERROR)
    return TableNumber(item, value, interference, stiffness, speeds, 1.0 / error, "table")


def _positive(row: Mapping[str, object], column: str, where: str) -> float:
    cell = str("" if row.get(column) is None else row[column]).strip()
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise ParameterError(f"{where}: {column} = {cell!r} must be a number above 0")
    return value
