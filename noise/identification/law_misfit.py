"""How far a law's forecast is from recordings, and how that changes with its numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from noise.identification.law_model import LOCAL, LawModel
from noise.identification.law_priors import priors

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

    def __init__(self, model: LawModel, start: NDArray[np.float64], *, loose: float = 1.0) -> None:
        self._model = model
        self._low, self._high = model.limits(start)
        self._matrix, self._target = priors(model, loose)
        self._weights = [
            (_COUNT * one.excerpts.rate) ** -0.5 * np.ones(one.excerpts.torque.size)
            for one in model.subjects
        ]

    def within(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
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

    def away(self, x: NDArray[np.float64]) -> list[NDArray[np.float64]]:
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

    def by_recording(self, away: list[NDArray[np.float64]]) -> NDArray[np.float64]:
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

    def missed(self, away: list[NDArray[np.float64]]) -> NDArray[np.float64]:
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

    def usual(self, away: list[NDArray[np.float64]]) -> float:
        """Return the usual size of deviations, 1 where the model is good.

        Parameters
        ----------
        away : list of ndarray, shape (n_samples,)
            As of `away` [-].
        """
        return max(1.0, 1.4826 * float(np.median(np.abs(np.concatenate(away)))))

    def cost(self, x: NDArray[np.float64], away: list[NDArray[np.float64]], usual: float) -> float:
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
        self,
        x: NDArray[np.float64],
        away: list[NDArray[np.float64]],
        usual: float,
        free: NDArray[np.bool_],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
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

    def _slopes(
        self, x: NDArray[np.float64], away: list[NDArray[np.float64]], free: NDArray[np.bool_]
    ) -> list[NDArray[np.float64]]:
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
