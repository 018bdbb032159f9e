"""How far a recording lies from simulated repeats, in units of what repeats differ by.

Each value of a signature is compared with its mean over the repeats and divided by its standard
deviation; a group's share is the mean over its values, and all groups weigh alike. Large
deviations count linearly (Huber 1964, Ann. Math. Statist. 35, 73), so that a single line of hum
cannot hide all else. The floor is the same number for a repeat against the others, each left out
once: 1.0 is the distance at which there is nothing to explain.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from noise.diagnosis.signature import GROUPS, group_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["Gap", "Reference", "gap_of", "reference"]

_BEND = 3.0
"""Deviations beyond so many standard deviations count linearly."""

_LEAST_SCALE = 0.03
"""Least standard deviation of a value: 3 %, or a quarter of a decibel."""

_NEIGHBOURS = 2
"""A few repeats tell a scatter badly, so it is averaged over so many values on either side."""


@dataclass(frozen=True, eq=False)
class Reference:
    """Simulated repeats of one condition.

    Parameters
    ----------
    mean, scale : ndarray, shape (n_values,)
        Of their signatures.
    null : ndarray, shape (n_repeats,)
        Squared distance of each repeat from the others.
    """

    mean: NDArray[np.float64]
    scale: NDArray[np.float64]
    null: NDArray[np.float64]

    def deviation(self, signature: NDArray[np.float64]) -> NDArray[np.float64]:
        """How many standard deviations each value lies from the mean."""
        return np.asarray((signature - self.mean) / self.scale)

    def squared(self, signature: NDArray[np.float64]) -> float:
        """Squared distance of a signature, 1 on average for a repeat."""
        return _squared(self.deviation(signature)) / float(np.mean(self.null))


@dataclass(frozen=True, eq=False)
class Gap:
    """The gap between recordings and simulation.

    Parameters
    ----------
    distance : float
        In units of the floor.
    p_value : float
        Probability of so large a gap between repeats.
    of_recordings : ndarray, shape (n_recordings,)
        Distance of each recording.
    """

    distance: float
    p_value: float
    of_recordings: NDArray[np.float64]


def reference(signatures: Sequence[NDArray[np.float64]]) -> Reference:
    """Make a reference of the signatures of at least three repeats.

    Examples
    --------
    >>> from noise.diagnosis.signature import NAMES
    >>> rng = np.random.default_rng(0)
    >>> repeats = reference(list(rng.normal(size=(8, len(NAMES)))))
    >>> repeats.null.shape, 0.5 < repeats.squared(rng.normal(size=len(NAMES))) < 2.0
    ((8,), True)
    """
    s = np.array(signatures)
    n = len(s)
    null = np.empty(n)
    for i in range(n):
        mean, scale = _moments(np.delete(s, i, axis=0))
        null[i] = _squared((s[i] - mean) / scale)
    mean, scale = _moments(s)
    return Reference(mean, scale, null)


def gap_of(
    signatures: Sequence[NDArray[np.float64]],
    references: Sequence[Reference],
    *,
    seed: int = 0,
    n_draws: int = 4000,
) -> Gap:
    """Gap between recordings and their references, each recording having its own.

    Parameters
    ----------
    signatures : sequence of ndarray
        One a recording.
    references : sequence of Reference
        One a recording.
    seed, n_draws : int
        Of the bootstrap that tells how likely the gap is between repeats.

    Returns
    -------
    Gap
    """
    squared = np.array([r.squared(s) for s, r in zip(signatures, references, strict=True)])
    statistic = float(np.mean(np.log(squared)))
    # Repeats of one condition were compared with one fewer than the recording was, and spread
    # about a mean of few: both by the usual factors.
    pooled = np.concatenate([np.log(r.null / np.mean(r.null)) for r in references])
    rng = np.random.default_rng(seed)
    draws = rng.choice(pooled, (n_draws, len(squared))).mean(axis=1)
    p_value = (1.0 + float(np.sum(draws >= statistic))) / (n_draws + 1.0)
    return Gap(float(np.sqrt(np.mean(squared))), p_value, np.sqrt(squared))


def _moments(s: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    variance = s.var(axis=0, ddof=1)
    kernel = np.ones(2 * _NEIGHBOURS + 1)
    known = np.isfinite(variance)
    filled = np.where(known, variance, 0.0)
    smooth = np.empty_like(variance)
    for i in range(len(GROUPS)):
        inside = i == _GROUP_OF
        if i == GROUPS.index("cycle"):  # quantities of several kinds have no neighbours
            smooth[inside] = variance[inside]
            continue
        total = np.convolve(filled[inside], kernel, mode="same")
        count = np.convolve(known[inside].astype(float), kernel, mode="same")
        smooth[inside] = total / np.maximum(count, 1.0)
    scale = np.sqrt(0.5 * variance + 0.5 * smooth + _LEAST_SCALE**2)
    return s.mean(axis=0), scale * np.sqrt(1.0 + 1.0 / len(s))


def _squared(deviation: NDArray[np.float64]) -> float:
    size = np.abs(deviation)
    cost = np.where(size <= _BEND, size**2, _BEND * (2.0 * size - _BEND))
    known = np.isfinite(cost)
    shares = [
        float(np.mean(cost[(i == _GROUP_OF) & known]))
        for i in range(len(GROUPS))
        if np.any((i == _GROUP_OF) & known)
    ]
    return float(np.mean(shares))


_GROUP_OF = group_of()
