"""CSV as Excel opens it at a double click: with a byte-order mark, and the signs of a language.

Where the decimal sign is a comma, Excel expects semicolons between cells: a file with the other
signs lands in one column, or 9.11 becomes a date. Excel also takes a text that begins with an
equals sign for a formula; here an apostrophe stands before it, which is taken off when a table is
read.
"""

from __future__ import annotations

import locale
import re
from typing import NamedTuple

__all__ = [
    "EXCEL_LANGUAGES",
    "PLAIN",
    "CsvSigns",
    "decimal_sign",
    "excel_signs",
    "plain_text",
    "separator_of",
    "with_apostrophe",
    "without_apostrophe",
]

_COMMAS = ("cs", "da", "de", "es", "fi", "fr", "hu", "it", "nb", "nl", "pl", "pt", "ru", "sv", "tr")
_POINTS = ("en", "he", "hi", "ja", "ko", "th", "zh")

EXCEL_LANGUAGES = (*_COMMAS, *_POINTS, "de-ch", "system")
"""Whose signs are known, by their two letters; ``system`` is that of this computer."""

_FORMULA = re.compile(r"'*[=+\-@\t\r]")
"""How a text begins that a spreadsheet computes, or that was kept from being one."""

_NUMBER = re.compile(r"-?\d+(?:([.,])\d+)?(?:[eE][+-]?\d+)?")
"""As it is written here, or by Excel."""


class CsvSigns(NamedTuple):
    """How CSV is written: what stands between cells, in numbers, and at both ends.

    Parameters
    ----------
    separator, decimal : str
        What stands between two cells, and between whole and parts of a number.
    marked : bool
        Whether a byte-order mark is at the beginning.
    line_end : str
    """

    separator: str
    decimal: str
    marked: bool
    line_end: str

    @property
    def of_excel(self) -> bool:
        """Whether numbers may have commas in them.

        Examples
        --------
        >>> PLAIN.of_excel
        False
        """
        return self.marked or self.separator == ";"

    def cell(self, value: object) -> object:
        """Return a number, or a text that is one, as it is written; all else as it is.

        Parameters
        ----------
        value : object
            [unit of its column]

        Returns
        -------
        object

        Examples
        --------
        >>> [excel_signs("de").cell(value) for value in (59.9, "59.9", "run07.wav", 3)]
        ['59,9', '59,9', 'run07.wav', 3]
        """
        if self.decimal == "." or not isinstance(value, float | str):
            return value
        text = str(value)
        return text.replace(".", self.decimal) if decimal_sign(text) == "." else text


PLAIN = CsvSigns(",", ".", marked=False, line_end="\n")
"""As programs write it."""


def excel_signs(language: str) -> CsvSigns:
    """Return the signs of a language, one of `EXCEL_LANGUAGES`.

    Examples
    --------
    >>> excel_signs("de").decimal, excel_signs("en").decimal
    (',', '.')
    """
    decimal = _of_this_computer() if language == "system" else "," if language in _COMMAS else "."
    separator = ";" if decimal == "," or language == "de-ch" else ","
    return CsvSigns(separator, decimal, marked=True, line_end="\r\n")


def decimal_sign(cell: str) -> str | None:
    """Return what stands between whole and parts of a number; None where a cell is none, or whole.

    Examples
    --------
    >>> [decimal_sign(cell) for cell in ("59,9", "1.5E-07", "3", "run07.wav")]
    [',', '.', None, None]
    """
    number = _NUMBER.fullmatch(cell)
    return number and number[1]


def separator_of(header: str) -> str:
    """Return what stands between two names of columns, none of which has a semicolon in it.

    Examples
    --------
    >>> separator_of("file;label;level_db")
    ';'
    """
    return ";" if ";" in header and "," not in header else ","


def with_apostrophe(text: str) -> str:
    """Return a text that a spreadsheet takes for no formula; a number is none.

    Examples
    --------
    >>> with_apostrophe("=cmd.wav"), with_apostrophe("run07.wav")
    ("'=cmd.wav", 'run07.wav')
    """
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def without_apostrophe(cell: str) -> str:
    """Return a text as it was before `with_apostrophe`.

    Examples
    --------
    >>> without_apostrophe("'=cmd.wav"), without_apostrophe("'s-Hertogenbosch, 1.wav")
    ('=cmd.wav', "'s-Hertogenbosch, 1.wav")
    """
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell) else cell


def plain_text(cell: str) -> str:
    """Return what stands in a cell of Excel's CSV as any other table has it.

    Examples
    --------
    >>> plain_text("59,9"), plain_text("'=cmd.wav")
    ('59.9', '=cmd.wav')
    """
    return cell.replace(",", ".") if decimal_sign(cell) == "," else without_apostrophe(cell)


def _of_this_computer() -> str:
    """Return the decimal sign that is set here."""
    before = locale.setlocale(locale.LC_NUMERIC)
    try:
        locale.setlocale(locale.LC_NUMERIC, "")
        return str(locale.localeconv()["decimal_point"])
    except locale.Error:  # a language that is not installed
        return "."
    finally:
        locale.setlocale(locale.LC_NUMERIC, before)
