"""How far a built bushing may lie from its drawing: the ``[tolerances]`` of a design file.

Each entry becomes a factor on the nominal value, which is what a population is drawn in: a number
is a relative standard deviation, ``absolute`` a standard deviation in the unit of the design file,
``low`` and ``high`` are limits in it between which all values are equally likely. A temperature's
factor is one of absolute temperature.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from models.checks import a_number, a_table, refuse_unknown
from models.errors import ParameterError

__all__ = ["ABSOLUTE_ZERO", "PARAMETERS", "Tolerance", "read_tolerances"]

ABSOLUTE_ZERO = -273.15
"""[degree Celsius]"""

PARAMETERS = {
    "elastomer_stiffness": "Nm/rad",
    "damping": "Nm s/rad",
    "critical_torque": "Nm",
    "kinetic_torque": "Nm",
    "support_stiffness": "Nm/rad",
    "interference": "mm",
    "temperature": "degree Celsius",
    "speed": "rad/s",
}
"""What can vary, with the unit in which a design file says it."""


@dataclass(frozen=True)
class Tolerance:
    """How one parameter varies.

    Parameters
    ----------
    name : str
        One of `PARAMETERS`.
    kind : str
        ``relative`` or ``absolute``, a standard deviation of a normal distribution; or ``limits``.
    first, second : float
        The standard deviation, and nothing; or the limits.

    Examples
    --------
    >>> Tolerance("interference", "absolute", 0.0279).factors(0.279)
    ('normal', 1.0, 0.1)
    >>> Tolerance("damping", "limits", 0.08, 0.12).factors(0.1)
    ('uniform', 0.8, 1.2)
    """

    name: str
    kind: str
    first: float
    second: float = math.nan

    def factors(self, nominal: float) -> tuple[str, float, float]:
        """Distribution of the factor on `nominal`, which is in the unit of `PARAMETERS`.

        Returns
        -------
        tuple of str, float, float
            ``normal`` with mean and standard deviation, or ``uniform`` with its limits.
        """
        offset = -ABSOLUTE_ZERO if self.name == "temperature" else 0.0
        scale = nominal + offset
        if self.kind == "relative":
            return "normal", 1.0, self.first
        if self.kind == "absolute":
            return "normal", 1.0, round(self.first / scale, 12)
        low, high = ((limit + offset) / scale for limit in (self.first, self.second))
        return "uniform", round(low, 12), round(high, 12)


def read_tolerances(given: object, where: str) -> tuple[Tolerance, ...]:
    """Read the table ``[tolerances]``.

    Raises
    ------
    ParameterError
        A name that cannot vary, or an entry that is none; the message names it.

    Examples
    --------
    >>> read_tolerances({"damping": 0.1}, "design")
    (Tolerance(name='damping', kind='relative', first=0.1, second=nan),)
    """
    table = a_table(given, "tolerances", where)
    refuse_unknown(table, set(PARAMETERS), f"{where}, tolerances")
    return tuple(_tolerance(name, entry, f"{where}, tolerances") for name, entry in table.items())


def _tolerance(name: str, entry: object, where: str) -> Tolerance:
    if not isinstance(entry, Mapping):
        return Tolerance(name, "relative", a_number({name: entry}, name, where, closed=True))
    inside = f"{where}, {name}"
    refuse_unknown(entry, {"relative", "absolute", "low", "high"}, inside)
    kinds = set(entry)
    if kinds == {"low", "high"}:
        least = -math.inf if name == "temperature" else 0.0
        low, high = (a_number(entry, key, inside, low=least) for key in ("low", "high"))
        if not low < high:
            raise ParameterError(f"{inside}: low = {low:g} is not below high = {high:g}")
        return Tolerance(name, "limits", low, high)
    if kinds in ({"relative"}, {"absolute"}):
        kind = kinds.pop()
        return Tolerance(name, kind, a_number(entry, kind, inside, closed=True))
    raise ParameterError(f"{inside}: give a number, or one of relative, absolute, low and high")
