"""Risk number of a design over its use, from runs of its nominal rig.

How hard a blow is, is told by the torque: by how much its swing would accelerate the free clamp
where the beams hold it. That is what the accelerometer reads in stick-slip, within a factor of two,
and it does not fall silent where the clamp is bolted down. Impulses are slips, and where nothing
sticks the periods of the vibration. Static over kinetic friction is that of the fit.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from models.rig import Rig
from noise.batch import one_thread
from noise.screening.design.design import Design
from noise.screening.map.grid import grid_of
from noise.screening.ranking.risk import design_risk, risk_grades
from sim.analysis.critical_speeds import motion_from_rest
from sim.analysis.regime import Regime, friction_regime
from sim.analysis.slips import motion_slips
from sim.temperature import at_temperature

_SPEEDS = 12

_SECONDS = 1.0
"""Of the runs, judged on their last half as critical speeds are [s]."""


def use_risk(design: Design, *, workers: int = -1) -> int:
    """Risk number of a design, from 1 to 10.

    Parameters
    ----------
    design : Design
    workers : int
        Threads; -1 is one a core.

    Examples
    --------
    >>> from noise.screening.design.design import load_design
    >>> use_risk(load_design("PDMS"))
    1
    """
    return design_risk(use_grades(design, workers=workers))


def use_grades(design: Design, *, workers: int = -1) -> NDArray[np.float64]:
    """Grade conditions that a design meets in use.

    Parameters
    ----------
    design : Design
    workers : int
        Threads; -1 is one a core.

    Returns
    -------
    ndarray, shape (n,)
        As of `noise.screening.ranking.risk.risk_grades`: twelve speeds of use at the ends and the
        middle of fits, supports and temperatures.

    Raises
    ------
    ParameterError
        If a condition cannot be simulated.
    """
    grid = grid_of(design)
    conditions = list(
        itertools.product(
            np.linspace(*grid.use, _SPEEDS).tolist(),
            ends_and_middle(np.clip(grid.interference, *design.rig.interference_range).tolist()),
            ends_and_middle(grid.support_stiffness),
            ends_and_middle(grid.temperature),
        )
    )
    distinct = list(dict.fromkeys(conditions))  # beyond the fits that are given one is held
    with one_thread():
        rows = Parallel(n_jobs=workers, prefer="threads")(
            delayed(_measured)(design.rig, *condition) for condition in distinct
        )
    found = dict(zip(distinct, rows, strict=True))
    return risk_grades(*np.array([found[condition] for condition in conditions]).T)


def ends_and_middle(values: Sequence[float]) -> list[float]:
    """First, middle and last value of an axis, each once, in its unit, such as [rad/s].

    Examples
    --------
    >>> ends_and_middle([1.0, 2.0, 3.0, 4.0]), ends_and_middle([5.0])
    ([1.0, 2.0, 4.0], [5.0])
    """
    last = len(values) - 1
    return [values[i] for i in sorted({0, last // 2, last})]


def _measured(
    rig: Rig, speed: float, interference: float, support_stiffness: float, temperature: float
) -> tuple[float, float, float]:
    """Acceleration [m/s2], impulses on the way [1/rad] and friction's ratio of one condition."""
    rig = at_temperature(rig, temperature)
    fit = rig.fit(interference)
    ratio = fit.critical_torque / fit.kinetic_torque if fit.kinetic_torque > 0.0 else np.inf
    motion = motion_from_rest(rig, speed, interference, support_stiffness, seconds=_SECONDS)
    regime = friction_regime(motion)
    if regime is Regime.STEADY_SLIDING:
        return 0.0, 0.0, ratio
    last = motion.since(motion.torque.size // 2)
    swing = last.torque - last.torque.mean()
    acceleration = rig.beams.lever * float(np.abs(swing).max()) / rig.clamp_inertia
    if regime is Regime.STICK_SLIP:
        impulses = float(motion_slips(last).times.size)
    else:
        impulses = float(np.sum((swing[:-1] < 0.0) & (swing[1:] >= 0.0)))
    return acceleration, impulses / (0.5 * _SECONDS * speed), ratio
