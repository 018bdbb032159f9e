"""Reading and writing of tables as CSV, Excel, JSON Lines or Parquet, by the suffix of the file.

All formats store the same values: missing, undefined and infinite numbers are empty; text is
escaped by `noise.base.progress.readable`; numbers have as many digits as reproduce them exactly.
CSV and Excel write the infinite stiffness of a bolted clamp as ``fixed``. CSV that replaces another
keeps its dialect, see `noise.base.csv_table`. Tables are written atomically, and a target that
cannot be written is refused before the work.
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
"""Suffixes of the table formats."""

_LIBRARIES = {
    ".xlsx": ("openpyxl", "excel", "an Excel workbook needs"),
    ".parquet": ("pyarrow", "parquet", "Parquet needs"),
}
_LABEL_COLUMN = "label_source"
"""Column that identifies a label table."""

_LONGEST_LINE = 1 << 20
"""Characters of the first line of a JSON Lines file that are read for the columns."""


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
        not installed, or data would be lost: a label table that another table replaces, or
        further sheets of a workbook.

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
    if path.suffix.lower() == ".xlsx" and path.is_file() and (others := _sheet_names(path)[1:]):
        raise ParameterError(
            f"{path}: has more sheets than that of the table ({', '.join(others)}), which would "
            "be lost; name another file"
        )
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
    ending = "" if path is None else Path(path).suffix.lower()
    keys, columns = columns, [readable(column) for column in columns]
    native_types = (date, time) if ending == ".xlsx" else ()

    def cells() -> Iterator[list[Any]]:
        for row in rows:
            yield [v if isinstance(v, native_types) else _table_cell(v) for v in map(row.get, keys)]

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
            _write_parquet(temporary, columns, cells())
        elif ending == ".xlsx":
            _write_workbook(temporary, columns, cells(), path.stem)
        elif ending == ".jsonl":
            with temporary.open("w", encoding="utf-8", newline="") as file:
                for row in cells():
                    record = dict(zip(columns, map(_finite, row), strict=True))
                    file.write(json.dumps(record, ensure_ascii=False) + "\n")
        else:
            form = CsvForm()  # unless a CSV table is replaced, whose dialect is kept
            with suppress(BushingNoiseError), reading(path, "table", largest=LARGEST_TEXT):
                form = read_csv(path.read_bytes())[0]
            with temporary.open("w", encoding=form.encoding, newline="") as file:
                write_csv(file, columns, cells(), form)


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
        names = {name.casefold(): name for name in known}
        header = [
            names.get(name.strip().casefold(), name) for name in map(_cell_text, next(lines, ()))
        ]
        return [name for name in header if name], _row_dicts(header, lines, numbers, separator)


def _lines(path: Path) -> tuple[Iterator[Sequence[object]], str]:
    """Return header and rows of a table, and the separator of a CSV."""
    ending = path.suffix.lower()
    if ending != ".csv":
        return (_parquet_lines(path) if ending == ".parquet" else _sheet_lines(path)), ""
    form, lines = read_csv(path.read_bytes())
    return lines, form.separator


def _row_dicts(
    header: Sequence[str],
    lines: Iterable[Sequence[object]],
    numbers: Collection[str],
    separator: str,
) -> list[dict[str, object]]:
    """Return the rows that are not empty as dictionaries by column."""
    indices = {name: index for index, name in enumerate(header) if name}
    if len(indices) < len(list(filter(None, header))):
        raise ExcessError(f"has two columns {max(filter(None, header), key=header.count)!r}")
    rows: list[dict[str, object]] = []
    for line in lines:
        if not any(map(_cell_text, line)):
            continue
        outside = (c for i, c in enumerate(line) if i >= len(header) or not header[i])
        if cell := next(filter(None, map(_cell_text, outside)), ""):
            raise ExcessError(f"row {len(rows) + 1} has {cell!r} in a column without a name")
        rows.append({name: line[i] if i < len(line) else None for name, i in indices.items()})
    _replace_commas(rows, [name for name in numbers if name in indices], separator)
    return rows


def _replace_commas(
    rows: Sequence[dict[str, object]], numbers: Sequence[str], separator: str
) -> None:
    """Replace decimal commas by points in place; refuse commas that may separate thousands."""
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
                    first = parse_json(file.readline(_LONGEST_LINE) or "{}")
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


# --- Parquet files, and the first sheet of Excel workbooks ---

_MIN_CELLS, _CELLS_PER_BYTE = 200_000, 20
"""Largest number of cells of a workbook or Parquet file: a constant plus a number per byte."""

_MOST_ROWS, _LONGEST_TEXT = 1_048_576, 32_767
"""Limits of Excel: rows of a sheet, and characters of a cell."""


def _finite(value: Cell) -> Cell:
    """Return a value with None in place of infinity."""
    return None if isinstance(value, float) and math.isinf(value) else value


def _cell_text(cell: object) -> str:
    """Return a cell as stripped text; empty for None."""
    return "" if cell is None else str(cell).strip()


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


def _sheet_names(path: Path) -> list[str]:
    """Return the sheet names of a workbook; empty if it cannot be read."""
    from openpyxl import load_workbook

    try:
        with reading(path, "workbook"), path.open("rb") as file:
            check_inflation(path)
            return list(load_workbook(file, read_only=True).sheetnames)
    except BushingNoiseError:  # reading the table reports it
        return []


def _sheet_lines(path: Path) -> Iterator[Sequence[object]]:
    """Yield the rows of the first sheet below its leading comments and empty rows."""
    from openpyxl import load_workbook

    check_inflation(path)
    with path.open("rb") as file:
        book = load_workbook(file, read_only=True, data_only=True)
        cells, in_table = 0, False
        for line in book.worksheets[0].iter_rows(max_row=_MOST_ROWS, values_only=True):
            cells += 1 + len(line)  # a small hostile file may claim any number
            _check_size(path, cells)
            first = next(filter(None, map(_cell_text, line)), "")
            in_table = in_table or (bool(first) and not first.startswith("#"))
            if in_table:
                yield line


def _write_workbook(
    path: Path, columns: Sequence[str], rows: Iterable[Sequence[Cell]], name: str
) -> None:
    """Write a workbook of one sheet with a frozen header and no formulas."""
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
        cell: Any = WriteOnlyCell(sheet)
        cell.value, cell.data_type = value[:_LONGEST_TEXT], "s"  # never a formula
        return cell

    for line in (columns, *lines):
        sheet.append([text(value) if isinstance(value, str) else value for value in line])
    book.properties.creator = "bushing-noise"
    book.save(path)


def _check_size(path: Path, n_cells: int) -> None:
    """Refuse a file that claims more cells than its size can hold."""
    if n_cells > _MIN_CELLS + _CELLS_PER_BYTE * path.stat().st_size:
        raise ExcessError(f"claims {n_cells} cells, more than a file of its size holds")
