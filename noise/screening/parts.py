"""Tolerance analysis: probability that a part is noisy in use, and Sobol' indices.

Parts are drawn as scrambled Sobol' points. A part is noisy if anywhere among the speeds of its use
a vibration lasts that is heard, whether it breaks out or only persists: it is tried where the
nominal design is loudest, where its own sliding is least stable, and at the ends of the use. The
interval of that probability is that of Clopper and Pearson, which covers at least what it states.

Which tolerance matters is told by Sobol' indices of the largest growth of a vibration over the use
(`scipy.stats.sobol_indices` and its bootstrap). A constant kinetic torque has no such growth, and
gets none.

A file that states no tolerances gets those of `ASSUMED`, and the answer says so.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray
from scipy import stats

from models.rig import Rig
from models.show import short_repr
from noise.batch.work import one_thread
from noise.screening.design import Design
from noise.screening.grid import shared_grid
from noise.screening.point import is_noisy
from noise.screening.tolerances import Tolerance, nominal_values, varied
from noise.screening.vibration import Condition
from sim.analysis.stability import growth_of_parts
from sim.friction import friction_law
from sim.temperature import at_temperature

ASSUMED = (
    Tolerance("elastomer_stiffness", "relative", 0.05),
    Tolerance("damping", "relative", 0.1),
    Tolerance("critical_torque", "relative", 0.05),
    Tolerance("kinetic_torque", "relative", 0.05),
    Tolerance("support_stiffness", "relative", 0.03),
    Tolerance("interference", "relative", 0.03),
)
"""Tolerances where a design states none: orders of magnitude for moulded rubber, no source."""

_SPEEDS = 9
"""Number of speeds of use at which the growth rate is computed."""

_PARTS = 64
_INDICES = 128
"""Sample size of the Sobol' indices, to be multiplied by the number of tolerances plus two."""


@dataclass(frozen=True)
class Estimate:
    """An estimate and its 95 % confidence interval [-]."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Sensitivity:
    """Sobol' indices of one tolerance for the growth rate of vibration.

    Parameters
    ----------
    name : str
        Of the parameter.
    first, total : Estimate
        Sobol' indices: the share of the variance that goes when the parameter no longer scatters,
        and the share that stays when it alone does [-].
    """

    name: str
    first: Estimate
    total: Estimate


@short_repr
@dataclass(frozen=True, eq=False)
class Robustness:
    """Results of the tolerance analysis of a design.

    Parameters
    ----------
    design : str
    at : Condition
        Fit, support and temperature that the parts scatter about; the nominal design's loudest.
    noisy : Estimate
        Probability that a part is noisy anywhere in its use [-].
    sensitivities : tuple of Sensitivity
        What matters most first; empty where friction has no slope.
    assumed : bool
        Whether the tolerances are `ASSUMED` rather than the design's own.

    Examples
    --------
    >>> from noise.screening.design import load_design
    >>> design = load_design("fluorocarbon-thesis")
    >>> found = robustness(design, np.random.default_rng(0), parts=4)
    >>> found.noisy.value, found.assumed
    (1.0, True)
    """

    design: str
    at: Condition
    noisy: Estimate
    sensitivities: tuple[Sensitivity, ...]
    assumed: bool


def middle_of_use(design: Design) -> Condition:
    """Return the condition in the middle of a design's use.

    Examples
    --------
    >>> from noise.screening.design import load_design
    >>> middle_of_use(load_design("fluorocarbon")).support_stiffness
    3745.0
    """
    grid = shared_grid([design])
    fit, support, temperature = (
        axis[(len(axis) - 1) // 2]
        for axis in (grid.interference, grid.support_stiffness, grid.temperature)
    )
    return Condition(0.5 * sum(grid.use), fit, support, temperature)


def robustness(
    design: Design,
    rng: np.random.Generator,
    *,
    at: Condition | None = None,
    parts: int = _PARTS,
    workers: int = -1,
) -> Robustness:
    """Analyse the tolerances of a design.

    Parameters
    ----------
    design : Design
        Its rig in its environment.
    rng : numpy.random.Generator
        Of the parts.
    at : Condition
        That the parts scatter about, with the speed at which the nominal design is loudest; by
        default the middle of its use.
    parts : int
        A power of two.
    workers : int
        Threads; -1 is one a core.

    Returns
    -------
    Robustness

    Raises
    ------
    ParameterError
        A part cannot be simulated.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from noise.screening.design import Use
    >>> use = Use(speed=(1.0,), interference=(0.279e-3,), support_stiffness=(2214.0,))
    >>> quiet = Design("PDMS", load_material_rig("PDMS"), use)
    >>> robustness(quiet, np.random.default_rng(0), parts=4, workers=1).noisy.value
    0.0
    """
    at = at or middle_of_use(design)
    use = shared_grid([design]).use
    speeds = np.linspace(max(use[0], 0.02 * use[1]), use[1], _SPEEDS)
    nominal = nominal_values(design.rig, at)
    spread = {one.name: one.factor(nominal[one.name]) for one in design.tolerances or ASSUMED}
    sampled = stats.qmc.Sobol(len(spread), rng=rng).random(parts)
    factors = np.column_stack(
        [one.ppf(column) for one, column in zip(spread.values(), sampled.T, strict=True)]
    )

    def part(row: NDArray[np.float64]) -> tuple[Rig, Condition]:
        return varied(design.rig, at, dict(zip(spread, row.tolist(), strict=True)))

    def growth(rows: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the growth of each row of factors at each speed, (n_rows, n_speeds) [1/s]."""
        return growth_of_parts(
            [
                (at_temperature(rig, own.temperature), own.interference, own.support_stiffness)
                for rig, own in map(part, rows)
            ],
            speeds,
        )

    def noisy(row: NDArray[np.float64], worst: float) -> bool:
        rig, own = part(row)
        speeds_tested = dict.fromkeys([own.speed, worst, float(speeds[0]), float(speeds[-1])])
        return is_noisy(rig, [replace(own, speed=speed) for speed in speeds_tested])

    worst = speeds[growth(factors).argmax(axis=1)].tolist()
    with one_thread():
        results = Parallel(n_jobs=workers, prefer="threads")(
            delayed(noisy)(row, speed) for row, speed in zip(factors, worst, strict=True)
        )
    k = int(sum(results))
    interval = stats.binomtest(k, parts).proportion_ci(0.95, method="exact")
    sensitivities: tuple[Sensitivity, ...] = ()
    if friction_law(design.rig.friction.name).torque is not None:
        sensitivities = _sensitivities(lambda rows: growth(rows.T).max(axis=1), spread, rng)
    return Robustness(
        design=design.name,
        at=at,
        noisy=Estimate(k / parts, float(interval.low), float(interval.high)),
        sensitivities=sensitivities,
        assumed=not design.tolerances,
    )


def _sensitivities(
    output: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    spread: dict[str, Any],
    rng: np.random.Generator,
) -> tuple[Sensitivity, ...]:
    """Return the Sobol' indices of an output, the largest total index first."""
    if len(spread) < 2:
        one = Estimate(1.0, 1.0, 1.0)
        return tuple(Sensitivity(name, one, one) for name in spread)
    sobol = stats.sobol_indices(func=output, n=_INDICES, dists=list(spread.values()), rng=rng)
    drawn = sobol.bootstrap(n_resamples=200)
    indices = [
        Sensitivity(
            name,
            *(
                Estimate(*(0.0 if math.isnan(x) else float(x) for x in (value[i], low[i], high[i])))
                for value, (low, high) in (
                    (sobol.first_order, drawn.first_order.confidence_interval),
                    (sobol.total_order, drawn.total_order.confidence_interval),
                )
            ),
        )
        for i, name in enumerate(spread)
    ]
    return tuple(sorted(indices, key=lambda index: -index.total.value))
