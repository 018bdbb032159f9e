"""Floor of a gap: what repeats of a condition differ by, simulated and recorded.

Each value of a signature has a mean and a standard deviation over the simulated repeats of its
condition. The floor is the distance of a repeat from the others, each left out once.

Simulated repeats scatter as rigs are assumed to. The recordings know better: two of one condition
differ by what this rig's repeats differ by, and where none was repeated, blocks of a recording tell
at least how steady it is. Recordings that differ by more than simulated repeats widen the floor in
proportion; such that differ by less do not narrow it, since two runs on one afternoon say little of
the next assembly.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from models.recording import Recording
from noise.base.arrays import Array
from noise.diagnosis.signature import (
    GROUP_OF,
    GROUPS,
    KINDS,
    block_signatures,
    group_costs,
    squared_distance,
)
from noise.diagnosis.simulated.repeats import condition_key

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

    mean: Array
    scale: Array
    null: Array
    repeats: Array

    def deviation(self, signature: Array) -> Array:
        """How many standard deviations each value lies from the mean.

        Parameters
        ----------
        signature : ndarray, shape (n_values,)
            As of `noise.diagnosis.signature.signature`.

        Returns
        -------
        ndarray, shape (n_values,)
            [-]
        """
        return np.asarray((signature - self.mean) / self.scale)

    def squared(self, deviation: Array) -> float:
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
        return squared_distance(deviation) / self.unit

    @property
    def unit(self) -> float:
        """Mean squared distance of repeats, in which distances are given [-]."""
        # one repeat in a hundred falls into another regime, and must not set the unit
        return float(np.mean(np.minimum(self.null, _UNUSUAL * np.median(self.null))))


def reference(signatures: Sequence[Array]) -> Reference:
    """Make a reference of the signatures of at least three repeats.

    In a distance whole spectra scatter by 3 % at least, whatever these repeats say; p-values come
    of the repeats as they are.

    Parameters
    ----------
    signatures : sequence of ndarray, shape (n_values,)
        One per repeat, as of `noise.diagnosis.signature.signature`.

    Examples
    --------
    >>> from noise.diagnosis.signature import NAMES
    >>> rng = np.random.default_rng(0)
    >>> repeats = reference(list(rng.normal(size=(8, len(NAMES)))))
    >>> repeats.null.shape, 0.5 < repeats.squared(rng.normal(size=len(NAMES))) < 2.0
    ((8,), True)
    """
    exchanged = np.array(signatures)
    s = with_least_scatter(exchanged)
    others = [moments(np.delete(s, i, axis=0)) for i in range(len(s))]
    null = [
        squared_distance((x - mean) / scale) for x, (mean, scale) in zip(s, others, strict=True)
    ]
    return Reference(*moments(s), np.array(null), exchanged)


def with_least_scatter(signatures: Array) -> Array:
    """Shift whole spectra of repeats so that none scatters by less than repeats always do.

    Parameters
    ----------
    signatures : ndarray, shape (n_repeats, n_values)
        As of `noise.diagnosis.signature.signature`.

    Returns
    -------
    ndarray, shape (n_repeats, n_values)
        As `signatures`.

    Examples
    --------
    >>> same = np.zeros((40, len(GROUP_OF)))
    >>> 0.02 < float(with_least_scatter(same)[:, 0].std()) < 0.04
    True
    """
    rng = np.random.default_rng(0)
    s = signatures.copy()
    for i in range(len(KINDS)):
        inside = (i == GROUP_OF) & np.isfinite(s).all(axis=0)
        if inside.any():
            lacking = LEAST_SCALE**2 - float(s[:, inside].var(axis=0, ddof=1).mean())
            if lacking > 0.0:
                s[:, inside] += math.sqrt(lacking) * rng.standard_normal((len(s), 1))
    return s


def moments(s: Array) -> tuple[Array, Array]:
    """Return mean and scale of signatures of repeats, shape (n_repeats, n_values).

    The scale is what one more repeat differs from the mean by.
    """
    variance = s.var(axis=0, ddof=1)
    kernel = np.ones(2 * _NEIGHBOURS + 1)
    smooth = variance.copy()  # of the cycle, whose quantities of several kinds have no neighbours
    for i in range(len(KINDS)):
        inside = i == GROUP_OF
        known = np.isfinite(variance[inside])
        total = np.convolve(np.where(known, variance[inside], 0.0), kernel, mode="same")
        count = np.convolve(known.astype(float), kernel, mode="same")
        smooth[inside] = total / np.maximum(count, 1.0)
    scale = np.sqrt(0.5 * variance + 0.5 * smooth + LEAST_SCALE**2)
    return s.mean(axis=0), scale * np.sqrt(1.0 + 1.0 / len(s))


_WIDENS_FROM = 0.99
"""Quantile of simulated repeats' differences beyond which recorded ones widen the floor;
assumed."""

_N_SETS, _N_DRAWS = 60, 400
"""Of repeats of one condition, and of such sets over all conditions."""


def references_of(
    recordings: Sequence[Recording],
    signatures: Sequence[Array],
    repeats: Mapping[tuple[float, ...], Sequence[Array]],
) -> list[Reference]:
    """Return what each recording is compared with: repeats, as far apart as the recordings' own.

    Parameters
    ----------
    recordings : sequence of Recording
    signatures : sequence of ndarray, shape (n_values,)
        Of the recordings, as of `noise.diagnosis.signature.signature`.
    repeats : mapping of (float, float, float, float, float) to sequence of ndarray
        Signatures, shape (n_values,), of at least three repeats, by speed [rad/s], interference
        [m], support stiffness [Nm/rad], sampling rate [Hz] and length [s], as `condition_key` gives
        them.

    Returns
    -------
    list of Reference
        One a recording; recordings of one condition share one.
    """
    own: dict[tuple[float, ...], list[Array]] = {}
    for recording, values in zip(recordings, signatures, strict=True):
        own.setdefault(condition_key(recording), []).append(values)
    pairs = [(own[key], repeats[key]) for key in own if len(own[key]) > 1]
    if pairs:
        wider = floor_widening(pairs)
    else:
        first = {condition_key(r): r for r in reversed(recordings)}
        wider = _block_widening([(r, repeats[key]) for key, r in first.items()])
    references = {}
    for key in own:
        s = np.array(repeats[key])
        mean = s.mean(axis=0)
        references[key] = reference(list(mean + wider[GROUP_OF] * (s - mean)))
    return [references[condition_key(r)] for r in recordings]


def floor_widening(repeated: Sequence[tuple[Sequence[Array], Sequence[Array]]]) -> Array:
    """By how much the floor is wider than simulated repeats have it.

    Parameters
    ----------
    repeated : sequence of (sequence of ndarray, sequence of ndarray)
        For each condition, signatures, shape (n_values,), of its recordings, at least two, and of
        its simulated repeats, at least four; as of `references_of`.

    Returns
    -------
    ndarray, shape (n_groups,)
        One for each of `noise.diagnosis.signature.GROUPS`, at least 1; all 1 where recorded
        repeats differ by no more than simulated ones do 99 times out of 100.
    """
    rng = np.random.default_rng(0)
    sets = [_sets(np.array(own), with_least_scatter(np.array(s)), rng) for own, s in repeated]
    return _beyond(np.array([one[0] for one in sets]), np.array([one[1:] for one in sets]))


def _block_widening(alone: Sequence[tuple[Recording, Sequence[Array]]]) -> Array:
    """As `floor_widening`, were runs as unsteady as the blocks of a recording are."""
    recorded = []
    for recording, others in alone:
        blocks = block_signatures(recording)
        if blocks is not None:
            s = with_least_scatter(np.array(others))
            spread = np.sqrt(s.var(axis=0, ddof=1) + LEAST_SCALE**2)
            error = np.sqrt(blocks.var(axis=0, ddof=1) / len(blocks))
            recorded.append(group_costs(error / spread))
    if not recorded:
        return np.ones(len(GROUPS))
    simulated = np.where(np.isfinite(recorded), 1.0, np.nan)
    return _beyond(np.array(recorded), simulated[:, None])


def _sets(own: Array, simulated: Array, rng: np.random.Generator) -> Array:
    """How far the recordings differ by group, and after them as many drawn from all.

    Each set is measured by the scatter of those outside it, so that any might be the recordings.
    """
    pool = np.concatenate([own, simulated])
    m = len(own)
    drawn = [rng.permutation(len(pool))[:m] for _ in range(_N_SETS)]
    costs = []
    for chosen in [np.arange(m), *drawn]:
        rest = np.delete(pool, chosen, axis=0)
        spread = np.sqrt(2.0 * (rest.var(axis=0, ddof=1) + LEAST_SCALE**2))
        pairs = [group_costs((pool[i] - pool[j]) / spread) for i, j in combinations(chosen, 2)]
        costs.append(np.mean(pairs, axis=0))
    return np.array(costs)


def _beyond(recorded: Array, simulated: Array) -> Array:
    """Ratio of what is recorded to what is simulated, root mean square, where that is unusual."""
    rng = np.random.default_rng(0)
    n_conditions, n_sets = simulated.shape[:2]
    drawn = rng.integers(n_sets, size=(_N_DRAWS, n_conditions))
    by_chance = np.nanmean(simulated[np.arange(n_conditions), drawn], axis=(1, 2))
    if np.nanmean(recorded) <= np.quantile(by_chance, _WIDENS_FROM):
        return np.ones(len(GROUPS))
    ratio = np.sqrt(_mean(recorded) / _mean(simulated.reshape(-1, len(GROUPS))))
    return np.fmax(ratio, 1.0)


def _mean(rows: Array) -> Array:
    """Mean of the columns, NaN where nothing is known."""
    known = np.isfinite(rows)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(known, rows, 0.0).sum(axis=0) / known.sum(axis=0))
