"""Reader and writer of CSV tables that detect and preserve the dialect of spreadsheets.

Excel in a locale with decimal commas writes semicolons and a UTF-8 byte order mark, its "Unicode
text" is UTF-16 with tabs, and older versions use a code page. Users add comments and ``sep=;``
above the header. All of this is read. A table that replaces another keeps its separator, decimal
sign and line ends. Text that a spreadsheet would evaluate as a formula gets an apostrophe.
"""

from __future__ import annotations

import codecs
import csv
import io
import json
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import NamedTuple, TextIO

Cell = bool | int | float | str | None
"""Value of a cell that every table format can store."""

_SEPARATORS = ",;\t|"
_SEPARATOR_LINE = re.compile(r'"?sep=(.)', re.IGNORECASE)
_FORMULA = re.compile(r"'*[=+\-@\t\r]")
"""Start of a formula, or of text that an apostrophe protects from being one."""

_NUMBER = re.compile(r"-?\d+(?:([.,])\d+)?(?:[eE][+-]?\d+)?")
_DECIMAL_ROWS = 1000
"""Rows from which the decimal sign of a table is detected."""

_SUPPORT, _FIXED = "support_stiffness", "fixed"
"""Prefix of the columns in which infinity means the bolted clamp, and the word for it."""


class CsvForm(NamedTuple):
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


def read_csv(content: bytes) -> tuple[CsvForm, Iterator[list[str]]]:
    r"""Return the dialect of a CSV table and its rows of text, header first.

    Raises
    ------
    ValueError
        The content is not text.
    csv.Error
        While iterating: quotes are unbalanced, so that cells would be mixed up.

    Examples
    --------
    >>> form, rows = read_csv(b"# by J.D.\nfile;level_db;note\nrun07.wav;59,9;'=1\n")
    >>> form.separator, form.decimal, list(rows)
    (';', ',', [['file', 'level_db', 'note'], ['run07.wav', '59,9', '=1']])
    """
    text, encoding = _decoded(content)
    if "\0" in text:
        raise ValueError("is no text")
    lines, separators, at = text.splitlines(keepends=True), _SEPARATORS, 0
    for line in lines:
        if named := _SEPARATOR_LINE.match(line):
            separators = named[1] + _SEPARATORS
        elif (bare := line.strip(" \t\r\n\"',;|")) and not bare.startswith("#"):
            break
        at += len(line)
    head = text[at:].partition("\n")[0]
    separator = max(separators, key=lambda one: len(next(csv.reader([head], delimiter=one), ())))
    sample = islice(csv.reader(_file(text, at), delimiter=separator), 1, _DECIMAL_ROWS)
    signs = [sign for row in sample for cell in row if (sign := decimal_sign(cell))]
    commas = 2 * signs.count(",") - len(signs)
    decimal = "," if commas > 0 or (not commas and separator == ";") else "."
    # Other separators are read only below a line ``sep=``, which is not written.
    writable = separator if separator in _SEPARATORS else ","
    form = CsvForm(encoding, writable, decimal, "\r\n" if "\r\n" in text else "\n")
    rows = csv.reader(_file(text, at), delimiter=separator, strict=True)
    return form, ([_without_apostrophe(cell) for cell in row] for row in rows)


def _decoded(content: bytes) -> tuple[str, str]:
    """Return the text and the encoding for writing; a code page is replaced by UTF-8."""
    if content[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        return content.decode("utf-16"), "utf-16"
    marked = content.startswith(codecs.BOM_UTF8)
    try:
        return content.decode("utf-8-sig"), "utf-8-sig" if marked else "utf-8"
    except UnicodeDecodeError:
        return content.decode("cp1252", "replace"), "utf-8-sig"


def _file(text: str, at: int) -> io.StringIO:
    """Return the text from a position on as a file for the csv module."""
    return io.StringIO(text[at:], newline="")


def _without_apostrophe(cell: str) -> str:
    """Return a cell without the apostrophe that protects it from being a formula."""
    return cell[1:] if cell[:1] == "'" and _FORMULA.match(cell) else cell


def write_csv(
    file: TextIO,
    columns: Sequence[str],
    rows: Iterable[Sequence[Cell]],
    form: CsvForm = CsvForm(),  # noqa: B008  # immutable
) -> None:
    """Write a table in a given dialect.

    Examples
    --------
    >>> import sys
    >>> write_csv(sys.stdout, ["file", "level_db"], [["run07.wav", 59.9]])
    file,level_db
    run07.wav,59.9
    """
    writer = csv.writer(file, delimiter=form.separator, lineterminator=form.line_end)
    writer.writerow(columns)
    for row in rows:
        writer.writerow([_csv_cell(*cell, form.decimal) for cell in zip(columns, row, strict=True)])


def decimal_sign(cell: str) -> str | None:
    """Return the decimal sign of a cell; None for integers and text.

    Examples
    --------
    >>> [decimal_sign(cell) for cell in ("59,9", "1.5E-07", "3", "run07.wav")]
    [',', '.', None, None]
    """
    number = _NUMBER.fullmatch(cell)
    return number and number[1]


def finite_or_fixed(column: str, value: Cell) -> Cell:
    """Return the cell value for people: infinity becomes ``fixed`` for a support, else None.

    Examples
    --------
    >>> finite_or_fixed("support_stiffness_Nm_rad", math.inf)
    'fixed'
    """
    if isinstance(value, float) and math.isinf(value):
        return _FIXED if value > 0.0 and column.startswith(_SUPPORT) else None
    return value


def _csv_cell(column: str, value: Cell, decimal: str) -> Cell:
    """Return a value as it is written into a CSV cell."""
    value = finite_or_fixed(column, value)
    if isinstance(value, str):
        return f"'{value}" if _FORMULA.match(value) and not _NUMBER.fullmatch(value) else value
    if isinstance(value, bool):
        return json.dumps(value)
    return str(value).replace(".", decimal) if isinstance(value, float) else value
