"""Summary of a recording in some four hundred numbers, and table of those of a case.

A *case* is what a user brings: recordings of one rig over several conditions, and its file. Each
number is taken from the recording and from simulated repeats of its condition; what matters is the
difference, its size against the repeats' own scatter, and how both change from condition to
condition and between repeats of one (`noise.diagnosis.evidence.case_row`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition, known_condition
from models.recording import Recording
from models.rig import Rig
from models.transfer_functions.transfer_function import TransferFunction
from noise.base.arrays import Array
from noise.diagnosis.evidence.bench_context import bench_context
from noise.diagnosis.evidence.channel_summary import band_levels, channel_summary, hum_summary
from noise.diagnosis.evidence.contact_summary import contact_summary, slip_starts
from noise.diagnosis.evidence.path_summary import common_residual, path_summary
from noise.diagnosis.evidence.reconstruction import (
    angle_summary,
    closed_spectrum,
    reconstruct,
    shaft_speed,
)
from noise.diagnosis.simulated.repeats import condition_key, nominal_repeats
from noise.diagnosis.simulated.transfer_functions import TransferFunctionCache, predict_outputs
from sim.bushing import lumped_bushing
from sim.effects.effect import Effect

Numbers = dict[str, float]

N_REPEATS = 3
"""Simulated repeats a condition; what a case may cost settles it; assumed."""

_OUTPUTS = ("acceleration", "pressure")


@dataclass(frozen=True, eq=False)
class CaseTable:
    """The numbers of a case.

    Parameters
    ----------
    names : tuple of str
        Of the columns.
    measured, nominal, scatter : ndarray, shape (n_recordings, n_numbers)
        Of the recordings; mean and standard deviation of simulated repeats. NaN where undefined
        [unit of the number].
    conditions : tuple of Condition
    rate : float
        Sampling rate of the recordings, the middle one where they differ [Hz].
    bench : mapping of str to float
        As `bench_context` gives it.
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
    """Summarise a recording against the rig that it is said to be of.

    Parameters
    ----------
    recording : Recording
        With speed, interference and support stiffness in its condition.
    rig : Rig
    transfer_functions : mapping of str to TransferFunction
        As `torque_transfer_functions` gives them.

    Returns
    -------
    dict of str to float
        What a missing channel would tell is missing [unit of the number].
    """
    condition, rate = known_condition(recording.condition), recording.rate
    signal = signals_of(recording)
    numbers: Numbers = {}
    # Torque and motion change sign together: what turns backwards is looked at from behind.
    turn, wanted = math.copysign(1.0, condition.speed), abs(condition.speed)
    speed = np.full(recording.samples.shape[1], wanted)
    if "angle" in signal:
        numbers |= _named("angle", angle_summary(turn * signal["angle"], wanted, rate))
        speed = shaft_speed(turn * signal["angle"], rate)
    for kind in ("torque", *_OUTPUTS):
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
    if len(residuals) == len(_OUTPUTS):
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
        for kind in ("torque", *_OUTPUTS, "angle")
        if (row := recording.first(kind)) is not None
    }


def path_numbers(
    signal: Mapping[str, Array],
    spectrum: NDArray[np.complex128],
    rate: float,
    transfer_functions: Mapping[str, TransferFunction],
    slips: Array,
) -> tuple[Numbers, dict[str, Array]]:
    """Compare acceleration and sound with what the torque should have made of them.

    Parameters
    ----------
    signal : mapping of str to ndarray, shape (n,)
        By kind of channel [unit of the channel].
    spectrum : ndarray of complex
        Of the torque, as `closed_spectrum` gives it [Nm].
    rate : float
        Sampling rate [Hz].
    transfer_functions : mapping of str to TransferFunction
        As `torque_transfer_functions` gives them.
    slips : ndarray, shape (n_slips,)
        When the contact slips [s].

    Returns
    -------
    dict of str to float
        [unit of the number]
    dict of str to ndarray, shape (n,)
        What the torque does not make, by kind of channel [unit of the channel].
    """
    numbers: Numbers = {}
    residuals = {}
    paths = {kind: transfer_functions[kind] for kind in _OUTPUTS if kind in signal}
    for kind, expected in predict_outputs(spectrum, signal["torque"].size, rate, paths).items():
        path, residuals[kind] = path_summary(expected, signal[kind], rate, slips)
        numbers |= _named(kind, path)
    return numbers, residuals


@dataclass(frozen=True, eq=False)
class NominalNumbers:
    """What the numbers of recordings would be were the rig as its file has it; simulated once.

    Parameters
    ----------
    rig : Rig
    library : mapping of str to Effect, optional
        Definitions of the effects of the rig, by name.
    seed : int
        Of the repeats.
    """

    rig: Rig
    library: Mapping[str, Effect] | None = None
    seed: int = 0
    _moments: dict[tuple[object, ...], tuple[Numbers, Numbers]] = field(default_factory=dict)

    @cached_property
    def transfer_functions(self) -> TransferFunctionCache:
        """The rig's, each looked up once."""
        return TransferFunctionCache(self.rig, self.library)

    def moments(self, recording: Recording) -> tuple[Numbers, Numbers]:
        """Mean and standard deviation over simulated repeats of a recording's condition."""
        key = (*condition_key(recording), recording.channel_names)
        if key not in self._moments:
            # Conditions share no repeat's rig: it would err in all of them alike.
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
        Of the repeats.
    nominal : NominalNumbers, optional
        Those of this rig, where several cases are of it.

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
        Of the former, with the channels of kinds that the latter has.
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
    """Return mean and standard deviation of each column over what is known of it.

    Parameters
    ----------
    values : ndarray, shape (n, n_columns)
        [unit of each column]

    Returns
    -------
    mean, spread : ndarray, shape (n_columns,)
        NaN where nothing is known, and of the spread where one row alone is [unit of the column].

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
