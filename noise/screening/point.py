"""Evaluation of points of a map: their vibration, regime, noise and level.

Whether a vibration dies, persists or breaks out is told by `noise.screening.vibration`. What sounds
has the name that `noise.labels` gives a recording of it, by the classifier that ships. The name by
the physics of the motion (`noise.noise_definition`) stands beside it: friction may strike the plate
as in a creak while the ear, and the classifier, hear the lines of a squawk. Where a vibration lasts
and has no name, it may still grow, or swell and fade, and more of it is heard.

A bar on the road swings: it runs from one turning on, a whole cycle is heard, and names and regimes
are those of the two intervals in which it moves at half its peak speed or more, whichever is
livelier. Every turning sticks, which by itself is neither regime nor noise.

A batch is points of one rig in one environment, evaluated on all cores. It is cut into rows that
differ in speed alone, which are independent, so that the numbers are the same whoever simulates
them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, replace
from functools import lru_cache

import numpy as np
from joblib import Parallel, delayed, hash as digest
from numpy.typing import NDArray

from features.kernels.weighting import WeightedLevels, weighted_levels
from models.condition import Condition as Stated
from models.radiation.impulse_responses import ImpulseResponses
from models.radiation.rig_response import impulse_responses
from models.recording import Recording
from models.rig import Rig, damping_at
from noise.base.labels import PERSISTS
from noise.batch.journal import Journal
from noise.batch.work import one_thread
from noise.classifier import load_classifier
from noise.labels.segments import file_label, label_recording
from noise.noise_definition import LEAST_LEVEL, noise_criteria
from noise.screening.vibration import RATE, Condition, gone_on, oscillation, vibrations_at
from sim.acquisition import Acquisition, sample
from sim.analysis.regime import Regime, motion_slips
from sim.chain import apply_chain_effects
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.motion import Motion, simulate_motion
from sim.run import (
    Sound,
    apply_sensor_effects,
    radiate_motion,
    sensor_channels,
    sensor_signals,
)
from sim.shaft import Oscillation
from sim.temperature import at_temperature

JUDGED = 0.5
"""Judged last part of a run: a window of the classifier [s]."""

_LONGER = 3.0
"""Judged part where a vibration has no name in the shorter one [s]."""

_RINGING = 0.4
"""Time before the judged part in which the structure rings [s]."""

_REGIME = 0.4
"""Last part of a motion in which slips are detected [s]."""

_FAST_SHARE = 0.5
"""Share of the peak speed above which a swing is judged [-]."""

_DAMPING_STEP = 0.04
"""Relative, of the beams' damping between the structures that are made: 0.2 dB at a resonance."""


@dataclass(frozen=True)
class PointResult:
    """Results of a point of a map.

    Parameters
    ----------
    regime : Regime
    label : str
        ``creak``, ``squawk``, ``squeal`` or ``none``: what `noise.labels` hears.
    persists : bool
        Whether that sounds only where the vibration already runs.
    physics : str
        The name by `noise.noise_definition`.
    level, level_max : float
        L_Aeq and L_AFmax of the sound [dB re 20 uPa]; NaN where nothing sounds.
    simulated : bool
        False where it was skipped, since a vibration dies before that speed.
    """

    regime: Regime
    label: str
    persists: bool
    physics: str
    level: float
    level_max: float
    simulated: bool = True


SILENT = PointResult(Regime.STEADY_SLIDING, "none", False, "none", math.nan, math.nan)
"""Result of a condition at which every vibration dies."""


def swing(speed: float, frequency: float) -> Oscillation:
    """Return the oscillation of a frequency [Hz] whose largest speed [rad/s] is given.

    Examples
    --------
    >>> swing(math.pi, 2.0).amplitude
    0.25
    """
    return Oscillation(speed / (2.0 * math.pi * frequency), frequency)


def evaluate_row(rig: Rig, row: Sequence[Condition]) -> list[PointResult]:
    """Simulate points that differ in speed alone; together they take less time.

    Parameters
    ----------
    rig : Rig
    row : sequence of Condition
        Of constant speed, or of swings.

    Returns
    -------
    list of PointResult

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon")
    >>> evaluate_row(rig, [Condition(10.0, 0.279e-3, 3745.0)])[0].label
    'squeal'
    """
    if row[0].frequency is not None:
        return [
            _audible_result(rig, at, _motion(rig, at, at.frequency)) for at in row if at.frequency
        ]
    results = [SILENT] * len(row)
    for i, one in vibrations_at(rig, row):
        if not one.simulated:
            results[i] = replace(SILENT, simulated=False)
        elif one.course is not None:
            persists = one.state == PERSISTS
            results[i] = _audible_result(rig, row[i], one.course.motion, persists=persists)
            if results[i].label == "none":
                longer = gone_on(one.course, _LONGER)
                results[i] = _audible_result(rig, row[i], longer, persists=persists, judged=_LONGER)
    return results


def is_noisy(rig: Rig, row: Sequence[Condition]) -> bool:
    """Return whether an audible vibration lasts at any of several speeds.

    Costs half of what the name of the noise does.
    """
    hot = at_temperature(rig, row[0].temperature)
    for i, one in vibrations_at(rig, row):
        if one.course is not None:
            sound = _sound(hot, row[i], _last_part(one.course.motion))
            if _levels(sound.pressure[-round(JUDGED * RATE) :]).level_a >= LEAST_LEVEL:
                return True
    return False


def _levels(pressure: NDArray[np.float64]) -> WeightedLevels:
    return weighted_levels(lambda first, last: pressure[first:last], pressure.size, RATE)


def _last_part(motion: Motion, judged: float = JUDGED) -> Motion:
    """Return the judged part [s] of a motion, and before it what still rings in it."""
    return motion.part(max(0, motion.torque.size - round((judged + _RINGING) * RATE)))


def _audible_result(
    rig: Rig, at: Condition, motion: Motion, *, persists: bool = False, judged: float = JUDGED
) -> PointResult:
    """Return regime, noise and level of a motion at a condition.

    Of constant speed the last `judged` seconds count, of a swing all but the first quarter of a
    cycle.
    """
    swings = at.frequency is not None
    if at.frequency is not None:
        start = round(0.25 / at.frequency * RATE)
    else:
        motion = _last_part(motion, judged)
        start = motion.torque.size - round(judged * RATE)
    whole = motion.part(start)
    intervals = _fast_intervals(whole) if swings else [whole]
    if all(oscillation(interval.torque) <= 1.0 for interval in intervals):
        return SILENT
    rig = at_temperature(rig, at.temperature)
    sound = _sound(rig, at, motion)
    pressure, pulses = sound.pressure[start:], sound.pulse_pressure[start:]
    levels = _levels(pressure)
    judged_parts = [(noise_criteria(one, pressure, pulses), one) for one in intervals]
    criteria, interval = max(judged_parts, key=lambda each: each[0].audible)
    slips = motion_slips(interval.part(-round(_REGIME * RATE))).times.size > 0
    physics = criteria.label
    if swings and physics == "creak" and criteria.blows < 0.0:
        physics = "squawk"  # lines that follow the speed, which no single spectrum shows
    label = physics
    if not swings and levels.level_a >= LEAST_LEVEL:
        label = _label(rig, at, motion, sound, start)
        label = physics if label == "unknown" else label
    return PointResult(
        regime=Regime.STICK_SLIP if slips else Regime.QUASI_HARMONIC,
        label=label,
        persists=persists and label != "none",
        physics=physics,
        level=levels.level_a,
        level_max=levels.level_af_max,
    )


_classifier = lru_cache(maxsize=1)(load_classifier)


def _label(rig: Rig, at: Condition, motion: Motion, sound: Sound, start: int) -> str:
    """Return the label of the classifier for a recording as `sim.run.simulate` makes it."""
    rng = np.random.default_rng(0)
    signals = sensor_signals(motion, sound, start)
    signals = apply_sensor_effects(signals, activated(rig.effects, EFFECTS), RATE, rng)
    sampled = sample(signals, 1, Acquisition(rate=RATE).over(rig.sensors), rng)
    condition = Stated(
        speed=at.speed, interference=at.interference, support_stiffness=at.support_stiffness,
        material=rig.material, temperature=at.temperature,
    )  # fmt: skip
    recording = Recording(
        np.stack(list(sampled.values())), RATE, sensor_channels(rig), condition=condition
    )
    return file_label(label_recording(recording, _classifier())).label


def _sound(rig: Rig, at: Condition, motion: Motion) -> Sound:
    effects = activated(rig.effects, EFFECTS)
    paths = _paths(rig, at.interference, at.support_stiffness)
    paths = apply_chain_effects(paths, effects, np.random.default_rng(0))
    return radiate_motion(motion, paths, effects)


def _motion(rig: Rig, at: Condition, frequency: float) -> Motion:
    """Simulate a swing from one turning point for a cycle and a quarter."""
    return simulate_motion(
        at_temperature(rig, at.temperature), swing(at.speed, frequency),
        interference=at.interference, support_stiffness=at.support_stiffness,
        seconds=1.25 / frequency, rate=RATE, tolerance=1e-5,
    )  # fmt: skip


def _fast_intervals(motion: Motion) -> list[Motion]:
    """Return the two longest parts of a swing at half its peak speed or more.

    Where the shaft turns back its torque turns from one side to the other, which is neither
    vibration nor noise. In between, the slow trend of the torque with the speed is taken off.
    """
    fast = np.abs(motion.shaft_speed) >= _FAST_SHARE * np.abs(motion.shaft_speed).max()
    edges = np.flatnonzero(np.diff(np.concatenate([[False], fast, [False]]).astype(int)))
    pieces = []
    for first, last in sorted(edges.reshape(-1, 2), key=lambda edge: edge[0] - edge[1])[:2]:
        piece = motion.part(first, last)
        time = np.linspace(-1.0, 1.0, last - first)
        trend = np.polynomial.Polynomial.fit(time, piece.torque, 3)(time)
        pieces.append(replace(piece, torque=piece.torque - trend + trend.mean()))
    return pieces


def _paths(rig: Rig, interference: float, support_stiffness: float) -> ImpulseResponses:
    """Return the responses of the structure, the beams' damping rounded to limit their number."""
    damping = damping_at(rig.fit(interference), support_stiffness)
    of_beams = (1.0 - rig.elastomer_damping_share) * damping
    if of_beams > 0.0 and math.isfinite(support_stiffness):
        rounded = math.exp(round(math.log(of_beams) / _DAMPING_STEP) * _DAMPING_STEP)
        rig = replace(rig, elastomer_damping_share=1.0 - rounded / damping)
    return impulse_responses(rig, interference, support_stiffness, RATE)


# --- batches of points ---------------------------------------------------------------------------

Evaluator = Callable[[Rig, Sequence[Condition]], list[PointResult]]
"""Returns what is known of each point of a rig."""


def batch_evaluator(
    *, workers: int = -1, advance: Callable[[int], None] = lambda _: None
) -> Evaluator:
    """Return a function that simulates batches.

    Parameters
    ----------
    workers : int
        Threads; -1 is one a core.
    advance : callable
        Is called with the number of points that were simulated since.

    Returns
    -------
    callable
        From a rig and conditions to a list of `PointResult`; raises ParameterError where one cannot
        be simulated.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> evaluate = batch_evaluator()
    >>> evaluate(load_material_rig("PDMS"), [Condition(1.0, 3e-4, 2e3)])[0].label
    'none'
    """

    def evaluate(rig: Rig, points: Sequence[Condition]) -> list[PointResult]:
        rows = _rows(points)
        work = Parallel(n_jobs=workers, prefer="threads", batch_size=1, return_as="generator")
        results: dict[Condition, PointResult] = {}
        with one_thread():
            of_rows = work(delayed(evaluate_row)(rig, row) for row in rows)
            for row, known in zip(rows, of_rows, strict=True):
                results |= zip(row, known, strict=True)
                advance(len(row))
        return [results[at] for at in points]

    return evaluate


def _rows(points: Sequence[Condition]) -> list[list[Condition]]:
    """Group points by row, which the structure follows; swings one by one."""

    def row(at: Condition) -> tuple[float, ...]:
        own = at.speed if at.frequency else 0.0
        return at.support_stiffness, at.interference, at.temperature, own

    ordered = sorted(points, key=lambda at: (row(at), at.speed))
    return [list(of_row) for _, of_row in itertools.groupby(ordered, row)]


def keeping(evaluate: Evaluator, lines: Journal) -> Evaluator:
    """Return an evaluator that reads what is in a journal, and adds what it simulates."""

    def journaled(rig: Rig, points: Sequence[Condition]) -> list[PointResult]:
        key = digest((rig, tuple(points)))
        if (stored := lines.get(key)) is not None:
            return [PointResult(Regime(regime), *values) for regime, *values in stored]
        results = evaluate(rig, points)
        lines.add(key, *([one.regime.value, *astuple(one)[1:]] for one in results))
        return results

    return journaled
