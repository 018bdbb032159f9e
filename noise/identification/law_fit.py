"""Fit of all friction laws to recordings, and choice of the simplest that predicts well.

A search starts from many points with few excerpts, each recording by itself, and ends with all
excerpts and one rig about which the recordings scatter. Laws are compared by the share of the
oscillation, cycle by cycle, that they fail to predict in held-out conditions.

A fit is least squares over excerpts of a cycle or two. From a known start, the predicted torque is
a smooth function of the numbers; so derivatives are finite differences, and the search is that of
Levenberg (1944) and Marquardt (1963).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from noise.base.arrays import Array
from noise.identification.bushing_fit import Known
from noise.identification.law_model import (
    CANDIDATES,
    LOCAL,
    SHARE_ASSUMED,
    LawModel,
    Subject,
    priors,
    share_error,
)
from noise.identification.measured import Measured
from noise.identification.outcome import LawScore

_STEP = 3e-4
"""Step of the logarithms for finite differences."""

_BEND = 2.5
"""Threshold of Huber's loss over the usual size of deviations; assumed."""

_COUNT = 5e-4
"""Correlation time of errors: so long a time counts as one observation [s]; assumed."""

_HOPELESS = 300.0
_FAR = 60.0
"""Bounds of deviations, in a fit and in the comparison of starts; assumed."""

_ENOUGH = 4e-3
"""Relative gain of an iteration below which the search ends; assumed."""

_TURNS = 4
"""Most attempts with shorter steps in an iteration."""

_LONGEST_STEP = 0.5
"""Longest step of a logarithm in one iteration; assumed."""


class Misfit:
    """Misfit of a model as a function of its vector of logarithms.

    Deviations are relative to the expected error of a good model, an array of shape (n_samples,)
    for each recording [-].

    Parameters
    ----------
    model : LawModel
    start : ndarray, shape (n,)
        Centre of the search, logarithms [-].
    loose : float
        Factor on the scatter of recordings [-].
    """

    def __init__(self, model: LawModel, start: Array, *, loose: float = 1.0) -> None:
        self._model = model
        self._low, self._high = model.limits(start)
        self._matrix, self._target = priors(model, loose)
        self._weights = [
            np.full(one.excerpts.torque.size, (_COUNT * one.excerpts.rate) ** -0.5)
            for one in model.subjects
        ]

    def deviations(self, x: Array) -> list[Array]:
        """Return the deviations of the recordings.

        Parameters
        ----------
        x : ndarray, shape (n,)
            Logarithms [-].

        Returns
        -------
        list of ndarray, shape (n_samples,)
            [-]
        """
        deviations = []
        for one, torque in zip(self._model.subjects, self._model.predicted(x), strict=True):
            e = one.excerpts
            if torque is None:
                deviations.append(np.full(e.torque.size, _HOPELESS))
                continue
            away = np.nan_to_num((torque - e.torque) / e.scale, nan=_HOPELESS)
            deviations.append(np.clip(away, -_HOPELESS, _HOPELESS).ravel())
        return deviations

    def by_recording(self, x: Array) -> Array:
        """Return the mean size of each recording's deviations, large ones clipped.

        Parameters
        ----------
        x : ndarray, shape (n,)
            Logarithms [-].

        Returns
        -------
        ndarray, shape (n_recordings,)
            [-]
        """
        return np.array([np.mean(np.minimum(np.abs(one), _FAR)) for one in self.deviations(x)])

    def missed(self, deviations: list[Array]) -> Array:
        """Return the share of the oscillation missed in each recording's median excerpt.

        Parameters
        ----------
        deviations : list of ndarray, shape (n_samples,)
            As of `deviations` [-].

        Returns
        -------
        ndarray, shape (n_recordings,)
            [-]
        """
        shares = []
        for one, away in zip(self._model.subjects, deviations, strict=True):
            e = one.excerpts
            error = (away.reshape(e.torque.shape) * e.scale) ** 2
            shares.append(np.sqrt(np.median(error.mean(axis=1)) / e.torque.var(axis=1).mean()))
        return np.array(shares)

    def cost(self, x: Array, deviations: list[Array], usual: float = 1.0) -> float:
        """Return Huber's loss of deviations over their usual size, plus that of the prior.

        Parameters
        ----------
        x : ndarray, shape (n,)
            Logarithms [-].
        deviations : list of ndarray, shape (n_samples,)
            As of `deviations` [-].
        usual : float
            [-]
        """
        size = np.abs(np.concatenate(deviations)) / usual
        bent = np.where(size <= _BEND, size**2, _BEND * (2.0 * size - _BEND))
        prior = self._matrix @ x - self._target
        return float(bent @ np.concatenate(self._weights) ** 2 + prior @ prior)

    def search(
        self, x: Array, iterations: int, free: NDArray[np.bool_] | None = None
    ) -> tuple[Array, list[Array], Array]:
        """Minimise the cost.

        Parameters
        ----------
        x : ndarray, shape (n,)
            Start, logarithms [-].
        iterations : int
            Most iterations.
        free : ndarray of bool, shape (n,), optional
            Numbers that move; by default all.

        Returns
        -------
        vector : ndarray, shape (n,)
            [-]
        deviations : list of ndarray, shape (n_samples,)
            Deviations for that vector [-].
        curvature : ndarray, shape (n, n)
            Of the cost [-].
        """
        free = np.ones(x.size, dtype=bool) if free is None else free
        away, damping, normal = self.deviations(x), 1e-3, np.eye(x.size)
        for _ in range(iterations):
            # usual size of deviations, 1 for a good model
            usual = max(1.0, 1.4826 * float(np.median(np.abs(np.concatenate(away)))))
            normal, slope = self._curvature(x, away, usual, free)
            before = self.cost(x, away, usual)
            inner = normal[np.ix_(free, free)]
            shorter = False
            for _ in range(_TURNS):
                change = np.zeros(x.size)
                damped = inner + damping * np.diag(np.diag(inner))
                change[free] = np.linalg.solve(damped, -slope[free])
                largest = max(1.0, float(np.abs(change).max()) / _LONGEST_STEP)
                moved = np.clip(x + change / largest, self._low, self._high)
                new = self.deviations(moved)
                after = self.cost(moved, new, usual)
                if after < before:
                    x, away, damping, shorter = moved, new, max(damping / 10.0, 1e-9), True
                    break
                damping *= 8.0
            if not shorter or after > (1.0 - _ENOUGH) * before:
                break
        return x, away, normal

    def _curvature(
        self, x: Array, away: list[Array], usual: float, free: NDArray[np.bool_]
    ) -> tuple[Array, Array]:
        """Return curvature, shape (n, n), and slope, shape (n,), of the cost [-]."""
        normal = self._matrix.T @ self._matrix
        slope = self._matrix.T @ (self._matrix @ x - self._target)
        slopes = self._slopes(x, away, free)
        for one, deviations, weight in zip(slopes, away, self._weights, strict=True):
            size = np.abs(deviations) / usual
            bent = np.where(size <= _BEND, 1.0, _BEND / np.maximum(size, _BEND))
            weighted = one * (weight**2 * bent / usual**2)[:, None]
            normal += one.T @ weighted
            slope += weighted.T @ deviations
        return normal, slope

    def _slopes(self, x: Array, away: list[Array], free: NDArray[np.bool_]) -> list[Array]:
        """Return derivatives of the deviations; numbers of all recordings are moved together."""
        model = self._model
        slopes = [np.zeros((one.size, x.size)) for one in away]
        places = [slice(i, model.n_local, len(LOCAL)) for i in range(len(LOCAL))]
        places += [slice(j, j + 1) for j in range(model.n_common, x.size)]
        for place in places:
            if not free[place].any():
                continue
            step = -_STEP if np.any(x[place] + _STEP > self._high[place]) else _STEP
            moved = x.copy()
            moved[place] += step
            for r, new in enumerate(self.deviations(moved)):
                column = place.start + (len(LOCAL) * r if place.stop == model.n_local else 0)
                slopes[r][:, column] = (new - away[r]) / step
        return slopes


_STUCK, _ELASTIC = (0.95, 1.0, 1.05), (0.85, 1.1, 1.5)
"""Factors on the stiffness of starts; an elastic contact hides some of the elastomer's [-];
assumed."""

_DAMPED = (0.55, 1.1)
"""Factors on the damping of starts [-]; assumed."""

_SHARED = (1.0, 0.45)
"""Factors on the elastomer's share of the damping, if that is unknown [-]; assumed."""


def starts(model: LawModel) -> Iterator[tuple[Array, list[Array]]]:
    """Yield the starts of a search.

    Parameters
    ----------
    model : LawModel

    Yields
    ------
    law : ndarray, shape (n_law,)
        The law's own parameters [-].
    local : list of ndarray, shape (n_recordings, 7)
        Choices of the numbers of the recordings [-].
    """
    own = np.stack([one.start for one in model.subjects])
    sticks = model.candidate.sticks
    grid = list(itertools.product(
        np.log(model.candidate.drops), np.log(_STUCK if sticks else _ELASTIC), np.log(_DAMPED),
        np.log(_SHARED if share_error(model) > SHARE_ASSUMED else (1.0,)),
    ))  # fmt: skip
    for chosen in itertools.product(*(some for _, _, some in model.candidate.free.values())):
        begun = own.copy()
        if "share" in model.candidate.free:  # weakening with speed replaces the step
            share = chosen[list(model.candidate.free).index("share")]
            begun[:, 1] -= math.log(1.0 - share)
        yield (
            np.log(chosen),
            [
                begun + np.array([stiffer, 0.0, drop, damped, 0.0, 0.0, share])
                for drop, stiffer, damped, share in grid
            ],
        )


_FEW = 3
"""Excerpts of each recording for the comparison of starts."""

_SKETCHED, _SEARCHED = 3, 2
"""Starts that are searched roughly, and those that are then searched to the end."""

_LOOSE = 4.0
"""Factor on the scatter of recordings in the rough search; assumed."""

_TIGHTENED = (2.0, 1.0)
"""Factors on it in the final searches; assumed."""

_ITERATIONS = {"sketch": 6, "hopeless": 3, "fit": 20}


@dataclass(frozen=True, eq=False)
class Sketch:
    """Rough fit of a law to few excerpts.

    Parameters
    ----------
    model : LawModel
    vectors : tuple of ndarray, shape (n,)
        Logarithms, best first.
    away : float
        Mean size of the deviations of the best [-].
    """

    model: LawModel
    vectors: tuple[Array, ...]
    away: float


@dataclass(frozen=True, eq=False)
class LawFit:
    """Fit of a law to recordings.

    Parameters
    ----------
    model : LawModel
    vector : ndarray, shape (n,)
        Logarithms.
    missed : ndarray, shape (n_recordings,)
        Share of each recording's oscillation that is not predicted [-].
    covariance : ndarray, shape (n, n)
        Of the vector by the curvature [-].
    cost : float
        Sum of squares [-].
    """

    model: LawModel
    vector: Array
    missed: Array
    covariance: Array
    cost: float


def sketch_law(model: LawModel, earlier: Sequence[Sketch] = ()) -> Sketch:
    """Fit a law roughly to few excerpts, from the best of its starts.

    Parameters
    ----------
    model : LawModel
    earlier : sequence of Sketch
        Rough fits of other laws to the same recordings, as further starts.

    Returns
    -------
    Sketch
    """
    few = replace(model, subjects=tuple(
        replace(one, excerpts=one.excerpts.some(_FEW)) for one in model.subjects
    ))  # fmt: skip
    begun = []
    for law, choices in starts(few):
        misfit = Misfit(few, few.vector(choices[0], law), loose=_LOOSE)
        # each recording takes its best choice
        costs = [misfit.by_recording(few.vector(local, law)) for local in choices]
        best = np.argmin(costs, axis=0)
        local = np.stack([choices[c][r] for r, c in enumerate(best)])
        begun.append((float(np.sum(np.min(costs, axis=0))), few.vector(local, law)))
    for other in earlier:
        theirs = other.vectors[0]
        start = few.vector(other.model.local(theirs), few.law_like(other.model, theirs))
        cost = Misfit(few, start, loose=_LOOSE).by_recording(start)
        begun.append((float(np.sum(cost)), start))
    begun.sort(key=lambda start: start[0])
    sketches = []
    for _, start in begun[:_SKETCHED]:
        misfit = Misfit(few, start, loose=_LOOSE)
        vector, *_ = misfit.search(start, _ITERATIONS["sketch"])
        sketches.append((float(np.mean(misfit.by_recording(vector))), vector))
    sketches.sort(key=lambda one: one[0])
    return Sketch(model, tuple(vector for _, vector in sketches[:_SEARCHED]), sketches[0][0])


def fit_law(sketch: Sketch, *, hopeless: bool = False) -> LawFit:
    """Fit a law to all excerpts.

    Parameters
    ----------
    sketch : Sketch
        Start of the search.
    hopeless : bool
        Whether the search stops early.

    Returns
    -------
    LawFit
    """
    fits = []
    for start in sketch.vectors[: 1 if hopeless else _SEARCHED]:
        vector = start
        for loose in _TIGHTENED[-1:] if hopeless else _TIGHTENED:
            iterations = _ITERATIONS["hopeless" if hopeless else "fit"]
            fit = _fitted(sketch.model, vector, iterations, loose=loose)
            vector = fit.vector
        fits.append(fit)
    return min(fits, key=lambda one: one.cost)


def _fitted(
    model: LawModel,
    start: Array,
    iterations: int,
    free: NDArray[np.bool_] | None = None,
    loose: float = 1.0,
) -> LawFit:
    """Return the fit of the free numbers of a law."""
    misfit = Misfit(model, start, loose=loose)
    vector, away, normal = misfit.search(start, iterations, free)
    covariance = np.asarray(np.linalg.pinv(normal), np.float64)
    return LawFit(model, vector, misfit.missed(away), covariance, misfit.cost(vector, away))


MARGIN = 1.09
"""Factor by which a law may miss more for each parameter that it has less; assumed."""

_LEAST = 0.005
"""Share of the oscillation that noise and transients make any law miss; assumed."""

_NOT_WORTH_IT = 3.0
"""Ratio to the best rough fit above which a law is not searched to the end; assumed."""


def left_out(recordings: Sequence[Measured]) -> list[int]:
    """Return the recordings to hold out: whole conditions, a third at most, no whole interference.

    Returns
    -------
    list of int
        Empty if there are fewer than three conditions.
    """
    by_condition: dict[tuple[float, float, float], list[int]] = {}
    for i, one in enumerate(recordings):
        c = one.condition
        key = (round(c.speed, 1), c.interference, c.support_stiffness)
        by_condition.setdefault(key, []).append(i)
    if len(by_condition) < 3:
        return []
    chosen: list[int] = []
    ordered = sorted(by_condition, key=lambda key: (key[1], key[2], key[0]))
    for key in ordered[1::2]:
        rest = [k for k in ordered if k != key and not set(by_condition[k]) & set(chosen)]
        known = any(k[1] == key[1] for k in rest) and any(k[2] == key[2] for k in rest)
        if known and len(chosen) + len(by_condition[key]) <= len(recordings) / 3:
            chosen += by_condition[key]
    return chosen


def choose_law(
    known: Known,
    subjects: Sequence[Subject],
    progress: Callable[[str], None],
) -> tuple[LawFit, tuple[LawScore, ...], tuple[str, ...]]:
    """Fit all laws and choose one.

    Parameters
    ----------
    known : Known
    subjects : sequence of Subject
        Recordings that slip.
    progress : callable
        Called with each step.

    Returns
    -------
    fit : LawFit
        Fit of the chosen law to all recordings.
    scores : tuple of LawScore
        Best first.
    held_out : tuple of str
        Held-out recordings.
    """
    recordings = [one.measured for one in subjects]
    held = left_out(recordings)
    trained = [i for i in range(len(subjects)) if i not in held]
    chosen = tuple(subjects[i] for i in trained)
    sketches: dict[str, Sketch] = {}
    for candidate in CANDIDATES:
        progress(f"law {candidate.name}: a first look")
        model = LawModel(candidate, chosen, known)
        alike = [s for s in sketches.values() if s.model.candidate.sticks == candidate.sticks]
        sketches[candidate.name] = sketch_law(model, alike)
    least = min(sketch.away for sketch in sketches.values())
    fits: dict[str, LawFit] = {}
    scores = []
    for name, sketch in sketches.items():
        fits[name] = fit_law(sketch, hopeless=sketch.away > _NOT_WORTH_IT * least)
        missed = _with_held(fits[name], subjects, trained, held).missed
        law, effects = fits[name].model.specs(fits[name].vector)
        values = {
            key: float(value) for spec in (law, *effects) for key, value in spec.parameters.items()
        }
        share = _mean(missed)
        scores.append(
            LawScore(name, _mean(missed[held or trained]), _mean(missed[trained]), share, values)
        )
        progress(f"law {name}: leaves {100.0 * share:.1f} % of the oscillation unexplained")
    scores.sort(key=lambda score: score.missed)
    fit = fits[_simplest(scores)]
    if held:
        whole = _with_held(fit, subjects, trained, held)
        fit = fit_law(Sketch(whole.model, (whole.vector,), 0.0))
    return fit, tuple(scores), tuple(recordings[i].name for i in held)


def _mean(shares: Array) -> float:
    return float(np.exp(np.mean(np.log(shares))))


def _simplest(scores: Sequence[LawScore]) -> str:
    """Return the simplest law that predicts nearly as well as the best."""
    best = scores[0]
    missed = {score.law: score.missed for score in scores}
    numbers = {candidate.name: len(candidate.free) for candidate in CANDIDATES}
    return next(
        law
        for law, n in numbers.items()
        if missed[law] + _LEAST <= MARGIN ** max(numbers[best.law] - n, 0) * (best.missed + _LEAST)
    )


def _with_held(
    fit: LawFit, subjects: Sequence[Subject], trained: Sequence[int], held: Sequence[int]
) -> LawFit:
    """Fit the numbers of held-out recordings, the rig being that of the others."""
    if not held:
        return fit
    model = replace(fit.model, subjects=tuple(subjects))
    x = model.extended(fit.model, fit.vector, trained)
    free = np.zeros(x.size, dtype=bool)
    free[: model.n_local].reshape(len(subjects), -1)[held] = True
    return _fitted(model, x, _ITERATIONS["fit"], free)
