"""Evaluation of batches of map points, on all cores or on a cluster.

A batch is points of one rig in one environment. It is cut into rows that differ in speed alone,
which are independent, so that the numbers are the same whoever simulates them.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import astuple

from joblib import Parallel, delayed, hash as digest

from models.errors import BushingNoiseError, ParameterError
from models.rig import Rig
from noise.batch.cluster import cluster
from noise.batch.journal import Journal
from noise.batch.work import one_thread
from noise.screening.point import PointResult, evaluate_row
from noise.screening.vibration import Condition
from sim.analysis.regime import Regime

Evaluator = Callable[[Rig, Sequence[Condition]], list[PointResult]]
"""Returns what is known of each point of a rig."""

_DIED = "the workers of the cluster that simulated it died; do they have enough memory?"


@contextmanager
def batch_evaluator(*, workers: int = -1, scheduler: str | None = None) -> Iterator[Evaluator]:
    """Give a function that simulates batches.

    Parameters
    ----------
    workers : int
        Threads; -1 is one a core.
    scheduler : str, optional
        Address of a Dask cluster that does it instead.

    Yields
    ------
    callable
        From a rig and conditions to a list of `PointResult`.

    Raises
    ------
    ParameterError
        The cluster cannot be used, or a condition cannot be simulated.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> with batch_evaluator() as evaluate:
    ...     [found] = evaluate(load_material_rig("PDMS"), [Condition(1.0, 3e-4, 2e3)])
    >>> found.label
    'none'
    """
    if scheduler is None:

        def on_threads(rig: Rig, points: Sequence[Condition]) -> list[PointResult]:
            rows = _rows(points)
            with one_thread():
                found = Parallel(n_jobs=workers, prefer="threads", batch_size=1)(
                    delayed(evaluate_row)(rig, row) for row in rows
                )
            return _in_order(points, rows, found)

        yield on_threads
        return
    with cluster(scheduler) as spread:

        def on_cluster(rig: Rig, points: Sequence[Condition]) -> list[PointResult]:
            rows = _rows(points)
            found = dict(spread(_evaluate_far, [(rig, row) for row in rows]))
            values: list[list[PointResult]] = []
            for index in range(len(rows)):
                result = found[index]
                if result is None or isinstance(result, str):
                    raise ParameterError(result or _DIED)
                values.append(result)
            return _in_order(points, rows, values)

        yield on_cluster


def keeping(evaluate: Evaluator, lines: Journal) -> Evaluator:
    """Give an evaluator that keeps what it finds in a journal, and does not do it again."""

    def kept(rig: Rig, points: Sequence[Condition]) -> list[PointResult]:
        key = digest((rig, tuple(points)))
        if (lately := lines.get(key)) is not None:
            return [PointResult(Regime(regime), *values) for regime, *values in lately]
        found = evaluate(rig, points)
        lines.add(key, *([one.regime.value, *astuple(one)[1:]] for one in found))
        return found

    return kept


def _rows(points: Sequence[Condition]) -> list[list[Condition]]:
    """Points by row, which the structure follows; swings one by one."""

    def row(at: Condition) -> tuple[float, ...]:
        own = at.speed if at.frequency else 0.0
        return at.support_stiffness, at.interference, at.temperature, own

    ordered = sorted(points, key=lambda at: (row(at), at.speed))
    return [list(of_row) for _, of_row in itertools.groupby(ordered, row)]


def _in_order(
    points: Sequence[Condition], rows: list[list[Condition]], found: list[list[PointResult]]
) -> list[PointResult]:
    known = dict(zip(itertools.chain(*rows), itertools.chain(*found), strict=True))
    return [known[at] for at in points]


def _evaluate_far(rig: Rig, row: list[Condition]) -> list[PointResult] | str:
    try:
        with one_thread():
            return evaluate_row(rig, row)
    except BushingNoiseError as error:
        return str(error)
