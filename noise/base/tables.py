"""Tables as files: CSV, Excel, JSON Lines or Parquet by the ending; CSV on standard output.

One value is written alike in all formats: nothing where there is none (an undefined number is
none, too, and an infinite one), texts as `noise.base.progress.readable` shows them, ``true`` and
``false``, and numbers with as many digits as give the same number back. In CSV and in a workbook
the infinite stiffness of a bolted clamp is the word ``fixed``. CSV that is written over another
keeps its form, see `noise.base.csv_table`. A table appears whole or not at all, and a target that
cannot be written is refused before the work whose result it is to hold.
"""

from __future__ import annotations

import json
import math
import numbers
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from datetime import date, time
from importlib import import_module
from pathlib import Path
from typing import Any

from models.errors import BushingNoiseError, ParameterError, RecordingError, not_installed
from models.foreign_file import LARGEST_TEXT, ExcessError, check_inflation, parse_json, reading
from noise.base.csv_table import Cell, CsvForm, decimal_sign, finite_or_fixed, read_csv, write_csv
from noise.base.files import atomic
from noise.base.progress import readable

TABLE_ENDINGS = (".csv", ".xlsx", ".jsonl", ".parquet")
"""Endings of the formats that tables are written in."""

_LIBRARIES = {
    ".xlsx": ("openpyxl", "excel", "an Excel workbook needs"),
    ".parquet": ("pyarrow", "parquet", "Parquet needs"),
}
_OF_LABELS = "label_source"
"""Column that label tables have."""

_LONGEST_LINE = 1 << 20
"""Characters of a line of JSON that are looked at for the columns."""


def check_table_path(path: str | Path | None, columns: Collection[str] = (_OF_LABELS,)) -> None:
    """Refuse a path that no table can be written to, before the work is done.

    Parameters
    ----------
    path : path-like or None
        None is standard output.
    columns : collection of str
        Of the table that will be written.

    Raises
    ------
    ParameterError
        The ending is none of `TABLE_ENDINGS`, the path is a folder, the library that writes the
        format is not installed, or what is there would be lost: a label table under another
        table, or the other sheets of a workbook.

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
    if path.suffix.lower() == ".xlsx" and path.is_file() and (others := sheet_names(path)[1:]):
        raise ParameterError(
            f"{path}: has more sheets than that of the table ({', '.join(others)}), which would "
            "be lost; name another file"
        )
    there = table_columns(path) if _OF_LABELS not in columns and path.is_file() else ()
    if _OF_LABELS in {name.strip().casefold() for name in there}:
        raise ParameterError(
            f"{path}: is a label table, in which corrections would be lost; name another file"
        )


def _check_format(path: Path) -> None:
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
        Format by its ending, parent folders are made; None writes CSV to standard output.
    columns : sequence of str
        All columns in their order; keys of a row that are not among them are left out.
    rows : iterable of mapping
        Column to value: a number, a text, a truth value or None. A missing column is None.

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
    ending = "" if path is None else Path(path).suffix.lower()
    rows = list(rows) if isinstance(rows, Iterator) else rows  # they may be gone through twice
    known, columns = columns, [readable(column) for column in columns]
    as_it_is = (date, time) if ending == ".xlsx" else ()

    def cells() -> Iterator[list[Any]]:
        for row in rows:
            yield [v if isinstance(v, as_it_is) else _cell(v) for v in map(row.get, known)]

    if path is None:
        if sys.stdout is None:
            raise ParameterError("standard output is closed; name a file for the table")
        write_csv(sys.stdout, columns, cells())
        sys.stdout.flush()
        return
    path = Path(path)
    check_table_path(path, columns)
    with atomic(path) as temporary:
        if ending == ".parquet":
            write_parquet(temporary, columns, cells())
        elif ending == ".xlsx":
            write_workbook(temporary, columns, cells(), path.stem)
        elif ending == ".jsonl":
            with temporary.open("w", encoding="utf-8", newline="") as file:
                for row in cells():
                    named = dict(zip(columns, map(finite, row), strict=True))
                    file.write(json.dumps(named, ensure_ascii=False) + "\n")
        else:
            form = CsvForm()  # that of the table that is there, if it is one
            with suppress(BushingNoiseError), reading(path, "table", largest=LARGEST_TEXT):
                form = read_csv(path.read_bytes())[0]
            with temporary.open("w", encoding=form.encoding, newline="") as file:
                write_csv(file, columns, cells(), form)


def read_table(
    path: Path, known: Collection[str] = (), numbers: Collection[str] = ()
) -> tuple[list[str], list[dict[str, object]]]:
    r"""Read a table as it stands: cells of CSV are text.

    Parameters
    ----------
    path : Path
        Format by its ending.
    known : collection of str
        Columns whose names are understood in capitals and with spaces about them as well.
    numbers : collection of str
        Columns of numbers, whose decimal commas become points.

    Returns
    -------
    columns : list of str
        Those that the file names before its rows, which JSON Lines does not.
    rows : list of dict
        Without those that are empty.

    Raises
    ------
    RecordingError
        It cannot be read, or is no table; two columns have one name, a cell is in no column, or
        numbers have points and commas.
    ParameterError
        There is no such file, or the library that reads the format is not installed.

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
        meant = {name.casefold(): name for name in known}
        header = [
            meant.get(name.strip().casefold(), name) for name in map(cell_text, next(lines, ()))
        ]
        return [name for name in header if name], _named(header, lines, numbers, separator)


def _lines(path: Path) -> tuple[Iterator[Sequence[object]], str]:
    """Return names of columns and rows, and what stands between the cells of a CSV."""
    ending = path.suffix.lower()
    if ending != ".csv":
        return (parquet_lines(path) if ending == ".parquet" else sheet_lines(path)), ""
    form, lines = read_csv(path.read_bytes())
    return lines, form.separator


def _named(
    header: Sequence[str],
    lines: Iterable[Sequence[object]],
    numbers: Collection[str],
    separator: str,
) -> list[dict[str, object]]:
    at = {name: place for place, name in enumerate(header) if name}
    if len(at) < len(list(filter(None, header))):
        raise ExcessError(f"has two columns {max(filter(None, header), key=header.count)!r}")
    rows: list[dict[str, object]] = []
    for line in lines:
        if not any(map(cell_text, line)):
            continue
        beyond = (c for i, c in enumerate(line) if i >= len(header) or not header[i])
        if cell := next(filter(None, map(cell_text, beyond)), ""):
            raise ExcessError(f"row {len(rows) + 1} has {cell!r} in a column without a name")
        rows.append(
            {name: line[place] if place < len(line) else None for name, place in at.items()}
        )
    _read_commas(rows, [name for name in numbers if name in at], separator)
    return rows


def _read_commas(rows: Sequence[dict[str, object]], numbers: Sequence[str], separator: str) -> None:
    """Write points for the decimal commas of numbers, where they are no thousands."""
    cells = [(row, name, str(row[name])) for row in rows for name in numbers]
    signs = {sign: cell for _, _, cell in cells if (sign := decimal_sign(cell.strip()))}
    if "," not in signs:
        return
    parts = (cell.partition(",")[2] for _, _, cell in cells if "," in cell)
    thousands = separator != ";" and all(len(part.strip()) == 3 for part in parts)
    if "." in signs or thousands:
        other = f" and {signs['.']!r}" if "." in signs else ""
        raise ExcessError(
            f"has numbers such as {signs[',']!r}{other}, in which a comma may be the decimal sign "
            "or not; write them with a point"
        )
    for row, name, cell in cells:
        if decimal_sign(cell.strip()):
            row[name] = cell.strip().replace(",", ".")


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
    try:
        with reading(path, "table"):
            if path.suffix.lower() == ".jsonl":
                with path.open(encoding="utf-8-sig") as file:
                    first = parse_json(file.readline(_LONGEST_LINE) or "{}")
                return set(first) if isinstance(first, dict) else set()
            return set(map(cell_text, next(_lines(path)[0], ()))) - {""}
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


# --- Parquet, and workbooks of Excel, of which the first sheet counts ---

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
