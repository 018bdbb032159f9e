"""Environments of a bushing: cold, hot, wet, dust, grease, as sets of friction parameters.

The thesis recommends to study them (Recommendation 5) and measured none. Each set is assumed,
number by number with its reasoning, in ``environments.toml`` beside this file; a rig in one of them
lists that among what is assumed. An effect that the rig has already keeps the rig's values.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

from models.errors import ParameterError
from models.rig import Fit, LawSpec, Rig, parse_spec
from noise.base import packaged_toml

DRY = "dry"
"""Environment of the measurements."""

FIT_PARAMETERS = ("elastomer_stiffness", "damping", "critical_torque", "kinetic_torque")
"""Parameters of a fit that environments and tolerances scale."""


@dataclass(frozen=True)
class Environment:
    """Environment: temperature, factors on the parameters of friction, and effects.

    Parameters
    ----------
    name : str
    temperature : float
        [degree Celsius]
    factors : dict of str to float
        On parameters of each fit, by `FIT_PARAMETERS` [-].
    effects : tuple of LawSpec
        What the contact does beyond its friction law.
    by_temperature : bool
        Whether the factors stand for the temperature: a rig whose material says how it depends on
        that has no need of them.
    why : tuple of str
        Reason for each number; all are assumed.
    """

    name: str
    temperature: float
    factors: dict[str, float]
    effects: tuple[LawSpec, ...] = ()
    by_temperature: bool = False
    why: tuple[str, ...] = ()


@lru_cache(maxsize=1)
def _environments() -> dict[str, Environment]:
    return {
        name: Environment(
            name=name,
            temperature=table["temperature_C"],
            effects=tuple(parse_spec(effect) for effect in table.get("effects", ())),
            by_temperature=table.get("by_temperature", False),
            why=tuple(table["why"]),
            factors={key: table[key] for key in FIT_PARAMETERS if key in table},
        )
        for name, table in packaged_toml("noise.screening", "environments.toml").items()
    }


def environment(name: str) -> Environment:
    """Return an environment by its name; case does not matter.

    Raises
    ------
    ParameterError
        There is none of that name.

    Examples
    --------
    >>> environment("Grease").factors["kinetic_torque"]
    0.3
    """
    match = _environments().get(name.strip().lower())
    if match is None:
        known = ", ".join(_environments())
        raise ParameterError(f"environment {name!r} is unknown; there are {known}")
    return match


def in_environment(rig: Rig, where: Environment) -> Rig:
    """Return the rig with the parameters of an environment.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> wet = in_environment(load_material_rig("fluorocarbon-thesis"), environment("wet"))
    >>> wet.fit(0.279e-3).kinetic_torque, wet.effects[0].name
    (4.8, 'velocity_weakening')
    """
    if where.name == DRY or (where.by_temperature and rig.temperature is not None):
        return rig
    has = {effect.name for effect in rig.effects}
    return replace(
        rig,
        fits=tuple(scaled_fit(fit, where.factors) for fit in rig.fits),
        effects=(*rig.effects, *(e for e in where.effects if e.name not in has)),
        assumed=(*rig.assumed, *(f"{where.name}: {reason}" for reason in where.why)),
    )


def scaled_fit(fit: Fit, factors: Mapping[str, float]) -> Fit:
    """Return a fit with its parameters multiplied.

    Parameters
    ----------
    fit : Fit
    factors : mapping of str to float
        By `FIT_PARAMETERS` [-]; others do nothing. What slides at a torque can be held by it, so a
        critical torque is at least the kinetic one.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> fit = load_material_rig("fluorocarbon-thesis").fit(0.279e-3)
    >>> scaled_fit(fit, {"kinetic_torque": 2.0}).critical_torque
    16.0
    """
    stiffness, damping, critical, kinetic = (factors.get(name, 1.0) for name in FIT_PARAMETERS)
    return replace(
        fit,
        elastomer_stiffness=fit.elastomer_stiffness * stiffness,
        critical_torque=max(fit.critical_torque * critical, fit.kinetic_torque * kinetic),
        kinetic_torque=fit.kinetic_torque * kinetic,
        damping={support: value * damping for support, value in fit.damping.items()},
    )
