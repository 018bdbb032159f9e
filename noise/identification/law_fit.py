"""A law fitted to what recordings do next: least squares over excerpts of a cycle or two.

Begun where the recording shows what it does, a model's torque depends smoothly on its numbers, so
the slopes come from small steps and the search is that of Levenberg (1944) and Marquardt (1963). It
begins at many places with few excerpts, each recording by itself, and ends with all of them and one
rig about which the recordings scatter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from noise.identification.law_misfit import Misfit
from noise.identification.law_model import LawModel
from noise.identification.law_starts import starts

_FEW = 3
"""Excerpts of each recording while places to begin at are compared."""

_TRIED, _KEPT = 3, 2
"""Places from which is searched roughly, and then to the end."""

_LOOSE = 4.0
"""Meanwhile recordings may differ by so many times what they do; assumed."""

_TIGHTENED = (2.0, 1.0)
"""And so many times in the end; assumed."""

_ITERATIONS = {"sketch": 6, "hopeless": 3, "fit": 20}

_ENOUGH = 4e-3
"""Relative gain of an iteration below which it is the last; assumed."""

_TURNS = 4
"""Shorter steps tried in an iteration."""

_LONGEST_STEP = 0.5
"""Of a logarithm in one iteration; assumed."""


@dataclass(frozen=True, eq=False)
class Sketch:
    """A law roughly fitted to few excerpts.

    Parameters
    ----------
    model : LawModel
    vectors : tuple of ndarray, shape (n,)
        Logarithms, best first.
    away : float
        Mean size of the deviations of the best [-].
    """

    model: LawModel
    vectors: tuple[NDArray[np.float64], ...]
    away: float


@dataclass(frozen=True, eq=False)
class LawFit:
    """A law fitted to recordings.

    Parameters
    ----------
    model : LawModel
    vector : ndarray, shape (n,)
        Logarithms.
    missed : ndarray, shape (n_recordings,)
        Share of each recording's oscillation that is not foretold [-].
    covariance : ndarray, shape (n, n)
        Of the vector by the curvature [-].
    """

    model: LawModel
    vector: NDArray[np.float64]
    missed: NDArray[np.float64]
    covariance: NDArray[np.float64]


def sketch_law(model: LawModel, earlier: Sequence[Sketch] = ()) -> Sketch:
    """Fit a law roughly, from the best of its starts.

    Parameters
    ----------
    model : LawModel
    earlier : sequence of Sketch
        Of other laws to the same recordings, whose numbers are tried as well.

    Returns
    -------
    Sketch
    """
    few = replace(model, subjects=tuple(one.with_some(_FEW) for one in model.subjects))
    begun = []
    for law, choices in starts(few):
        misfit = Misfit(few, few.vector(choices[0], law), loose=_LOOSE)
        # each recording takes what suits it best
        costs = [misfit.by_recording(misfit.away(few.vector(local, law))) for local in choices]
        best = np.argmin(costs, axis=0)
        local = np.stack([choices[c][r] for r, c in enumerate(best)])
        begun.append((float(np.sum(np.min(costs, axis=0))), few.vector(local, law)))
    for other in earlier:
        theirs = other.vectors[0]
        start = few.vector(other.model.local(theirs), few.law_like(other.model, theirs))
        misfit = Misfit(few, start, loose=_LOOSE)
        begun.append((float(np.sum(misfit.by_recording(misfit.away(start)))), start))
    begun.sort(key=lambda start: start[0])
    tried = []
    for _, start in begun[:_TRIED]:
        misfit = Misfit(few, start, loose=_LOOSE)
        vector, away, _ = _searched(misfit, start, _ITERATIONS["sketch"])
        tried.append((float(np.mean(misfit.by_recording(away))), vector))
    tried.sort(key=lambda one: one[0])
    return Sketch(model, tuple(vector for _, vector in tried[:_KEPT]), tried[0][0])


def fit_law(sketch: Sketch, *, hopeless: bool = False) -> LawFit:
    """Fit a law to all excerpts.

    Parameters
    ----------
    sketch : Sketch
        Where to begin.
    hopeless : bool
        Then it is not searched to the end.

    Returns
    -------
    LawFit
    """
    found = []
    for start in sketch.vectors[: 1 if hopeless else _KEPT]:
        vector = start
        for loose in _TIGHTENED[-1:] if hopeless else _TIGHTENED:
            misfit = Misfit(sketch.model, vector, loose=loose)
            iterations = _ITERATIONS["hopeless" if hopeless else "fit"]
            vector, away, normal = _searched(misfit, vector, iterations)
        found.append((misfit.cost(vector, away, 1.0), vector, misfit.missed(away), normal))
    _, vector, missed, normal = min(found, key=lambda one: one[0])
    return LawFit(sketch.model, vector, missed, _inverse(normal))


def fit_some(model: LawModel, vector: NDArray[np.float64], free: NDArray[np.bool_]) -> LawFit:
    """Fit some numbers of a law, the others being known.

    Parameters
    ----------
    model : LawModel
    vector : ndarray, shape (n,)
        Where to begin, logarithms [-].
    free : ndarray of bool, shape (n,)
        Which numbers are searched.

    Returns
    -------
    LawFit
    """
    misfit = Misfit(model, vector)
    vector, away, normal = _searched(misfit, vector, _ITERATIONS["fit"], free)
    return LawFit(model, vector, misfit.missed(away), _inverse(normal))


def _searched(
    misfit: Misfit, x: NDArray[np.float64], iterations: int, free: NDArray[np.bool_] | None = None
) -> tuple[NDArray[np.float64], list[NDArray[np.float64]], NDArray[np.float64]]:
    """Return the vector found, deviations there, and the curvature of the misfit."""
    free = np.ones(x.size, dtype=bool) if free is None else free
    away = misfit.away(x)
    damping = 1e-3
    normal = np.eye(x.size)
    for _ in range(iterations):
        usual = misfit.usual(away)
        normal, slope = misfit.curvature(x, away, usual, free)
        before = misfit.cost(x, away, usual)
        inner = normal[np.ix_(free, free)]
        found = False
        for _ in range(_TURNS):
            change = np.zeros(x.size)
            change[free] = np.linalg.solve(inner + damping * np.diag(np.diag(inner)), -slope[free])
            largest = max(1.0, float(np.abs(change).max()) / _LONGEST_STEP)
            tried = misfit.within(x + change / largest)
            new = misfit.away(tried)
            after = misfit.cost(tried, new, usual)
            if after < before:
                x, away, damping, found = tried, new, max(damping / 10.0, 1e-9), True
                break
            damping *= 8.0
        if not found or after > (1.0 - _ENOUGH) * before:
            break
    return x, away, normal


def _inverse(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.linalg.pinv(normal), dtype=np.float64)
