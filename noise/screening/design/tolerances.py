"""Tolerances of built bushings about their drawing: the ``[tolerances]`` of a design file.

Each entry becomes a factor on the nominal value, which is what a population is drawn in: a number
is a relative standard deviation, ``absolute`` a standard deviation in the unit of the design file,
``low`` and ``high`` are limits in it between which all values are equally likely. A temperature's
factor is one of absolute temperature. Parameters of the rig's effects can vary as well, each under
the name of its effect: ``slip_pulse.amplitude = 0.1``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from models.errors import ParameterError
from models.schema import as_table, number, refuse_unknown
from models.units import ABSOLUTE_ZERO

if TYPE_CHECKING:
    from models.rig import LawSpec
    from noise.screening.parts.sampling import Distribution


PARAMETERS = {
    "elastomer_stiffness": "Nm/rad",
    "damping": "Nm s/rad",
    "critical_torque": "Nm",
    "kinetic_torque": "Nm",
    "elastomer_inertia": "kg m2",
    "support_stiffness": "Nm/rad",
    "interference": "mm",
    "temperature": "degree Celsius",
    "speed": "rad/s",
}
"""What can vary, with the unit in which a design file says it; and parameters of effects."""


def unit_of(name: str) -> str:
    """Return the unit in which a design file says a tolerance.

    Examples
    --------
    >>> unit_of("damping"), unit_of("shaft_compliance.inertia")
    ('Nm s/rad', 'kg m2')
    """
    effect, dot, parameter = name.partition(".")
    if not dot:
        return PARAMETERS[name]
    from sim.effects import EFFECTS  # only files with effects that vary need it

    known = EFFECTS[effect].parameters if effect in EFFECTS else {}
    return known[parameter].unit if parameter in known else ""


_WIDEST_NORMAL = 1.0 / 6.0
"""Relative standard deviation from which on a normal distribution is taken as lognormal."""

_NARROWEST = 1e-300
"""Standard deviation of what does not vary, of which `scipy.stats` takes none of 0."""


@dataclass(frozen=True)
class Tolerance:
    """How one parameter varies.

    Parameters
    ----------
    name : str
        One of `PARAMETERS`, or ``EFFECT.PARAMETER``.
    kind : str
        ``relative`` or ``absolute``, a standard deviation of a normal distribution; or ``limits``.
    first, second : float
        The standard deviation, as a share [-] or in the unit of `PARAMETERS`, and nothing; or the
        limits, in that unit.

    Examples
    --------
    >>> Tolerance("damping", "limits", 0.08, 0.12).factor(0.1).ppf([0.0, 0.5, 1.0])
    array([0.8, 1. , 1.2])
    """

    name: str
    kind: str
    first: float
    second: float = math.nan

    def factor(self, nominal: float) -> Distribution:
        """Distribution of the factor on a nominal value.

        A normal distribution so wide that it would reach to zero is taken as lognormal.

        Parameters
        ----------
        nominal : float
            In the unit of `PARAMETERS`, such as [Nm].

        Returns
        -------
        Distribution
            Of `scipy.stats`; its median is 1 unless there are limits.
        """
        from scipy import stats

        offset = -ABSOLUTE_ZERO if self.name == "temperature" else 0.0
        scale = nominal + offset
        if self.kind == "limits":
            low, high = (round((each + offset) / scale, 12) for each in (self.first, self.second))
            factor: Distribution = stats.uniform(low, high - low)
            return factor
        spread = self.first if self.kind == "relative" else round(self.first / scale, 12)
        if spread < _WIDEST_NORMAL:
            factor = stats.norm(1.0, max(spread, _NARROWEST))
        else:
            factor = stats.lognorm(math.sqrt(math.log1p(spread**2)))
        return factor


def read_tolerances(
    given: object, where: str, effects: Sequence[LawSpec] = ()
) -> tuple[Tolerance, ...]:
    """Read the table ``[tolerances]``.

    Parameters
    ----------
    given : object
        What the file holds.
    where : str
        What messages call it.
    effects : sequence of LawSpec
        Of the rig, the parameters of which can vary where it states them.

    Raises
    ------
    ParameterError
        A name that cannot vary, or an entry that is none; the message names it.

    Examples
    --------
    >>> read_tolerances({"damping": 0.1}, "design")
    (Tolerance(name='damping', kind='relative', first=0.1, second=nan),)
    """
    table, where = as_table(given, "tolerances", where), f"{where}, tolerances"
    stated = {
        spec.name: {key for key, value in spec.parameters.items() if not isinstance(value, str)}
        for spec in effects
    }
    refuse_unknown(table, set(PARAMETERS) | set(stated), where)
    found = []
    for name, entry in table.items():
        if name in PARAMETERS:
            found.append(_tolerance(name, entry, where))
            continue
        inner = as_table(entry, name, where)
        refuse_unknown(inner, stated[name], f"{where}, {name}")
        found += [_tolerance(f"{name}.{key}", value, where) for key, value in inner.items()]
    return tuple(found)


def _tolerance(name: str, entry: object, where: str) -> Tolerance:
    if not isinstance(entry, Mapping):
        return Tolerance(name, "relative", number({name: entry}, name, where, closed=True))
    inside = f"{where}, {name}"
    refuse_unknown(entry, {"relative", "absolute", "low", "high"}, inside)
    kinds = set(entry)
    if kinds == {"low", "high"}:
        least = -math.inf if name == "temperature" else 0.0
        low, high = (number(entry, key, inside, low=least) for key in ("low", "high"))
        if not low < high:
            raise ParameterError(f"{inside}: low = {low:g} is not below high = {high:g}")
        return Tolerance(name, "limits", low, high)
    if kinds in ({"relative"}, {"absolute"}):
        kind = kinds.pop()
        return Tolerance(name, kind, number(entry, kind, inside, closed=True))
    raise ParameterError(f"{inside}: give a number, or one of relative, absolute, low and high")
