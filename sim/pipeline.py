"""The stages of a run: motion, force, sound, what reaches the sensors, what these make of it.

Each is a function of what the one before gave, and of a generator where it scatters. A `Plan` says
what is to be run, and goes through

    motion = run_motion(plan, rng)
    sound = radiate_motion(motion, paths, plan.effects)
    signals = sensor_signals(motion, sound, plan.n_settling)
    signals = apply_sensor_effects(signals, plan.effects, plan.rate, rng)

and `sim.acquisition`. Paths are those of `models.radiation` as `sim.chain` changes them. Who needs
only some of the stages, or keeps what they give, calls those.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from models.condition import Condition
from models.radiation.impulse_responses import radiate, radiate_pulses
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from models.radiation.impulse_responses import ImpulseResponses
    from models.rig import Rig
    from sim.effects.effect import ActiveEffect, Signals
    from sim.motion import Motion
    from sim.shaft import ShaftMotion


@dataclass(frozen=True, eq=False)
class Plan:
    """A run before it is computed.

    Parameters
    ----------
    rig : Rig
        Its friction at the ambient temperature.
    shaft : ShaftMotion
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.
    effects : sequence of ActiveEffect
        In the order in which they act.
    rate : float
        Of motion and sound [Hz].
    n_settling, n_kept : int
        Samples at that rate from rest to where the run is kept, and those that are kept.
    temperature : float, optional
        Ambient [degree Celsius], for the record.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> plan = Plan(load_material_rig("PDMS"), ConstantSpeed(5.0), 0.279e-3, 2214.0, (), 90e3, 0, 9)
    >>> plan.condition.speed, run_motion(plan).torque.size
    (5.0, 9)
    """

    rig: Rig
    shaft: ShaftMotion
    interference: float
    support_stiffness: float
    effects: Sequence[ActiveEffect]
    rate: float
    n_settling: int
    n_kept: int
    temperature: float | None = None

    @property
    def condition(self) -> Condition:
        """What the engineer sets on the rig; without a speed where it varies."""
        return Condition(
            speed=self.shaft.value if isinstance(self.shaft, ConstantSpeed) else None,
            interference=self.interference,
            support_stiffness=self.support_stiffness,
            material=self.rig.material,
            temperature=self.temperature,
        )


@dataclass(frozen=True, eq=False)
class Sound:
    """What a motion makes accelerometer and microphone see, before any noise; shapes (n,).

    Parameters
    ----------
    acceleration : ndarray, shape (n,)
        At the clamp [m/s2].
    pressure : ndarray, shape (n,)
        At the microphone [Pa].
    pulse_pressure : ndarray, shape (n,)
        The part of `pressure` that slip pulses make through the plate [Pa].
    """

    acceleration: NDArray[np.float64]
    pressure: NDArray[np.float64]
    pulse_pressure: NDArray[np.float64]


def run_motion(
    plan: Plan, rng: np.random.Generator | None = None, *, tolerance: float | None = None
) -> Motion:
    """Simulate the motion of a plan from rest; `rng` and `tolerance` as of `simulate_motion`."""
    return simulate_motion(
        plan.rig,
        plan.shaft,
        interference=plan.interference,
        support_stiffness=plan.support_stiffness,
        seconds=(plan.n_settling + plan.n_kept) / plan.rate,
        rate=plan.rate,
        effects=plan.effects,
        rng=rng,
        tolerance=tolerance,
    )


def pulse_force(motion: Motion, effects: Sequence[ActiveEffect]) -> NDArray[np.float64]:
    """Force that a motion makes the effects exert in the anchors' joint [N], shape (n,)."""
    force = np.zeros_like(motion.torque)
    for active in effects:
        if active.effect.force is not None:
            force += active.effect.force(motion, active.form, active.values)
    return force


def radiate_motion(
    motion: Motion, paths: ImpulseResponses, effects: Sequence[ActiveEffect] = ()
) -> Sound:
    """Send torque and pulses of a motion through structure and plate.

    Parameters
    ----------
    motion : Motion
    paths : ImpulseResponses
        At the motion's rate, as effects have changed them.
    effects : sequence of ActiveEffect
        Of which some make pulses.

    Returns
    -------
    Sound
        As long as the motion.
    """
    acceleration, pressure = radiate(paths, motion.torque)
    force = pulse_force(motion, effects)
    pulse_pressure = np.zeros_like(pressure)
    if np.any(force):
        struck, pulse_pressure = radiate_pulses(paths, force)
        acceleration += struck
        pressure += pulse_pressure
    return Sound(acceleration, pressure, pulse_pressure)


def sensor_signals(motion: Motion, sound: Sound, n_settling: int) -> Signals:
    """Return what reaches the sensors while the run is kept, by channel; the angle from 0 on."""
    return {
        "torque": motion.torque[n_settling:],
        "acceleration": sound.acceleration[n_settling:],
        "pressure": sound.pressure[n_settling:],
        "angle": motion.shaft_angle[n_settling:] - motion.shaft_angle[n_settling],
    }


def apply_sensor_effects(
    signals: Signals, effects: Sequence[ActiveEffect], rate: float, rng: np.random.Generator
) -> Signals:
    """Let the effects on sensors change signals of a run in one block, in their order.

    The sampling rate is that of the signals [Hz].
    """
    for active in effects:
        signals = active.sensed(signals, rate, {"rng": rng, "whole": True})
    return signals


@dataclass(frozen=True)
class Timing:
    """Rate and settling of a kind of run.

    Parameters
    ----------
    least_rate : float
        Motion and sound are computed at a multiple of the sampling rate no lower than this [Hz].
    settling : float
        How long a shaft at constant speed has turned before a run is kept [s].
    tolerance : float, optional
        Error of a step of the solver where the motion has no exact solution [-]; by default that
        of the friction law.

    Examples
    --------
    >>> SIMULATION.rate(30e3), SIMULATION.rate(48e3), DIAGNOSIS.rate(25.6e3)
    (90000.0, 96000.0, 76800.0)
    """

    least_rate: float
    settling: float
    tolerance: float | None = None

    def decimation(self, sampling_rate: float) -> int:
        """By what the rate of motion and sound is divided for a sampling rate [Hz]."""
        return math.ceil(self.least_rate / sampling_rate)

    def rate(self, sampling_rate: float) -> float:
        """Rate of motion and sound for a sampling rate [Hz]."""
        return self.decimation(sampling_rate) * sampling_rate


SIMULATION = Timing(least_rate=90e3, settling=0.5)
"""Of recordings that are simulated to be kept: sound is right up to 20 kHz and beyond."""

DIAGNOSIS = Timing(least_rate=75e3, settling=0.25, tolerance=3e-6)
"""Of the many runs that a diagnosis compares with recordings: settled as long as structures are
followed to ring on, torques right to four digits. The shipped posterior of causes was fitted to
runs of exactly these, so they change with it only."""

LEARNING = replace(DIAGNOSIS, least_rate=60e3)
"""Of the cases that it was fitted to: usual rates are still at least halved, so that what lies
above half of them is filtered out as in a recording and does not fold back."""

SCREENING = Timing(least_rate=30e3, settling=0.6)
"""Of a point of a map, named by its physics: creaks reach 15 kHz."""

SCREENING_SLOW = Timing(least_rate=30e3, settling=1.5)
"""Of a point whose vibration still grows or dies after that; some creaks set in that late."""

REGIME_RATE = 15e3
"""Of a motion of which only the regime and slow lines are asked [Hz]; it resolves stick, and the
solution does not depend on it."""
