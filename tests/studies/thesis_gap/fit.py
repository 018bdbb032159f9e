"""Fitting a candidate to some of the cells: a fixed design, then a local search.

The design is the same for all fits (Sobol's points, not scrambled), so it knows no cell. The local
search starts at the design's best on the training cells, draws neighbours from a fixed seed, and
takes those that lower the training error. No step of it looks at a cell that is left out. Rigs are
simulated once and kept, since folds that agree walk the same way.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import qmc

from tests.studies.thesis_gap.speeds import coarse_errors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from tests.studies.thesis_gap.candidates import Candidate

__all__ = ["Effort", "Trials", "fitted_point", "rms"]

_FIRST_STEP = 0.15
"""Standard deviation of the first neighbours, in units of the ranges."""

_SHRINK, _GROW = 0.85, 1.2


@dataclass(frozen=True)
class Effort:
    """How much is tried.

    Parameters
    ----------
    design : int
        Logarithm to base two of the points of the design.
    steps : int
        Of each local search.
    """

    design: int = 6
    steps: int = 10


@dataclass(frozen=True)
class Trials:
    """A candidate's errors at the points tried so far.

    Parameters
    ----------
    candidate : Candidate
    """

    candidate: Candidate
    _known: dict[tuple[float, ...], NDArray[np.float64]] = field(default_factory=dict)

    def errors(self, point: Sequence[float]) -> NDArray[np.float64]:
        """Errors at a point of the unit cube, shape (n_cells,)."""
        key = tuple(float(place) for place in point)
        if key not in self._known:
            self._known[key] = coarse_errors(self.candidate.rig(key))
        return self._known[key]


def fitted_point(
    trials: Trials,
    training: Sequence[int],
    effort: Effort,
    starts: Sequence[Sequence[float]] = (),
) -> tuple[float, ...]:
    """Return the point that is best on the training cells.

    Parameters
    ----------
    trials : Trials
    training : sequence of int
        Positions of the cells that count.
    effort : Effort
    starts : sequence of points
        Tried beside the design; fitted to the same training cells, if fitted at all.

    Returns
    -------
    tuple of float
        In the unit cube.
    """
    cells = list(training)
    n = trials.candidate.dimensions
    design = qmc.Sobol(n, scramble=False).random_base2(effort.design)
    design = np.vstack([design, *(np.array(start)[None, :] for start in starts)])
    costs = [rms(trials.errors(point)[cells]) for point in design]
    best, cost = design[int(np.argmin(costs))], min(costs)
    rng = np.random.default_rng(0)
    step = _FIRST_STEP
    for _ in range(effort.steps):
        moved = best + step * rng.standard_normal(n)
        point = 1.0 - np.abs(1.0 - np.abs(moved) % 2.0)
        trial = rms(trials.errors(point)[cells])
        step *= _GROW if trial < cost else _SHRINK
        if trial < cost:
            best, cost = point, trial
    return tuple(best.tolist())


def rms(values: NDArray[np.float64]) -> float:
    """Root mean square.

    Examples
    --------
    >>> rms(np.array([3.0, -3.0]))
    3.0
    """
    return float(np.sqrt(np.mean(np.square(values))))
