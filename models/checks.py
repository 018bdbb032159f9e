"""Checked access to the content of a TOML file; a refusal names file, key and value."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from contextlib import suppress
from difflib import get_close_matches
from typing import Any

from models.errors import ParameterError

__all__ = [
    "a_number", "a_support", "a_table", "a_text", "a_vector", "meant", "refuse_unknown",
]  # fmt: skip


def meant(name: str, known: Iterable[str]) -> str:
    """Return the question whether the nearest known name was meant, empty where none is near.

    Examples
    --------
    >>> meant("desing", ["design", "fit"]), meant("x", ["design"])
    ("; did you mean 'design'?", '')
    """
    near = get_close_matches(name, list(known), n=1)
    return f"; did you mean {near[0]!r}?" if near else ""


def refuse_unknown(table: Mapping[str, Any], known: set[str], where: str) -> None:
    """Refuse keys that are not known, which are most often misspelt.

    Raises
    ------
    ParameterError
        A key is not among `known`.

    Examples
    --------
    >>> refuse_unknown({"speed": 1.0}, {"speed"}, "rig.toml")
    """
    for key in table:
        if key not in known:
            raise ParameterError(
                f"{where}: unknown key {key!r}{meant(key, known)}; known are "
                f"{', '.join(sorted(known))}"
            )


def a_table(value: Any, key: str, where: str) -> Mapping[str, Any]:
    """Return `value` if it is a table.

    Raises
    ------
    ParameterError
        It is not; the message names file and key.

    Examples
    --------
    >>> a_table({"speed": 1.0}, "shaft", "rig.toml")
    {'speed': 1.0}
    """
    if not isinstance(value, Mapping):
        raise ParameterError(f"{where}: {key} must be a table")
    return value


def a_text(value: Any, key: str, where: str) -> str:
    """Return `value` if it is a text.

    Raises
    ------
    ParameterError
        It is not; the message names file and key.

    Examples
    --------
    >>> a_text("PDMS", "material", "rig.toml")
    'PDMS'
    """
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
    """Return a finite number above `low`, up to `high`; `closed` admits `low` itself.

    All are in the unit that the file's key has [unit of the key].

    Raises
    ------
    ParameterError
        It is missing, no number, or out of range.

    Examples
    --------
    >>> a_number({"speed": 5}, "speed", "rig.toml", high=10.0)
    5.0
    """
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
    """Return the support stiffness [Nm/rad] that a text says; ``fixed`` is infinite.

    Raises
    ------
    ParameterError
        It is neither a positive number nor ``fixed``.

    Examples
    --------
    >>> a_support("2214", "damping", "rig.toml"), a_support("fixed", "damping", "rig.toml")
    (2214.0, inf)
    """
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
    """Return the list of `size` finite numbers at `key`.

    Raises
    ------
    ParameterError
        It is no such list.

    Examples
    --------
    >>> a_vector({"position_m": [0, 0, 1]}, "position_m", 3, "rig.toml")
    (0.0, 0.0, 1.0)
    """
    value = table.get(key)
    if not isinstance(value, list) or len(value) != size:
        raise ParameterError(f"{where}: {key} = {value!r} must be a list of {size} numbers")
    return tuple(a_number({key: v}, key, where, low=-math.inf) for v in value)
