"""Tables in binary formats: Parquet, and workbooks of Excel, of which the first sheet counts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from models.errors import BushingNoiseError, ParameterError
from models.foreign_file import ExcessError, check_inflation, reading
from noise.base.csv_table import Cell, finite_or_fixed
from noise.base.progress import readable

_FEW_CELLS, _MOST_CELLS = 200_000, 20
"""Cells that a workbook or Parquet file may hold: so many, and so many a byte."""

_MOST_ROWS, _LONGEST_TEXT = 1_048_576, 32_767
"""Of a sheet; and of a cell [characters]."""


def finite(value: Cell) -> Cell:
    """Return a value as programs read it: an infinite number is none."""
    return None if isinstance(value, float) and math.isinf(value) else value


def cell_text(cell: object) -> str:
    """Return a cell as a text without blanks about it, empty for none."""
    return "" if cell is None else str(cell).strip()


def parquet_lines(path: Path) -> Iterator[Sequence[object]]:
    """Yield names of columns and rows of a Parquet file."""
    from pyarrow import parquet

    with parquet.ParquetFile(path) as file:
        yield file.schema_arrow.names
        _check_size(path, file.metadata.num_rows * file.metadata.num_columns)
        table = file.read()
    yield from zip(*(column.to_pylist() for column in table.columns), strict=True)


def write_parquet(path: Path, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    """Write a Parquet file; a column of texts and numbers becomes one of texts."""
    import pyarrow as pa
    from pyarrow import parquet

    cells = [list(map(finite, row)) for row in rows]
    arrays = {}
    for place, column in enumerate(columns):
        values = [row[place] for row in cells]
        try:
            arrays[column] = pa.array(values)
        except (pa.ArrowInvalid, pa.ArrowTypeError):
            arrays[column] = pa.array([None if one is None else str(one) for one in values])
    parquet.write_table(pa.table(arrays), path)


def sheet_names(path: Path) -> list[str]:
    """Return the names of the sheets of a workbook, none where it cannot be read."""
    from openpyxl import load_workbook

    try:
        with reading(path, "workbook"), path.open("rb") as file:
            check_inflation(path)
            return list(load_workbook(file, read_only=True).sheetnames)
    except BushingNoiseError:  # whoever reads it says so
        return []


def sheet_lines(path: Path) -> Iterator[Sequence[object]]:
    """Yield the rows of the first sheet, from the first that is no comment."""
    from openpyxl import load_workbook

    check_inflation(path)
    with path.open("rb") as file:
        book = load_workbook(file, read_only=True, data_only=True)
        cells, begun = 0, False
        for line in book.worksheets[0].iter_rows(max_row=_MOST_ROWS, values_only=True):
            cells += 1 + len(line)  # a sheet may claim to hold any number
            _check_size(path, cells)
            first = next(filter(None, map(cell_text, line)), "")
            begun = begun or (bool(first) and not first.startswith("#"))
            if begun:
                yield line


def write_workbook(
    path: Path, columns: Sequence[str], rows: Iterable[Sequence[Cell]], name: str
) -> None:
    """Write one sheet: its header frozen, numbers as numbers, no text ever a formula."""
    from openpyxl import Workbook
    from openpyxl.cell import WriteOnlyCell

    lines = [list(map(finite_or_fixed, columns, row)) for row in rows]
    if len(lines) >= _MOST_ROWS:
        raise ParameterError(
            f"{len(lines)} rows are more than an Excel sheet has ({_MOST_ROWS}); name a .csv or "
            ".parquet"
        )
    book = Workbook(write_only=True)
    title = "".join("_" if letter in r"[]:*?/\'" else letter for letter in readable(name))[:31]
    sheet = book.create_sheet(title or "table")
    sheet.freeze_panes = "A2"

    def text(value: str) -> Any:
        of_text: Any = WriteOnlyCell(sheet)
        of_text.value, of_text.data_type = value[:_LONGEST_TEXT], "s"  # never a formula
        return of_text

    for line in (columns, *lines):
        sheet.append([text(value) if isinstance(value, str) else value for value in line])
    book.properties.creator = "bushing-noise"
    book.save(path)


def _check_size(path: Path, n_cells: int) -> None:
    if n_cells > _FEW_CELLS + _MOST_CELLS * path.stat().st_size:
        raise ExcessError(f"claims {n_cells} cells, more than a file of its size holds")
