"""Tables as files: CSV, Excel, JSON Lines or Parquet by the ending; CSV on standard output.

One value is written alike in all formats: nothing where there is none (an undefined number is
none, too, and an infinite one), texts as `noise.base.readable` shows them, ``true`` and ``false``,
and numbers with as many digits as give the same number back. In CSV and in a workbook the infinite
stiffness of a bolted clamp is the word ``fixed``; in CSV a text that a spreadsheet would take for a
formula (it begins with ``=``, ``+``, ``-``, ``@``, a tab or a carriage return) has an apostrophe
before it, which reading takes away. A table appears whole or not at all, and a target that cannot
be written is refused before the work whose result it is to hold.
"""

from __future__ import annotations

import csv
import json
import math
import numbers
import sys
from collections.abc import Iterator
from datetime import date, time
from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import BushingNoiseError, ParameterError, RecordingError, not_installed
from models.foreign_file import LARGEST_TEXT, parse_json, reading
from noise.base.atomic import atomic
from noise.base.csv_text import finite_or_fixed, read_csv, signs_there, write_csv
from noise.base.excel_csv import PLAIN, excel_signs, separator_of
from noise.base.parquet import finite, read_parquet, write_parquet
from noise.base.readable import readable

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from typing import Any, TextIO

    Cell = bool | int | float | str | None

__all__ = [
    "TABLE_ENDINGS",
    "check_table_path",
    "plain_cell",
    "read_table",
    "table_columns",
    "table_endings",
    "write_table",
]

TABLE_ENDINGS = (".csv", ".xlsx", ".jsonl", ".parquet")
"""Endings of the formats that tables are written in."""

_LONGEST_LINE = 1 << 20
"""Characters of a line that are looked at for the columns."""


def table_endings(*more: str) -> str:
    """Return the endings of tables in words, with those that something else has as well.

    Examples
    --------
    >>> table_endings()
    '.csv, .xlsx, .jsonl or .parquet'
    """
    *first, last = (*TABLE_ENDINGS, *more)
    return f"{', '.join(first)} or {last}"


def check_table_path(path: str | Path | None, excel: str | None = None) -> None:
    """Refuse a path that no table can be written to, before the work is done.

    Parameters
    ----------
    path : path-like or None
        None is standard output.
    excel : str, optional
        Language of the Excel that is to open it, as for `write_table`.

    Raises
    ------
    ParameterError
        The ending is none of `TABLE_ENDINGS`, the path is a folder, or the library that writes the
        format is not installed; with `excel`, it is no CSV.

    Examples
    --------
    >>> check_table_path("features.ods")
    Traceback (most recent call last):
    models.errors.ParameterError: features.ods: tables end in .csv, .xlsx, .jsonl or .parquet
    """
    if path is None:
        return
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in TABLE_ENDINGS:
        raise ParameterError(f"{path}: tables end in {table_endings()}")
    if path.is_dir():
        raise ParameterError(f"{path}: is a folder; name a file to write")
    if excel is not None and ending != ".csv":
        raise ParameterError(f"{path}: --excel says how a .csv is written; leave it out")
    if ending == ".xlsx":
        from noise.base.workbook import check_openpyxl

        check_openpyxl(path)
    if ending == ".parquet":
        try:
            import pyarrow as pa  # noqa: F401
        except ImportError:
            raise ParameterError(
                not_installed(f"{path}: Parquet needs", "pyarrow", "parquet")
            ) from None


def write_table(
    path: str | Path | None,
    columns: Sequence[str],
    rows: Iterable[Mapping[str, object]],
    excel: str | None = None,
) -> None:
    """Write a table.

    Parameters
    ----------
    path : path-like or None
        Format by its ending, parent folders are made; None writes CSV to standard output.
    columns : sequence of str
        All columns in their order; keys of a row that are not among them are left out.
    rows : iterable of mapping
        Column to value: a number, a text, a truth value or None. A missing column is None.
    excel : str, optional
        One of `noise.base.excel_csv.EXCEL_LANGUAGES`: CSV as Excel in that language opens it; by
        default as the one is written that is there, else plain.

    Raises
    ------
    ParameterError
        The path cannot be written, see `check_table_path`.

    Examples
    --------
    >>> rows = [{"file": "run07.wav", "level_db": 81.5}, {"file": "bad.wav", "level_db": None}]
    >>> write_table(None, ["file", "level_db"], rows)
    file,level_db
    run07.wav,81.5
    bad.wav,
    """
    cells = _Cells(rows, columns)
    columns = [readable(column) for column in columns]
    signs = PLAIN if excel is None else excel_signs(excel)
    if path is None:
        if sys.stdout is None:
            raise ParameterError("standard output is closed; name a file for the table")
        write_csv(sys.stdout, columns, cells, signs)
        sys.stdout.flush()
        return
    path = Path(path)
    check_table_path(path, excel)
    ending = path.suffix.lower()
    if excel is None and ending == ".csv":
        signs = signs_there(path)
    with atomic(path) as temporary:
        if ending == ".parquet":
            write_parquet(temporary, columns, cells)
        elif ending == ".xlsx":
            from noise.base.workbook import write_workbook

            cells.kept = (date, time)
            finite = [list(map(finite_or_fixed, columns, row)) for row in cells]
            write_workbook(temporary, columns, finite, path)
        else:
            with temporary.open("w", encoding="utf-8", newline="") as file:
                if ending == ".csv":
                    write_csv(file, columns, cells, signs)
                else:
                    _write_json_lines(file, columns, cells)


def read_table(path: Path) -> tuple[list[str], list[dict[str, object]]]:
    r"""Read a table as it stands: cells of CSV are text.

    Parameters
    ----------
    path : Path
        Format by its ending.

    Returns
    -------
    columns : list of str
        Those that the file names before its rows, which JSON Lines does not.
    rows : list of dict

    Raises
    ------
    RecordingError
        It cannot be read, or is no table.
    ParameterError
        There is no such file, or the library that reads the format is not installed.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "labels.csv"
    ...     _ = path.write_text("file,label\nrun07.wav,creak\n")
    ...     read_table(path)
    (['file', 'label'], [{'file': 'run07.wav', 'label': 'creak'}])
    """
    check_table_path(path)
    if not path.exists():
        raise ParameterError(f"{path}: there is no such file")
    ending = path.suffix.lower()
    with reading(path, "table", error=RecordingError, largest=LARGEST_TEXT):
        if ending == ".parquet":
            return read_parquet(path)
        if ending == ".xlsx":
            from noise.base.workbook import read_workbook

            return read_workbook(path)
        if ending == ".csv":
            with path.open(encoding="utf-8", newline="") as file:
                return read_csv(file)
        with path.open(encoding="utf-8-sig") as file:
            return [], [parse_json(line) for line in file if line.strip()]


def table_columns(path: Path) -> set[str]:
    """Return the columns of a table; none where it is no table or cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_table(Path(folder) / "t.csv", ["file"], [])
    ...     table_columns(Path(folder) / "t.csv")
    {'file'}
    """
    ending = path.suffix.lower()
    try:
        with reading(path, "table"):
            if ending == ".parquet":
                from pyarrow import parquet

                return set(parquet.read_schema(path).names)
            if ending == ".xlsx":
                from noise.base.workbook import read_workbook

                return set(read_workbook(path)[0])
            # Names of columns can be read though cells may not, such as of Excel without Unicode.
            with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
                header = file.readline(_LONGEST_LINE)
            if ending == ".jsonl":
                first = parse_json(header or "{}")
                return set(first) if isinstance(first, dict) else set()
            return set(next(csv.reader([header], delimiter=separator_of(header)), ()))
    except BushingNoiseError:
        return set()


def plain_cell(value: object) -> Cell:
    """Return a value as one that every format of a table can hold; NaN stays.

    Examples
    --------
    >>> import numpy as np
    >>> plain_cell(np.float64(2.5)), plain_cell(3), plain_cell(None)
    (2.5, 3, None)
    """
    if value is None or isinstance(value, str | bool):
        return value
    item = getattr(value, "item", None)  # scalars of numpy
    if callable(item):
        return plain_cell(item())
    if isinstance(value, numbers.Integral):
        return int(value)
    return float(value) if isinstance(value, numbers.Real) else str(value)


def _cell(value: object) -> Cell:
    plain = plain_cell(value)
    if isinstance(plain, str):  # such as a name, which may hold what no UTF-8 can
        return readable(plain)
    return None if isinstance(plain, float) and math.isnan(plain) else plain


class _Cells:
    """Rows as they are written, each made when it is its turn; to be gone through again."""

    kept: tuple[type, ...] = ()  # what is written as it is

    def __init__(self, rows: Iterable[Mapping[str, object]], columns: Sequence[str]) -> None:
        self._rows = list(rows) if isinstance(rows, Iterator) else rows
        self._columns = columns

    def __iter__(self) -> Iterator[list[Any]]:
        for row in self._rows:
            cells = map(row.get, self._columns)
            yield [one if isinstance(one, self.kept) else _cell(one) for one in cells]


def _write_json_lines(file: TextIO, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    for row in rows:
        line = json.dumps(dict(zip(columns, map(finite, row), strict=True)), ensure_ascii=False)
        file.write(line + "\n")
