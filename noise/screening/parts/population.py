"""Simulation of many bushings of one design: the noise that each makes, and its margin.

A label is simulated. Critical speeds are by stability where the friction has a slope, which costs
a fiftieth of simulating them and, for the calibrated fluorocarbon, differs by less than a step of
the map; ``critical="simulation"`` simulates them, and so is a constant kinetic torque, of which
stability tells nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray

from models.errors import ParameterError
from models.rig import Rig
from noise.batch import one_thread
from noise.screening.design.design import Design
from noise.screening.map.grid import DEFAULT_SPEEDS
from noise.screening.map.point import evaluate_point
from noise.screening.parts.variation import UsePoint, use_point, varied
from noise.screening.ranking.margins import margin_of, range_of
from sim.analysis.critical_speeds import regime_at
from sim.analysis.regime import Regime
from sim.analysis.stability import steady_sliding
from sim.friction import friction_law
from sim.temperature import at_temperature

if TYPE_CHECKING:
    Critical = Literal["stability", "simulation", "none"]


_BEYOND = 1.5
_STEP = 0.25
"""Of the speeds at which critical ones are sought [rad/s]; stability interpolates between them."""

_SUPPORT_STEP = 0.05
"""Relative, between the supports whose structure is made."""

_COARSE = 8
"""Steps between the speeds that are simulated first."""


@dataclass(frozen=True, eq=False)
class Outcomes:
    """What became of each bushing; arrays of shape (n,).

    Parameters
    ----------
    labels : ndarray of str, shape (n,)
        Noise at the point of use; empty texts where it was not asked for.
    v_crit1, v_crit2 : ndarray, shape (n,)
        [rad/s], as of `noise.screening.ranking.margins`; NaN where they were not asked for, v_crit1
        also where stability, which does not know it, tells v_crit2.
    margin : ndarray, shape (n,)
        Of the use to what vibrates [rad/s], positive where nothing does; ``inf`` where nothing
        vibrates at any speed tried, and NaN where it was not asked for.
    """

    labels: NDArray[np.str_]
    v_crit1: NDArray[np.float64]
    v_crit2: NDArray[np.float64]
    margin: NDArray[np.float64]


def outcomes(
    design: Design,
    factors: ArrayLike,
    *,
    names: Sequence[str],
    point: UsePoint | None = None,
    labels: bool = True,
    critical: Critical = "stability",
    workers: int = -1,
) -> Outcomes:
    """Tell what becomes of many bushings of one design.

    Parameters
    ----------
    design : Design
    factors : array_like, shape (n, d)
        On the nominal parameters, one row per bushing.
    names : sequence of str, length d
        Of the columns, from `noise.screening.design.tolerances.PARAMETERS`.
    point : UsePoint, optional
        Condition at which they are heard; by default the middle of the design's use.
    labels : bool
        Whether to tell labels.
    critical : {"stability", "simulation", "none"}
        How critical speeds and margins are found, if at all.
    workers : int
        Threads; -1 is one a core.

    Returns
    -------
    Outcomes

    Raises
    ------
    ParameterError
        Names and factors do not fit together, or a factor cannot be used.

    Examples
    --------
    >>> from noise.screening.design.design import load_design
    >>> found = outcomes(load_design("fluorocarbon"), [[1.0], [3.0]], names=["damping"])
    >>> found.labels.tolist(), (found.margin[1] > found.margin[0]).item()
    (['squeal', 'none'], True)
    """
    table = np.atleast_2d(np.asarray(factors, dtype=np.float64))
    if table.ndim != 2 or table.shape[1] != len(names):
        raise ParameterError(
            f"factors of shape {table.shape} do not fit {len(names)} names: {', '.join(names)}"
        )
    point = point or use_point(design)
    with one_thread():
        rows = Parallel(n_jobs=workers, prefer="threads")(
            delayed(_outcome)(
                design.rig, point, dict(zip(names, row, strict=True)), labels, critical
            )
            for row in table.tolist()
        )
    found, v_crit1, v_crit2, margin = zip(*rows, strict=True) if rows else ((), (), (), ())
    return Outcomes(
        np.array(found, dtype=str), np.array(v_crit1), np.array(v_crit2), np.array(margin)
    )


def _outcome(
    rig: Rig, point: UsePoint, factors: dict[str, float], labels: bool, critical: Critical
) -> tuple[str, float, float, float]:
    nominal, rig_as_drawn = point, rig
    rig, point = varied(rig, point, factors)
    label = ""
    if labels:
        label = evaluate_point(
            rig,
            point.speed,
            interference=point.interference,
            support_stiffness=point.support_stiffness,
            temperature=point.temperature,
            structure=(rig_as_drawn, _rounded(nominal, point)),
        ).label
    if critical == "none":
        return label, math.nan, math.nan, math.nan
    rig = at_temperature(rig, point.temperature)
    fastest = max(DEFAULT_SPEEDS[1], _BEYOND * point.use[1])
    speed = np.arange(1, math.ceil(fastest / _STEP) + 1, dtype=np.float64) * _STEP
    if critical == "stability" and friction_law(rig.friction.name).torque is not None:
        growth = steady_sliding(rig, speed, point.interference, point.support_stiffness).growth
        span = range_of(speed, growth > 0.0, growth)
        return label, math.nan, span[1], margin_of(span, point.use)
    sticks, vibrates = _simulated(rig, point, speed)
    return label, sticks[1], vibrates[1], margin_of(vibrates, point.use)


def _rounded(nominal: UsePoint, point: UsePoint) -> float:
    """Support whose structure is heard: few of them are made."""
    if math.isinf(point.support_stiffness):
        return point.support_stiffness
    away = math.log(point.support_stiffness / nominal.support_stiffness)
    return nominal.support_stiffness * math.exp(_SUPPORT_STEP * round(away / _SUPPORT_STEP))


def _simulated(
    rig: Rig, point: UsePoint, speed: NDArray[np.float64]
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Ranges of speed that stick and that vibrate: coarse first, then between what differs."""
    regimes: dict[int, Regime] = {}

    def at(i: int) -> Regime:
        if i not in regimes:
            regimes[i] = regime_at(
                rig, float(speed[i]), point.interference, point.support_stiffness
            )
        return regimes[i]

    stops = sorted({*range(0, speed.size, _COARSE), speed.size - 1})
    for i in stops:
        at(i)
    todo = list(pairwise(stops))
    while todo:
        left, right = todo.pop()
        middle = (left + right) // 2
        if right - left > 1 and at(left) is not at(right):
            at(middle)
            todo += [(left, middle), (middle, right)]
        elif right - left > 1:
            regimes.update(dict.fromkeys(range(left + 1, right), regimes[left]))
    found = [regimes[i] for i in range(speed.size)]
    sticks = np.array([regime is Regime.STICK_SLIP for regime in found])
    vibrates = np.array([regime is not Regime.STEADY_SLIDING for regime in found])
    return range_of(speed, sticks), range_of(speed, vibrates)
