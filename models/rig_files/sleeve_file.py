"""The ``[sleeve]`` table of a rig file: the rubber sleeve that the fits were measured on."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from models.bushing import Sleeve, shore_modulus
from models.checks import a_number, a_table, refuse_unknown
from models.errors import ParameterError

__all__ = ["modulus_of", "read_sleeve"]

_LENGTHS = {"inner_radius": "inner_radius_mm", "wall": "wall_mm", "length": "length_mm"}
_MODULUS, _HARDNESS = "youngs_modulus_MPa", "hardness_shore_A"


def read_sleeve(table: Any, base: Sleeve | None, where: str) -> Sleeve:
    """Read a sleeve, laid over the one of a base.

    Parameters
    ----------
    table : mapping
        As the TOML file holds it.
    base : Sleeve or None
        What the table does not say is of this; without one it says all but poisson_ratio.
    where : str
        What messages call the table.

    Raises
    ------
    ParameterError
        It holds what cannot be used; the message names the key.

    Examples
    --------
    >>> table = {"inner_radius_mm": 15, "wall_mm": 4.5, "length_mm": 40.8, "hardness_shore_A": 75}
    >>> round(read_sleeve(table, None, "rig, sleeve").youngs_modulus / 1e6, 2)
    7.05
    """
    table = a_table(table, "sleeve", where)
    refuse_unknown(table, {*_LENGTHS.values(), _MODULUS, _HARDNESS, "poisson_ratio"}, where)
    if _MODULUS in table and _HARDNESS in table:
        raise ParameterError(f"{where}: give one of {_MODULUS} and {_HARDNESS}, not both")
    given = {
        field: 1e-3 * a_number(table, key, where)
        for field, key in _LENGTHS.items()
        if base is None or key in table
    }
    if _HARDNESS in table:
        given["youngs_modulus"] = modulus_of(table[_HARDNESS], where)
    elif base is None or _MODULUS in table:
        given["youngs_modulus"] = 1e6 * a_number(table, _MODULUS, where)
    if "poisson_ratio" in table:
        given["poisson_ratio"] = a_number(table, "poisson_ratio", where, high=0.5, closed=True)
    return Sleeve(**given) if base is None else replace(base, **given)


def modulus_of(hardness: Any, where: str) -> float:
    """Young's modulus by a file's hardness in Shore A [Pa].

    Raises
    ------
    ParameterError
        No number, or one outside of what the relation holds for.

    Examples
    --------
    >>> round(modulus_of(60, "rig, change") / 1e6, 2)
    3.61
    """
    value = a_number({_HARDNESS: hardness}, _HARDNESS, where)
    try:
        return shore_modulus(value)
    except ParameterError as error:
        raise ParameterError(f"{where}: {error}") from None
