"""The rig's parameters recalibrated, within what a rig file may be wrong by.

What the recalibration closes by itself is told apart, because it may hide the effect that is
missing (Kennedy and O'Hagan 2001; Brynjarsdottir and O'Hagan 2014).

A search that follows no slope.

Where a rig changes its regime a cost jumps, and between two jumps it is rough. So each number is
tried by a step up and a step down, kept where that helps and tried again in the same direction,
with steps that shrink (Hooke and Jeeves 1961, J. ACM 8, 212).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from noise.diagnosis.fit.case_comparison import CaseComparison
from noise.diagnosis.simulated.model_runs import OFFSETS, Model

_FARTHEST = 4
"""A step is repeated in one direction so often at most."""


def pattern_search(
    cost: Callable[[NDArray[np.float64]], float],
    start: NDArray[np.float64],
    steps: NDArray[np.float64],
    shrink: Sequence[float],
) -> tuple[NDArray[np.float64], float]:
    """Search for the least cost about a start.

    Parameters
    ----------
    cost : callable
        Of an ndarray as `start`; may be infinite.
    start, steps : ndarray, shape (n,)
        Steps of 0 leave a number as it is [any unit].
    shrink : sequence of float
        Factors on the steps, one a round.

    Returns
    -------
    ndarray, shape (n,)
        The best that was tried [unit of `start`].
    float
        Its cost [unit of the cost].

    Examples
    --------
    >>> found, _ = pattern_search(lambda x: float(abs(x - 0.7).sum()), np.zeros(2), np.ones(2),
    ...                           (1.0, 0.5, 0.25, 0.125))
    >>> bool(np.all(abs(found - 0.7) < 0.1))
    True
    """
    x, best = start.copy(), cost(start)
    for factor in shrink:
        for i in np.flatnonzero(steps):
            for sign in (1.0, -1.0):
                improved = False
                for _ in range(_FARTHEST):
                    candidate = x.copy()
                    candidate[i] += sign * factor * steps[i]
                    tried = cost(candidate)
                    if tried >= best:
                        break
                    x, best, improved = candidate, tried, True
                if improved:
                    break
    return x, best


PRIOR = 0.12
"""Relative standard deviation of what a rig file may be wrong by; assumed."""

HOLD = 0.15
"""Weight of the prior against the distance of one recording; assumed."""

_STEP = 0.08
_SHRINK = (1.0, 0.5, 0.25, 0.125)

_MOST = 4
"""Recordings that a fit looks at, of different conditions; assumed."""

_BY_NUMBERS = ("channel_delay",)
"""Effects that change phases, of which a signature knows nothing and the summary does."""

_NUMBERS = 20.0
"""Weight of the summary's numbers, were all of them hopelessly off; assumed."""

_LOOK = 0.04
"""So far off the cost is looked at for how sure an offset is; assumed."""

_UNSURE = 0.1
"""By how much the mean distance of a few repeats is off by chance; assumed."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """A model, what it leaves on the recordings it was fitted to, and how well it is known.

    Parameters
    ----------
    model : Model
    cost : float
        Mean distance of the recordings, and the prior, in floors [-].
    spreads : tuple of callable
        That tell `spread` in parts; only of the few models that are told is it asked.
    """

    model: Model
    cost: float
    spreads: tuple[Callable[[], tuple[float, ...]], ...] = ()

    @cached_property
    def spread(self) -> tuple[float, ...]:
        """Standard deviation of the logarithm of each offset, and then of the effect's strength."""
        return tuple(spread for part in self.spreads for spread in part())


def split(conditions: Sequence[Condition]) -> tuple[list[int], list[int]]:
    """Which recordings are fitted to, and which are held out: whole conditions, about two fifths.

    The fastest is among those held out, and the slowest where there are several: what closes there
    is foretold and not only filled in.

    Examples
    --------
    >>> from models.condition import Condition
    >>> at = [Condition(speed=v) for v in (1.0, 2.0, 2.0, 3.0, 4.0)]
    >>> split(at)
    ([0, 1, 2, 3], [4])
    """
    different = list(dict.fromkeys(conditions))
    if len(different) == 1:
        half = max(1, len(conditions) // 2)
        return list(range(half)), list(range(half, len(conditions))) or [0]
    by_speed = sorted(different, key=lambda c: (abs(c.speed or 0.0), c.interference or 0.0))
    out = set(by_speed[::-2][: max(1, 2 * len(different) // 5)])
    if len(out) > 1:  # the slowest in the place of the slowest of these
        out = {*by_speed[::-2][: len(out) - 1], by_speed[0]}
    held = [i for i, c in enumerate(conditions) if c in out]
    fitted = [i for i, c in enumerate(conditions) if c not in out]
    return fitted, held


def different(comparison: CaseComparison, chosen: Sequence[int], most: int = _MOST) -> list[int]:
    """Choose recordings for a fit: one a condition, as repeats tell it nothing new."""
    first: dict[Condition, int] = {}
    for i in chosen:
        first.setdefault(comparison.recordings[i].condition, i)
    listed = list(first.values())
    places = np.linspace(0, len(listed) - 1, min(most, len(listed))).round().astype(int)
    return [listed[k] for k in places.tolist()]


def offset_cost(
    comparison: CaseComparison, few: Sequence[int], model: Model, *, single_run: bool = False
) -> float:
    """Mean distance of recordings from a model in floors [-], and what its offsets cost."""
    held = HOLD * float(np.sum((np.array(model.offsets) / PRIOR) ** 2)) / len(few)
    if any(spec.name in _BY_NUMBERS for spec in model.effects):
        held += _NUMBERS * float(np.mean(comparison.residuals(model, few) ** 2))
    return float(np.mean(comparison.misfits(model, few, single_run=single_run))) + held


def fit_parameters(
    comparison: CaseComparison,
    chosen: Sequence[int],
    start: Model | None = None,
    *,
    rounds: int = len(_SHRINK),
) -> Fitted:
    """Recalibrate the rig's parameters, whatever effects a model has.

    Parameters
    ----------
    comparison : CaseComparison
    chosen : sequence of int
        Recordings to fit to.
    start : Model, optional
        By default the rig as its file has it.
    rounds : int
        Of the search, the last of which have the smallest steps.
    """
    begin, few = start or Model(), different(comparison, chosen)

    def cost(x: NDArray[np.float64]) -> float:
        return offset_cost(comparison, few, replace(begin, offsets=tuple(x.tolist())))

    steps = np.full(len(OFFSETS), _STEP)
    x, _ = pattern_search(cost, np.array(begin.offsets), steps, _SHRINK[-rounds:])
    return fitted_with_spreads(comparison, few, replace(begin, offsets=tuple(x.tolist())))


def fitted_with_spreads(comparison: CaseComparison, few: Sequence[int], model: Model) -> Fitted:
    """Tell how well the parameters of a fitted model are known."""

    def cost(x: NDArray[np.float64]) -> float:
        return offset_cost(comparison, few, replace(model, offsets=tuple(x.tolist())))

    x = np.array(model.offsets)
    look = np.full(len(OFFSETS), _LOOK)
    return Fitted(model, cost(x), (partial(spreads, cost, x, look, PRIOR),))


def spreads(
    cost: Callable[[NDArray[np.float64]], float],
    x: NDArray[np.float64],
    look: NDArray[np.float64],
    most: float,
) -> tuple[float, ...]:
    """How far each number can be off before the cost tells, as a standard deviation.

    Parameters
    ----------
    cost : callable
    x : ndarray, shape (n,)
        Where it is least [any unit]. Where the cost is infinite to one side, the other tells.
    look : ndarray, shape (n,)
        So far off it is looked at; it is taken to rise as the square from there inwards In the
        unit of `x` [any unit].
    most : float
        Standard deviation where it does not rise [unit of `x`].

    Examples
    --------
    >>> steep = spreads(lambda x: 4e3 * float(x @ x), np.zeros(1), np.full(1, 0.04), 0.12)
    >>> 0.0 < steep[0] < 0.01
    True
    """
    best, found = cost(x), []
    for i, step in enumerate(look.tolist()):
        tried = []
        for sign in (1.0, -1.0):
            away = x.copy()
            away[i] += sign * step
            tried.append(cost(away))
        known = [one for one in tried if math.isfinite(one)]
        rise = max(sum(known) / len(known) - best, 1e-9) if known else 1e-9
        found.append(min(step * math.sqrt(_UNSURE / rise), most))
    return tuple(found)
