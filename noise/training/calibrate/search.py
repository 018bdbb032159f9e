"""Search for the unknowns: evolution of a Gaussian cloud of candidates (CMA-ES), on log scales.

The cost has many valleys and no gradient, since a regime changes at a stroke. N. Hansen and A.
Ostermeier (2001), *Evolutionary Computation* 9(2), through the package ``cma``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError, not_installed
from noise.training.calibrate.cells import CELLS, Cell
from noise.training.calibrate.objective import Score, score
from noise.training.calibrate.unknowns import rig_of, start, values_at

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

__all__ = ["Found", "search"]

_SPREAD, _WIDE_SPREAD = 0.05, 0.35
"""First standard deviation of the logarithms, about the start and about the round start."""

_CANDIDATES = 12
"""In each generation."""


@dataclass(frozen=True)
class Found:
    """The best candidate of a search.

    Parameters
    ----------
    values : mapping of str to float
        Of the unknowns [each in its `unit`].
    score : Score
    """

    values: Mapping[str, float]
    score: Score


def search(
    generations: int,
    seed: int = 0,
    fitted: Sequence[Cell] = CELLS,
    *,
    critical_speeds_alone: bool = False,
    rounded: bool = False,
    workers: int = -1,
    progress: Callable[[int, Found], None] | None = None,
) -> Found:
    """Search the unknowns of the fluorocarbon.

    Parameters
    ----------
    generations : int
        Of twelve candidates each, in each of which about a hundred runs are simulated.
    seed : int
    fitted : sequence of Cell
        The critical speeds that count.
    critical_speeds_alone : bool
        As for `noise.training.calibrate.objective.score`.
    rounded : bool
        Begin at round numbers, with a wider cloud.
    workers : int
        Threads; the result does not depend on it.
    progress : callable
        Called after each generation with its number, from 1 on, and the best so far.

    Returns
    -------
    Found

    Raises
    ------
    ParameterError
        If the package ``cma`` is missing.
    """
    try:
        import cma
    except ImportError:
        raise ParameterError(not_installed("the search needs", "cma", "calibrate")) from None

    def judged(point: NDArray[np.float64]) -> Found:
        values = values_at(point)
        return Found(
            values,
            score(
                rig_of(values), fitted, critical_speeds_alone=critical_speeds_alone, workers=workers
            ),
        )

    first = start(rounded=rounded)
    best = judged(first)
    # A seed of 0 would be taken from the clock.
    options = {"seed": seed + 1, "popsize": _CANDIDATES, "verbose": -9}
    strategy = cma.CMAEvolutionStrategy(first, _WIDE_SPREAD if rounded else _SPREAD, options)
    for generation in range(1, generations + 1):
        points = strategy.ask()
        candidates = [judged(np.asarray(point)) for point in points]
        strategy.tell(points, [candidate.score.cost for candidate in candidates])
        best = min([best, *candidates], key=lambda found: found.score.cost)
        if progress is not None:
            progress(generation, best)
    return best
