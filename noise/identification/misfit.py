"""Misfit of a law to excerpts of recordings, and its minimisation.

A fit is least squares over excerpts of a cycle or two. From a known start, the predicted torque is
a smooth function of the numbers; so derivatives are finite differences, and the search is that of
Levenberg (1944) and Marquardt (1963).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from noise.base.arrays import Array
from noise.identification.law_model import LOCAL, LawModel, priors

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
