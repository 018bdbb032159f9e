"""The floor of a case: what its own repeats differ by, beside what simulated repeats do.

Simulated repeats scatter as rigs are assumed to. The recordings know better: two of one condition
differ by what this rig's repeats differ by, and where none was repeated, blocks of a recording tell
at least how steady it is. Recordings that differ by more than simulated repeats widen the floor in
proportion; such that differ by less do not narrow it, since two runs on one afternoon say little
of the next assembly.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from models.recording import Recording
from noise.base.arrays import Array
from noise.diagnosis.gap.distance import (
    EDGES,
    GROUPS,
    KINDS,
    LEAST_SCALE,
    Gap,
    Reference,
    block_signatures,
    gap_of,
    group_costs,
    group_of,
    reference,
    signature,
    with_least_scatter,
)
from noise.diagnosis.simulated.repeats import condition_key

_LIKE_THE_MOST = 0.5
"""Share of the largest deviation from which on others are as large; assumed."""


def channel_distances(signatures: Sequence[Array], references: Sequence[Reference]) -> Array:
    """Distance of each recording from its repeats, channel by channel.

    The torque's cycle counts as torque.

    Parameters
    ----------
    signatures : sequence of ndarray, shape (n_values,)
        One per recording, as of `noise.diagnosis.gap.distance.signature`.
    references : sequence of Reference
        One a recording.

    Returns
    -------
    ndarray, shape (n_recordings, n_kinds)
        In units of what repeats differ by in the channel, `KINDS` [-]; NaN where there is none.

    Examples
    --------
    >>> from noise.diagnosis.gap.distance import reference
    >>> from noise.diagnosis.gap.distance import NAMES
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
            each = [_costs(one.deviation(repeat)) for repeat in one.repeats]
            n = len(each)
            # a repeat that is one of those the mean is of lies nearer to it than another would
            floors[id(one)] = np.mean(each, axis=0) * (n + 1.0) / (n - 1.0)
        rows.append(np.sqrt(_costs(one.deviation(values)) / floors[id(one)]))
    return np.array(rows)


def worst_places(deviations: Array) -> tuple[tuple[str, ...], tuple[float, float]]:
    """Tell in which channels and band deviations are largest.

    Parameters
    ----------
    deviations : ndarray, shape (n_recordings, n_values)
        In standard deviations of repeats [-].

    Returns
    -------
    channels : tuple of str
    band : (float, float)
        Of the bands of the first of them [Hz].

    Examples
    --------
    >>> from noise.diagnosis.gap.distance import NAMES
    >>> off = np.ones((2, len(NAMES)))
    >>> off[:, [NAMES.index(f"pressure_{f}") for f in (400, 449, 504)]] = 30.0
    >>> channels, (low, high) = worst_places(off)
    >>> channels, round(low), round(high)
    (('pressure',), 400, 566)
    """
    costs = np.array([_costs(row) for row in deviations])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # channels that were not recorded
        of_channels = np.sqrt(np.nanmean(costs, axis=0))
        size = np.sqrt(np.nanmean(deviations**2, axis=0))
    known = np.nan_to_num(of_channels)
    order = np.argsort(-known)
    worst = int(order[0])
    channels = tuple(KINDS[i] for i in order if known[i] >= _LIKE_THE_MOST * known[worst])
    inside = np.nan_to_num(size[worst == _GROUP_OF])
    bands = np.flatnonzero(inside >= _LIKE_THE_MOST * inside.max())
    return channels, (float(EDGES[bands[0]]), float(EDGES[bands[-1] + 1]))


def _costs(deviation: Array) -> Array:
    """Mean cost of each of `KINDS`, the torque's with that of its cycle."""
    *channels, cycle = group_costs(deviation)
    torque = KINDS.index("torque")
    if np.isfinite(cycle):
        channels[torque] = 0.5 * (channels[torque] + cycle)
    return np.array(channels)


N_REPEATS = 12
"""Simulated repeats a condition; what a diagnosis may cost settles it; assumed."""

_UNUSUAL = 0.99
"""Quantile of simulated repeats' differences beyond which recorded ones widen the floor;
assumed."""

_N_SETS, _N_DRAWS = 60, 400
"""Of repeats of one condition, and of such sets over all conditions."""


def repeat_gap(
    recordings: Sequence[Recording],
    repeats: Mapping[tuple[float, ...], Sequence[Array]],
    *,
    least: float = LEAST_SCALE,
    seed: int = 0,
) -> Gap:
    """Gap between recordings and repeats of their conditions, simulated or recorded.

    Parameters
    ----------
    recordings : sequence of Recording
    repeats : mapping of (float, float, float, float, float) to sequence of ndarray
        Signatures, shape (n_values,), of at least three repeats, by speed [rad/s], interference
        [m], support stiffness [Nm/rad], sampling rate [Hz] and length [s], as `condition_key` gives
        them.
    least : float
        As in `noise.diagnosis.gap.distance.reference`.
    seed : int

    Returns
    -------
    Gap
    """
    signatures = [signature(recording) for recording in recordings]
    references, widened = references_of(recordings, signatures, repeats, least=least, seed=seed)
    return replace(
        gap_of(signatures, references, seed=seed),
        widened=widened,
        of_channels=channel_distances(signatures, references),
    )


def references_of(
    recordings: Sequence[Recording],
    signatures: Sequence[Array],
    repeats: Mapping[tuple[float, ...], Sequence[Array]],
    *,
    least: float = LEAST_SCALE,
    seed: int = 0,
) -> tuple[list[Reference], float]:
    """Return what each recording is compared with: repeats, as far apart as the recordings' own.

    Parameters
    ----------
    recordings : sequence of Recording
    signatures : sequence of ndarray, shape (n_values,)
        Of the recordings, as of `noise.diagnosis.gap.distance.signature`.
    repeats, least, seed
        As of `repeat_gap`.

    Returns
    -------
    references : list of Reference
        One a recording; recordings of one condition share one.
    widened : float
        By how much the floor is wider than the repeats alone have it [-].
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
    each = wider[_GROUP_OF]
    references = {}
    for key in own:
        s = np.array(repeats[key])
        mean = s.mean(axis=0)
        references[key] = reference(list(mean + each * (s - mean)), least=least, seed=seed)
    return [references[condition_key(r)] for r in recordings], float(np.sqrt(np.mean(wider**2)))


def floor_widening(repeated: Sequence[tuple[Sequence[Array], Sequence[Array]]]) -> Array:
    """By how much the floor is wider than simulated repeats have it.

    Parameters
    ----------
    repeated : sequence of (sequence of ndarray, sequence of ndarray)
        For each condition, signatures, shape (n_values,), of its recordings, at least two, and of
        its simulated repeats, at least four; as of `repeat_gap`.

    Returns
    -------
    ndarray, shape (n_groups,)
        One for each of `noise.diagnosis.gap.distance.GROUPS`, at least 1; all 1 where recorded
        repeats differ by no more than simulated ones do 99 times out of 100.
    """
    rng = np.random.default_rng(0)
    sets = [_sets(np.array(own), with_least_scatter(np.array(s)), rng) for own, s in repeated]
    return _beyond(np.array([one[0] for one in sets]), np.array([one[1:] for one in sets]))


def _block_widening(alone: Sequence[tuple[Recording, Sequence[Array]]]) -> Array:
    """As `floor_widening`, were runs as unsteady as the blocks of a recording are."""
    recorded, simulated = [], []
    for recording, others in alone:
        blocks = block_signatures(recording)
        if blocks is None:
            continue
        s = with_least_scatter(np.array(others))
        spread = np.sqrt(s.var(axis=0, ddof=1) + LEAST_SCALE**2)
        error = np.sqrt(blocks.var(axis=0, ddof=1) / len(blocks))
        recorded.append(group_costs(error / spread))
        simulated.append([np.where(np.isfinite(recorded[-1]), 1.0, np.nan)])
    if not recorded:
        return np.ones(len(GROUPS))
    return _beyond(np.array(recorded), np.array(simulated))


def _sets(own: Array, simulated: Array, rng: np.random.Generator) -> Array:
    """How far the recordings differ by group, and after them as many drawn from all.

    Each set is measured by the scatter of those outside it, so that any might be the recordings.
    """
    pool = np.concatenate([own, simulated])
    m = len(own)
    drawn = [rng.permutation(len(pool))[:m] for _ in range(_N_SETS)]
    costs = np.empty((1 + _N_SETS, len(GROUPS)))
    for k, chosen in enumerate([np.arange(m), *drawn]):
        rest = np.delete(pool, chosen, axis=0)
        spread = np.sqrt(2.0 * (rest.var(axis=0, ddof=1) + LEAST_SCALE**2))
        pairs = [group_costs((pool[i] - pool[j]) / spread) for i, j in combinations(chosen, 2)]
        costs[k] = np.mean(pairs, axis=0)
    return costs


def _beyond(recorded: Array, simulated: Array) -> Array:
    """Ratio of what is recorded to what is simulated, root mean square, where that is unusual."""
    rng = np.random.default_rng(0)
    n_conditions, n_sets = simulated.shape[:2]
    drawn = rng.integers(n_sets, size=(_N_DRAWS, n_conditions))
    by_chance = np.nanmean(simulated[np.arange(n_conditions), drawn], axis=(1, 2))
    if np.nanmean(recorded) <= np.quantile(by_chance, _UNUSUAL):
        return np.ones(len(GROUPS))
    ratio = np.sqrt(_mean(recorded) / _mean(simulated.reshape(-1, len(GROUPS))))
    return np.fmax(ratio, 1.0)


def _mean(rows: Array) -> Array:
    """Mean of the columns, NaN where nothing is known."""
    known = np.isfinite(rows)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(known, rows, 0.0).sum(axis=0) / known.sum(axis=0))


_GROUP_OF = group_of()
