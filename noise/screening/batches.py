"""Evaluation of batches of map points, on all cores.

A batch is points of one rig in one environment. It is cut into rows that differ in speed alone,
which are independent, so that the numbers are the same whoever simulates them.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import astuple

from joblib import Parallel, delayed, hash as digest

from models.rig import Rig
from noise.batch.journal import Journal
from noise.batch.work import one_thread
from noise.screening.point import PointResult, evaluate_row
from noise.screening.vibration import Condition
from sim.analysis.regime import Regime

Evaluator = Callable[[Rig, Sequence[Condition]], list[PointResult]]
"""Returns what is known of each point of a rig."""


@contextmanager
def batch_evaluator(
    *, workers: int = -1, advance: Callable[[int], None] = lambda _: None
) -> Iterator[Evaluator]:
    """Yield a function that simulates batches.

    Parameters
    ----------
    workers : int
        Threads; -1 is one a core.
    advance : callable
        Is called with the number of points that were simulated since.

    Yields
    ------
    callable
        From a rig and conditions to a list of `PointResult`.

    Raises
    ------
    ParameterError
        A condition cannot be simulated.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> with batch_evaluator() as evaluate:
    ...     [result] = evaluate(load_material_rig("PDMS"), [Condition(1.0, 3e-4, 2e3)])
    >>> result.label
    'none'
    """

    def evaluate(rig: Rig, points: Sequence[Condition]) -> list[PointResult]:
        rows = _rows(points)
        work = Parallel(n_jobs=workers, prefer="threads", batch_size=1, return_as="generator")
        results: dict[Condition, PointResult] = {}
        with one_thread():
            of_rows = work(delayed(evaluate_row)(rig, row) for row in rows)
            for row, known in zip(rows, of_rows, strict=True):
                results |= zip(row, known, strict=True)
                advance(len(row))
        return [results[at] for at in points]

    yield evaluate


def _rows(points: Sequence[Condition]) -> list[list[Condition]]:
    """Group points by row, which the structure follows; swings one by one."""

    def row(at: Condition) -> tuple[float, ...]:
        own = at.speed if at.frequency else 0.0
        return at.support_stiffness, at.interference, at.temperature, own

    ordered = sorted(points, key=lambda at: (row(at), at.speed))
    return [list(of_row) for _, of_row in itertools.groupby(ordered, row)]


def keeping(evaluate: Evaluator, lines: Journal) -> Evaluator:
    """Return an evaluator that reads what is in a journal, and adds what it simulates."""

    def journaled(rig: Rig, points: Sequence[Condition]) -> list[PointResult]:
        key = digest((rig, tuple(points)))
        if (stored := lines.get(key)) is not None:
            return [PointResult(Regime(regime), *values) for regime, *values in stored]
        results = evaluate(rig, points)
        lines.add(key, *([one.regime.value, *astuple(one)[1:]] for one in results))
        return results

    return journaled
