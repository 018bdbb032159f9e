"""What log-odds of causes mean on one rig: a multinomial regression on cases simulated of it.

Hypotheses are sets of causes, and there are more of them than a few hundred cases can teach one by
one. So what a set of effects scores is the sum of what its members score, of what all pairs (or
triples) have in common, and of a little of its own. Before any case is seen, a set scores the sum
of its members' log-odds; a ridge holds it there, as strongly as cases left out say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize, minimize_scalar
from scipy.special import log_softmax

from noise.diagnosis.causes.posterior import CAUSES

_LARGEST = 12.0
"""Of a logarithm of odds; no library is large enough to tell more; assumed."""

_UNIT = 4.0
"""Of logarithms of odds, so that they are about 1."""

_OWN_SHARE = 0.5
"""Of what a set's own weights count beside those of its members; assumed."""

_RIDGES = (0.3, 1.0, 3.0, 10.0, 30.0)
"""Tried; the cases left out in folds choose among them. Grid, folds and steps are assumed."""
_FOLDS = 4
_STEPS = 80

Sets = tuple[frozenset[str], ...]


@dataclass(frozen=True, eq=False)
class LocalModel:
    """Scores of hypotheses from log-odds of causes.

    Parameters
    ----------
    hypotheses : tuple of frozenset of str
    weights : ndarray, shape (n_hypotheses, n_causes + 1)
        Of log-odds over `_UNIT` and of a constant [-].
    temperature : float
        That calibrates the scores on cases left out [-].
    ridge : float
        [-]
    """

    hypotheses: Sets
    weights: NDArray[np.float64]
    temperature: float
    ridge: float

    def log_likelihoods(self, odds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Logarithms of likelihoods but for a common factor.

        Parameters
        ----------
        odds : ndarray, shape (n_causes,)
            Natural logarithms of odds of `CAUSES` [-].

        Returns
        -------
        ndarray, shape (n_hypotheses,)
            [-]
        """
        return np.asarray(self.weights @ _features(odds[None])[0] / self.temperature)


def fit_local_model(
    odds: NDArray[np.float64], causes: Sequence[frozenset[str]], hypotheses: Sets
) -> LocalModel:
    """Fit what log-odds mean.

    Parameters
    ----------
    odds : ndarray, shape (n_cases, n_causes)
        Natural logarithms of odds of `CAUSES` [-].
    causes : sequence of frozenset of str
        Of each case, one of the hypotheses.
    hypotheses : tuple of frozenset of str

    Returns
    -------
    LocalModel
    """
    x = _features(odds)
    place = {hypothesis: i for i, hypothesis in enumerate(hypotheses)}
    y = np.array([place[cause] for cause in causes], dtype=int)
    if not y.size:
        return LocalModel(hypotheses, _first_weights(hypotheses), 1.0, np.inf)
    # Each hypothesis is left out in turn as evenly as its cases allow.
    fold = np.zeros(y.size, dtype=int)
    order = np.argsort(y, kind="stable")
    fold[order] = np.arange(y.size) % _FOLDS
    best: tuple[float, float, float] | None = None
    for ridge in _RIDGES:
        left_out = np.zeros((y.size, len(hypotheses)))
        for k in range(_FOLDS):
            out = fold == k
            if out.any() and not out.all():
                weights = _weights(x[~out], y[~out], hypotheses, ridge)
                left_out[out] = x[out] @ weights.T
        loss, temperature = _tempered(left_out, y)
        if best is None or loss < best[0]:
            best = (loss, ridge, temperature)
    assert best is not None
    _, ridge, temperature = best
    return LocalModel(hypotheses, _weights(x, y, hypotheses, ridge), temperature, ridge)


def _features(odds: NDArray[np.float64]) -> NDArray[np.float64]:
    clipped = np.clip(odds, -_LARGEST, _LARGEST) / _UNIT
    return np.column_stack([clipped, np.ones(len(clipped))])


def _first_weights(hypotheses: Sets) -> NDArray[np.float64]:
    """Weights by which a set scores the sum of its members' log-odds."""
    weights = np.zeros((len(hypotheses), len(CAUSES) + 1))
    for i, hypothesis in enumerate(hypotheses):
        for cause in hypothesis or {"none"}:
            if cause in CAUSES:
                weights[i, CAUSES.index(cause)] = _UNIT
    return weights


def _parts(hypotheses: Sets) -> NDArray[np.float64]:
    """Of what the weights of each hypothesis are made, shape (n_hypotheses, n_parts)."""
    members = sorted({cause for hypothesis in hypotheses for cause in hypothesis or {"none"}})
    of_members = [[cause in (h or {"none"}) for cause in members] for h in hypotheses]
    of_size = [[len(h) == 2, len(h) == 3] for h in hypotheses]
    own = _OWN_SHARE * np.eye(len(hypotheses))
    return np.column_stack([np.array(of_members, float), np.array(of_size, float), own])


def _weights(
    x: NDArray[np.float64], y: NDArray[np.int64], hypotheses: Sets, ridge: float
) -> NDArray[np.float64]:
    first, parts = _first_weights(hypotheses), _parts(hypotheses)
    offset = _log_shares(y, len(hypotheses))
    truth = np.zeros((y.size, len(hypotheses)))
    truth[np.arange(y.size), y] = 1.0
    shape = (parts.shape[1], x.shape[1])

    def loss(flat: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        more = flat.reshape(shape)
        log_p = log_softmax(x @ (first + parts @ more).T + offset, axis=1)
        slope = parts.T @ ((np.exp(log_p) - truth).T @ x) + ridge * more
        value = -float(log_p[np.arange(y.size), y].sum()) + 0.5 * ridge * float((more**2).sum())
        return value, slope.ravel()

    found = minimize(
        loss, np.zeros(shape).ravel(), jac=True, method="L-BFGS-B", options={"maxiter": _STEPS}
    )
    return np.asarray(first + parts @ found.x.reshape(shape))


def _log_shares(y: NDArray[np.int64], n: int) -> NDArray[np.float64]:
    """Logarithm of the share of each hypothesis in the cases; those without a case do not count."""
    count = np.bincount(y, minlength=n)
    return np.where(count > 0, np.log(np.maximum(count, 1) / y.size), -1e3)


def _tempered(scores: NDArray[np.float64], y: NDArray[np.int64]) -> tuple[float, float]:
    """Mean loss and temperature at which scores of cases left out are likeliest."""
    offset = _log_shares(y, scores.shape[1])

    def loss(log_temperature: float) -> float:
        log_p = log_softmax(scores / np.exp(log_temperature) + offset, axis=1)
        return -float(log_p[np.arange(y.size), y].mean())

    found = minimize_scalar(loss, bounds=(-0.7, 2.0), method="bounded")
    return float(found.fun), float(np.exp(found.x))
