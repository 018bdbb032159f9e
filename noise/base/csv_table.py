"""CSV tables in the form that programs and spreadsheets give them, and written back in that form.

Excel in a language with decimal commas writes semicolons between cells and a mark of UTF-8 first,
its "Unicode text" is UTF-16 with tabs, older versions write the code page of the computer; people
add comments and ``sep=;`` above the names of the columns. All of this is read, and a table that is
written over another keeps what that had: encoding, first lines, separator, decimal sign and ends of
lines. A text that a spreadsheet would take for a formula has an apostrophe before it.
"""

from __future__ import annotations

import codecs
import csv
import io
import json
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from itertools import islice
from typing import NamedTuple, TextIO

Cell = bool | int | float | str | None
"""A value as every format of a table can hold it."""

_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_CODE_PAGES = ("cp1252", "cp1250", "mac_roman", "cp850")
"""Of Windows in western and central Europe, the Macintosh and DOS, the likeliest first."""

_SEPARATORS = ",;\t|"
_LINE = re.compile(r"[^\r\n]*(\r\n|\r|\n|$)")
_SEPARATOR_LINE = re.compile(r'\ufeff?"?sep=(.)', re.IGNORECASE)
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
    head : str
        What stands before the names of the columns: a byte-order mark, ``sep=;``, comments.
    separator, decimal, line_end : str
        Between two cells, between whole and parts of a number, and after each row.
    """

    encoding: str = "utf-8"
    head: str = ""
    separator: str = ","
    decimal: str = "."
    line_end: str = "\n"


PLAIN = CsvForm()
"""As programs write it."""


def decoded(content: bytes, names: Iterable[str] = ()) -> tuple[str, str]:
    r"""Return the text of a CSV table and its encoding.

    Parameters
    ----------
    content : bytes
    names : iterable of str
        That are likely in it, such as of recordings: they tell one code page from another.

    Raises
    ------
    ValueError
        It is in no encoding that is known.

    Examples
    --------
    >>> decoded("prüfstand.wav".encode("cp1252"))
    ('prüfstand.wav', 'cp1252')
    >>> decoded("łożysko.wav".encode("cp1250"), names=["łożysko.wav"])
    ('łożysko.wav', 'cp1250')
    """
    for mark, encoding in _MARKS:
        if content.startswith(mark):
            return content.decode(encoding), encoding
    if b"\0" in content[:4]:  # UTF-16 without a mark
        encoding = "utf-16-be" if content[:1] == b"\0" else "utf-16-le"
        return content.decode(encoding), encoding
    with suppress(UnicodeDecodeError):
        return content.decode("utf-8"), "utf-8"
    special = [name for name in names if not name.isascii()]
    texts: dict[str, str] = {}
    for page in _CODE_PAGES:
        with suppress(UnicodeDecodeError):
            texts[page] = content.decode(page)
    if "\0" in next(iter(texts.values())):
        raise ValueError("is no text")
    page = max(texts, key=lambda page: sum(name in texts[page] for name in special))
    return texts[page], page


def csv_form(text: str, encoding: str = "utf-8") -> CsvForm:
    r"""Return the form of a CSV table.

    Examples
    --------
    >>> csv_form("# by J.D.\nfile;level_db\nrun07.wav;59,9\n")
    CsvForm(encoding='utf-8', head='# by J.D.\n', separator=';', decimal=',', line_end='\n')
    """
    start, separators = int(text.startswith("\ufeff")), _SEPARATORS
    while line := _LINE.match(text, start):
        if named := _SEPARATOR_LINE.match(line[0]):
            separators = named[1] + _SEPARATORS
        elif (bare := line[0].strip(" \t\r\n\"',;|")) and not bare.startswith("#"):
            break
        if not line[0]:
            break
        start = line.end()
    head = "" if line is None else line[0]
    separator = max(separators, key=lambda one: len(next(csv.reader([head], delimiter=one), ())))
    form = CsvForm(encoding, text[:start], separator, line_end=(line and line[1]) or "\n")
    rows = islice(_lines(text, form, strict=False), 1, _ROWS_LOOKED_AT)
    signs = [sign for row in rows for cell in row if (sign := decimal_sign(cell))]
    commas = 2 * signs.count(",") - len(signs)
    return form._replace(decimal="," if commas > 0 or (not commas and separator == ";") else ".")


def csv_lines(text: str, form: CsvForm) -> Iterator[list[str]]:
    r"""Yield names of columns and rows as texts, without the apostrophes of `write_csv`.

    Raises
    ------
    csv.Error
        Quotes do not fit together, so that cells would be taken for others.

    Examples
    --------
    >>> text = "file;note\nrun07.wav;'=1\n"
    >>> list(csv_lines(text, csv_form(text)))
    [['file', 'note'], ['run07.wav', '=1']]
    """
    for line in _lines(text, form, strict=True):
        yield [cell[1:] if cell[:1] == "'" and _FORMULA.match(cell) else cell for cell in line]


def _lines(text: str, form: CsvForm, *, strict: bool) -> Iterator[list[str]]:
    lines = io.StringIO(text[len(form.head) :], newline="")
    return csv.reader(lines, delimiter=form.separator, strict=strict)


def write_csv(
    file: TextIO,
    columns: Sequence[str],
    rows: Iterable[Sequence[Cell]],
    form: CsvForm = PLAIN,
) -> None:
    """Write a table, by default as programs do.

    Examples
    --------
    >>> import sys
    >>> write_csv(sys.stdout, ["file", "level_db"], [["run07.wav", 59.9]])
    file,level_db
    run07.wav,59.9
    """
    file.write(form.head)
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
