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
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from models.errors import ParameterError
from models.rig import LawSpec, Rig, damping_at
from models.schema import as_table, number, refuse_unknown
from models.units import ABSOLUTE_ZERO
from noise.screening.environments import FIT_PARAMETERS, scaled_fit
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from noise.screening.vibration import Condition

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
"""Parameters that can vary, with their units in a design file; those of effects vary as well."""


_WIDEST_NORMAL = 1.0 / 6.0
"""Relative standard deviation from which on a normal distribution is taken as lognormal."""

_NARROWEST = 1e-300
"""Standard deviation of a constant; `scipy.stats` does not take 0."""


@dataclass(frozen=True)
class Tolerance:
    """Tolerance of one parameter.

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

    def factor(self, nominal: float) -> Any:
        """Return the distribution of the factor on a nominal value.

        A normal distribution so wide that it would reach to zero is taken as lognormal.

        Parameters
        ----------
        nominal : float
            In the unit of `PARAMETERS`, such as [Nm].

        Returns
        -------
        rv_frozen
            Distribution of `scipy.stats`; its median is 1 unless there are limits.
        """
        from scipy import stats

        offset = -ABSOLUTE_ZERO if self.name == "temperature" else 0.0
        scale = nominal + offset
        if self.kind == "limits":
            low, high = (round((each + offset) / scale, 12) for each in (self.first, self.second))
            return stats.uniform(low, high - low)
        spread = self.first if self.kind == "relative" else round(self.first / scale, 12)
        if spread < _WIDEST_NORMAL:
            return stats.norm(1.0, max(spread, _NARROWEST))
        return stats.lognorm(math.sqrt(math.log1p(spread**2)))


def read_tolerances(
    given: object, where: str, effects: Sequence[LawSpec] = ()
) -> tuple[Tolerance, ...]:
    """Read the table ``[tolerances]``.

    Parameters
    ----------
    given : object
        Content of the table.
    where : str
        Name of the file in messages.
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
    tolerances = []
    for name, entry in table.items():
        if name in PARAMETERS:
            tolerances.append(_tolerance(name, entry, where))
            continue
        inner = as_table(entry, name, where)
        refuse_unknown(inner, stated[name], f"{where}, {name}")
        tolerances += [_tolerance(f"{name}.{key}", value, where) for key, value in inner.items()]
    return tuple(tolerances)


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


def nominal_values(rig: Rig, at: Condition) -> dict[str, float]:
    """Return the nominal values of all parameters that can vary, in the units of `PARAMETERS`.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from noise.screening.vibration import Condition
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> nominal_values(rig, Condition(5.0, 0.279e-3, 2214.0))["critical_torque"]
    10.7
    """
    fit = rig.fit(at.interference)
    return {
        "elastomer_stiffness": fit.elastomer_stiffness,
        "damping": damping_at(fit, at.support_stiffness),
        "critical_torque": fit.critical_torque,
        "kinetic_torque": fit.kinetic_torque,
        "support_stiffness": at.support_stiffness,
        "interference": 1e3 * at.interference,
        "temperature": at.temperature,
        "speed": at.speed,
        "elastomer_inertia": rig.elastomer_inertia,
        **{
            f"{spec.name}.{key}": value
            for spec in rig.effects
            for key, value in spec.parameters.items()
            if not isinstance(value, str)
        },
    }


def varied(rig: Rig, at: Condition, factors: Mapping[str, float]) -> tuple[Rig, Condition]:
    """Return rig and condition with parameters changed.

    Parameters
    ----------
    rig : Rig
    at : Condition
    factors : mapping of str to float
        By the names of `PARAMETERS` [-]. That of the temperature
        is one of absolute temperature; a critical torque is at least the kinetic one. A parameter
        of an effect, by ``EFFECT.PARAMETER``, goes no farther than the effect has it.

    Raises
    ------
    ParameterError
        A name that cannot vary, or a factor that is not positive and finite.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from noise.screening.vibration import Condition
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> rig, _ = varied(rig, Condition(5.0, 0.279e-3, 2214.0), {"kinetic_torque": 1.1})
    >>> round(rig.fit(0.279e-3).kinetic_torque, 6)
    8.8
    """
    for name, factor in factors.items():
        if name not in PARAMETERS and not _is_stated(rig, name):
            raise ParameterError(f"{name!r} cannot vary; what can is {', '.join(PARAMETERS)}")
        if not 0.0 < factor < math.inf:
            raise ParameterError(f"the factor {factor:g} on {name} must be above 0 and finite")
    if any(name in factors for name in FIT_PARAMETERS):
        rig = replace(rig, fits=tuple(scaled_fit(fit, factors) for fit in rig.fits))
    rig = replace(
        rig,
        elastomer_inertia=rig.elastomer_inertia * factors.get("elastomer_inertia", 1.0),
        effects=tuple(_scaled_effect(spec, factors) for spec in rig.effects),
    )
    absolute = at.temperature - ABSOLUTE_ZERO
    at = replace(
        at,
        speed=at.speed * factors.get("speed", 1.0),
        interference=at.interference * factors.get("interference", 1.0),
        support_stiffness=at.support_stiffness * factors.get("support_stiffness", 1.0),
        temperature=absolute * factors.get("temperature", 1.0) + ABSOLUTE_ZERO
        if "temperature" in factors
        else at.temperature,
    )
    return rig, at


def _is_stated(rig: Rig, name: str) -> bool:
    effect, _, key = name.partition(".")
    return any(
        spec.name == effect and isinstance(spec.parameters.get(key), int | float)
        for spec in rig.effects
    )


def _scaled_effect(spec: LawSpec, factors: Mapping[str, float]) -> LawSpec:
    known = EFFECTS[spec.name].parameters if spec.name in EFFECTS else {}
    scaled: dict[str, float | str] = {}
    for key, value in spec.parameters.items():
        factor = factors.get(f"{spec.name}.{key}")
        scaled[key] = value
        if factor is not None and not isinstance(value, str):
            scaled[key] = value * factor
            if key in known:
                scaled[key] = min(max(value * factor, known[key].low), known[key].high)
    return replace(spec, parameters=scaled)
