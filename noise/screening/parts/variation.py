"""Variation of a design: rig and condition with parameters changed by factors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from models.errors import ParameterError
from models.rig import LawSpec, Rig, damping_at
from models.show import short_repr
from models.units import ABSOLUTE_ZERO
from noise.screening.design.design import Design
from noise.screening.design.environments import FIT_PARAMETERS, scaled_fit
from noise.screening.design.tolerances import PARAMETERS
from noise.screening.map.grid import grid_of
from sim.effects import EFFECTS


@short_repr
@dataclass(frozen=True)
class UsePoint:
    """One condition of a design's use.

    Parameters
    ----------
    speed : float
        [rad/s]
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    temperature : float
        [degree Celsius]
    use : tuple of float
        Slowest and fastest speed of use, for margins [rad/s].
    """

    speed: float
    interference: float
    support_stiffness: float
    temperature: float
    use: tuple[float, float]


def use_point(design: Design) -> UsePoint:
    """Return the middle of a design's use: of its speeds, fits, supports and temperatures.

    Examples
    --------
    >>> from noise.screening.design.design import load_design
    >>> point = use_point(load_design("fluorocarbon"))
    >>> point.interference, point.support_stiffness
    (0.000279, 3745.0)
    """
    grid = grid_of(design)
    return UsePoint(
        speed=0.5 * (grid.use[0] + grid.use[1]),
        interference=_middle(grid.interference),
        support_stiffness=_middle(grid.support_stiffness),
        temperature=_middle(grid.temperature),
        use=grid.use,
    )


def _middle(values: tuple[float, ...]) -> float:
    return values[(len(values) - 1) // 2]


def nominal_values(design: Design, point: UsePoint) -> dict[str, float]:
    """Nominal values of all that can vary, in the units of `noise.screening.design.tolerances`.

    Examples
    --------
    >>> from noise.screening.design.design import load_design
    >>> design = load_design("fluorocarbon-thesis")
    >>> nominal_values(design, use_point(design))["critical_torque"]
    10.7
    """
    fit = design.rig.fit(point.interference)
    return {
        "elastomer_stiffness": fit.elastomer_stiffness,
        "damping": damping_at(fit, point.support_stiffness),
        "critical_torque": fit.critical_torque,
        "kinetic_torque": fit.kinetic_torque,
        "support_stiffness": point.support_stiffness,
        "interference": 1e3 * point.interference,
        "temperature": point.temperature,
        "speed": point.speed,
        "elastomer_inertia": design.rig.elastomer_inertia,
        **{
            f"{spec.name}.{key}": value
            for spec in design.rig.effects
            for key, value in spec.parameters.items()
            if not isinstance(value, str)
        },
    }


def varied(rig: Rig, point: UsePoint, factors: Mapping[str, float]) -> tuple[Rig, UsePoint]:
    """Return rig and condition with parameters changed.

    Parameters
    ----------
    rig : Rig
    point : UsePoint
    factors : mapping of str to float
        By the names of `noise.screening.design.tolerances.PARAMETERS` [-]. That of the temperature
        is one of absolute temperature; a critical torque is at least the kinetic one. A parameter
        of an effect, by ``EFFECT.PARAMETER``, goes no farther than the effect has it.

    Raises
    ------
    ParameterError
        A name that cannot vary, or a factor that is not positive and finite.

    Examples
    --------
    >>> from noise.screening.design.design import load_design
    >>> design = load_design("fluorocarbon-thesis")
    >>> rig, _ = varied(design.rig, use_point(design), {"kinetic_torque": 1.1})
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
    absolute = point.temperature - ABSOLUTE_ZERO
    point = replace(
        point,
        speed=point.speed * factors.get("speed", 1.0),
        interference=point.interference * factors.get("interference", 1.0),
        support_stiffness=point.support_stiffness * factors.get("support_stiffness", 1.0),
        temperature=absolute * factors.get("temperature", 1.0) + ABSOLUTE_ZERO
        if "temperature" in factors
        else point.temperature,
    )
    return rig, point


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
