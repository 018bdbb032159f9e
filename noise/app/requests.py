"""Parsing of request parameters: numbers, choices and texts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from models.errors import ParameterError
from models.schema import Quantity

_SHOWN = 40
"""Maximum length of a value in an error message."""


def number(
    request: Mapping[str, Any],
    key: str,
    low: float,
    high: float,
    missing: float | None = None,
    *,
    whole: bool = False,
) -> float:
    """Return a number of a request.

    Parameters
    ----------
    request : mapping
        JSON object or query parameters.
    key : str
    low, high : float
        Bounds [unit of the key].
    missing : float, optional
        Default [unit of the key]; without it the key is required.
    whole : bool
        Whether the number must be an integer.

    Raises
    ------
    ParameterError
        The value is not a number or out of bounds.

    Examples
    --------
    >>> number({"low": "50"}, "low", 1.0, 100.0), number({}, "low", 1.0, 100.0, 20.0)
    (50.0, 20.0)
    >>> number({"place": 3}, "place", 0, 9, whole=True)
    3
    """
    value = request.get(key)
    if value in (None, "") and missing is not None:
        return missing
    parsed: float = math.nan
    if isinstance(value, int | float) and not isinstance(value, bool):
        parsed = value
    elif isinstance(value, str):
        try:
            parsed = int(value) if whole else float(value)
        except ValueError:
            parsed = math.nan
    bounds = Quantity(key, low=low, high=high, closed=True)
    if not bounds.possible(parsed) or (whole and not isinstance(parsed, int)):
        wanted = bounds.wanted.replace("a number", "a whole number" if whole else "a number")
        raise ParameterError(f"{key} {str(value)[:_SHOWN]!r}: must be {wanted}")
    return parsed


def choice(request: Mapping[str, Any], key: str, known: Iterable[str], missing: str = "") -> str:
    """Return a choice of a request.

    Raises
    ------
    ParameterError
        The value is not one of the choices.

    Examples
    --------
    >>> choice({"order": "desc"}, "order", ("asc", "desc"))
    'desc'
    """
    value, words = request.get(key, missing), tuple(known)
    if not isinstance(value, str) or (value not in words and value != missing):
        named = ", ".join(filter(None, words))
        raise ParameterError(f"{key} {str(value)[:_SHOWN]!r}: must be one of {named}")
    return value


def text(request: Mapping[str, Any], key: str, longest: int) -> str:
    """Return a text of a request with single spaces; empty if missing.

    Raises
    ------
    ParameterError
        The value is not a text or too long.

    Examples
    --------
    >>> text({"question": " Which  annoys more? "}, "question", 80)
    'Which annoys more?'
    """
    value = request.get(key, "")
    if not isinstance(value, str) or len(value) > longest:
        raise ParameterError(f"{key}: must be a text of at most {longest} characters")
    return " ".join(value.split())
