"""The temperature's table of a rig or material file, read, checked and written.

Two keys are enough; the others have values that `models.bushing` gives reasons for.
"""

from __future__ import annotations

import math
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from models.bushing import TemperatureDependence
from models.checks import a_number, a_table, refuse_unknown
from models.errors import ParameterError
from models.units import ABSOLUTE_ZERO

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["read_temperature", "temperature_text"]

_KEYS = {
    "reference": "reference_C",
    "glass_transition": "glass_transition_C",
    "c1": "wlf_c1",
    "c2": "wlf_c2_K",
    "stiffening": "stiffening",
    "exponent": "stiffening_exponent",
    "friction_peak": "friction_peak_rad_s",
    "friction_width": "friction_width",
    "friction_floor": "friction_floor",
}

_RANGES = {
    "reference": (ABSOLUTE_ZERO, 2000.0),
    "glass_transition": (ABSOLUTE_ZERO, 2000.0),
    "c1": (0.0, 100.0),
    "c2": (50.0, 1e3),  # what it must exceed for the shift to be finite at the glass temperature
    "stiffening": (0.0, 10.0),
    "exponent": (0.0, 1.0),
    "friction_peak": (0.0, 1e12),
    "friction_width": (0.0, 20.0),
    "friction_floor": (0.0, 1.0),
}
"""Ends count, unless the lower one is that of what must be positive."""

_POSITIVE = {"c1", "c2", "friction_peak", "friction_width"}


def read_temperature(table: Any, where: str) -> TemperatureDependence:
    """Read how a material depends on temperature.

    Parameters
    ----------
    table : mapping
        Of TOML.
    where : str
        What messages begin with.

    Raises
    ------
    ParameterError
        A key is unknown or missing, or a value cannot be used.

    Examples
    --------
    >>> read_temperature({"reference_C": 23, "glass_transition_C": -20}, "rig").range
    (-20.0, 80.0)
    """
    given: Mapping[str, Any] = a_table(table, "temperature", where)
    where = f"{where}, temperature"
    refuse_unknown(given, set(_KEYS.values()), where)
    found = {}
    for field in fields(TemperatureDependence):
        key, (low, high) = _KEYS[field.name], _RANGES[field.name]
        needed = field.name in ("reference", "glass_transition")
        if key in given or needed:
            closed = field.name not in _POSITIVE
            found[field.name] = a_number(given, key, where, low=low, high=high, closed=closed)
    read = TemperatureDependence(**found)
    if not read.reference > read.glass_transition:
        raise ParameterError(
            f"{where}: reference_C = {read.reference:g} is not above glass_transition_C = "
            f"{read.glass_transition:g}; what is no elastomer there has no friction to be shifted"
        )
    return read


def temperature_text(depends: TemperatureDependence) -> list[str]:
    """Write the table, a line a key that is not the default.

    Examples
    --------
    >>> temperature_text(TemperatureDependence(23.0, -20.0))
    ['[temperature]', 'reference_C = 23', 'glass_transition_C = -20']
    """
    lines = ["[temperature]"]
    for field in fields(depends):
        value = getattr(depends, field.name)
        if value is not None and value != field.default and math.isfinite(value):
            lines.append(f"{_KEYS[field.name]} = {value:.6g}")
    return lines
