"""The text of a CSV table: one row a line, as it is read by programs or opened in Excel."""

from __future__ import annotations

import csv
import itertools
import json
import math
from typing import TYPE_CHECKING

from noise.base.excel_csv import plain_text, separator_of, with_apostrophe, without_apostrophe

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from typing import TextIO

    from noise.base.excel_csv import ExcelSigns
    from noise.base.tables import Cell

__all__ = ["finite_or_fixed", "read_csv", "write_csv"]

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
    of_excel = header.startswith(_MARK)
    header = header.removeprefix(_MARK)
    lines = itertools.chain([header], file)
    reader = csv.DictReader(lines, delimiter=separator_of(header))
    of_excel |= reader.reader.dialect.delimiter == ";"
    meant = plain_text if of_excel else without_apostrophe
    rows: list[dict[str, object]] = [
        {str(c): meant(value) if isinstance(value, str) else value for c, value in row.items()}
        for row in reader
    ]
    return list(reader.fieldnames or ()), rows


def write_csv(
    file: TextIO,
    columns: Sequence[str],
    rows: Iterable[Sequence[Cell]],
    signs: ExcelSigns | None = None,
) -> None:
    """Write a table, as Excel opens it where its signs are given.

    Examples
    --------
    >>> import sys
    >>> write_csv(sys.stdout, ["file", "level_db"], [["run07.wav", 59.9]])
    file,level_db
    run07.wav,59.9
    """
    if signs is None:
        writer = csv.writer(file, lineterminator="\n")
    else:
        file.write(_MARK)
        writer = csv.writer(file, delimiter=signs.separator, lineterminator="\r\n")
    writer.writerow(columns)
    for row in rows:
        cells = map(_csv_cell, columns, row)
        writer.writerow(cells if signs is None else [_excel_cell(cell, signs) for cell in cells])


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


def _excel_cell(value: Cell, signs: ExcelSigns) -> Cell:
    return signs.text(value) if isinstance(value, float) else value
