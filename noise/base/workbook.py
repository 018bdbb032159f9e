"""Tables as Excel workbooks: one sheet, the header frozen, numbers as numbers, no formula ever.

Text stays text whatever it begins with: a recording called ``=cmd.wav`` is its name, no formula.
"""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

from models.errors import ParameterError, not_installed
from models.foreign_file import ExcessError, check_inflation, reading
from noise.base.readable import readable

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from noise.base.tables import Cell

__all__ = ["check_openpyxl", "read_workbook", "write_workbook"]

_LONGEST = 32_767
"""Characters that a cell holds."""

_MOST_ROWS = 1_048_576
"""Of a sheet."""

_WIDEST, _NARROWEST = 48, 8
"""Of columns [characters]."""

_LOOKED_AT = 200
"""Rows by which the width of a column is chosen."""


_FEW_CELLS, _MOST_CELLS = 100_000, 10
"""What is read at most, and that for each byte of the file [cells]."""


def check_openpyxl(path: Path) -> None:
    """Refuse a workbook that cannot be read or written without the extra.

    Raises
    ------
    ParameterError
        openpyxl is not installed.

    Examples
    --------
    >>> from importlib.util import find_spec
    >>> from pathlib import Path
    >>> if find_spec("openpyxl"):
    ...     check_openpyxl(Path("labels.xlsx"))
    """
    try:
        import openpyxl  # noqa: F401
    except ImportError:
        raise ParameterError(
            not_installed(f"{path}: an Excel workbook needs", "openpyxl", "excel")
        ) from None


def write_workbook(
    path: Path, columns: Sequence[str], rows: Sequence[Sequence[Cell]], there: Path
) -> None:
    """Write a table as a workbook.

    Parameters
    ----------
    path : Path
    columns : sequence of str
    rows : sequence of sequence
        Numbers are finite, texts as `noise.base.readable` shows them.
    there : Path
        Whose name its sheet has; where a workbook of several stands there, they are kept, and the
        table takes the place of the first.

    Raises
    ------
    ParameterError
        The table has more rows than a sheet.
    """
    if len(rows) >= _MOST_ROWS:
        raise ParameterError(
            f"{len(rows)} rows are more than an Excel sheet has ({_MOST_ROWS}); name a .csv or "
            ".parquet"
        )
    from openpyxl.cell import WriteOnlyCell
    from openpyxl.styles import Font
    from openpyxl.utils import get_column_letter

    book, page = _empty_sheet(there)
    page.freeze_panes = "A2"
    for number, column in enumerate(columns):
        cells = (column, *(row[number] for row in rows[:_LOOKED_AT]))
        longest = max(len(str(cell)) for cell in cells if cell is not None)
        letter = get_column_letter(number + 1)
        page.column_dimensions[letter].width = min(max(longest, _NARROWEST), _WIDEST) + 2

    def cell(value: Cell) -> Any:
        if not isinstance(value, str):
            return value
        of_text = WriteOnlyCell(page)
        of_text.value = value[:_LONGEST]
        of_text.data_type = "s"  # what begins like a formula is none
        return of_text

    head = [cell(column) for column in columns]
    for one in head:
        one.font = Font(bold=True)
    page.append(head)
    for row in rows:
        page.append([cell(value) for value in row])
    if columns:
        page.auto_filter.ref = f"A1:{get_column_letter(len(columns))}{len(rows) + 1}"
    book.properties.creator = "bushing-noise"
    book.save(path)


def read_workbook(path: Path) -> tuple[list[str], list[dict[str, object]]]:
    """Read the first sheet of a workbook: the names of its columns, and its rows.

    Raises
    ------
    ValueError
        It claims more cells than it can hold. What the libraries raise over a damaged one is left
        to `models.foreign_file.reading`.
    """
    from openpyxl import load_workbook

    check_inflation(path)
    with path.open("rb") as file:
        book = load_workbook(file, read_only=True, data_only=True)
        lines = _lines(book.worksheets[0], path.stat().st_size) if book.worksheets else []
    named = (
        [(at, str(name)) for at, name in enumerate(lines[0]) if name is not None] if lines else []
    )
    rows = [
        {name: line[at] for at, name in named if at < len(line)}
        for line in lines[1:]
        if any(value is not None for value in line)
    ]
    return [name for _, name in named], rows


def _empty_sheet(there: Path) -> tuple[Any, Any]:
    """Return a workbook and the sheet of it that is to be filled, beside those that are there."""
    from openpyxl import Workbook, load_workbook

    # What is no workbook is written over.
    with suppress(ParameterError), reading(there, "workbook"), there.open("rb") as file:
        check_inflation(there)
        if len(load_workbook(file, read_only=True).sheetnames) > 1:
            book = load_workbook(file)
            old = book.worksheets[0]
            book.remove(old)
            return book, book.create_sheet(old.title, 0)
    book = Workbook(write_only=True)
    return book, book.create_sheet(_sheet_name(there.stem))


def _lines(sheet: Any, size: int) -> list[tuple[object, ...]]:
    """Return the rows of a sheet, of which its file may claim to hold any number."""
    lines, cells = [], 0
    for line in sheet.iter_rows(max_row=_MOST_ROWS, values_only=True):
        cells += 1 + len(line)
        if cells > _FEW_CELLS + _MOST_CELLS * size:
            raise ExcessError(f"claims more than {cells} cells, more than a file of its size holds")
        lines.append(line)
    return lines


def _sheet_name(name: str) -> str:
    """Return a name that a sheet may have."""
    return (
        "".join("_" if letter in r"[]:*?/\'" else letter for letter in readable(name))[:31]
        or "table"
    )
