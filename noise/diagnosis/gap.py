"""Gap between recordings and simulation, in units of what repeats differ by.

A recording's distance is that of its signature from the mean over repeats, in standard deviations;
1.0 is the floor, at which there is nothing to explain.

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
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.stats import t as students_t

from noise.base.arrays import Array
from noise.diagnosis.floor import Reference, moments
from noise.diagnosis.signature import channel_costs, squared_distance

_MOST_EXCHANGES, _N_DRAWN = 200, 4000
"""Exchanges within one condition, of which as many are drawn where there are more, and those drawn
of all conditions together."""


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
    of_channels : ndarray, shape (n_recordings, n_kinds)
        Distance of each recording in each kind of channel, in floors of its own; NaN where there
        is none [-].
    """

    distance: float
    p_value: float
    of_recordings: Array
    of_channels: Array


def gap_of(signatures: Sequence[Array], references: Sequence[Reference], *, seed: int = 0) -> Gap:
    """Gap between recordings and their references.

    Parameters
    ----------
    signatures : sequence of ndarray, shape (n_values,)
        One per recording, as of `noise.diagnosis.signature.signature`.
    references : sequence of Reference
        One a recording; recordings of one condition share one.
    seed : int
        Of the exchanges that tell how likely the gap is between repeats.

    Returns
    -------
    Gap

    Examples
    --------
    >>> from noise.diagnosis.floor import reference
    >>> from noise.diagnosis.signature import NAMES
    >>> runs = np.random.default_rng(0).normal(size=(20, len(NAMES)))
    >>> repeats = reference(list(runs[:12]))
    >>> gap_of(list(runs[12:14] + 4.0), [repeats] * 2).p_value < 0.05
    True
    """
    squared = np.array([
        r.squared(r.deviation(s)) for s, r in zip(signatures, references, strict=True)
    ])  # fmt: skip
    rng = np.random.default_rng(seed)
    statistic, draws, farthest = 0.0, np.zeros(_N_DRAWN), True
    away, variance, freedom = 0.0, 0.0, math.inf
    for shared in {id(r): r for r in references}.values():
        own = [i for i, r in enumerate(references) if r is shared]
        exchanged = _exchanged(np.array([signatures[i] for i in own]), shared.repeats, rng)
        statistic += exchanged[0]
        draws += rng.choice(exchanged, _N_DRAWN)
        farthest = farthest and exchanged[0] >= exchanged.max()
        # Distances of repeats are about log-normal; recordings of a condition share its error.
        null = 0.5 * np.log(shared.null / shared.unit)
        away += float(np.sum(0.5 * np.log(squared[own]) - null.mean()))
        variance += len(own) ** 2 * float(null.var(ddof=1)) * (1.0 + 1.0 / null.size)
        freedom = min(freedom, null.size - 1.0)
    # ties, the case itself among them, count as being as far out
    as_far = int(np.sum(draws >= statistic - 1e-9 * abs(statistic)))
    p_value = (1.0 + as_far) / (_N_DRAWN + 1.0)
    if farthest:  # no exchange lies farther out, so that their number alone would set the value
        tail = float(students_t.sf(away / math.sqrt(variance + 1e-12), freedom))
        p_value = min(p_value, max(tail, 1.0 / (_N_DRAWN + 1.0)))
    return Gap(
        float(np.sqrt(np.mean(squared))), p_value, np.sqrt(squared),
        channel_distances(signatures, references),
    )  # fmt: skip


def _exchanged(own: Array, repeats: Array, rng: np.random.Generator) -> Array:
    """Sum of distances from the rest with the recordings, and then others, as the odd ones."""
    pool = np.concatenate([own, repeats])
    size, m = len(pool), len(own)
    if math.comb(size, m) <= _MOST_EXCHANGES:
        chosen = list(combinations(range(size), m))
    else:
        drawn = [tuple(rng.permutation(size)[:m].tolist()) for _ in range(_MOST_EXCHANGES)]
        chosen = [tuple(range(m)), *drawn]
    sums = []
    for odd in chosen:
        mean, scale = moments(np.delete(pool, odd, axis=0))
        sums.append(sum(math.sqrt(squared_distance((pool[j] - mean) / scale)) for j in odd))
    return np.array(sums)


def channel_distances(signatures: Sequence[Array], references: Sequence[Reference]) -> Array:
    """Distance of each recording from its repeats, channel by channel.

    The torque's cycle counts as torque.

    Parameters
    ----------
    signatures : sequence of ndarray, shape (n_values,)
        One per recording, as of `noise.diagnosis.signature.signature`.
    references : sequence of Reference
        One a recording.

    Returns
    -------
    ndarray, shape (n_recordings, n_kinds)
        In units of what repeats differ by in the channel, `KINDS` [-]; NaN where there is none.

    Examples
    --------
    >>> from noise.diagnosis.floor import reference
    >>> from noise.diagnosis.signature import NAMES
    >>> runs = np.random.default_rng(0).normal(size=(13, len(NAMES)))
    >>> runs[12, : len(NAMES) // 4] += 8.0
    >>> torque, *others = channel_distances([runs[12]], [reference(list(runs[:12]))])[0]
    >>> bool(torque > 2.0), bool(max(others) < 1.5)
    (True, True)
    """
    floors: dict[int, Array] = {}
    rows = []
    for values, one in zip(signatures, references, strict=True):
        if id(one) not in floors:
            each = [channel_costs(one.deviation(repeat)) for repeat in one.repeats]
            n = len(each)
            # a repeat that is one of those the mean is of lies nearer to it than another would
            floors[id(one)] = np.mean(each, axis=0) * (n + 1.0) / (n - 1.0)
        rows.append(np.sqrt(channel_costs(one.deviation(values)) / floors[id(one)]))
    return np.array(rows)
