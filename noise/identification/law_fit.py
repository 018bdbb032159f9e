"""Laws of friction fitted to what recordings do next, and the simplest that does as well as any.

A fit is least squares over excerpts of a cycle or two. Begun where the recording shows what it
does, a model's torque depends smoothly on its numbers, so the slopes come from small steps and the
search is that of Levenberg (1944) and Marquardt (1963). It begins at many places with few excerpts,
each recording by itself, and ends with all of them and one rig about which the recordings scatter.

Laws are compared on whole conditions that are left out: what counts is how much of their
oscillation a law predicts, cycle by cycle.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from noise.base.arrays import Array
from noise.identification.bushing_fit import Known
from noise.identification.law_model import (
    CANDIDATES,
    LOCAL,
    SHARE_ASSUMED,
    Candidate,
    LawModel,
    priors,
    share_error,
)
from noise.identification.measured import Measured
from noise.identification.outcome import LawScore
from noise.identification.static_test import Evidence
from noise.identification.subjects import Subject

_STEP = 3e-4
"""Of the logarithms, for slopes."""

_BEND = 2.5
"""Deviations beyond so many times their usual size count linearly; assumed."""

_COUNT = 5e-4
"""Neighbouring samples err alike: so long a time counts as one observation [s]; assumed."""

_HOPELESS = 300.0
_FAR = 60.0
"""Deviations beyond which one is as bad as the other; assumed."""


class Misfit:
    """Misfit of a model as a function of its vector.

    Parameters
    ----------
    model : LawModel
    start : ndarray, shape (n,)
        About which it is searched, logarithms [-].
    loose : float
        Factor on what recordings may differ by [-].
    """

    def __init__(self, model: LawModel, start: Array, *, loose: float = 1.0) -> None:
        self._model = model
        self._low, self._high = model.limits(start)
        self._matrix, self._target = priors(model, loose)
        self._weights = [
            (_COUNT * one.excerpts.rate) ** -0.5 * np.ones(one.excerpts.torque.size)
            for one in model.subjects
        ]

    def within(self, x: Array) -> Array:
        """Return a vector within its limits.

        Parameters
        ----------
        x : ndarray, shape (n,)
            Logarithms [-].

        Returns
        -------
        ndarray, shape (n,)
            [-]
        """
        return np.clip(x, self._low, self._high)

    def away(self, x: Array) -> list[Array]:
        """Tell how far each recording is from what a vector foretells.

        Parameters
        ----------
        x : ndarray, shape (n,)
            Logarithms [-].

        Returns
        -------
        list of ndarray, shape (n_samples,)
            In what a good model may miss it by [-].
        """
        found = []
        for one, torque in zip(self._model.subjects, self._model.foretell(x), strict=True):
            e = one.excerpts
            if torque is None:
                found.append(np.full(e.torque.size, _HOPELESS))
                continue
            away = np.nan_to_num((torque - e.torque) / e.scale, nan=_HOPELESS)
            found.append(np.clip(away, -_HOPELESS, _HOPELESS).ravel())
        return found

    def by_recording(self, away: list[Array]) -> Array:
        """Mean size of each recording's deviations, large ones cut.

        Parameters
        ----------
        away : list of ndarray, shape (n_samples,)
            As of `away` [-].

        Returns
        -------
        ndarray, shape (n_recordings,)
            [-]
        """
        return np.array([np.mean(np.minimum(np.abs(one), _FAR)) for one in away])

    def missed(self, away: list[Array]) -> Array:
        """Share of each recording's oscillation that is not foretold.

        Parameters
        ----------
        away : list of ndarray, shape (n_samples,)
            As of `away` [-].

        Returns
        -------
        ndarray, shape (n_recordings,)
            Of the median excerpt [-].
        """
        shares = []
        for one, deviations in zip(self._model.subjects, away, strict=True):
            e = one.excerpts
            error = (deviations.reshape(e.torque.shape) * e.scale) ** 2
            shares.append(np.sqrt(np.median(error.mean(axis=1)) / e.torque.var(axis=1).mean()))
        return np.array(shares)

    def usual(self, away: list[Array]) -> float:
        """Return the usual size of deviations, 1 where the model is good.

        Parameters
        ----------
        away : list of ndarray, shape (n_samples,)
            As of `away` [-].
        """
        return max(1.0, 1.4826 * float(np.median(np.abs(np.concatenate(away)))))

    def cost(self, x: Array, away: list[Array], usual: float) -> float:
        """Sum of squares, of Huber's kind.

        Parameters
        ----------
        x : ndarray, shape (n,)
            Logarithms [-].
        away : list of ndarray, shape (n_samples,)
            Deviations there [-].
        usual : float
            Their usual size [-].
        """
        size = np.abs(np.concatenate(away)) / usual
        bent = np.where(size <= _BEND, size**2, _BEND * (2.0 * size - _BEND))
        prior = self._matrix @ x - self._target
        return float(bent @ np.concatenate(self._weights) ** 2 + prior @ prior)

    def curvature(
        self, x: Array, away: list[Array], usual: float, free: NDArray[np.bool_]
    ) -> tuple[Array, Array]:
        """Return curvature and slope of the cost.

        Parameters
        ----------
        x : ndarray, shape (n,)
            Logarithms [-].
        away : list of ndarray, shape (n_samples,)
            Deviations there [-].
        usual : float
            Their usual size [-].
        free : ndarray of bool, shape (n,)
            Which numbers move.

        Returns
        -------
        curvature : ndarray, shape (n, n)
            [-]
        slope : ndarray, shape (n,)
            [-]
        """
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
        """Slopes of each recording's deviations: a number of its own is moved in all at once."""
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
            for r, new in enumerate(self.away(moved)):
                column = place.start + (len(LOCAL) * r if place.stop == model.n_local else 0)
                slopes[r][:, column] = (new - away[r]) / step
        return slopes


_STUCK, _ELASTIC = (0.95, 1.0, 1.05), (0.85, 1.1, 1.5)
"""Factors on stiffness that are tried; an elastic contact hides some of the elastomer's [-];
assumed."""

_DAMPED = (0.55, 1.1)
"""And on damping [-]; assumed."""

_SHARED = (1.0, 0.45)
"""And on the elastomer's share of it, where that is not known [-]; assumed."""


def starts(model: LawModel) -> Iterator[tuple[Array, list[Array]]]:
    """Give places to begin at.

    Parameters
    ----------
    model : LawModel

    Yields
    ------
    law : ndarray, shape (n_law,)
        The law's own parameters [-].
    local : list of ndarray, shape (n_recordings, 7)
        Numbers of the recordings that go with it; each recording may take another [-].
    """
    own = np.stack([one.start for one in model.subjects])
    sticks = model.candidate.sticks
    grid = list(itertools.product(
        np.log(model.candidate.drops), np.log(_STUCK if sticks else _ELASTIC), np.log(_DAMPED),
        np.log(_SHARED if share_error(model) > SHARE_ASSUMED else (1.0,)),
    ))  # fmt: skip
    for chosen in itertools.product(*(some for _, _, some in model.candidate.free.values())):
        begun = _begun(model.candidate, own, chosen)
        yield (
            np.log(chosen),
            [
                begun + np.array([stiffer, 0.0, drop, damped, 0.0, 0.0, share])
                for drop, stiffer, damped, share in grid
            ],
        )


def _begun(candidate: Candidate, local: Array, chosen: tuple[float, ...]) -> Array:
    """Let a torque that fades with speed take the place of the step between two torques."""
    if "share" not in candidate.free:
        return local
    share = chosen[list(candidate.free).index("share")]
    begun = local.copy()
    begun[:, 1] -= math.log(1.0 - share)
    return begun


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
    vectors: tuple[Array, ...]
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
    vector: Array
    missed: Array
    covariance: Array


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
    return LawFit(sketch.model, vector, missed, np.asarray(np.linalg.pinv(normal), np.float64))


def fit_some(model: LawModel, vector: Array, free: NDArray[np.bool_]) -> LawFit:
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
    return LawFit(
        model, vector, misfit.missed(away), np.asarray(np.linalg.pinv(normal), np.float64)
    )


def _searched(
    misfit: Misfit, x: Array, iterations: int, free: NDArray[np.bool_] | None = None
) -> tuple[Array, list[Array], Array]:
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


MARGIN = 1.09
"""A simpler law may miss so many times as much for each number that it has less; assumed."""

_LEAST = 0.005
"""Share of the oscillation that any law may miss: what a cell and a start leave; assumed."""

_NOT_WORTH_IT = 3.0
"""A law that misses so many times as much at first is not searched to the end; assumed."""


def left_out(recordings: Sequence[Measured]) -> list[int]:
    """Choose recordings to leave out: whole conditions, about a third, no interference altogether.

    Returns
    -------
    list of int
        None of them where there are fewer than three conditions.
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
    evidence: Mapping[bool, tuple[Evidence, ...]],
) -> tuple[LawFit, tuple[LawScore, ...], tuple[str, ...]]:
    """Fit all laws and choose.

    Parameters
    ----------
    known : Known
    subjects : sequence of Subject
        Recordings that slip.
    progress : callable
        Told what is being done.
    evidence : mapping of bool to tuple of Evidence
        Of the rig's numbers from elsewhere than stick-slip, by whether a law truly sticks.

    Returns
    -------
    fit : LawFit
        Of the law that was chosen, to all recordings.
    scores : tuple of LawScore
        Best first.
    held_out : tuple of str
        Recordings that the laws were compared on.
    """
    recordings = [one.measured for one in subjects]
    held = left_out(recordings)
    trained = [i for i in range(len(subjects)) if i not in held]
    sketches: dict[str, Sketch] = {}
    for candidate in CANDIDATES:
        progress(f"law {candidate.name}: a first look")
        chosen = tuple(subjects[i] for i in trained)
        model = LawModel(candidate, chosen, known, evidence[candidate.sticks])
        alike = [s for s in sketches.values() if s.model.candidate.sticks == candidate.sticks]
        sketches[candidate.name] = sketch_law(model, alike)
    least = min(sketch.away for sketch in sketches.values())
    fits: dict[str, LawFit] = {}
    scores = []
    for name, sketch in sketches.items():
        fits[name] = fit_law(sketch, hopeless=sketch.away > _NOT_WORTH_IT * least)
        missed = _with_held(fits[name], subjects, trained, held).missed
        scores.append(
            LawScore(
                name, _mean(missed[held or trained]), _mean(missed[trained]), _mean(missed),
                _parameters(fits[name]),
            )
        )  # fmt: skip
        share = 100.0 * scores[-1].missed
        progress(f"law {name}: leaves {share:.1f} % of the oscillation unexplained")
    scores.sort(key=lambda score: score.missed)
    fit = fits[_simplest(scores)]
    if held:
        whole = _with_held(fit, subjects, trained, held)
        fit = fit_law(Sketch(whole.model, (whole.vector,), 0.0))
    return fit, tuple(scores), tuple(recordings[i].name for i in held)


def _mean(shares: Array) -> float:
    return float(np.exp(np.mean(np.log(shares))))


def _simplest(scores: Sequence[LawScore]) -> str:
    """Name the simplest law that foretells nearly as much as the best."""
    best = scores[0]
    missed = {score.law: score.missed for score in scores}
    numbers = {candidate.name: candidate.n_parameters for candidate in CANDIDATES}
    return next(
        law
        for law, n in numbers.items()
        if missed[law] + _LEAST <= MARGIN ** max(numbers[best.law] - n, 0) * (best.missed + _LEAST)
    )


def _with_held(
    fit: LawFit, subjects: Sequence[Subject], trained: Sequence[int], held: Sequence[int]
) -> LawFit:
    """Let recordings left out have numbers of their own about the rig that the others gave."""
    if not held:
        return fit
    model = replace(fit.model, subjects=tuple(subjects))
    x = model.extended(fit.model, fit.vector, trained)
    free = np.zeros(x.size, dtype=bool)
    free[: model.n_local].reshape(len(subjects), -1)[held] = True
    return fit_some(model, x, free)


def _parameters(fit: LawFit) -> dict[str, float]:
    law, effects = fit.model.specs(fit.vector)
    return {key: float(value) for spec in (law, *effects) for key, value in spec.parameters.items()}
