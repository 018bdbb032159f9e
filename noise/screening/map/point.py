"""Evaluation of one point of a map: simulated, and its noise named by its physics.

What noise a condition makes is said by `noise.noise_definition`, the definition that the classifier
learns: it looks at motion and sound without room and microphone, and costs no more than the run. So
a screen judges designs by the same names as recordings are labelled with, and does not inherit the
classifier's errors. The rig runs from rest, and is judged once it has settled: after 0.6 s if the
vibration then neither grows nor dies, else after 1.5 s; some creaks set in that late. The solver's
steps are as long as regimes and spectra allow, rather than single events. It is the rig's constant
version (`sim.rig_effects`), whose boundaries are sharp; what a listener hears of a point has
the irregularity that the rig states.

A bar on the road swings: it runs from one turning on, a whole cycle is heard, and names and regimes
are those of the two intervals in which it moves at half its peak speed or more, whichever is
livelier. Every turning sticks, which by itself is neither regime nor noise.

Intervals of a swing in which the shaft moves fast, each nearly of one speed.

Where the shaft turns back its torque turns from one side to the other, which is neither vibration
nor noise. In between, the slow trend of the torque with the speed is taken off.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from features.kernels.levels import weighted_levels
from models.radiation.impulse_responses import ImpulseResponses
from models.radiation.rig_response import impulse_responses
from models.rig import Rig, damping_at
from noise.noise_definition import NoiseCriteria, noise_criteria
from sim.analysis.regime import LEAST_OSCILLATION, Regime
from sim.analysis.slips import motion_slips
from sim.effects import EFFECTS
from sim.effects.effect import Effect, activated
from sim.motion import Motion
from sim.rig_effects import constant_version
from sim.run import SCREENING, SCREENING_SLOW, Plan, Timing, radiate_motion, run_motion
from sim.shaft import ConstantSpeed, Oscillation
from sim.temperature import at_temperature

if TYPE_CHECKING:
    from sim.motion import Motion

_FAST_SHARE = 0.5
"""Of the peak speed, above which a swing is judged."""


def fast_intervals(motion: Motion, *, swings: bool) -> list[Motion]:
    """List the parts of a motion that are nearly of one speed.

    Parameters
    ----------
    motion : Motion
        Of a whole swing, or at constant speed.
    swings : bool

    Returns
    -------
    list of Motion
        All of it, or the two longest intervals at half the peak speed or more.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.motion import simulate_motion
    >>> from sim.shaft import Oscillation
    >>> motion = simulate_motion(load_material_rig("PDMS"), Oscillation(0.26, 4.0), rate=30e3,
    ...                          interference=0.3e-3, support_stiffness=2214.0, seconds=0.25)
    >>> [round(part.torque.size / motion.rate, 3) for part in fast_intervals(motion, swings=True)]
    [0.083, 0.042]
    """
    if not swings:
        return [motion]
    fast = np.abs(motion.shaft_speed) >= _FAST_SHARE * np.abs(motion.shaft_speed).max()
    edges = np.flatnonzero(np.diff(np.concatenate([[False], fast, [False]]).astype(int)))
    pieces = sorted(edges.reshape(-1, 2), key=lambda edge: edge[0] - edge[1])[:2]
    return [_piece(motion, first, last) for first, last in pieces]


def _piece(motion: Motion, first: int, last: int) -> Motion:
    """Part of a motion, without the slow trend of its torque over a swing."""
    kept = {
        field.name: getattr(motion, field.name)[first:last]
        for field in fields(motion)
        if field.name != "rate"
    }
    time = np.linspace(-1.0, 1.0, last - first)
    trend = np.polynomial.Polynomial.fit(time, kept["torque"], 3)(time)
    kept["torque"] = kept["torque"] - trend + trend.mean()
    return replace(motion, **kept)


REGIMES = (Regime.STEADY_SLIDING, Regime.QUASI_HARMONIC, Regime.STICK_SLIP)
"""In the order of their codes."""

_TOLERANCE = 1e-5

_EVALUATED = 0.6
"""Length of what is judged, after settling [s]."""

LONGEST_POINT = SCREENING_SLOW.settling + _EVALUATED
"""How long a point's run from rest lasts at most, at constant speed [s]."""

_SETTLED = 0.8
"""Least ratio of the vibration's strength, from one third of what is judged to the last."""

_DAMPING_STEP = 0.04
"""Relative, of the beams' damping between the structures that are made: 0.2 dB at a resonance."""


@dataclass(frozen=True)
class PointResult:
    """Regime, noise and level of a simulated point.

    Parameters
    ----------
    regime : Regime
    label : str
        ``creak``, ``squawk``, ``squeal`` or ``none``.
    level, level_max : float
        L_Aeq and L_AFmax of the sound [dB re 20 uPa]; NaN where it slides steadily.
    """

    regime: Regime
    label: str
    level: float
    level_max: float


@dataclass(frozen=True, eq=False)
class Sound:
    """Motion and sound of a point, the part that is judged.

    Parameters
    ----------
    motion : Motion
    pressure, pulse_pressure : ndarray, shape (n,)
        At the motion's rate [Pa].
    """

    motion: Motion
    pressure: NDArray[np.float64]
    pulse_pressure: NDArray[np.float64]


def shaft_motion(speed: float, frequency: float | None) -> float | Oscillation:
    """Return how the shaft turns at a point: steadily, or swinging as fast as that at most.

    Parameters
    ----------
    speed : float
        The largest [rad/s].
    frequency : float, optional
        Of the swing [Hz].

    Examples
    --------
    >>> shaft_motion(5.0, None), shaft_motion(math.pi, 2.0).amplitude
    (5.0, 0.25)
    """
    if frequency is None:
        return speed
    return Oscillation(speed / (2.0 * math.pi * frequency), frequency)


def evaluate_point(
    rig: Rig,
    shaft: float | Oscillation,
    *,
    interference: float,
    support_stiffness: float,
    temperature: float = 23.0,
    library: Mapping[str, Effect] = EFFECTS,
    structure: tuple[Rig, float] | None = None,
) -> PointResult:
    """Simulate a point of a rig's constant version, and say its regime, its noise and its level.

    Parameters
    ----------
    rig : Rig
    shaft : float or Oscillation
        Constant speed [rad/s], or how the shaft swings.
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    temperature : float
        [degree Celsius]
    library : mapping of str to Effect
        Effects that the rig's can be found among.
    structure : tuple of Rig and float, optional
        Rig and support stiffness [Nm/rad] through whose clamp, beams and plate it is heard, where
        making those of each point would take too long; by default its own.

    Returns
    -------
    PointResult

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon")
    >>> evaluate_point(rig, 10.0, interference=0.279e-3, support_stiffness=3745.0).label
    'squeal'
    """
    rig = constant_version(rig, library)
    plan = _plan(rig, shaft, interference, support_stiffness, temperature, library, SCREENING)
    plan, motion = _settled(plan)
    swings = isinstance(shaft, Oscillation)
    intervals = fast_intervals(motion.since(plan.n_settling), swings=swings)
    if all(_oscillation(interval) <= 1.0 for interval in intervals):
        return PointResult(Regime.STEADY_SLIDING, "none", math.nan, math.nan)
    made_of, support = structure or (plan.rig, support_stiffness)
    paths = _paths(made_of, interference, support, plan.rate)
    sound = _sound(plan, motion, paths)
    found, interval = _liveliest(sound, intervals)
    slips = motion_slips(interval).times.size > 0
    regime = Regime.STICK_SLIP if slips else Regime.QUASI_HARMONIC
    label = found.label
    if swings and label == "creak" and found.blows < 0.0:
        label = "squawk"  # lines that follow the speed, which no single spectrum shows
    return PointResult(regime, label, *_levels(sound))


def point_sound(
    rig: Rig,
    shaft: float | Oscillation,
    *,
    interference: float,
    support_stiffness: float,
    temperature: float = 23.0,
    rate: float = 48e3,
    library: Mapping[str, Effect] = EFFECTS,
) -> Sound:
    """Return motion and sound of a point at another rate [Hz], as irregular as the rig states."""
    plan = _plan(
        rig, shaft, interference, support_stiffness, temperature, library, SCREENING_SLOW, rate
    )
    paths = _paths(plan.rig, interference, support_stiffness, rate)
    return _sound(plan, run_motion(plan, tolerance=_TOLERANCE), paths)


def _plan(
    rig: Rig,
    shaft: float | Oscillation,
    interference: float,
    support_stiffness: float,
    temperature: float,
    library: Mapping[str, Effect],
    timing: Timing,
    rate: float | None = None,
) -> Plan:
    """Plan a run at a rate [Hz]; a swinging shaft settles for a quarter of its cycle instead."""
    rate = rate or timing.least_rate
    n_settling, n_kept = round(timing.settling * rate), round(_EVALUATED * rate)
    if isinstance(shaft, Oscillation):
        n_settling = round(0.25 / shaft.frequency * rate)
        n_kept = round(1.25 / shaft.frequency * rate) - n_settling
    rig = at_temperature(rig, temperature)
    return Plan(
        rig=rig,
        shaft=shaft if isinstance(shaft, Oscillation) else ConstantSpeed(float(shaft)),
        interference=interference,
        support_stiffness=support_stiffness,
        effects=activated(rig.effects, library),
        rate=rate,
        n_settling=n_settling,
        n_kept=n_kept,
        temperature=temperature,
    )


def _settled(plan: Plan) -> tuple[Plan, Motion]:
    """Motion that has settled where it is judged, and the plan of it."""
    motion = run_motion(plan, tolerance=_TOLERANCE)
    if isinstance(plan.shaft, Oscillation) or _is_settled(motion.since(plan.n_settling)):
        return plan, motion
    plan = replace(plan, n_settling=round(SCREENING_SLOW.settling * plan.rate))
    return plan, run_motion(plan, tolerance=_TOLERANCE)


def _is_settled(motion: Motion) -> bool:
    """Whether a vibration neither grows nor dies, or there is none."""
    first, _, last = (float(np.std(part)) for part in np.array_split(motion.torque, 3))
    least = LEAST_OSCILLATION * abs(float(np.mean(motion.torque)))
    if max(first, last) <= 0.1 * least:
        return True
    return _SETTLED * first <= last <= first / _SETTLED


def _oscillation(motion: Motion) -> float:
    mean = abs(float(np.mean(motion.torque)))
    return float(np.std(motion.torque)) / (LEAST_OSCILLATION * mean) if mean > 0.0 else math.inf


def _sound(plan: Plan, motion: Motion, paths: ImpulseResponses) -> Sound:
    sound, start = radiate_motion(motion, paths, plan.effects), plan.n_settling
    return Sound(
        motion.since(start),
        sound.pressure[start:],
        sound.pulse_pressure[start:],
    )


def _levels(sound: Sound) -> tuple[float, float]:
    """L_Aeq and L_AFmax [dB re 20 uPa], as of a recording that holds what is judged."""
    heard = sound.pressure
    found = weighted_levels(lambda first, last: heard[first:last], heard.size, sound.motion.rate)
    return found.level_a, found.level_af_max


def _paths(
    rig: Rig, interference: float, support_stiffness: float, rate: float
) -> ImpulseResponses:
    """Responses of the structure, the beams' damping rounded so that few are made."""
    damping = damping_at(rig.fit(interference), support_stiffness)
    of_beams = (1.0 - rig.elastomer_damping_share) * damping
    if of_beams > 0.0 and math.isfinite(support_stiffness):
        rounded = math.exp(round(math.log(of_beams) / _DAMPING_STEP) * _DAMPING_STEP)
        rig = replace(rig, elastomer_damping_share=1.0 - rounded / damping)
    return impulse_responses(rig, interference, support_stiffness, rate)


def _liveliest(sound: Sound, intervals: list[Motion]) -> tuple[NoiseCriteria, Motion]:
    """Criteria of the liveliest interval, with the sound of all, and that interval."""
    found = [
        (noise_criteria(interval, sound.pressure, sound.pulse_pressure), interval)
        for interval in intervals
    ]
    return max(found, key=lambda one: one[0].audible)
