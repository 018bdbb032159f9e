"""Parts within tolerances: how they vary, and the probability that one is noisy in its use.

Parts are drawn as scrambled Sobol' points. A part is noisy if anywhere among the speeds of its use
a vibration lasts that is heard, whether it breaks out or only persists: it is tried where the
nominal design is loudest, where its own sliding is least stable, and at the ends of the use. The
interval of that probability is that of Clopper and Pearson, which covers at least what it states.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from scipy import stats

from models.errors import ParameterError
from models.rig import LawSpec, Rig, damping_at
from noise.batch.work import one_thread
from noise.screening.design import Design, Tolerance
from noise.screening.environments import FIT_PARAMETERS, scaled_fit
from noise.screening.point import is_noisy
from noise.screening.vibration import Condition, growth_at
from sim.effects import EFFECTS

_SPEEDS = 9
"""Number of speeds of use at which the growth rate is computed."""

_PARTS = 64

_WIDEST_NORMAL = 1.0 / 6.0
"""Relative standard deviation from which on a normal distribution is taken as lognormal."""

_NARROWEST = 1e-300
"""Standard deviation of a constant; `scipy.stats` does not take 0."""


def factor_of(tolerance: Tolerance, nominal: float) -> Any:
    """Return the distribution of the factor on a nominal value.

    A normal distribution so wide that it would reach to zero is taken as lognormal.

    Parameters
    ----------
    tolerance : Tolerance
    nominal : float
        In the unit of `noise.screening.design.PARAMETERS`, such as [Nm].

    Returns
    -------
    rv_frozen
        Distribution of `scipy.stats`; its median is 1 unless there are limits.

    Examples
    --------
    >>> factor_of(Tolerance("damping", None, 0.08, 0.12), 0.1).ppf([0.0, 0.5, 1.0])
    array([0.8, 1. , 1.2])
    """
    if tolerance.spread is None:
        low, high = (round(limit / nominal, 12) for limit in (tolerance.low, tolerance.high))
        return stats.uniform(low, high - low)
    if tolerance.spread < _WIDEST_NORMAL:
        return stats.norm(1.0, max(tolerance.spread, _NARROWEST))
    return stats.lognorm(math.sqrt(math.log1p(tolerance.spread**2)))


def nominal_values(rig: Rig, at: Condition) -> dict[str, float]:
    """Return the nominal values of all parameters that can vary, in the units of `PARAMETERS`.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
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
        By the names of `nominal_values` [-]. A critical torque is at least the kinetic one. A
        parameter of an effect goes no farther than the effect has it.

    Raises
    ------
    ParameterError
        A factor is not positive and finite.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> rig, _ = varied(rig, Condition(5.0, 0.279e-3, 2214.0), {"kinetic_torque": 1.1})
    >>> round(rig.fit(0.279e-3).kinetic_torque, 6)
    8.8
    """
    for name, factor in factors.items():
        if not 0.0 < factor < math.inf:
            raise ParameterError(f"the factor {factor:g} on {name} must be above 0 and finite")
    if any(name in factors for name in FIT_PARAMETERS):
        rig = replace(rig, fits=tuple(scaled_fit(fit, factors) for fit in rig.fits))
    rig = replace(
        rig,
        elastomer_inertia=rig.elastomer_inertia * factors.get("elastomer_inertia", 1.0),
        effects=tuple(_scaled_effect(spec, factors) for spec in rig.effects),
    )
    at = replace(
        at,
        interference=at.interference * factors.get("interference", 1.0),
        support_stiffness=at.support_stiffness * factors.get("support_stiffness", 1.0),
    )
    return rig, at


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


@dataclass(frozen=True)
class NoisyParts:
    """Probability that a part is noisy anywhere in its use, and its 95 % confidence interval.

    Parameters
    ----------
    probability, low, high : float
        [-]
    """

    probability: float
    low: float
    high: float


def noisy_parts(
    design: Design,
    at: Condition,
    use: tuple[float, float],
    rng: np.random.Generator,
    *,
    parts: int = _PARTS,
    workers: int = -1,
) -> NoisyParts:
    """Return the probability that a part of a design is noisy anywhere in its use.

    Parameters
    ----------
    design : Design
        Its rig in its environment; with tolerances.
    at : Condition
        That the parts scatter about, with the speed at which the nominal design is loudest.
    use : (float, float)
        Slowest and fastest speed of use [rad/s].
    rng : numpy.random.Generator
        Of the parts.
    parts : int
        A power of two.
    workers : int
        Threads; -1 is one a core.

    Returns
    -------
    NoisyParts

    Raises
    ------
    ParameterError
        A part cannot be simulated.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> quiet = Design("PDMS", load_material_rig("PDMS"), tolerances=(Tolerance("damping", 0.1),))
    >>> at, rng = Condition(1.0, 0.279e-3, 2214.0), np.random.default_rng(0)
    >>> noisy_parts(quiet, at, (0.5, 1.0), rng, parts=4, workers=1)
    NoisyParts(probability=0.0, low=0.0, high=0.602...)
    """
    speeds = np.linspace(max(use[0], 0.02 * use[1]), use[1], _SPEEDS)
    nominal = nominal_values(design.rig, at)
    sampled = stats.qmc.Sobol(len(design.tolerances), rng=rng).random(parts)
    factors = np.column_stack(
        [
            factor_of(one, nominal[one.name]).ppf(column)
            for one, column in zip(design.tolerances, sampled.T, strict=True)
        ]
    )
    names = [one.name for one in design.tolerances]
    drawn = [varied(design.rig, at, dict(zip(names, row, strict=True))) for row in factors.tolist()]

    def noisy(rig: Rig, own: Condition) -> bool:
        worst = speeds[growth_at(rig, own, speeds).argmax()]
        tested = dict.fromkeys([own.speed, *map(float, (worst, speeds[0], speeds[-1]))])
        return is_noisy(rig, [replace(own, speed=speed) for speed in tested])

    with one_thread():
        results = Parallel(n_jobs=workers, prefer="threads")(
            delayed(noisy)(*part) for part in drawn
        )
    k = int(sum(results))
    interval = stats.binomtest(k, parts).proportion_ci(0.95, method="exact")
    return NoisyParts(k / parts, float(interval.low), float(interval.high))
