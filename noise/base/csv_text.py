"""The text of a CSV table: one row a line, as it is read by programs or opened in Excel."""

from __future__ import annotations

import csv
import itertools
import json
import math
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError
from models.foreign_file import reading
from noise.base.excel_csv import (
    PLAIN,
    CsvSigns,
    decimal_sign,
    plain_text,
    separator_of,
    with_apostrophe,
    without_apostrophe,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path
    from typing import TextIO

    from noise.base.tables import Cell

__all__ = ["finite_or_fixed", "read_csv", "signs_there", "write_csv"]

_MARK = "\ufeff"
"""How CSV begins by which Excel knows that it is UTF-8."""

_SUPPORT, _FIXED = "support_stiffness", "fixed"
"""How the columns begin whose infinity is the bolted clamp, and what it is called."""


def read_csv(file: TextIO) -> tuple[list[str], list[dict[str, object]]]:
    r"""Read names of columns and rows, all cells as text; those of Excel as programs write them.

    Examples
    --------
    >>> import io
    >>> read_csv(io.StringIO("file;level_db\nrun07.wav;59,9\n"))[1]
    [{'file': 'run07.wav', 'level_db': '59.9'}]
    """
    header = file.readline()
    signs = _signs(header)
    lines = itertools.chain([header.removeprefix(_MARK)], file)
    reader = csv.DictReader(lines, delimiter=signs.separator)
    meant = plain_text if signs.of_excel else without_apostrophe
    rows: list[dict[str, object]] = [
        {str(c): meant(value) if isinstance(value, str) else value for c, value in row.items()}
        for row in reader
    ]
    return list(reader.fieldnames or ()), rows


def write_csv(
    file: TextIO,
    columns: Sequence[str],
    rows: Iterable[Sequence[Cell]],
    signs: CsvSigns = PLAIN,
) -> None:
    """Write a table, by default as programs do.

    Examples
    --------
    >>> import sys
    >>> write_csv(sys.stdout, ["file", "level_db"], [["run07.wav", 59.9]])
    file,level_db
    run07.wav,59.9
    """
    if signs.marked:
        file.write(_MARK)
    writer = csv.writer(file, delimiter=signs.separator, lineterminator=signs.line_end)
    writer.writerow(columns)
    for row in rows:
        cells = map(_csv_cell, columns, row)
        writer.writerow(cells if signs.decimal == "." else map(signs.cell, cells))


def signs_there(path: Path) -> CsvSigns:
    r"""Return how the CSV table is written that is there; plain where there is none to be read.

    Parameters
    ----------
    path : Path

    Returns
    -------
    CsvSigns
        By the header; the decimal sign is that of the first number which has one.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "labels.csv"
    ...     _ = path.write_text("file;level_db\nrun07.wav;59,9\n")
    ...     signs_there(path)
    CsvSigns(separator=';', decimal=',', marked=False, line_end='\n')
    """
    try:
        with reading(path, "table"), path.open(encoding="utf-8", newline="") as file:
            signs = _signs(file.readline())
            if not signs.of_excel:
                return signs
            cells = (cell for row in csv.reader(file, delimiter=signs.separator) for cell in row)
            found = next(filter(None, map(decimal_sign, cells)), signs.decimal)
            return signs._replace(decimal=found)
    except BushingNoiseError:
        return PLAIN


def _signs(header: str) -> CsvSigns:
    """Return how a table is written; how its numbers are is likely, not known."""
    separator = separator_of(header)
    decimal = "," if separator == ";" else "."
    line_end = "\r\n" if header.endswith("\r\n") else "\n"
    return CsvSigns(separator, decimal, header.startswith(_MARK), line_end)


def finite_or_fixed(column: str, value: Cell) -> Cell:
    """Return what people read in a cell; an infinite number is none, but for the bolted clamp.

    Examples
    --------
    >>> finite_or_fixed("support_stiffness_Nm_rad", math.inf)
    'fixed'
    """
    if isinstance(value, float) and math.isinf(value):
        return _FIXED if value > 0.0 and column.startswith(_SUPPORT) else None
    return value


def _csv_cell(column: str, value: Cell) -> Cell:
    if isinstance(value, str):
        return with_apostrophe(value)
    return json.dumps(value) if isinstance(value, bool) else finite_or_fixed(column, value)
