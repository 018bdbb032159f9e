"""A rig fitted to a table of measured numbers: its score, and the search for what it leaves open.

A number's misfit is mostly log(simulated / measured), times its weight. Groups of them, each by its
root mean square, add up to the cost that the search lowers. A regime changes at a stroke, so the
search follows no slope.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray

from models.condition import FIXED
from models.errors import ParameterError
from models.rig import Rig
from models.show import short_repr
from noise.diagnosis.fit.fit import pattern_search
from noise.identification.quantities import QUANTITIES, SettledRun, settled_run


@short_repr
@dataclass(frozen=True)
class TableNumber:
    """A measured number.

    Parameters
    ----------
    item : str
        Of `noise.identification.quantities.QUANTITIES`.
    value : float
        As measured [the item's unit].
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    speeds : tuple of float
        At which the rig is run for it [rad/s].
    weight : float
        Of its misfit [-].
    group : str
        Numbers of a group count by the root mean square of their misfits, one without by itself.
    """

    item: str
    value: float
    interference: float
    support_stiffness: float
    speeds: tuple[float, ...] = ()
    weight: float = 1.0
    group: str = ""

    def misfit(self, found: float) -> float:
        """Distance of what a rig gives from what was measured, both in the item's unit [-]."""
        return QUANTITIES[self.item].misfit(found, self.value)

    def __str__(self) -> str:
        fixed = self.support_stiffness == FIXED
        support = "fixed" if fixed else f"{self.support_stiffness:.0f} Nm/rad"
        return f"{self.item} at {1e3 * self.interference:.3f} mm, {support}"


_UNUSABLE = 100.0

Task = tuple[float, float, float]
"""Interference, support stiffness and speed of a run."""


@dataclass(frozen=True)
class TableScore:
    """What a rig comes to.

    Parameters
    ----------
    cost : float
        To be minimised [-].
    found : mapping of TableNumber to float
        What it gives [each in its item's unit].
    """

    cost: float
    found: Mapping[TableNumber, float]

    def rms(self, numbers: Iterable[TableNumber]) -> float:
        """Root mean square of the misfits of some numbers [-]."""
        errors = [number.misfit(self.found[number]) for number in numbers]
        return math.sqrt(sum(error * error for error in errors) / len(errors))


def score_table(
    rig: Rig | None, table: Sequence[TableNumber], *, workers: int = -1
) -> TableScore:  # fmt: skip
    """Judge a rig by measured numbers.

    Parameters
    ----------
    rig : Rig or None
        None is no rig at all, as bad as can be.
    table : sequence of TableNumber
    workers : int
        Threads; the result does not depend on it.

    Returns
    -------
    TableScore

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from noise.identification.table_fit import TableNumber
    >>> number = TableNumber("effective_stiffness", 464.0, 0.279e-3, 2214.0)
    >>> round(score_table(load_material_rig("fluorocarbon"), [number]).found[number])
    511
    """
    if rig is None:
        return TableScore(_UNUSABLE, {})
    tasks = dict.fromkeys(task for number in table for task in _tasks(number))
    try:
        made = Parallel(n_jobs=workers, prefer="threads")(
            delayed(settled_run)(rig, *task) for task in tasks
        )
        runs: dict[Task, SettledRun] = dict(zip(tasks, made, strict=True))
        found = {
            number: QUANTITIES[number.item].found(
                rig, number, [runs[task] for task in _tasks(number)]
            )
            for number in table
        }
    except ParameterError:
        return TableScore(_UNUSABLE, {})
    squares: dict[object, list[float]] = {}
    for number in table:
        weighted = number.weight * number.misfit(found[number])
        squares.setdefault(number.group or number, []).append(weighted * weighted)
    return TableScore(sum(math.sqrt(sum(s) / len(s)) for s in squares.values()), found)


def _tasks(number: TableNumber) -> list[Task]:
    return [(number.interference, number.support_stiffness, speed) for speed in number.speeds]


@dataclass(frozen=True, eq=False)
class TableFit:
    """A rig fitted to a table.

    Parameters
    ----------
    rig : Rig
    vector : ndarray, shape (n,)
        Logarithms of what was searched [-].
    score : TableScore
    """

    rig: Rig
    vector: NDArray[np.float64]
    score: TableScore


def fit_table(
    rig_of: Callable[[NDArray[np.float64]], Rig | None], table: Sequence[TableNumber],
    start: NDArray[np.float64], *, step: float = 0.1, rounds: int = 4,
    width: float = math.inf, workers: int = -1,
    progress: Callable[[TableScore], None] | None = None,
) -> TableFit:  # fmt: skip
    """Search a vector of logarithms for the rig that the numbers are of.

    Parameters
    ----------
    rig_of : callable
        The rig at a vector, None where there is none.
    table : sequence of TableNumber
    start : ndarray, shape (n,)
        Where the search begins, logarithms [-].
    step : float
        Of the first round [-]; each later one has half of it.
    rounds : int
    width : float
        Standard deviation of the vector about its start, as far as that is known [-].
    workers : int
        Threads; the result does not depend on it.
    progress : callable, optional
        Told each score that is better than those before.

    Returns
    -------
    TableFit

    Raises
    ------
    ParameterError
        The start makes no rig that can be simulated.
    """
    best = [math.inf]

    def cost(vector: NDArray[np.float64]) -> float:
        score = score_table(rig_of(vector), table, workers=workers)
        away = float(np.sum(((vector - start) / width) ** 2)) / len(table)
        whole = math.hypot(score.cost, math.sqrt(away))
        if whole < best[0]:
            best[0] = whole
            if progress is not None:
                progress(score)
        return whole

    steps = np.full(start.size, step)
    vector, _ = pattern_search(cost, start, steps, [0.5**i for i in range(rounds)])
    rig = rig_of(vector)
    if rig is None:
        raise ParameterError("the numbers that a search began at make no rig")
    return TableFit(rig, vector, score_table(rig, table, workers=workers))
