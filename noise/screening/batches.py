"""Evaluation of batches of map points, on all cores or on a cluster.

A batch is points of one rig in one environment. It is cut into pieces that are independent, so that
the numbers are the same whoever simulates them; the pieces follow supports, whose structure is
then made once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace

import numpy as np
from joblib import Parallel, delayed, hash as digest
from numpy.typing import NDArray

from models.errors import BushingNoiseError, ParameterError
from models.rig import Rig
from noise.batch.cluster import cluster
from noise.batch.journal import Journal
from noise.batch.work import one_thread
from noise.screening.point import REGIMES, evaluate_point, evaluate_row
from noise.screening.vibration import Condition

LABELS = ("none", "creak", "squawk", "squeal")
"""Of a point, in the order of their codes."""

_PIECE = 32
"""Points of a row that are handed out at once."""

_DIED = "the workers of the cluster that simulated it died; do they have enough memory?"


@dataclass(frozen=True, eq=False)
class Batch:
    """Points to simulate.

    Parameters
    ----------
    rig : Rig
        In its environment.
    speed : ndarray, shape (n,)
        Of the shaft, the peak where it swings [rad/s].
    frequency : ndarray, shape (n,)
        Of the swing [Hz]; NaN at constant speed.
    interference, support_stiffness, temperature : ndarray, shape (n,)
        [m], [Nm/rad], [degree Celsius]
    """

    rig: Rig
    speed: NDArray[np.float64]
    frequency: NDArray[np.float64]
    interference: NDArray[np.float64]
    support_stiffness: NDArray[np.float64]
    temperature: NDArray[np.float64]

    def part(self, chosen: NDArray[np.int64]) -> Batch:
        """Return some of the points."""
        _, *axes = (getattr(self, one.name) for one in fields(self))
        return Batch(self.rig, *(axis[chosen] for axis in axes))


Evaluator = Callable[[Batch], "NDArray[np.float64]"]
"""Returns of each point, shape (n, 6): codes of regime and label, whether that persists only, code
of the label by physics, L_Aeq and L_AFmax [dB]."""


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
        From a `Batch` to an array of shape (n, 6).

    Raises
    ------
    ParameterError
        The cluster cannot be used, or a condition cannot be simulated.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> one, rig = np.ones(1), load_material_rig("PDMS")
    >>> with batch_evaluator() as evaluate:
    ...     evaluate(Batch(rig, one, np.nan * one, 3e-4 * one, 2e3 * one, one))
    array([[ 0.,  0.,  0.,  0., nan, nan]])
    """
    if scheduler is None:

        def on_threads(batch: Batch) -> NDArray[np.float64]:
            pieces = _pieces(batch, _PIECE)
            with one_thread():
                found = Parallel(n_jobs=workers, prefer="threads", batch_size=1)(
                    delayed(_evaluate)(batch.part(piece)) for piece in pieces
                )
            return _joined(batch, pieces, found)

        yield on_threads
        return
    with cluster(scheduler) as spread:

        def on_cluster(batch: Batch) -> NDArray[np.float64]:
            pieces = _pieces(batch, _PIECE)
            calls = [(batch.part(piece),) for piece in pieces]
            found: dict[int, NDArray[np.float64] | str | None] = dict(
                spread(_evaluate_on_cluster, calls)
            )
            values: list[NDArray[np.float64]] = []
            for index in range(len(pieces)):
                result = found[index]
                if result is None or isinstance(result, str):
                    raise ParameterError(result or _DIED)
                values.append(result)
            return _joined(batch, pieces, values)

        yield on_cluster


def keeping(evaluate: Evaluator, lines: Journal) -> Evaluator:
    """Give an evaluator that keeps what it finds, and does not do again what was kept.

    Parameters
    ----------
    evaluate : callable
    lines : Journal

    Returns
    -------
    callable
        From a `Batch` to an array of shape (n, 6), as `evaluate`.
    """

    def kept(batch: Batch) -> NDArray[np.float64]:
        key = digest(tuple(getattr(batch, one.name) for one in fields(batch)))
        if (found := lines.get(key)) is not None:
            return np.array(found, dtype=np.float64)
        rows = evaluate(batch)
        lines.add(key, *rows.tolist())
        return rows

    return kept


def _pieces(batch: Batch, size: int) -> list[NDArray[np.int64]]:
    """Rows of constant speed as they are, cut where they are long; other points in tens."""
    order = np.lexsort(
        (batch.speed, batch.interference, batch.support_stiffness, batch.temperature)
    )
    axes = np.stack([batch.interference, batch.support_stiffness, batch.temperature])[:, order]
    ends = np.flatnonzero(np.any(axes[:, 1:] != axes[:, :-1], axis=0)) + 1
    rows = np.split(order, ends)
    return [piece for row in rows for piece in np.array_split(row, math.ceil(row.size / size))]


def _joined(
    batch: Batch, pieces: list[NDArray[np.int64]], found: list[NDArray[np.float64]]
) -> NDArray[np.float64]:
    rows = np.empty((batch.speed.size, 6))
    for piece, values in zip(pieces, found, strict=True):
        rows[piece] = values
    return rows


def _evaluate_on_cluster(batch: Batch) -> NDArray[np.float64] | str:
    try:
        with one_thread():
            return _evaluate(batch)
    except BushingNoiseError as error:
        return str(error)


def _evaluate(batch: Batch) -> NDArray[np.float64]:
    first, *_ = zip(batch.interference, batch.support_stiffness, batch.temperature, strict=True)
    at = Condition(0.0, *(float(value) for value in first))
    if np.isnan(batch.frequency).all():
        found = evaluate_row(batch.rig, at, batch.speed.tolist())
    else:
        swings = zip(batch.speed.tolist(), batch.frequency.tolist(), strict=True)
        found = [
            evaluate_point(batch.rig, replace(at, speed=speed, frequency=frequency))
            for speed, frequency in swings
        ]
    return np.array(
        [
            (
                REGIMES.index(one.regime), LABELS.index(one.label), one.persists,
                LABELS.index(one.physics), one.level, one.level_max,
            )
            for one in found
        ]
    )  # fmt: skip
