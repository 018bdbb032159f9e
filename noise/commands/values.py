"""Values of options: parsers of a text, which refuse what cannot be used and say what could."""

from __future__ import annotations

import math
from argparse import ArgumentTypeError
from collections.abc import Callable
from pathlib import Path


def number_or_none(text: str) -> float | None:
    """Read a number, which may be infinite [-]; None where the text is none.

    Examples
    --------
    >>> number_or_none("0.279"), number_or_none("fast")
    (0.279, None)
    """
    try:
        return float(text)
    except ValueError:
        return None


def number(
    above: float = -math.inf, *, least: float = -math.inf, most: float = math.inf
) -> Callable[[str], float]:
    """Return a parser of finite numbers larger than `above`, from `least` up to `most`.

    Parameters
    ----------
    above, least, most : float
        In the unit of the option, such as [mm].

    Returns
    -------
    callable
        Of the text of an option; raises ArgumentTypeError where it is no such number.

    Examples
    --------
    >>> number(above=0.0)("0.279")
    0.279
    """

    def parse(text: str) -> float:
        value = number_or_none(text)
        if value is None or not math.isfinite(value):
            raise ArgumentTypeError(f"is {text!r}, expected a number")
        if not (value > above and least <= value <= most):
            limits = [f"above {above:g}"] * math.isfinite(above)
            limits += [f"at least {least:g}"] * math.isfinite(least)
            limits += [f"at most {most:g}"] * math.isfinite(most)
            raise ArgumentTypeError(f"is {text!r}, expected a number {' and '.join(limits)}")
        return value

    return parse


_LONGEST_NUMBER = 18  # digits

MOST_WORKERS = 1024
"""Processes or threads that a command starts at most: beyond it systems refuse to start more."""


def whole_number(least: int, *, most: int | None = None, more: str = "") -> Callable[[str], int]:
    """Return a parser of whole numbers from `least` on; `more` ends what it says it expected.

    Examples
    --------
    >>> whole_number(1)("2")
    2
    """

    def parse(text: str) -> int:
        plain = text.strip()
        decimal = plain.isdecimal() and len(plain) <= _LONGEST_NUMBER
        if not decimal or int(plain) < least or (most is not None and int(plain) > most):
            span = f"of {least} or more" if most is None else f"from {least} to {most}"
            raise ArgumentTypeError(f"is {text!r}, expected a whole number {span}{more}")
        return int(plain)

    return parse


def one_of(*values: str | int) -> Callable[[str], str | int]:
    """Return a parser of one of several values, of words in either case.

    Examples
    --------
    >>> one_of("H1", "H2", "Hv")("hv")
    'Hv'
    """
    known = {str(value).lower(): value for value in values}

    def parse(text: str) -> str | int:
        value = known.get(text.strip().lower())
        if value is None:
            *others, last = map(str, values)
            raise ArgumentTypeError(f"is {text!r}, expected {', '.join(others)} or {last}")
        return value

    return parse


def band(text: str) -> tuple[float, float]:
    """Read a band of frequencies [Hz].

    Examples
    --------
    >>> band("200..2000")
    (200.0, 2000.0)
    """
    low, dots, high = text.partition("..")
    first, last = number_or_none(low), number_or_none(high)
    if not dots or first is None or last is None or not 0.0 <= first < last < math.inf:
        raise ArgumentTypeError(f"is {text!r}, expected LOW..HIGH in Hz, such as 100..5000")
    return first, last


def path(text: str) -> Path:
    """Read a path, which is not empty."""
    if not text:
        raise ArgumentTypeError("is '', expected a path ('.' is the current folder)")
    return Path(text)


def change(text: str) -> tuple[str, str | float]:
    """Read a change of the rig: a name, and a number in the unit of its key or a text."""
    name, equals, amount = (part.strip() for part in text.partition("="))
    if not (name and equals and amount):
        raise ArgumentTypeError(f"is {text!r}, expected NAME=AMOUNT, such as damping=x2")
    number = number_or_none(amount)
    return name, amount if number is None else number
