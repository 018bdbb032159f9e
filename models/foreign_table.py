"""Reader of text tables of numbers (CSV) written by loggers, analysers and spreadsheets.

Columns are separated by semicolons, tabs, commas or blanks; numbers may have a decimal comma unless
commas separate columns. The rows above the numbers give names and units of the columns:
``Force [kN]``, or a row of units below a row of names.
"""

import csv
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.foreign_file import ExcessError
from models.units import quantity_of_unit, split_unit

_SEPARATORS = (";", "\t", ",", " ")
_UTF16 = (b"\xff\xfe", b"\xfe\xff")


@dataclass(frozen=True, eq=False)
class ForeignTable:
    """Table of numbers with named columns.

    Parameters
    ----------
    names, units : tuple of str
        One per column; units as the file spells them, empty where it states none.
    values : ndarray, shape (n_rows, n_columns)
        [units of the file]; NaN for an empty cell.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: NDArray[np.float64]


def read_table(path: Path) -> ForeignTable:
    r"""Read a table of two or more columns, within `models.foreign_file.reading`.

    Parameters
    ----------
    path : Path
        Text in UTF-8, UTF-16 with a byte order mark, or Windows-1252.

    Raises
    ------
    ValueError
        The table has no numbers, rows differ in length, or a cell is not a number.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "hit.csv"
    ...     _ = path.write_text("Zeit [s];Kraft [N]\n0;1,5\n0,001;80\n", encoding="utf-8")
    ...     table = read_table(path)
    >>> table.names, table.units, table.values.tolist()
    (('Zeit', 'Kraft'), ('s', 'N'), [[0.0, 1.5], [0.001, 80.0]])
    """
    text = _decoded(path.read_bytes())
    for separator in _SEPARATORS:
        reader = csv.reader(
            io.StringIO(text, newline=""), delimiter=separator, skipinitialspace=separator == " "
        )
        rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
        rows = [(line, row) for line, row in rows if any(row)]
        first = next((i for i, (_, row) in enumerate(rows) if _begins_numbers(row)), None)
        if first is not None:
            break
    else:
        raise ExcessError("holds no rows of numbers; columns are separated by ; or , or tabs")
    n = len(rows[first][1])
    if not any(row[-1] for _, row in rows[first:]):  # a separator at the end of each line
        n -= 1
    values = np.empty((len(rows) - first, n))
    names, units = _headings([row[:n] for _, row in rows[:first] if len(row) >= n], n)
    for target, (line, row) in zip(values, rows[first:], strict=True):
        if len(row) < n or any(row[n:]):
            raise ExcessError(
                f"line {line} has {len(row)} columns, those before it have {n}"
                + "; where commas separate columns, numbers have a decimal point"
                * (separator == ",")
            )
        for column, cell in enumerate(row[:n]):
            try:
                target[column] = float(cell.replace(",", ".")) if cell else np.nan
            except ValueError:
                name = names[column] or f"column {column + 1}"
                raise ExcessError(f"{name} is {cell!r} in line {line}, expected a number") from None
    return ForeignTable(names, units, values)


def _decoded(content: bytes) -> str:
    if content.startswith(_UTF16):
        return content.decode("utf-16")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


def _begins_numbers(row: list[str]) -> bool:
    try:
        float(row[0].replace(",", "."))
    except ValueError:
        return False
    return sum(map(bool, row)) > 1


def _headings(rows: list[list[str]], n: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names and units of columns from the rows nearest above the numbers."""
    stated = [""] * n
    for row in reversed(rows):
        if quantity_of_unit(row[0]) and not any(stated):  # a row of units
            stated = row
        elif any(row[1:]):
            parts = [split_unit(cell.lstrip("#% ")) for cell in row]
            # A column whose only heading is a unit has that unit.
            units = [
                unit or below or (name if quantity_of_unit(name) else "")
                for (name, unit), below in zip(parts, stated, strict=True)
            ]
            return tuple(name for name, _ in parts), tuple(units)
    return ("",) * n, tuple(stated)
