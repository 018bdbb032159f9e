"""Distance of a recording from repeats, in units of what repeats differ by.

Each value of a signature is compared with its mean over the repeats and divided by its standard
deviation; a group's share is the mean over its values, and all groups weigh alike. Large
deviations count linearly (Huber 1964, Ann. Math. Statist. 35, 73), so that a single line of hum
cannot hide all else. The floor is the same number for a repeat against the others, each left out
once: 1.0 is the distance at which there is nothing to explain.

Whether a gap could be chance is asked by exchange: a recording that is a repeat might as well have
been any of the others. Each in turn takes its place, in every condition on its own, and the share
of exchanges that lie as far out is the p-value, whatever the distribution and however few the
repeats (Phipson & Smyth 2010, Stat. Appl. Genet. Mol. Biol. 9, 39). Of a few repeats of one
condition there are few exchanges; what lies farther out than all of them is as seldom as the tail
of their distances says.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as students_t

from noise.diagnosis.gap.signature import GROUPS, KINDS, group_of

_Distance = TypeVar("_Distance", float, "NDArray[np.float64]")

_BEND = 3.0
"""Deviations beyond so many standard deviations count linearly; assumed."""

LEAST_SCALE = 0.03
"""Least standard deviation of a value, and of a spectrum as a whole where nothing is known of how
far repeats scatter: 3 %, which between two repeats is half a decibel at one and a half sigma;
assumed."""

_NEIGHBOURS = 2
"""A few repeats tell a scatter badly, so it is averaged over so many values on either side;
assumed."""

_UNUSUAL = 4.0
"""Times the median squared distance of repeats, which counts as that much in their mean;
assumed."""

_MOST_EXCHANGES = 200
"""Within one condition; beyond, as many are drawn."""


@dataclass(frozen=True, eq=False)
class Reference:
    """Repeats of one condition.

    Parameters
    ----------
    mean, scale : ndarray, shape (n_values,)
        Of their signatures [Np], or [-] of the cycle.
    null : ndarray, shape (n_repeats,)
        Squared distance of each repeat from the others [-].
    repeats : ndarray, shape (n_repeats, n_values)
        Their signatures, as they are exchanged [Np], or [-] of the cycle.
    """

    mean: NDArray[np.float64]
    scale: NDArray[np.float64]
    null: NDArray[np.float64]
    repeats: NDArray[np.float64]

    def deviation(self, signature: NDArray[np.float64]) -> NDArray[np.float64]:
        """How many standard deviations each value lies from the mean.

        Parameters
        ----------
        signature : ndarray, shape (n_values,)
            As of `noise.diagnosis.gap.signature.signature`.

        Returns
        -------
        ndarray, shape (n_values,)
            [-]
        """
        return np.asarray((signature - self.mean) / self.scale)

    def squared(self, signature: NDArray[np.float64]) -> float:
        """Squared distance of a signature, 1 on average for a repeat.

        Parameters
        ----------
        signature : ndarray, shape (n_values,)
            As of `noise.diagnosis.gap.signature.signature`.

        Returns
        -------
        float
            In squared floors [-].
        """
        return self.squared_of(self.deviation(signature))

    def squared_of(self, deviation: NDArray[np.float64]) -> float:
        """Squared distance of deviations, 1 on average for those of a repeat.

        Parameters
        ----------
        deviation : ndarray, shape (n_values,)
            In standard deviations [-].

        Returns
        -------
        float
            In squared floors [-].
        """
        return _squared(deviation) / self.unit

    @property
    def unit(self) -> float:
        """Mean squared distance of repeats, in which distances are given [-]."""
        # one repeat in a hundred falls into another regime, and must not set the unit
        return float(np.mean(np.minimum(self.null, _UNUSUAL * np.median(self.null))))


@dataclass(frozen=True, eq=False)
class Gap:
    """The gap between recordings and their repeats.

    Parameters
    ----------
    distance : float
        In units of the floor [-].
    p_value : float
        Probability of so large a gap between repeats.
    of_recordings : ndarray, shape (n_recordings,)
        Distance of each recording, in floors [-].
    widened : float
        By how much the floor is larger than the repeats alone had it [-].
    of_channels : ndarray, shape (n_recordings, n_kinds)
        Distance of each recording in each kind of channel, in floors of its own; NaN where there
        is none, and none at all where it was not asked for [-].
    """

    distance: float
    p_value: float
    of_recordings: NDArray[np.float64]
    widened: float = 1.0
    of_channels: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, len(KINDS))))


def reference(
    signatures: Sequence[NDArray[np.float64]], *, least: float = LEAST_SCALE, seed: int = 0
) -> Reference:
    """Make a reference of the signatures of at least three repeats.

    Parameters
    ----------
    signatures : sequence of ndarray, shape (n_values,)
        One a repeat As of `noise.diagnosis.gap.signature.signature`.
    least : float
        Relative scatter of whole spectra that is known to be there whatever these repeats say; 0
        where they scatter as they should. It is for p-values: in a distance, 3 % is the least.
    seed : int
        Of what is added to repeats that scatter by less.

    Examples
    --------
    >>> from noise.diagnosis.gap.signature import NAMES
    >>> rng = np.random.default_rng(0)
    >>> repeats = reference(list(rng.normal(size=(8, len(NAMES)))))
    >>> repeats.null.shape, 0.5 < repeats.squared(rng.normal(size=len(NAMES))) < 2.0
    ((8,), True)
    """
    exchanged = with_least_scatter(np.array(signatures), least, seed)
    s = with_least_scatter(np.array(signatures), LEAST_SCALE, seed)
    null = np.empty(len(s))
    for i in range(len(s)):
        mean, scale = _moments(np.delete(s, i, axis=0))
        null[i] = _squared((s[i] - mean) / scale)
    mean, scale = _moments(s)
    return Reference(mean, scale, null, exchanged)


def gap_of(
    signatures: Sequence[NDArray[np.float64]],
    references: Sequence[Reference],
    *,
    seed: int = 0,
    n_draws: int = 4000,
) -> Gap:
    """Gap between recordings and their references.

    Parameters
    ----------
    signatures : sequence of ndarray, shape (n_values,)
        One a recording As of `noise.diagnosis.gap.signature.signature`.
    references : sequence of Reference
        One a recording; recordings of one condition share one.
    seed, n_draws : int
        Of the exchanges that tell how likely the gap is between repeats.

    Returns
    -------
    Gap

    Examples
    --------
    >>> from noise.diagnosis.gap.signature import NAMES
    >>> runs = np.random.default_rng(0).normal(size=(20, len(NAMES)))
    >>> repeats = reference(list(runs[:12]))
    >>> gap_of(list(runs[12:14] + 4.0), [repeats] * 2).p_value < 0.05
    True
    """
    squared = np.array([r.squared(s) for s, r in zip(signatures, references, strict=True)])
    rng = np.random.default_rng(seed)
    statistic, draws, farthest = 0.0, np.zeros(n_draws), True
    for shared in {id(r): r for r in references}.values():
        own = [s for s, r in zip(signatures, references, strict=True) if r is shared]
        exchanged = _exchanged(np.array(own), shared.repeats, rng)
        statistic += exchanged[0]
        draws += rng.choice(exchanged, n_draws)
        farthest = farthest and exchanged[0] >= exchanged.max()
    # ties, the case itself among them, count as being as far out
    as_far = int(np.sum(draws >= statistic - 1e-9 * abs(statistic)))
    p_value = (1.0 + as_far) / (n_draws + 1.0)
    if farthest:  # no exchange lies farther out, so that their number alone would set the value
        p_value = min(p_value, max(_tail(squared, references), 1.0 / (n_draws + 1.0)))
    return Gap(float(np.sqrt(np.mean(squared))), p_value, np.sqrt(squared))


def _tail(squared: NDArray[np.float64], references: Sequence[Reference]) -> float:
    """Probability of so large distances by the scatter of those that the repeats have [-].

    Distances of repeats are about log-normal; recordings of a condition share its error.
    """
    away, variance, freedom = 0.0, 0.0, math.inf
    for shared in {id(r): r for r in references}.values():
        own = np.array([0.5 * math.log(x) for x, r in zip(squared, references, strict=True)
                        if r is shared])  # fmt: skip
        null = 0.5 * np.log(shared.null / shared.unit)
        away += float(np.sum(own - null.mean()))
        variance += own.size**2 * float(null.var(ddof=1)) * (1.0 + 1.0 / null.size)
        freedom = min(freedom, null.size - 1.0)
    return float(students_t.sf(away / math.sqrt(variance + 1e-12), freedom))


def with_least_scatter(
    signatures: NDArray[np.float64], least: float = LEAST_SCALE, seed: int = 0
) -> NDArray[np.float64]:
    """Shift whole spectra of repeats so that none scatters by less than repeats always do.

    Parameters
    ----------
    signatures : ndarray, shape (n_repeats, n_values)
        As of `noise.diagnosis.gap.signature.signature`.
    least : float
        Relative standard deviation.
    seed : int

    Returns
    -------
    ndarray, shape (n_repeats, n_values)
        As `signatures`.

    Examples
    --------
    >>> same = np.zeros((40, len(_GROUP_OF)))
    >>> 0.02 < float(with_least_scatter(same)[:, 0].std()) < 0.04
    True
    """
    rng = np.random.default_rng(seed)
    s = signatures.copy()
    for i in range(len(KINDS)):
        inside = (i == _GROUP_OF) & np.isfinite(s).all(axis=0)
        if inside.any():
            lacking = least**2 - float(s[:, inside].var(axis=0, ddof=1).mean())
            if lacking > 0.0:
                s[:, inside] += math.sqrt(lacking) * rng.standard_normal((len(s), 1))
    return s


def group_costs(deviation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean square of the deviations in each of `GROUPS`, large ones bent; NaN where unknown.

    Parameters
    ----------
    deviation : ndarray, shape (n_values,)
        In standard deviations [-].

    Returns
    -------
    ndarray, shape (n_groups,)
        [-]

    Examples
    --------
    >>> group_costs(np.full(len(_GROUP_OF), 2.0))
    array([4., 4., 4., 4.])
    """
    cost = _bent(deviation)
    shares = np.full(len(GROUPS), np.nan)
    for i in range(len(GROUPS)):
        inside = cost[(i == _GROUP_OF) & np.isfinite(cost)]
        if inside.size:
            shares[i] = inside.mean()
    return shares


def _bent(deviation: NDArray[np.float64]) -> NDArray[np.float64]:
    size = np.abs(deviation)
    return np.where(size <= _BEND, size**2, _BEND * (2.0 * size - _BEND))


def _exchanged(
    own: NDArray[np.float64], repeats: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    """Sum of distances from the rest with the recordings, and then others, as the odd ones."""
    pool = np.concatenate([own, repeats])
    size, m = len(pool), len(own)
    if math.comb(size, m) <= _MOST_EXCHANGES:
        chosen = list(combinations(range(size), m))
    else:
        drawn = [tuple(rng.permutation(size)[:m].tolist()) for _ in range(_MOST_EXCHANGES)]
        chosen = [tuple(range(m)), *drawn]
    sums = np.empty(len(chosen))
    for k, odd in enumerate(chosen):
        mean, scale = _moments(np.delete(pool, odd, axis=0))
        sums[k] = sum(math.sqrt(_squared((pool[j] - mean) / scale)) for j in odd)
    return sums


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
    scale = np.sqrt(0.5 * variance + 0.5 * smooth + LEAST_SCALE**2)
    return s.mean(axis=0), scale * np.sqrt(1.0 + 1.0 / len(s))


def _squared(deviation: NDArray[np.float64]) -> float:
    return float(np.nanmean(group_costs(deviation)))


def closed_fraction(
    before: _Distance, after: _Distance, floor: _Distance | float = 1.0
) -> _Distance:
    """Share of what lies above the floor that is closed; negative where the gap grew [-].

    Parameters
    ----------
    before, after, floor : float or ndarray, shape (n,)
        Gaps without and with a change, and that of repeats, all in floors [-].

    Examples
    --------
    >>> closed_fraction(3.0, 1.5)
    0.75
    """
    return (before - after) / (before - floor)


_GROUP_OF = group_of()
