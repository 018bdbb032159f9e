"""How likely votes are for sounds on a scale: Bradley and Terry's model with Davidson's ties.

Of two sounds whose values differ by d, the first is chosen, the second is, or no difference is
heard with probabilities in the ratio exp(d/2) : exp(-d/2) : exp(t) (R. R. Davidson, J. Am. Stat.
Assoc. 65, 317, 1970); without such votes the last is left out, and the first is chosen with
probability 1 / (1 + exp(-d)) (R. A. Bradley, M. E. Terry, Biometrika 39, 324, 1952).

One person's votes are few, and often a sound wins all of its comparisons: the likelihood then grows
for ever as that sound rises. So half the logarithm of the determinant of Fisher's information is
added to its logarithm (D. Firth, Biometrika 80, 27, 1993). That takes away the first order of the
bias and keeps every value finite; of many votes it changes nothing. Of two sounds it adds half a
vote to each.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

__all__ = ["Likelihood"]

_OUTCOMES = np.array([[0.5, 0.0], [-0.5, 0.0], [0.0, 1.0]])
"""By what the logarithm of an outcome's odds grows with the difference, and with t."""

_CLOSE = 1e-4
"""How closely the highest point is found, in standard deviations."""

_STEP = 1e-4
"""By which a derivative is taken."""


@dataclass(frozen=True, eq=False)
class Likelihood:
    """Of the values of n sounds, and of t, given votes; the values have mean zero.

    Parameters
    ----------
    n : int
        Sounds; each is compared with each of the others, over others where not itself.
    pairs : ndarray of int, shape (n_pairs, 2)
    counts : ndarray, shape (n_pairs, 3)
        Votes for the first, for the second, for no difference [-].

    Examples
    --------
    >>> three_to_one = Likelihood(2, np.array([[0, 1]]), np.array([[3.0, 1.0, 0.0]]))
    >>> best, _ = three_to_one.highest(np.zeros(3), three_to_one.free, np.eye(1))
    >>> round(float(np.exp(best[0] - best[1])), 3)  # 3.5 to 1.5
    2.333
    """

    n: int
    pairs: NDArray[np.intp]
    counts: Array

    @cached_property
    def has_ties(self) -> bool:
        """Whether any vote is for no difference."""
        return bool(self.counts[:, 2].any())

    @cached_property
    def free(self) -> Array:
        """Directions in which values and t may change, shape (n + 1, n_free)."""
        # Contrasts of Helmert: orthonormal, each without a mean.
        rows, cols = np.indices((self.n, self.n - 1))
        contrasts = np.where(rows <= cols, 1.0, 0.0) - np.where(rows == cols + 1, cols + 1.0, 0.0)
        free = np.zeros((self.n + 1, self.n - 1 + self.has_ties))
        free[: self.n, : self.n - 1] = contrasts / np.linalg.norm(contrasts, axis=0)
        if self.has_ties:
            free[self.n, self.n - 1] = 1.0
        return free

    @cached_property
    def _differences(self) -> Array:
        differences = np.zeros((len(self.pairs), self.n + 1))
        rows = np.arange(len(self.pairs))
        differences[rows, self.pairs[:, 0]] = 1.0
        differences[rows, self.pairs[:, 1]] = -1.0
        return differences

    @cached_property
    def _totals(self) -> Array:
        return np.asarray(self.counts.sum(axis=1))

    def probabilities(self, at: Array) -> Array:
        """Return the probability of each outcome of each pair, shape (n_pairs, 3)."""
        odds = np.outer(self._differences @ at, _OUTCOMES[:, 0]) + at[-1] * _OUTCOMES[:, 1]
        if not self.has_ties:
            odds[:, 2] = -np.inf
        odds = np.exp(odds - odds.max(axis=1, keepdims=True))
        return np.asarray(odds / odds.sum(axis=1, keepdims=True))

    def information(self, at: Array) -> Array:
        """Return Fisher's information on values and t, shape (n + 1, n + 1)."""
        return self._information(self.probabilities(at))

    def _information(self, p: Array) -> Array:
        difference = p[:, 0] - p[:, 1]
        of_difference = self._totals * 0.25 * (p[:, 0] + p[:, 1] - difference**2)
        of_both = self._totals * -0.5 * difference * p[:, 2]
        of_t = self._totals * p[:, 2] * (1.0 - p[:, 2])
        found = self._differences.T @ (of_difference[:, None] * self._differences)
        across = self._differences.T @ of_both
        found[-1] += across
        found[:, -1] += across
        found[-1, -1] += of_t.sum()
        return np.asarray(found)

    def value(self, at: Array) -> float:
        """Return the logarithm of the likelihood with what is added to it."""
        return self.value_and_slope(at)[0]

    def value_and_slope(self, at: Array) -> tuple[float, Array]:
        """Return `value` and its derivatives, shape (n + 1,)."""
        p = self.probabilities(at)
        information = self.free.T @ self._information(p) @ self.free
        inverse = self.free @ np.linalg.inv(information) @ self.free.T
        voted = self.counts > 0.0
        value = self.counts[voted] @ np.log(p[voted]) + 0.5 * np.linalg.slogdet(information)[1]
        spread = self._differences @ inverse
        # Of each pair the covariance of its difference and t, and by it that of each outcome.
        dd, dt = (spread * self._differences).sum(axis=1), spread[:, -1]
        mean = p @ _OUTCOMES
        off = _OUTCOMES[None] - mean[:, None]
        variance = off[..., 0] ** 2 * dd[:, None] + off[..., 1] ** 2 * inverse[-1, -1]
        variance += 2.0 * off[..., 0] * off[..., 1] * dt[:, None]
        skew = ((p * variance)[..., None] * off).sum(axis=1)
        pull = self.counts @ _OUTCOMES + self._totals[:, None] * (0.5 * skew - mean)
        slope = self._differences.T @ pull[:, 0]
        slope[-1] += pull[:, 1].sum()
        return float(value), np.asarray(slope)

    def curvature(self, at: Array) -> Array:
        """Return how fast `slope` falls along the directions that are free, (n_free, n_free)."""
        slopes = [
            self.value_and_slope(at - step)[1] - self.value_and_slope(at + step)[1]
            for step in _STEP * self.free.T
        ]
        curvature = np.array(slopes) @ self.free / (2.0 * _STEP)
        return np.asarray(0.5 * (curvature + curvature.T))

    def highest(self, start: Array, along: Array, curvature: Array) -> tuple[Array, float]:
        """Return where `value` is highest, and how high.

        Parameters
        ----------
        start : ndarray, shape (n + 1,)
            Values and t to begin with [-].
        along : ndarray, shape (n + 1, n_along)
            Directions in which it looks [-].
        curvature : ndarray, shape (n_along, n_along)
            About how fast the slope falls along them, by which steps are measured [-].
        """
        from scipy.optimize import minimize

        if not along.shape[1]:
            return start, self.value(start)
        steps = along @ np.linalg.inv(np.linalg.cholesky(curvature)).T

        def fall(by: Array) -> tuple[float, Array]:
            value, slope = self.value_and_slope(start + steps @ by)
            return -value, -steps.T @ slope

        begin = np.zeros(along.shape[1])
        found = minimize(fall, begin, jac=True, method="BFGS", options={"gtol": _CLOSE})
        return start + steps @ found.x, -float(found.fun)
