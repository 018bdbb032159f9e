"""Simulation of one run of the rig: from an operating condition to a recording.

`simulate` computes the stages of a run: motion, forces and sound, signals at the sensors, samples.
Each stage is a function of the one before, and of a random generator where it scatters, so callers
that need only some stages call those. `sim.live` sends a rig whose setting changes through the same
solver and effects block by block.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.drawing import BLUE, ORANGE, axes_or_new, thinned
from models.radiation.impulse_responses import ImpulseResponses, radiate
from models.radiation.rig_response import impulse_responses
from models.recording import Channel, Recording
from models.rig import Rig
from models.show import short_repr
from sim.acquisition import Acquisition, sample
from sim.chain import apply_chain_effects
from sim.effects.effect import ActiveEffect, Effect, Signals
from sim.motion import Motion, simulate_motion
from sim.plan import SIMULATION, Plan, Setting, plan_run
from sim.shaft import ShaftMotion, shaft_motion

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False)
class Sound:
    """Acceleration and sound pressure that a motion causes, before any noise.

    Parameters
    ----------
    acceleration : ndarray, shape (n,)
        At the clamp [m/s2].
    pressure : ndarray, shape (n,)
        At the microphone [Pa].
    pulse_pressure : ndarray, shape (n,)
        Part of `pressure` that slip pulses cause through the plate [Pa].
    """

    acceleration: NDArray[np.float64]
    pressure: NDArray[np.float64]
    pulse_pressure: NDArray[np.float64]


def run_motion(
    plan: Plan, rng: np.random.Generator | None = None, *, tolerance: float | None = None
) -> Motion:
    """Simulate the motion of a plan from rest; `rng` and `tolerance` as for `simulate_motion`."""
    return simulate_motion(
        plan.rig,
        plan.shaft,
        interference=plan.interference,
        support_stiffness=plan.support_stiffness,
        seconds=(plan.n_settling + plan.n_recorded) / plan.rate,
        rate=plan.rate,
        effects=plan.effects,
        rng=rng,
        tolerance=tolerance,
    )


def pulse_force(motion: Motion, effects: Sequence[ActiveEffect]) -> NDArray[np.float64]:
    """Return the force that the effects exert in the anchors' joint [N], shape (n,)."""
    force = np.zeros_like(motion.torque)
    for active in effects:
        if active.effect.force is not None:
            force += active.effect.force(motion, active.form, active.values)
    return force


def radiate_motion(
    motion: Motion, paths: ImpulseResponses, effects: Sequence[ActiveEffect] = ()
) -> Sound:
    """Compute the sound of a motion: its torque and slip pulses through structure and plate.

    Parameters
    ----------
    motion : Motion
    paths : ImpulseResponses
        At the motion's rate, already changed by effects.
    effects : sequence of ActiveEffect
        Those that exert a force add slip pulses.

    Returns
    -------
    Sound
        As long as the motion.
    """
    acceleration, pressure = radiate(paths, motion.torque)
    force = pulse_force(motion, effects)
    pulse_pressure = np.zeros_like(pressure)
    if np.any(force):
        pulse_acceleration, pulse_pressure = radiate(paths, force, "pulse")
        acceleration += pulse_acceleration
        pressure += pulse_pressure
    return Sound(acceleration, pressure, pulse_pressure)


def sensor_signals(motion: Motion, sound: Sound, n_settling: int) -> Signals:
    """Return the signals at the sensors after settling, by channel; the angle starts at 0."""
    return {
        "torque": motion.torque[n_settling:],
        "acceleration": sound.acceleration[n_settling:],
        "pressure": sound.pressure[n_settling:],
        "angle": motion.shaft_angle[n_settling:] - motion.shaft_angle[n_settling],
    }


def apply_sensor_effects(
    signals: Signals, effects: Sequence[ActiveEffect], rate: float, rng: np.random.Generator
) -> Signals:
    """Apply effects on sensors, in order, to the signals of a whole run at a rate [Hz]."""
    for active in effects:
        signals = active.apply_sensors(signals, rate, rng)
    return signals


def record_motions(
    plan: Plan,
    motions: Sequence[Motion],
    rigs: Sequence[Rig],
    acquisition: Acquisition,
    noise_rng: np.random.Generator,
    effect_rng: np.random.Generator,
) -> tuple[Signals, list[Sound]]:
    """Record the motions of one or more bushings with one microphone.

    Parameters
    ----------
    plan : Plan
        Plan of every bushing.
    motions : sequence of Motion
        Motion of each bushing from rest.
    rigs : sequence of Rig
        Rig that carries each bushing and radiates its sound.
    acquisition : Acquisition
    noise_rng, effect_rng : numpy.random.Generator
        Generators of the sensors' noise and of effects that scatter.

    Returns
    -------
    samples : dict of str to ndarray, shape (n,)
        By channel, in its unit; ``torque_2`` and so on belong to the second bushing.
    sounds : list of Sound
        Sound of each motion alone, before any noise.
    """
    sounds, sensor_inputs = list[Sound](), list[Signals]()
    for motion, rig in zip(motions, rigs, strict=True):
        paths = impulse_responses(rig, plan.interference, plan.support_stiffness, plan.rate)
        paths = apply_chain_effects(paths, plan.effects, effect_rng.spawn(1)[0])
        sounds.append(radiate_motion(motion, paths, plan.effects))
        sensor_inputs.append(sensor_signals(motion, sounds[-1], plan.n_settling))
    together = {"pressure": reduce(np.add, [signals["pressure"] for signals in sensor_inputs])}
    decimation = SIMULATION.decimation(acquisition.rate)
    samples: Signals = {}
    for number, signals in enumerate(sensor_inputs, start=1):
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
    """Result of a simulated run.

    Parameters
    ----------
    recording : Recording
        Samples of the sensors.
    motion : Motion
        Motion and torques at the rate of the computation, including what no sensor measures.
    pressure : ndarray, shape (n,)
        Sound pressure at the microphone at ``motion.rate``, free of noise [Pa].
    pulse_pressure : ndarray, shape (n,)
        Part of `pressure` that slip pulses cause through the plate [Pa].
    settling : float
        Time that the rig ran before the recording starts [s].

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

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Plot the torques in contact and elastomer over the last tenth of a second.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw into; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> from matplotlib.figure import Figure
        >>> from models.rig_file import load_material_rig
        >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.1)
        >>> run.plot(Figure().subplots()).get_title("left")
        'PDMS, 0.279 mm, 2214 Nm/rad, 5 rad/s'
        """
        motion = self.motion
        part = slice(max(0, motion.torque.size - round(_SHOWN * motion.rate)), None)
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
        Motion of the shaft; a number is a constant speed [rad/s].
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.
    temperature : float
        Ambient temperature [degree Celsius]; it acts if the rig's material states a dependence.
    seconds : float
        Length of the recording [s].
    acquisition : Acquisition, optional
        Sampling rate, noise and sensors; by default 30 kHz. Sensors that it does not state are
        the rig's.
    settling : float, optional
        Time that the rig runs before the recording starts [s]; by default 0.5 at constant speed,
        otherwise 0.
    library : mapping of str to Effect, optional
        Effects by name, in which the rig's are looked up; by default `sim.effects.EFFECTS`.
    rng : numpy.random.Generator, optional
        Generator of the sensors' noise and of effects that scatter; by default seeded with 0.

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
    setting = Setting(rig, shaft_motion(shaft), interference, support_stiffness, temperature)
    plan = plan_run(
        setting, seconds=seconds, rate=acquisition.rate, settling=settling, library=library
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
    recorded = slice(plan.n_settling, None)
    return Run(
        recording=recording,
        motion=motion.part(plan.n_settling),
        pressure=sound.pressure[recorded],
        pulse_pressure=sound.pulse_pressure[recorded],
        settling=plan.n_settling / plan.rate,
    )


def sensor_channels(rig: Rig) -> tuple[Channel, ...]:
    """Return the channels of a recording of a rig."""
    return (
        Channel("torque"),
        Channel("acceleration"),
        Channel("pressure", position=rig.microphone.position),
        Channel("angle"),
    )


_SHOWN = 0.1
"""Time that a plot shows by default [s]: single slips are still visible."""


Curve = tuple[NDArray[np.float64], str, str, float]
"""Values, colour, label (empty for none) and line width of a curve."""


def torque_curves(motion: Motion, part: slice) -> list[Curve]:
    """Return the torque curves of a part of a motion; the more important one is drawn last.

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
