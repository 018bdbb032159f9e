"""CSV tables in the form that programs and spreadsheets give them, and written back in that form.

Excel in a language with decimal commas writes semicolons between cells and a mark of UTF-8 first,
its "Unicode text" is UTF-16 with tabs, older versions write a code page; people add comments and
``sep=;`` above the names of the columns. All of this is read. A table that is written over another
keeps its separator, decimal sign and ends of lines. A text that a spreadsheet would take for a
formula has an apostrophe before it.
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
"""A value as every format of a table can hold it."""

_SEPARATORS = ",;\t|"
_SEPARATOR_LINE = re.compile(r'"?sep=(.)', re.IGNORECASE)
_FORMULA = re.compile(r"'*[=+\-@\t\r]")
"""How a text begins that a spreadsheet computes, or that was kept from being one."""

_NUMBER = re.compile(r"-?\d+(?:([.,])\d+)?(?:[eE][+-]?\d+)?")
_ROWS_LOOKED_AT = 1000
"""Rows by which the decimal sign of a table is found."""

_SUPPORT, _FIXED = "support_stiffness", "fixed"
"""How the columns begin whose infinity is the bolted clamp, and what it is called."""


class CsvForm(NamedTuple):
    """The form of a CSV table; by default as programs write it.

    Parameters
    ----------
    encoding : str
        In which it is written.
    separator, decimal, line_end : str
        Between two cells, between whole and parts of a number, and after each row.
    """

    encoding: str = "utf-8"
    separator: str = ","
    decimal: str = "."
    line_end: str = "\n"


def read_csv(content: bytes) -> tuple[CsvForm, Iterator[list[str]]]:
    r"""Return the form of a CSV table, and names of columns and rows as texts.

    Raises
    ------
    ValueError
        It is no text.
    csv.Error
        While rows are read: quotes do not fit together, so that cells would be taken for others.

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
    looked_at = islice(csv.reader(_file(text, at), delimiter=separator), 1, _ROWS_LOOKED_AT)
    signs = [sign for row in looked_at for cell in row if (sign := decimal_sign(cell))]
    commas = 2 * signs.count(",") - len(signs)
    decimal = "," if commas > 0 or (not commas and separator == ";") else "."
    kept = separator if separator in _SEPARATORS else ","  # any other needs its line ``sep=``
    form = CsvForm(encoding, kept, decimal, "\r\n" if "\r\n" in text else "\n")
    rows = csv.reader(_file(text, at), delimiter=separator, strict=True)
    return form, ([_without_apostrophe(cell) for cell in row] for row in rows)


def _decoded(content: bytes) -> tuple[str, str]:
    """Text, and the encoding in which it is written back: a code page may lack a letter."""
    if content[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        return content.decode("utf-16"), "utf-16"
    marked = content.startswith(codecs.BOM_UTF8)
    try:
        return content.decode("utf-8-sig"), "utf-8-sig" if marked else "utf-8"
    except UnicodeDecodeError:
        return content.decode("cp1252", "replace"), "utf-8-sig"


def _file(text: str, at: int) -> io.StringIO:
    return io.StringIO(text[at:], newline="")


def _without_apostrophe(cell: str) -> str:
    return cell[1:] if cell[:1] == "'" and _FORMULA.match(cell) else cell


def write_csv(
    file: TextIO,
    columns: Sequence[str],
    rows: Iterable[Sequence[Cell]],
    form: CsvForm = CsvForm(),  # noqa: B008  # it cannot be changed
) -> None:
    """Write a table, by default as programs do.

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
        writer.writerow([_written(*cell, form.decimal) for cell in zip(columns, row, strict=True)])


def decimal_sign(cell: str) -> str | None:
    """Return what stands between whole and parts of a number; None where a cell is none, or whole.

    Examples
    --------
    >>> [decimal_sign(cell) for cell in ("59,9", "1.5E-07", "3", "run07.wav")]
    [',', '.', None, None]
    """
    number = _NUMBER.fullmatch(cell)
    return number and number[1]


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


def _written(column: str, value: Cell, decimal: str) -> Cell:
    value = finite_or_fixed(column, value)
    if isinstance(value, str):
        return f"'{value}" if _FORMULA.match(value) and not _NUMBER.fullmatch(value) else value
    if isinstance(value, bool):
        return json.dumps(value)
    return str(value).replace(".", decimal) if isinstance(value, float) else value
