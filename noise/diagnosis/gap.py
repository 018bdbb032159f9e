"""Distance of a recording from repeats, in units of what repeats differ by.

Stick-slip is chaotic: two runs of one rig agree in no waveform, but in what they are made of. So a
recording has a signature, the levels of each channel in sixth octaves and the statistics of the
torque's slips.

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

The floor of a case is what its own repeats differ by, beside what simulated repeats do. These
scatter as rigs are assumed to. The recordings know better: two of one condition differ by what this
rig's repeats differ by, and where none was repeated, blocks of a recording tell at least how steady
it is. Recordings that differ by more than simulated repeats widen the floor in proportion; such
that differ by less do not narrow it, since two runs on one afternoon say little of the next
assembly.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.stats import t as students_t

from features.kernels.levels import band_power
from features.kernels.spectra import welch
from models.recording import Recording
from noise.base.arrays import Array
from noise.diagnosis.evidence.channel_summary import USABLE
from noise.diagnosis.simulated.repeats import condition_key

KINDS = ("torque", "acceleration", "pressure")
"""Kinds of channel that have a signature; of each the first channel counts."""

_PER_OCTAVE = 6
_LOWEST, _HIGHEST = 50.0, 8000.0
_RESOLUTION = 12.0
"""Of the spectra [Hz]; the lowest bands share their lines with their neighbours; assumed."""

_SENSOR_NOISE = {"torque": 0.025, "acceleration": 0.1, "pressure": 4e-3}
"""White noise from 0 to 15 kHz, rms in the channel's unit, five times that of good sensors: added
to all bands, so that what lies below it does not count; assumed."""

_NOISE_BAND = 15e3

_CORNER = 500.0
"""Below which that noise rises as 1/f, as amplifiers' and rooms' does [Hz]; assumed."""

_N_BANDS = math.floor(_PER_OCTAVE * math.log2(_HIGHEST / _LOWEST))
EDGES = _LOWEST * 2.0 ** (np.arange(_N_BANDS + 1) / _PER_OCTAVE)
"""Of the bands, shape (n_bands + 1,) [Hz]."""

_STATISTICS = ("mean", "spread", "slow", "skewness", "highest", "lowest", "steepest_fall")
"""Of the torque: logarithm of its mean, its standard deviation and that of its slow part over the
mean, skewness, its highest and lowest thousandth over the mean, and the steepest fall."""

GROUPS = (*KINDS, "cycle")
"""Parts of a signature that weigh alike in a distance: three spectra, and the torque's cycle."""

NAMES = (
    *(f"{kind}_{round(low)}" for kind in KINDS for low in EDGES[:-1].tolist()),
    *(f"cycle_{name}" for name in _STATISTICS),
)
"""Of the values of a signature."""


_GROUP_OF = np.array([GROUPS.index(name.split("_")[0]) for name in NAMES])
"""Index into `GROUPS` of each value of a signature."""


def signature(recording: Recording) -> Array:
    """Describe a recording by what does not depend on phases.

    Parameters
    ----------
    recording : Recording
        In physical units.

    Returns
    -------
    ndarray, shape (n,)
        By `NAMES`: levels in nepers (a tenth is 0.87 dB), so that they compare with relative
        errors; NaN where a channel is missing or its rate does not reach a band.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> run = simulate(load_material_rig("fluorocarbon-thesis"), 2.5, seconds=0.4)
    >>> values = signature(run.recording)
    >>> values.shape == (len(NAMES),), bool(np.isfinite(values).all())
    (True, True)
    """
    values = np.full(len(NAMES), np.nan)
    for i, kind in enumerate(KINDS):
        if (row := recording.first(kind)) is not None:
            signal, rate = recording.samples[row], recording.rate
            values[i * _N_BANDS : (i + 1) * _N_BANDS] = _levels(signal, rate, kind)
            if kind == "torque":
                values[len(KINDS) * _N_BANDS :] = _cycle(signal, rate)
    return values


def _levels(signal: Array, rate: float, kind: str) -> Array:
    spectrum = welch(signal - signal.mean(), rate, _RESOLUTION)
    power = band_power(spectrum, EDGES[:-1], EDGES[1:])
    power[EDGES[1:] > USABLE * rate] = np.nan
    lines = np.diff(EDGES) + _CORNER * np.diff(np.log(EDGES))
    noise = _SENSOR_NOISE[kind] ** 2 * lines / _NOISE_BAND
    return np.asarray(0.5 * np.log(power + noise))


def _cycle(torque: Array, rate: float) -> Array:
    mean, spread = float(torque.mean()), float(torque.std())
    scale = abs(mean) + 1e-9
    block = max(1, round(0.02 * rate))
    slow = torque[: torque.size // block * block].reshape(-1, block).mean(axis=1)
    low, high = np.quantile(torque, (0.001, 0.999))
    step = max(1, round(2e-4 * rate))
    fall = float(np.min(torque[step:] - torque[:-step]))
    skewness = float(np.mean((torque - mean) ** 3)) / (spread**3 + 1e-12)
    return np.array([
        math.log(scale), spread / scale, float(slow.std()) / scale, skewness,
        float(high) / scale, float(low) / scale, fall / scale,
    ])  # fmt: skip


_BLOCK = 0.25
"""Shortest block of a recording that has a signature of its own [s]; assumed."""

_MOST_BLOCKS = 16
_FEWEST_BLOCKS = 3


def block_signatures(recording: Recording) -> Array | None:
    """Describe each block of a recording.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    ndarray, shape (n_blocks, n_values), or None
        None where the recording is too short for three; as of `signature`.
    """
    count = min(int(recording.duration / _BLOCK + 1e-6), _MOST_BLOCKS)
    if count < _FEWEST_BLOCKS:
        return None
    n = recording.samples.shape[1] // count
    return np.array([
        signature(replace(recording, samples=recording.samples[:, i * n : (i + 1) * n]))
        for i in range(count)
    ])  # fmt: skip


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

_MOST_EXCHANGES, _N_DRAWN = 200, 4000
"""Exchanges within one condition, of which as many are drawn where there are more, and those drawn
of all conditions together."""


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
            As of `noise.diagnosis.gap.signature`.

        Returns
        -------
        ndarray, shape (n_values,)
            [-]
        """
        return np.asarray((signature - self.mean) / self.scale)

    def squared(self, signature: Array) -> float:
        """Squared distance of a signature, 1 on average for a repeat.

        Parameters
        ----------
        signature : ndarray, shape (n_values,)
            As of `noise.diagnosis.gap.signature`.

        Returns
        -------
        float
            In squared floors [-].
        """
        return self.squared_of(self.deviation(signature))

    def squared_of(self, deviation: Array) -> float:
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
    of_channels : ndarray, shape (n_recordings, n_kinds)
        Distance of each recording in each kind of channel, in floors of its own; NaN where there
        is none [-].
    """

    distance: float
    p_value: float
    of_recordings: Array
    of_channels: Array


def reference(signatures: Sequence[Array]) -> Reference:
    """Make a reference of the signatures of at least three repeats.

    In a distance whole spectra scatter by 3 % at least, whatever these repeats say; p-values come
    of the repeats as they are.

    Parameters
    ----------
    signatures : sequence of ndarray, shape (n_values,)
        One per repeat, as of `noise.diagnosis.gap.signature`.

    Examples
    --------
    >>> from noise.diagnosis.gap import NAMES
    >>> rng = np.random.default_rng(0)
    >>> repeats = reference(list(rng.normal(size=(8, len(NAMES)))))
    >>> repeats.null.shape, 0.5 < repeats.squared(rng.normal(size=len(NAMES))) < 2.0
    ((8,), True)
    """
    exchanged = np.array(signatures)
    s = with_least_scatter(exchanged)
    null = np.empty(len(s))
    for i in range(len(s)):
        mean, scale = _moments(np.delete(s, i, axis=0))
        null[i] = _squared((s[i] - mean) / scale)
    mean, scale = _moments(s)
    return Reference(mean, scale, null, exchanged)


def gap_of(signatures: Sequence[Array], references: Sequence[Reference], *, seed: int = 0) -> Gap:
    """Gap between recordings and their references.

    Parameters
    ----------
    signatures : sequence of ndarray, shape (n_values,)
        One per recording, as of `noise.diagnosis.gap.signature`.
    references : sequence of Reference
        One a recording; recordings of one condition share one.
    seed : int
        Of the exchanges that tell how likely the gap is between repeats.

    Returns
    -------
    Gap

    Examples
    --------
    >>> from noise.diagnosis.gap import NAMES
    >>> runs = np.random.default_rng(0).normal(size=(20, len(NAMES)))
    >>> repeats = reference(list(runs[:12]))
    >>> gap_of(list(runs[12:14] + 4.0), [repeats] * 2).p_value < 0.05
    True
    """
    squared = np.array([r.squared(s) for s, r in zip(signatures, references, strict=True)])
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


def with_least_scatter(signatures: Array) -> Array:
    """Shift whole spectra of repeats so that none scatters by less than repeats always do.

    Parameters
    ----------
    signatures : ndarray, shape (n_repeats, n_values)
        As of `noise.diagnosis.gap.signature`.

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
    rng = np.random.default_rng(0)
    s = signatures.copy()
    for i in range(len(KINDS)):
        inside = (i == _GROUP_OF) & np.isfinite(s).all(axis=0)
        if inside.any():
            lacking = LEAST_SCALE**2 - float(s[:, inside].var(axis=0, ddof=1).mean())
            if lacking > 0.0:
                s[:, inside] += math.sqrt(lacking) * rng.standard_normal((len(s), 1))
    return s


def group_costs(deviation: Array) -> Array:
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


def _bent(deviation: Array) -> Array:
    size = np.abs(deviation)
    return np.where(size <= _BEND, size**2, _BEND * (2.0 * size - _BEND))


def _exchanged(own: Array, repeats: Array, rng: np.random.Generator) -> Array:
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


def _moments(s: Array) -> tuple[Array, Array]:
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


def _squared(deviation: Array) -> float:
    return float(np.nanmean(group_costs(deviation)))


def closed_fraction(before: float, after: float, floor: float = 1.0) -> float:
    """Share of what lies above the floor that is closed; negative where the gap grew [-].

    Parameters
    ----------
    before, after, floor : float
        Gaps without and with a change, and that of repeats, all in floors [-].

    Examples
    --------
    >>> closed_fraction(3.0, 1.5)
    0.75
    """
    return (before - after) / (before - floor)


_LIKE_THE_MOST = 0.5
"""Share of the largest deviation from which on others are as large; assumed."""


def channel_distances(signatures: Sequence[Array], references: Sequence[Reference]) -> Array:
    """Distance of each recording from its repeats, channel by channel.

    The torque's cycle counts as torque.

    Parameters
    ----------
    signatures : sequence of ndarray, shape (n_values,)
        One per recording, as of `noise.diagnosis.gap.signature`.
    references : sequence of Reference
        One a recording.

    Returns
    -------
    ndarray, shape (n_recordings, n_kinds)
        In units of what repeats differ by in the channel, `KINDS` [-]; NaN where there is none.

    Examples
    --------
    >>> from noise.diagnosis.gap import reference
    >>> from noise.diagnosis.gap import NAMES
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
    >>> from noise.diagnosis.gap import NAMES
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
        Of the recordings, as of `noise.diagnosis.gap.signature`.
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
    each = wider[_GROUP_OF]
    references = {}
    for key in own:
        s = np.array(repeats[key])
        mean = s.mean(axis=0)
        references[key] = reference(list(mean + each * (s - mean)))
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
        One for each of `noise.diagnosis.gap.GROUPS`, at least 1; all 1 where recorded
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
    if np.nanmean(recorded) <= np.quantile(by_chance, _WIDENS_FROM):
        return np.ones(len(GROUPS))
    ratio = np.sqrt(_mean(recorded) / _mean(simulated.reshape(-1, len(GROUPS))))
    return np.fmax(ratio, 1.0)


def _mean(rows: Array) -> Array:
    """Mean of the columns, NaN where nothing is known."""
    known = np.isfinite(rows)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(known, rows, 0.0).sum(axis=0) / known.sum(axis=0))
