"""Checked access to what a TOML file holds; every refusal names the file, the key and the value."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from models.errors import ParameterError

__all__ = ["a_number", "a_support", "a_table", "a_text", "a_vector", "refuse_unknown"]


def refuse_unknown(table: Mapping[str, Any], known: set[str], where: str) -> None:
    """Refuse keys that are not known, which are most often misspelt."""
    for key in table:
        if key not in known:
            raise ParameterError(
                f"{where}: unknown key {key!r}; known are {', '.join(sorted(known))}"
            )


def a_table(value: Any, key: str, where: str) -> Mapping[str, Any]:
    """Return `value` if it is a table."""
    if not isinstance(value, Mapping):
        raise ParameterError(f"{where}: {key} must be a table")
    return value


def a_text(value: Any, key: str, where: str) -> str:
    """Return `value` if it is a text."""
    if not isinstance(value, str):
        raise ParameterError(f"{where}: {key} = {value!r} must be a text in quotes")
    return value


def a_number(
    table: Mapping[str, Any],
    key: str,
    where: str,
    *,
    low: float = 0.0,
    high: float = math.inf,
    closed: bool = False,
) -> float:
    """Return a finite number above `low`, up to `high`; `closed` admits `low` itself."""
    value = table.get(key)
    if value is None:
        raise ParameterError(f"{where}: {key} is missing")
    number = math.nan
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        with suppress(OverflowError):
            number = float(value)
    inside = low <= number <= high if closed else low < number <= high
    if not (math.isfinite(number) and inside):
        least = "at least" if closed else "above"
        most = "" if math.isinf(high) else f" and at most {high:g}"
        wanted = "a number" if math.isinf(low) else f"a number {least} {low:g}{most}"
        raise ParameterError(f"{where}: {key} = {value!r} must be {wanted}")
    return number


def a_support(text: str, key: str, where: str) -> float:
    """Return the support stiffness [Nm/rad] that a text says; ``fixed`` is infinite."""
    if text == "fixed":
        return math.inf
    number = math.nan
    with suppress(ValueError):
        number = float(text)
    if not 0.0 < number < math.inf:
        raise ParameterError(
            f"{where}: {key} has the entry {text!r}; entries are support stiffnesses in Nm/rad, "
            "or fixed"
        )
    return number


def a_vector(table: Mapping[str, Any], key: str, size: int, where: str) -> tuple[float, ...]:
    """Return the list of `size` finite numbers at `key`."""
    value = table.get(key)
    if not isinstance(value, list) or len(value) != size:
        raise ParameterError(f"{where}: {key} = {value!r} must be a list of {size} numbers")
    return tuple(a_number({key: v}, key, where, low=-math.inf) for v in value)
