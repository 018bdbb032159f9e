"""Evidence of a case: some five hundred numbers per recording, and one row per case.

A *case* is what a user brings: recordings of one rig at several conditions, and its rig file. Each
number is computed from the recording and from simulated repeats of its condition.

The posterior needs one row per case. First each number of a recording becomes a deviation: its
difference from the simulation with the rig file, divided by its scatter on this bench. The scatter
combines the differences between simulated repeats (pooled over all conditions of the case, since
there are few per condition) and the scatter that gains and hammer tests add on quiet benches
(`scale`). Then the deviations are summarised over the recordings of the case: median difference in
its own unit and in units of the scatter, mean in units of its standard error, spread, largest
value, trend with speed, and difference between repeats of one condition. The row also holds the
measured values and a few numbers on the bench: sensors, lengths, responses, law, listed effects.
"""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition, known_condition, same_support
from models.recording import Recording
from models.rig import Rig
from models.transfer_functions.transfer_function import TransferFunction
from noise.base.arrays import Array
from noise.diagnosis.evidence.channel_summary import (
    band_levels,
    channel_summary,
    common_residual,
    hum_summary,
    path_summary,
)
from noise.diagnosis.evidence.contact_summary import contact_summary, slip_starts
from noise.diagnosis.evidence.reconstruction import (
    angle_summary,
    closed_spectrum,
    reconstruct,
    shaft_speed,
)
from noise.diagnosis.simulated.repeats import CHANNELS, condition_key, nominal_repeats
from noise.diagnosis.simulated.transfer_functions import (
    OUTPUTS,
    TransferFunctionCache,
    predict_outputs,
)
from sim.acquisition import Acquisition
from sim.bushing import lumped_bushing
from sim.effects.effect import Effect

Numbers = dict[str, float]

N_REPEATS = 3
"""Simulated repeats per condition; a compromise with computing time; assumed."""


@dataclass(frozen=True, eq=False)
class CaseTable:
    """The numbers of a case.

    Parameters
    ----------
    names : tuple of str
        Names of the columns.
    measured, nominal, scatter : ndarray, shape (n_recordings, n_numbers)
        Numbers of the recordings; mean and standard deviation of simulated repeats. NaN where
        undefined [unit of the number].
    conditions : tuple of Condition
    rate : float
        Sampling rate of the recordings, the median where they differ [Hz].
    bench : mapping of str to float
        As `bench_context` returns it.
    """

    names: tuple[str, ...]
    measured: Array
    nominal: Array
    scatter: Array
    conditions: tuple[Condition, ...]
    rate: float
    bench: Mapping[str, float] = field(default_factory=dict)


def summary(
    recording: Recording, rig: Rig, transfer_functions: Mapping[str, TransferFunction]
) -> Numbers:
    """Summarise a recording, given the rig of its rig file.

    Parameters
    ----------
    recording : Recording
        With speed, interference and support stiffness in its condition.
    rig : Rig
    transfer_functions : mapping of str to TransferFunction
        As `torque_transfer_functions` returns them.

    Returns
    -------
    dict of str to float
        Numbers that need a missing channel are left out [unit of the number].
    """
    condition, rate = known_condition(recording.condition), recording.rate
    signal = signals_of(recording)
    numbers: Numbers = {}
    # Torque and motion change sign together, so a shaft that turns backwards is mirrored.
    turn, wanted = math.copysign(1.0, condition.speed), abs(condition.speed)
    speed = np.full(recording.samples.shape[1], wanted)
    if "angle" in signal:
        numbers |= _named("angle", angle_summary(turn * signal["angle"], wanted, rate))
        speed = shaft_speed(turn * signal["angle"], rate)
    for kind in ("torque", *OUTPUTS):
        if kind in signal:
            numbers |= _named(kind, channel_summary(signal[kind], rate))
            numbers |= _named(f"{kind}_raw", hum_summary(signal[kind], rate))
            numbers |= _named(kind, band_levels(signal[kind], rate))
    if "torque" not in signal:
        return numbers
    torque = signal["torque"]
    bushing = lumped_bushing(rig, condition.interference, condition.support_stiffness)
    spectrum = closed_spectrum(torque, rate)
    motion = reconstruct(turn * torque, speed, rate, bushing, turn * spectrum)
    fit = rig.fit(condition.interference)
    numbers |= _named("contact", contact_summary(motion, fit, wanted))
    slips = slip_starts(motion, wanted)[0] / motion.rate + motion.start
    more, residuals = path_numbers(signal, spectrum, rate, transfer_functions, slips)
    numbers |= more
    for kind, residual in residuals.items():
        numbers |= _named(kind, hum_summary(residual, rate))
    if len(residuals) == len(OUTPUTS):
        numbers |= common_residual(residuals["acceleration"], residuals["pressure"], rate)
    return numbers


def signals_of(recording: Recording) -> dict[str, Array]:
    """Select the first channel of each kind.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    dict of str to ndarray, shape (n,)
        By kind of channel [unit of the channel].
    """
    return {
        kind: recording.samples[row]
        for kind in ("torque", *OUTPUTS, "angle")
        if (row := recording.first(kind)) is not None
    }


def path_numbers(
    signal: Mapping[str, Array],
    spectrum: NDArray[np.complex128],
    rate: float,
    transfer_functions: Mapping[str, TransferFunction],
    slips: Array,
) -> tuple[Numbers, dict[str, Array]]:
    """Compare acceleration and sound with their predictions from the measured torque.

    Parameters
    ----------
    signal : mapping of str to ndarray, shape (n,)
        By kind of channel [unit of the channel].
    spectrum : ndarray of complex
        Spectrum of the torque, as `closed_spectrum` returns it [Nm].
    rate : float
        Sampling rate [Hz].
    transfer_functions : mapping of str to TransferFunction
        As `torque_transfer_functions` returns them.
    slips : ndarray, shape (n_slips,)
        Times at which the contact begins to slip [s].

    Returns
    -------
    dict of str to float
        [unit of the number]
    dict of str to ndarray, shape (n,)
        Measured less predicted, by kind of channel [unit of the channel].
    """
    numbers: Numbers = {}
    residuals = {}
    paths = {kind: transfer_functions[kind] for kind in OUTPUTS if kind in signal}
    for kind, expected in predict_outputs(spectrum, signal["torque"].size, rate, paths).items():
        path, residuals[kind] = path_summary(expected, signal[kind], rate, slips)
        numbers |= _named(kind, path)
    return numbers, residuals


@dataclass(frozen=True, eq=False)
class NominalNumbers:
    """Numbers of simulated repeats of a rig; each condition is simulated once and stored.

    Parameters
    ----------
    rig : Rig
    library : mapping of str to Effect, optional
        Definitions of the effects of the rig, by name.
    seed : int
        Seed of the repeats.
    """

    rig: Rig
    library: Mapping[str, Effect] | None = None
    seed: int = 0
    _moments: dict[tuple[object, ...], tuple[Numbers, Numbers]] = field(default_factory=dict)

    @cached_property
    def transfer_functions(self) -> TransferFunctionCache:
        """Transfer functions of the rig."""
        return TransferFunctionCache(self.rig, self.library)

    def moments(self, recording: Recording) -> tuple[Numbers, Numbers]:
        """Mean and standard deviation over simulated repeats of a recording's condition."""
        key = (*condition_key(recording), recording.channel_names)
        if key not in self._moments:
            # Each condition has its own perturbed rigs: a shared one would err alike in all.
            seeds = np.random.SeedSequence([self.seed, len(self._moments)]).generate_state(
                N_REPEATS
            )
            repeats = nominal_repeats(
                recording, self.rig, self.transfer_functions, seeds.tolist(), library=self.library
            )
            transfer_functions = self.transfer_functions.whole(recording)
            alike = [same_channels(repeat, recording) for repeat in repeats]
            self._moments[key] = _mean_and_deviation(
                [summary(x, self.rig, transfer_functions) for x in alike]
            )
        return self._moments[key]


def case_table(
    recordings: Sequence[Recording],
    rig: Rig,
    *,
    library: Mapping[str, Effect] | None = None,
    seed: int = 0,
    nominal: NominalNumbers | None = None,
) -> CaseTable:
    """Summarise the recordings of a case, and simulated repeats of each condition.

    Parameters
    ----------
    recordings : sequence of Recording
    rig : Rig
    library : mapping of str to Effect, optional
        Definitions of the effects of the rig, by name.
    seed : int
        Seed of the repeats.
    nominal : NominalNumbers, optional
        Repeats of this rig that other cases have simulated already.

    Returns
    -------
    CaseTable
    """
    nominal = nominal or NominalNumbers(rig, library, seed)
    rows = [
        summary(recording, rig, nominal.transfer_functions.whole(recording))
        for recording in recordings
    ]
    means, spreads = zip(*(nominal.moments(recording) for recording in recordings), strict=True)
    names = tuple(sorted({name for row in (*rows, *means) for name in row}))

    def table(numbers: Sequence[Numbers]) -> Array:
        return np.array([[row.get(name, math.nan) for name in names] for row in numbers])

    return CaseTable(
        names,
        table(rows),
        table(means),
        table(spreads),
        tuple(recording.condition for recording in recordings),
        float(np.median([recording.rate for recording in recordings])),
        bench_context(rig, recordings),
    )


def same_channels(repeat: Recording, recording: Recording) -> Recording:
    """Return a repeat without the channels that a recording lacks.

    Parameters
    ----------
    repeat, recording : Recording

    Returns
    -------
    Recording
        The repeat, with the kinds of channel that `recording` has.
    """
    rows = [i for i, c in enumerate(repeat.channels) if recording.first(c.kind) is not None]
    return replace(
        repeat, samples=repeat.samples[rows], channels=tuple(repeat.channels[i] for i in rows)
    )


def _mean_and_deviation(repeats: Sequence[Numbers]) -> tuple[Numbers, Numbers]:
    names = list(dict.fromkeys(name for numbers in repeats for name in numbers))
    values = np.array([[numbers.get(name, math.nan) for name in names] for numbers in repeats])
    mean, spread = column_moments(values)
    known = np.isfinite(mean)
    names = [name for name, it_is in zip(names, known.tolist(), strict=True) if it_is]
    return (
        dict(zip(names, mean[known].tolist(), strict=True)),
        dict(zip(names, spread[known].tolist(), strict=True)),
    )


def column_moments(values: Array) -> tuple[Array, Array]:
    """Return mean and standard deviation of the finite values of each column.

    Parameters
    ----------
    values : ndarray, shape (n, n_columns)
        [unit of each column]

    Returns
    -------
    mean, spread : ndarray, shape (n_columns,)
        NaN without a finite value; the spread is NaN with only one [unit of the column].

    Examples
    --------
    >>> column_moments(np.array([[1.0, np.nan], [3.0, 5.0]]))
    (array([2., 5.]), array([1.41421356,        nan]))
    """
    known = np.isfinite(values)
    count = known.sum(axis=0)
    mean = np.where(known, values, 0.0).sum(axis=0) / np.maximum(count, 1)
    square = np.where(known, values - mean, 0.0) ** 2
    spread = np.sqrt(square.sum(axis=0) / np.maximum(count - 1, 1))
    return np.where(count > 0, mean, math.nan), np.where(count > 1, spread, math.nan)


def _named(kind: str, numbers: Numbers) -> Numbers:
    return {f"{kind}_{name}": value for name, value in numbers.items()}


CONTEXT = (
    *(f"{kind}_noise" for kind in CHANNELS), *(f"{kind}_step" for kind in CHANNELS),
    "seconds", "coherence", "constant_law", "listed",
)  # fmt: skip
"""Names of the numbers on the bench, in the order of the row."""

_BAND = (100.0, 3000.0)
"""Band of the coherence of a hammer test [Hz]; assumed."""


def bench_context(rig: Rig, recordings: Sequence[Recording]) -> dict[str, float]:
    """Describe the bench of a case in a few numbers.

    Parameters
    ----------
    rig : Rig
        With the sensors of the simulated repeats.
    recordings : sequence of Recording

    Returns
    -------
    dict of str to float
        Some or all of `CONTEXT`: logarithm of the noise over that of good sensors [-]; step of a
        converter over that noise [-]; length of a recording [s]; what the coherence of measured
        responses lacks of 1, or 1 without any [-]; whether the friction law is the constant one;
        number of listed effects.

    Examples
    --------
    >>> from models.recording import Channel, Recording
    >>> from models.rig_file import load_material_rig
    >>> run = Recording(np.zeros((1, 15_000)), 30e3, (Channel("torque"),))
    >>> bench_context(load_material_rig("fluorocarbon-thesis"), [run])
    {'seconds': 0.5, 'coherence': 1.0, 'constant_law': 1.0, 'listed': 0.0, 'torque_noise': 0.0, \
'torque_step': 0.0}
    """
    context = {
        "seconds": float(np.median([r.duration for r in recordings])),
        "coherence": lacking_coherence(rig, recordings),
        "constant_law": float(rig.friction.name == "coulomb"),
        "listed": float(len(rig.effects)),
    }
    for kind, usual in Acquisition().noise.items():
        if any(r.first(kind) is not None for r in recordings):
            sensor = rig.sensors.of(kind)
            level = usual if sensor.noise is None else sensor.noise
            context[f"{kind}_noise"] = math.log(max(level / usual, 1e-3))
            context[f"{kind}_step"] = sensor.step / usual
    return context


def lacking_coherence(rig: Rig, recordings: Sequence[Recording]) -> float:
    """Return what the median coherence of the measured responses lacks of 1.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Recording
        Only responses of their supports count.

    Returns
    -------
    float
        Of the response with the lowest coherence [-]: 0 where coherence was not stated, 1 where no
        response was measured.
    """
    supports = [r.condition.support_stiffness for r in recordings]
    responses = [
        response
        for entry in rig.measured
        if any(s is not None and same_support(s, entry.support_stiffness) for s in supports)
        for response in (entry.torque_to_acceleration, entry.torque_to_pressure)
        if response is not None
    ]
    if not responses:
        return 1.0
    lacking = [0.0]
    for response in responses:
        if response.coherence is not None:
            inside = (response.frequencies >= _BAND[0]) & (response.frequencies <= _BAND[1])
            if inside.any():
                lacking.append(1.0 - float(np.median(response.coherence[inside])))
    return max(lacking)


PARTS = ("middle", "sure", "spread", "largest", "with_speed", "repeats", "as_is")
"""Summaries of the deviations of a number over the recordings, in the order of the row."""

_COUNTS = ("recordings", "rate", "conditions")

MISSING = -999.0
"""Value of what is undefined in a case; a tree separates it by a split."""

LARGEST = 1e4
"""Limit of deviations [-]; assumed."""

_LEAST_SCALE = 1e-3
_LEAST_SHARE = 1e-2
"""Least scale of a number, as a share of its typical size [-]; assumed, as is the absolute least
scale."""

_OWN = 1.0 / 3.0
"""Weight of the scatter at the recording's own condition; the rest is that over all conditions
[-]; assumed."""


def evidence_names(names: Sequence[str]) -> tuple[str, ...]:
    """Names of the columns of `evidence`.

    Parameters
    ----------
    names : sequence of str
        Names of the numbers.

    Returns
    -------
    tuple of str
        ``part:number`` for each of `PARTS`; number of recordings, sampling rate, number of
        conditions; `CONTEXT`; and ``typical:number``.

    Examples
    --------
    >>> evidence_names(["torque_offset"])[0]
    'middle:torque_offset'
    """
    parts = (f"{part}:{name}" for part in PARTS for name in names)
    return (*parts, *_COUNTS, *CONTEXT, *(f"typical:{name}" for name in names))


def aligned(table: CaseTable, names: Sequence[str]) -> tuple[Array, ...]:
    """Return the numbers of a case in a given order.

    Parameters
    ----------
    table : CaseTable
    names : sequence of str

    Returns
    -------
    measured, nominal, scatter : ndarray, shape (n_recordings, n_names)
        NaN where the case has no such number [unit of the number].

    Examples
    --------
    >>> from noise.diagnosis.evidence.summary import CaseTable
    >>> one = np.ones((1, 1))
    >>> table = CaseTable(("a",), one, one, one, (), 30e3)
    >>> aligned(table, ["b", "a"])[0].tolist()
    [[nan, 1.0]]
    """
    columns = _columns(table.names, tuple(names))
    known = columns >= 0

    def chosen(rows: Array) -> Array:
        filled = np.full((len(rows), columns.size), np.nan)
        filled[:, known] = rows[:, columns[known]]
        return filled

    return chosen(table.measured), chosen(table.nominal), chosen(table.scatter)


@lru_cache(maxsize=64)
def _columns(of_table: tuple[str, ...], names: tuple[str, ...]) -> NDArray[np.int64]:
    """Return where names stand in a table; -1 where it has none of that name."""
    place = {name: i for i, name in enumerate(of_table)}
    return np.array([place.get(name, -1) for name in names], dtype=np.int64)


def scale_of(tables: Sequence[CaseTable], names: Sequence[str]) -> Array:
    """Return the scatter of each number beyond that of simulated repeats.

    Parameters
    ----------
    tables : sequence of CaseTable
        Cases without a cause on quiet benches. On others, repeats include the noise as well.
    names : sequence of str

    Returns
    -------
    ndarray, shape (n_names,)
        Half of the distance between the 16th and the 84th percentile, less the scatter of repeats
        in quadrature [unit of the number].
    """
    rows = [aligned(table, names) for table in tables]
    away = np.concatenate([measured - nominal for measured, nominal, _ in rows])
    levels = np.concatenate([measured for measured, _, _ in rows])
    repeats = np.concatenate([_pooled(scatter) for _, _, scatter in rows])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # numbers that no case has
        low, high = np.nanpercentile(away, [16.0, 84.0], axis=0)
        typical = np.nanmedian(np.abs(levels), axis=0)
        expected = np.nanmedian(repeats, axis=0)
    beyond = np.maximum((0.5 * (high - low)) ** 2 - np.nan_to_num(expected) ** 2, 0.0)
    least = _LEAST_SHARE * np.nan_to_num(typical, nan=1.0) + _LEAST_SCALE
    return np.asarray(np.maximum(np.nan_to_num(np.sqrt(beyond), nan=1.0), least))


def evidence(table: CaseTable, names: Sequence[str], scale: Array) -> NDArray[np.float32]:
    """Return a case as one row.

    Parameters
    ----------
    table : CaseTable
    names : sequence of str
        Names of the numbers.
    scale : ndarray, shape (n_names,)
        As `scale_of` returns it.

    Returns
    -------
    ndarray of float32, shape (n_columns,)
        Columns as in `evidence_names`; `MISSING` where undefined; deviations in units of the
        scatter [-], but ``middle`` and ``as_is`` in the unit of the number.
    """
    measured, nominal, scatter = aligned(table, names)
    away = measured - nominal
    expected = np.sqrt(_pooled(scatter) ** 2 + scale**2)
    z = away / expected
    speed = np.abs(np.array([c.speed for c in table.conditions], dtype=np.float64))
    fast, slow = speed >= np.median(speed), speed <= np.median(speed)
    size = np.where(np.isfinite(z), np.abs(z), -1.0)
    largest = np.take_along_axis(z, size.argmax(axis=0)[None], axis=0)[0]
    groups = _conditions(table)
    with np.errstate(invalid="ignore", over="ignore"):  # numbers without bounds
        parts = [
            _middle(away),
            standard_errors(z),
            np.sqrt(_mean(np.square(z - _mean(z)))),
            largest,
            _mean(z[fast]) - _mean(z[slow]),
            _between_repeats(groups, measured / expected),
            _middle(measured),
        ]
        typical = _middle(z)
    bench = [table.bench.get(name, np.nan) for name in CONTEXT]
    counts = [len(measured), table.rate, len(groups)]
    row = np.concatenate([*parts, counts, bench, typical])
    row = np.nan_to_num(row, nan=MISSING, posinf=LARGEST, neginf=-LARGEST)
    return np.asarray(np.clip(row, -LARGEST, LARGEST * 100.0), dtype=np.float32)


def deviations(table: CaseTable, names: Sequence[str], scale: Array) -> Array:
    """Return the deviations of a case from its nominal numbers, in units of their scatter.

    Parameters
    ----------
    table : CaseTable
    names : sequence of str
        Names of the numbers.
    scale : ndarray, shape (n_names,)
        As `scale_of` returns it.

    Returns
    -------
    ndarray, shape (n_recordings, n_names)
        In standard deviations [-]; NaN where a number is unknown.
    """
    measured, nominal, scatter = aligned(table, names)
    return np.asarray((measured - nominal) / np.sqrt(_pooled(scatter) ** 2 + scale**2))


def standard_errors(deviation: Array) -> Array:
    """Return the mean over recordings, in units of its standard error.

    Parameters
    ----------
    deviation : ndarray, shape (n_recordings, n_names)
        In standard deviations [-].

    Returns
    -------
    ndarray, shape (n_names,)
        [-], 0 without a finite value.

    Examples
    --------
    >>> standard_errors(np.array([[1.0, np.nan], [1.0, np.nan], [1.0, np.nan], [1.0, np.nan]]))
    array([2., 0.])
    """
    count = np.isfinite(deviation).sum(axis=0)
    return np.asarray(np.nansum(deviation, axis=0) / np.sqrt(np.maximum(count, 1)))


def _pooled(scatter: Array) -> Array:
    """Return the scatter of repeats, shrunk towards that of all recordings; 0 if unknown."""
    square = np.square(scatter)
    everywhere = np.nan_to_num(_mean(square))
    own = np.where(np.isnan(square), everywhere, square)
    return np.asarray(np.sqrt(_OWN * own + (1.0 - _OWN) * everywhere))


def _mean(rows: Array) -> Array:
    """Return the mean of the finite values of each column; NaN without any."""
    known = ~np.isnan(rows)
    count = known.sum(axis=0)
    total = np.where(known, rows, 0.0).sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _middle(rows: Array) -> Array:
    """Return the median of the finite values of each column; NaN without any."""
    ordered = np.sort(rows, axis=0)  # NaN comes last
    count = (~np.isnan(rows)).sum(axis=0)
    low, high = np.maximum(count - 1, 0) // 2, count // 2
    high = np.minimum(high, len(rows) - 1)
    column = np.arange(rows.shape[1])
    return np.asarray(0.5 * (ordered[low, column] + ordered[high, column]))


def _conditions(table: CaseTable) -> list[list[int]]:
    """Return the recordings of each condition."""
    groups: dict[tuple[float | None, ...], list[int]] = {}
    for i, c in enumerate(table.conditions):
        groups.setdefault((c.speed, c.interference, c.support_stiffness), []).append(i)
    return list(groups.values())


def _between_repeats(groups: Sequence[Sequence[int]], values: Array) -> Array:
    """Root mean square difference of recordings of one condition."""
    pairs = [pair for group in groups for pair in itertools.combinations(group, 2)]
    if not pairs:
        return np.full(values.shape[1], np.nan)
    one, other = np.array(pairs).T
    return np.asarray(np.sqrt(_mean(np.square(values[one] - values[other]))))
