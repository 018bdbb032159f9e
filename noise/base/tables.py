"""Reading and writing of tables as CSV, Excel, JSON Lines or Parquet, by the suffix of the file.

All formats store the same values: missing, undefined and infinite numbers are empty; text is
escaped by `noise.base.progress.readable`; numbers have as many digits as reproduce them exactly.
CSV and Excel write the infinite stiffness of a bolted clamp as ``fixed``. Tables are written
atomically, and a target that cannot be written is refused before the work.

CSV is read as spreadsheets write it. Excel in a locale with decimal commas writes semicolons and a
UTF-8 byte order mark, its "Unicode text" is UTF-16 with tabs, and older versions use a code page.
Users add comments and ``sep=;`` above the header. A table that replaces another keeps its
separator, decimal sign and line ends. Text that a spreadsheet would evaluate as a formula gets an
apostrophe.
"""

from __future__ import annotations

import csv
import io
import json
import math
import numbers
import re
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from itertools import islice, product, zip_longest
from pathlib import Path
from typing import Any, NamedTuple, TextIO

from models.errors import BushingNoiseError, ParameterError, RecordingError, not_installed
from models.foreign_file import (
    LARGEST_TEXT,
    ExcessError,
    check_inflation,
    decoded,
    parse_json,
    reading,
)
from noise.base.files import atomic
from noise.base.progress import readable

Cell = bool | int | float | str | None
"""Value of a cell that every table format can store."""

TABLE_ENDINGS = (".csv", ".xlsx", ".jsonl", ".parquet")
"""Suffixes of the table formats."""

_LIBRARIES = {
    ".xlsx": ("openpyxl", "excel", "an Excel workbook needs"),
    ".parquet": ("pyarrow", "parquet", "Parquet needs"),
}
"""Module, extra and text of the formats that need a library."""

_LABEL_COLUMN = "label_source"
"""Column that identifies a label table."""


def check_table_path(path: str | Path | None, columns: Collection[str] = (_LABEL_COLUMN,)) -> None:
    """Refuse a path to which the table cannot be written.

    Parameters
    ----------
    path : path-like or None
        None is standard output.
    columns : collection of str
        Columns of the table.

    Raises
    ------
    ParameterError
        The suffix is not in `TABLE_ENDINGS`, the path is a folder, the library of the format is
        not installed, or a label table would be replaced by another table.

    Examples
    --------
    >>> check_table_path("features.ods")
    Traceback (most recent call last):
    models.errors.ParameterError: features.ods: tables end in .csv, .xlsx, .jsonl or .parquet
    """
    if path is None:
        return
    path = Path(path)
    _check_format(path)
    if path.suffix.lower() == ".xlsx" and path.is_file():
        with reading(path, "table"):  # which refuses further sheets, since they would be lost
            next(iter(_workbook_lines(path)), None)
    existing = table_columns(path) if _LABEL_COLUMN not in columns and path.is_file() else ()
    if _LABEL_COLUMN in {name.strip().casefold() for name in existing}:
        raise ParameterError(
            f"{path}: is a label table, in which corrections would be lost; name another file"
        )


def _check_format(path: Path) -> None:
    """Refuse an unknown suffix, a folder, or a format whose library is not installed."""
    ending = path.suffix.lower()
    if ending not in TABLE_ENDINGS:
        raise ParameterError(f"{path}: tables end in .csv, .xlsx, .jsonl or .parquet")
    if path.is_dir():
        raise ParameterError(f"{path}: is a folder; name a file to write")
    if ending in _LIBRARIES:
        package, extra, needs = _LIBRARIES[ending]
        try:
            import_module(package)
        except ImportError:
            raise ParameterError(not_installed(f"{path}: {needs}", package, extra)) from None


def write_table(
    path: str | Path | None, columns: Sequence[str], rows: Iterable[Mapping[str, object]]
) -> None:
    """Write a table.

    Parameters
    ----------
    path : path-like or None
        File, with the format by its suffix; parent folders are made. None is CSV on standard
        output.
    columns : sequence of str
        Columns in their order; other keys of the rows are ignored.
    rows : iterable of mapping
        Column to value: a number, a text, a bool or None. A missing column is None.

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
    names = [readable(column) for column in columns]
    cells = ([_table_cell(row.get(column)) for column in columns] for row in rows)
    if path is None:
        if sys.stdout is None:
            raise ParameterError("standard output is closed; name a file for the table")
        _write_csv(sys.stdout, names, cells, _Form())
        sys.stdout.flush()
        return
    path = Path(path)
    check_table_path(path, names)
    with atomic(path) as temporary:
        if path.suffix.lower() == ".parquet":
            _write_parquet(temporary, names, cells)
        elif path.suffix.lower() == ".xlsx":
            _write_workbook(temporary, names, cells)
        elif path.suffix.lower() == ".jsonl":
            with temporary.open("w", encoding="utf-8", newline="") as file:
                for row in cells:
                    record = dict(zip(names, map(_finite, row), strict=True))
                    file.write(json.dumps(record, ensure_ascii=False) + "\n")
        else:
            form = _Form()  # unless a CSV table is replaced, whose dialect is kept
            with suppress(BushingNoiseError), reading(path, "table", largest=LARGEST_TEXT):
                form = _read_csv(path.read_bytes())[0]
            with temporary.open("w", encoding=form.encoding, newline="") as file:
                _write_csv(file, names, cells, form)


def read_table(
    path: Path, known: Collection[str] = (), numbers: Collection[str] = ()
) -> tuple[list[str], list[dict[str, object]]]:
    r"""Read a table without converting the cells: those of CSV are text.

    Parameters
    ----------
    path : Path
        File, with the format by its suffix.
    known : collection of str
        Column names that are matched regardless of case and surrounding blanks.
    numbers : collection of str
        Columns of numbers, whose decimal commas become points.

    Returns
    -------
    columns : list of str
        Names in the header; empty for JSON Lines.
    rows : list of dict
        Rows that are not empty.

    Raises
    ------
    RecordingError
        The file cannot be read or is no table; two columns have the same name, a cell is outside
        the columns, or the decimal sign is ambiguous.
    ParameterError
        There is no such file, or the library of the format is not installed.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "labels.csv"
    ...     _ = path.write_text("sep=;\nFile;p_creak\nrun07.wav;0,75\n")
    ...     read_table(path, known=["file"], numbers=["p_creak"])
    (['file', 'p_creak'], [{'file': 'run07.wav', 'p_creak': '0.75'}])
    """
    _check_format(path)
    if not path.exists():
        raise ParameterError(f"{path}: there is no such file")
    with reading(path, "table", error=RecordingError, largest=LARGEST_TEXT):
        if path.suffix.lower() == ".jsonl":
            with path.open(encoding="utf-8-sig") as file:
                return [], [parse_json(line) for line in file if line.strip()]
        lines, separator = _lines(path)
        spelling = {name.casefold(): name for name in known}
        header = [spelling.get(name.casefold(), name) for name in map(_cell_text, next(lines, ()))]
        columns = [name for name in header if name]
        if double := [name for name in columns if columns.count(name) > 1]:
            raise ExcessError(f"has two columns {double[0]!r}")
        rows: list[dict[str, object]] = []
        for line in lines:
            if not any(map(_cell_text, line)):
                continue
            outside = [c for c, name in zip_longest(line, header) if not name and _cell_text(c)]
            if outside:
                cell = _cell_text(outside[0])
                raise ExcessError(f"row {len(rows) + 1} has {cell!r} in a column without a name")
            rows.append({name: cell for name, cell in zip_longest(header, line) if name})
        _replace_commas(rows, [name for name in numbers if name in columns], separator)
        return columns, rows


def _lines(path: Path) -> tuple[Iterator[Sequence[object]], str]:
    """Return header and rows of a table, and the separator of a CSV."""
    if path.suffix.lower() == ".parquet":
        return _parquet_lines(path), ""
    if path.suffix.lower() == ".xlsx":
        return _workbook_lines(path), ""
    form, lines = _read_csv(path.read_bytes())
    return lines, form.separator


def _replace_commas(
    rows: Sequence[dict[str, object]], numbers: Sequence[str], separator: str
) -> None:
    """Replace decimal commas by points in place; refuse commas that may separate thousands."""
    signs: dict[str, str] = {}
    places, decimals = [], set()
    for row, name in product(rows, numbers):
        cell = _cell_text(row[name])
        if (sign := _decimal_sign(cell)) is not None:
            signs[sign] = cell
            places.append((row, name, cell.replace(",", ".")))
            decimals.add(len(cell.partition(",")[2]))
    if "," not in signs:
        return
    if "." in signs or (separator != ";" and decimals == {3}):
        other = f" and {signs['.']!r}" if "." in signs else ""
        raise ExcessError(
            f"has numbers such as {signs[',']!r}{other}, in which a comma may be the decimal sign "
            "or not; write them with a point"
        )
    for row, name, cell in places:
        row[name] = cell


def table_columns(path: Path) -> set[str]:
    """Return the columns of a table; empty if the file is no table or cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_table(Path(folder) / "t.csv", ["file"], [])
    ...     table_columns(Path(folder) / "t.csv")
    {'file'}
    """
    try:
        with reading(path, "table"):
            if path.suffix.lower() == ".jsonl":
                with path.open(encoding="utf-8-sig") as file:
                    first = parse_json(file.readline(1 << 20) or "{}")
                return set(first) if isinstance(first, dict) else set()
            return set(map(_cell_text, next(_lines(path)[0], ()))) - {""}
    except BushingNoiseError:
        return set()


def plain_cell(value: object) -> Cell:
    """Return a value as a plain Python bool, int, float or str; None and NaN stay.

    Examples
    --------
    >>> import numpy as np
    >>> plain_cell(np.float64(2.5)), plain_cell(3), plain_cell(None)
    (2.5, 3, None)
    """
    if value is None or isinstance(value, str | bool):
        return value
    item = getattr(value, "item", None)  # numpy scalars
    if callable(item):
        return plain_cell(item())
    if isinstance(value, numbers.Integral):
        return int(value)
    return float(value) if isinstance(value, numbers.Real) else str(value)


def _table_cell(value: object) -> Cell:
    """Return a value as it is stored in a table: displayable text, no NaN."""
    plain = plain_cell(value)
    if isinstance(plain, str):
        return readable(plain)
    return None if isinstance(plain, float) and math.isnan(plain) else plain


_MIN_CELLS, _CELLS_PER_BYTE = 200_000, 20
"""Largest number of cells of a workbook or Parquet file: a constant plus a number per byte."""

_LONGEST_TEXT = 32_767
"""Characters of a cell in Excel at most."""


def _finite(value: Cell) -> Cell:
    """Return a value with None in place of infinity."""
    return None if isinstance(value, float) and math.isinf(value) else value


def _cell_text(cell: object) -> str:
    """Return a cell as stripped text; empty for None."""
    return "" if cell is None else str(cell).strip()


def _check_size(path: Path, n_cells: int) -> None:
    """Refuse a file that claims more cells than its size can hold."""
    if n_cells > _MIN_CELLS + _CELLS_PER_BYTE * path.stat().st_size:
        raise ExcessError(f"claims {n_cells} cells, more than a file of its size holds")


def _workbook_lines(path: Path) -> Iterator[Sequence[object]]:
    """Yield the rows of the only sheet of a workbook from its header on."""
    from openpyxl import load_workbook

    check_inflation(path)
    with path.open("rb") as file:
        book = load_workbook(file, read_only=True, data_only=True)
        if len(book.sheetnames) > 1:
            raise ExcessError(f"has several sheets ({', '.join(book.sheetnames)}), must have one")
        n_cells, in_table = 0, False
        for line in book.worksheets[0].iter_rows(values_only=True):
            n_cells += 1 + len(line)
            _check_size(path, n_cells)
            first = next(filter(None, map(_cell_text, line)), "")
            in_table = in_table or (bool(first) and not first.startswith("#"))
            if in_table:
                yield line


def _write_workbook(path: Path, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    """Write a workbook of one sheet without formulas."""
    from openpyxl import Workbook
    from openpyxl.cell import WriteOnlyCell

    book = Workbook(write_only=True)
    sheet = book.create_sheet("table")

    def plain(value: Cell) -> Any:
        if not isinstance(value, str):
            return value
        cell: Any = WriteOnlyCell(sheet)
        cell.value, cell.data_type = value[:_LONGEST_TEXT], "s"  # never a formula
        return cell

    sheet.append(list(map(plain, columns)))
    for row in rows:
        sheet.append([plain(_infinity(*cell)) for cell in zip(columns, row, strict=True)])
    book.save(path)


def _parquet_lines(path: Path) -> Iterator[Sequence[object]]:
    """Yield header and rows of a Parquet file."""
    from pyarrow import parquet

    with parquet.ParquetFile(path) as file:
        yield file.schema_arrow.names
        _check_size(path, file.metadata.num_rows * file.metadata.num_columns)
        table = file.read()
    yield from zip(*(column.to_pylist() for column in table.columns), strict=True)


def _write_parquet(path: Path, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    """Write a Parquet file; columns of mixed types become text."""
    import pyarrow as pa
    from pyarrow import parquet

    cells = [list(map(_finite, row)) for row in rows]
    arrays = {}
    for index, column in enumerate(columns):
        values = [row[index] for row in cells]
        try:
            arrays[column] = pa.array(values)
        except (pa.ArrowInvalid, pa.ArrowTypeError):
            arrays[column] = pa.array([None if one is None else str(one) for one in values])
    parquet.write_table(pa.table(arrays), path)


_SEPARATORS = ",;\t|"
_HEADER = re.compile(r"(?!\W*(?:sep=|#|$))", re.IGNORECASE)
"""Start of the header, behind comments, ``sep=;`` and lines of separators alone."""

_FORMULA = re.compile(r"'*[=+\-@\t\r]")
"""Start of a formula, or of text that an apostrophe protects from being one."""

_NUMBER = re.compile(r"-?\d+(?:([.,])\d+)?(?:[eE][+-]?\d+)?")
_DECIMAL_ROWS = 1000
"""Rows from which the decimal sign of a table is detected."""

_SUPPORT = "support_stiffness"
"""Prefix of the columns in which infinity means the bolted clamp, written ``fixed``."""


class _Form(NamedTuple):
    """Dialect of a CSV table.

    Parameters
    ----------
    encoding : str
        Encoding for writing.
    separator, decimal, line_end : str
        Cell separator, decimal sign and line terminator.
    """

    encoding: str = "utf-8"
    separator: str = ","
    decimal: str = "."
    line_end: str = "\n"


def _read_csv(content: bytes) -> tuple[_Form, Iterator[list[str]]]:
    """Return the dialect of a CSV table and its rows of text, header first."""
    text, encoding = decoded(content)
    if "\0" in text:
        raise ValueError("is no text")
    lines = text.splitlines(keepends=True)
    start = next((i for i, line in enumerate(lines) if _HEADER.match(line)), len(lines))
    head, table = "".join(lines[start : start + 1]), "".join(lines[start:])
    separator = max(_SEPARATORS, key=lambda one: len(next(csv.reader([head], delimiter=one), ())))
    sample = islice(csv.reader(_file(table), delimiter=separator), 1, _DECIMAL_ROWS)
    signs = [sign for row in sample for cell in row if (sign := _decimal_sign(cell))]
    commas = signs.count(",") - signs.count(".")
    decimal = "," if commas > 0 or (not commas and separator == ";") else "."
    form = _Form(encoding, separator, decimal, "\r\n" if "\r\n" in text else "\n")
    rows = csv.reader(_file(table), delimiter=separator, strict=True)
    # An apostrophe protects a text from being a formula.
    plain = ([c[1:] if c[:1] == "'" and _FORMULA.match(c) else c for c in row] for row in rows)
    return form, plain


def _file(text: str) -> io.StringIO:
    """Return a text as a file for the csv module."""
    return io.StringIO(text, newline="")


def _write_csv(
    file: TextIO, columns: Sequence[str], rows: Iterable[Sequence[Cell]], form: _Form
) -> None:
    """Write a table in a given dialect."""
    writer = csv.writer(file, delimiter=form.separator, lineterminator=form.line_end)
    writer.writerow(columns)
    for row in rows:
        writer.writerow([_csv_cell(*cell, form.decimal) for cell in zip(columns, row, strict=True)])


def _decimal_sign(cell: str) -> str | None:
    """Return the decimal sign of a cell; None for integers and text."""
    number = _NUMBER.fullmatch(cell)
    return number and number[1]


def _csv_cell(column: str, value: Cell, decimal: str) -> Cell:
    """Return a value as it is written into a CSV cell."""
    if isinstance(value, str):
        return f"'{value}" if _FORMULA.match(value) and not _NUMBER.fullmatch(value) else value
    if isinstance(value, bool):
        return json.dumps(value)
    value = _infinity(column, value)
    return str(value).replace(".", decimal) if isinstance(value, float) else value


def _infinity(column: str, value: Cell) -> Cell:
    """Return ``fixed`` for the infinite stiffness of a bolted clamp, and nothing for others."""
    if isinstance(value, float) and math.isinf(value):
        return "fixed" if value > 0.0 and column.startswith(_SUPPORT) else None
    return value
