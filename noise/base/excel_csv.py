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
    "ExcelSigns",
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

_NUMBER = re.compile(r"-?\d+(,\d+)?(e[+-]?\d+)?")


class ExcelSigns(NamedTuple):
    """What stands between two cells, and between whole and parts of a number."""

    separator: str
    decimal: str

    def text(self, value: float) -> str:
        """Return a number as it is written.

        Parameters
        ----------
        value : float
            [unit of its column]

        Returns
        -------
        str

        Examples
        --------
        >>> ExcelSigns(";", ",").text(59.9)
        '59,9'
        """
        return repr(value).replace(".", self.decimal)


def excel_signs(language: str) -> ExcelSigns:
    """Return the signs of a language, one of `EXCEL_LANGUAGES`.

    Examples
    --------
    >>> excel_signs("de"), excel_signs("en").decimal
    (ExcelSigns(separator=';', decimal=','), '.')
    """
    if language == "de-ch":
        return ExcelSigns(";", ".")
    decimal = _of_this_computer() if language == "system" else "," if language in _COMMAS else "."
    return ExcelSigns(";", ",") if decimal == "," else ExcelSigns(",", ".")


def separator_of(header: str) -> str:
    """Return what stands between two names of columns, none of which has a semicolon in it.

    Examples
    --------
    >>> separator_of("file;label;level_db")
    ';'
    """
    return ";" if ";" in header and "," not in header else ","


def with_apostrophe(text: str) -> str:
    """Return a text that a spreadsheet takes for nothing else.

    Examples
    --------
    >>> with_apostrophe("=cmd.wav"), with_apostrophe("run07.wav")
    ("'=cmd.wav", 'run07.wav')
    """
    return f"'{text}" if _FORMULA.match(text) else text


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
    return cell.replace(",", ".") if _NUMBER.fullmatch(cell) else without_apostrophe(cell)


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
