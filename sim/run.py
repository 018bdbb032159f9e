"""One run of the rig: from an operating condition to a recording, as the rig's computer has it.

`simulate` goes through the stages of a run in one block: motion, force and sound, what reaches the
sensors, what these and the data acquisition make of it. Each is a function of what the one before
gave, and of a generator where it scatters, so who needs only some of them, or keeps what they give,
calls those. `sim.blocks` sends blocks through the same solver, effects and filters.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.drawing import BLUE, ORANGE, axes_or_new, thinned
from models.errors import ParameterError
from models.radiation.impulse_responses import ImpulseResponses, radiate
from models.radiation.rig_response import impulse_responses
from models.recording import Channel, Recording
from models.rig import Rig
from models.show import short_repr
from models.units import ABSOLUTE_ZERO
from sim.acquisition import Acquisition, sample
from sim.chain import changed_chain
from sim.effects import EFFECTS
from sim.effects.effect import ActiveEffect, Effect, Signals, activated
from sim.motion import Motion, simulate_motion
from sim.shaft import ConstantSpeed, ShaftMotion
from sim.temperature import at_temperature

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LONGEST_RUN = 600.0
"""[s]; the whole run is held in memory. `sim.blocks` has no such limit."""


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

REGIME_RATE = 15e3
"""Of a motion of which only the regime and slow lines are asked [Hz]; it resolves stick, and the
solution does not depend on it."""


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
        struck, pulse_pressure = radiate(paths, force, "pulse")
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


def record_motions(
    plan: Plan,
    motions: Sequence[Motion],
    rigs: Sequence[Rig],
    acquisition: Acquisition,
    noise_rng: np.random.Generator,
    effect_rng: np.random.Generator,
) -> tuple[Signals, list[Sound]]:
    """Record the motions of one or several bushings, which one microphone hears together.

    Parameters
    ----------
    plan : Plan
        Of each.
    motions : sequence of Motion
        From rest on.
    rigs : sequence of Rig
        What carries and radiates each.
    acquisition : Acquisition
    noise_rng, effect_rng : numpy.random.Generator
        Of the sensors' noise, and of effects that scatter.

    Returns
    -------
    samples : dict of str to ndarray, shape (n,)
        By channel, in its unit; ``torque_2`` and so on are of the second bushing.
    sounds : list of Sound
        Of each motion alone, before any noise.
    """
    sounds, seen = list[Sound](), list[Signals]()
    for motion, rig in zip(motions, rigs, strict=True):
        paths = impulse_responses(rig, plan.interference, plan.support_stiffness, plan.rate)
        paths = changed_chain(paths, plan.effects, effect_rng.spawn(1)[0])
        sounds.append(radiate_motion(motion, paths, plan.effects))
        seen.append(sensor_signals(motion, sounds[-1], plan.n_settling))
    together = {"pressure": reduce(np.add, [signals["pressure"] for signals in seen])}
    decimation = SIMULATION.decimation(acquisition.rate)
    samples: Signals = {}
    for number, signals in enumerate(seen, start=1):
        sensed = apply_sensor_effects(signals | together, plan.effects, plan.rate, effect_rng)
        for kind, values in sample(sensed, decimation, acquisition, noise_rng).items():
            if number == 1:
                samples[kind] = values
            elif kind != "pressure":
                samples[f"{kind}_{number}"] = values
    return samples, sounds


@short_repr
@dataclass(frozen=True, eq=False)
class Run:
    """What a simulated run gives.

    Parameters
    ----------
    recording : Recording
        What the sensors recorded.
    motion : Motion
        What moved, including what no sensor sees; at the rate of the computation.
    pressure : ndarray, shape (n,)
        Sound pressure at the microphone at ``motion.rate``, free of noise [Pa].
    pulse_pressure : ndarray, shape (n,)
        The part of `pressure` that slip pulses make through the plate [Pa].
    settling : float
        How long the rig has run before all this [s].

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.1)
    >>> run.motion.rate, run.settling, run.pressure.shape
    (90000.0, 0.5, (9000,))
    """

    recording: Recording
    motion: Motion
    pressure: NDArray[np.float64]
    pulse_pressure: NDArray[np.float64]
    settling: float

    def plot(
        self, ax: "Axes | None" = None, *, start: float | None = None, end: float | None = None
    ) -> "Axes":
        """Draw the torques in contact and elastomer over time.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure.
        start, end : float, optional
            What is shown [s]; by default the last tenth of a second.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ParameterError
            There is nothing of the run between them.

        Examples
        --------
        >>> from matplotlib.figure import Figure
        >>> from models.rig_file import load_material_rig
        >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.1)
        >>> run.plot(Figure().subplots()).get_title("left")
        'PDMS, 0.279 mm, 2214 Nm/rad, 5 rad/s'
        """
        motion = self.motion
        lasting = motion.torque.size / motion.rate
        end = lasting if end is None else end
        start = max(0.0, end - _SHOWN) if start is None else start
        part = slice(math.ceil(max(0.0, start) * motion.rate), round(end * motion.rate))
        if not motion.torque[part].size:
            raise ParameterError(
                f"start = {start:g} s and end = {end:g} s hold nothing of a run of {lasting:g} s"
            )
        time = np.arange(motion.torque.size)[part] / motion.rate
        with axes_or_new(ax) as axes:
            for values, colour, label, width in torque_curves(motion, part):
                axes.plot(*thinned(time, values), color=colour, linewidth=width, label=label)
            axes.set_xlabel("Time [s]")
            axes.set_ylabel("Torque [Nm]")
            axes.set_title(", ".join(self.recording.condition.words), loc="left")
            axes.legend(loc="best")
        return axes


def simulate(
    rig: Rig,
    shaft: ShaftMotion | float,
    *,
    interference: float = 0.279e-3,
    support_stiffness: float = 2214.0,
    temperature: float = 23.0,
    seconds: float = 1.0,
    acquisition: Acquisition | None = None,
    settling: float | None = None,
    library: Mapping[str, Effect] | None = None,
    rng: np.random.Generator | None = None,
) -> Run:
    """Simulate one run of the rig.

    Parameters
    ----------
    rig : Rig
    shaft : ShaftMotion or float
        How the shaft turns; a number is a constant speed [rad/s].
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.
    temperature : float
        Ambient [degree Celsius]; recorded, and acts where the rig's material says how.
    seconds : float
        Length of the recording [s].
    acquisition : Acquisition, optional
        Sampling rate, noise and sensors; by default 30 kHz. What it does not say of the sensors is
        the rig's.
    settling : float, optional
        How long the rig has run before the recording starts [s]; by default that of
        `SIMULATION` at constant speed, else none.
    library : mapping of str to Effect, optional
        Effects that the rig's can be found among; by default `sim.effects.EFFECTS`.
    rng : numpy.random.Generator, optional
        Of the sensors' noise and of effects that scatter; by default seeded with 0.

    Returns
    -------
    Run

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.1)
    >>> run.recording.channel_names, run.recording.samples.shape
    (('torque', 'acceleration', 'pressure', 'angle'), (4, 3000))
    """
    acquisition = (acquisition or Acquisition()).over(rig.sensors)
    # Two streams, so that an effect that scatters leaves the sensors' noise as it is.
    noise_rng, effect_rng = (rng or np.random.default_rng(0)).spawn(2)
    plan = plan_run(
        rig,
        shaft,
        interference=interference,
        support_stiffness=support_stiffness,
        temperature=temperature,
        seconds=seconds,
        rate=acquisition.rate,
        settling=settling,
        library=library,
    )
    motion = run_motion(plan, effect_rng)
    samples, (sound,) = record_motions(
        plan, [motion], [plan.rig], acquisition, noise_rng, effect_rng
    )
    recording = Recording(
        samples=np.stack(list(samples.values())),
        rate=acquisition.rate,
        channels=sensor_channels(rig),
        condition=plan.condition,
    )
    kept = slice(plan.n_settling, None)
    return Run(
        recording=recording,
        motion=motion.since(plan.n_settling),
        pressure=sound.pressure[kept],
        pulse_pressure=sound.pulse_pressure[kept],
        settling=plan.n_settling / plan.rate,
    )


def plan_run(
    rig: Rig,
    shaft: ShaftMotion | float,
    *,
    interference: float,
    support_stiffness: float,
    temperature: float,
    seconds: float,
    rate: float,
    settling: float | None,
    library: Mapping[str, Effect] | None,
) -> Plan:
    """Check what is asked of a run, and plan it.

    Parameters
    ----------
    rig, shaft, interference, support_stiffness, temperature, seconds, settling, library
        As for `simulate`.
    rate : float
        Of the recording [Hz].

    Returns
    -------
    Plan
        At a multiple of `rate`, as `SIMULATION` has it.

    Raises
    ------
    ParameterError
        If a value cannot be used, or the shaft is neither a number nor a motion.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> plan = plan_run(
    ...     load_material_rig("PDMS"), 5, interference=0.279e-3, support_stiffness=2214.0,
    ...     temperature=23.0, seconds=1.0, rate=30e3, settling=None, library=None,
    ... )
    >>> plan.shaft, plan.rate, plan.n_settling, plan.n_kept
    (ConstantSpeed(value=5.0), 90000.0, 45000, 90000)
    """
    if isinstance(shaft, Real):
        shaft = ConstantSpeed(float(shaft))
    if not isinstance(shaft, ShaftMotion):
        raise ParameterError(f"shaft = {shaft!r}: give a speed in rad/s, or a motion of sim.shaft")
    if settling is None:
        settling = SIMULATION.settling if isinstance(shaft, ConstantSpeed) else 0.0
    _check(seconds, settling, rate, interference, temperature)
    rig = at_temperature(rig, temperature)
    return Plan(
        rig=rig,
        shaft=shaft,
        interference=interference,
        support_stiffness=support_stiffness,
        effects=activated(rig.effects, library or EFFECTS),
        rate=SIMULATION.rate(rate),
        n_settling=round(settling * SIMULATION.rate(rate)),
        n_kept=round(seconds * rate) * SIMULATION.decimation(rate),
        temperature=temperature,
    )


def sensor_channels(rig: Rig) -> tuple[Channel, ...]:
    """Return the channels of a recording of a rig."""
    return (
        Channel("torque"),
        Channel("acceleration"),
        Channel("pressure", position=rig.microphone.position),
        Channel("angle"),
    )


def _check(
    seconds: float, settling: float, rate: float, interference: float, temperature: float
) -> None:
    if not (0.0 < seconds <= LONGEST_RUN and 0.0 <= settling <= LONGEST_RUN):
        raise ParameterError(
            f"seconds = {seconds:g} must be above 0, settling = {settling:g} at least 0, both at "
            f"most {LONGEST_RUN:g}"
        )
    if not 1e3 <= rate <= 400e3:
        raise ParameterError(f"rate = {rate:g} Hz must lie between 1000 and 400000")
    if round(seconds * rate) < 2:
        raise ParameterError(f"seconds = {seconds:g} holds no two samples at {rate:g} Hz")
    if not ABSOLUTE_ZERO <= temperature < 1e4:
        raise ParameterError(f"temperature = {temperature:g} degree Celsius is none")
    if not 0.0 < interference < 1e-2:
        raise ParameterError(
            f"interference = {1e3 * interference:g} mm must be above 0 and below 10"
        )


_SHOWN = 0.1
"""A run is drawn from so long before its end [s]: slips can still be told apart."""


Curve = tuple[NDArray[np.float64], str, str, float]
"""Values, colour, label (empty for none) and line width."""


def torque_curves(motion: Motion, part: slice) -> list[Curve]:
    """Return the torques of a part of a motion, the more important one later and so on top.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.1)
    >>> [label for _, _, label, _ in torque_curves(run.motion, slice(0, 10))]
    ['contact', 'elastomer']
    """
    return [
        (motion.friction_torque[part], ORANGE, "contact", 0.9),
        (motion.torque[part], BLUE, "elastomer", 1.3),
    ]
