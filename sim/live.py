"""A rig that turns on while it is changed: the sound of one run, block by block as it is asked.

What does not change is the run that `sim.long_run.simulate_blocks` gives, sample by sample. A
change takes effect over one block: speeds go from one to the other, what moves goes on from where
it is in the rig as it was and as it is now, and the torques cross over; so do the impulse responses
from torque to sound. Nothing jumps, so nothing clicks.

The sound lags behind the motion by `LOOKAHEAD`, in which a slip shows how far the torque falls: an
effect that makes a force of the motion sees so much of what is to come, where a whole run shows it
all. Effects of drive and sensors that need a run as a whole are left out; those that act here have
other random numbers than in a recording.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np

from sim.acquisition import Acquisition, digitise
from sim.effect_blocks import begun, drive_block, sensors_block
from sim.live_setting import KnownPaths, Setting, paths_of, plan_of, streams
from sim.motion import Motion, MotionSolver, steps_beyond
from sim.motion_limits import blaming_the_unusual
from sim.pipeline import pulse_force
from sim.streams import AnalogueFilter, Decimation, LiveConvolution, crossing
from sim.timing import SIMULATION

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from models.radiation.impulse_responses import ImpulseResponses
    from sim.effect_blocks import Memories
    from sim.effects.effect import ActiveEffect, Effect, Signals
    from sim.pipeline import Plan
    from sim.shaft import ShaftMotion

    PathsOf = Callable[["Setting"], ImpulseResponses | None]

__all__ = ["LOOKAHEAD", "LiveBlock", "LiveRun"]

LOOKAHEAD = 0.005
"""By which the sound lags behind the motion [s]."""

_SEEN = 0.2
"""Of the motion before a block, that effects which make a force see [s]."""

_LONGEST_RESPONSE = 3.0
"""From torque to sound [s]."""


@dataclass(frozen=True, eq=False)
class LiveBlock:
    """What came next.

    Parameters
    ----------
    pressure : ndarray, shape (n,)
        As recorded [Pa].
    torque : ndarray, shape (n,)
        Of the bushing on the clamp [Nm].
    speed : float
        Of the shaft at the end [rad/s].
    """

    pressure: NDArray[np.float64]
    torque: NDArray[np.float64]
    speed: float


class LiveRun:
    """One run of the rig that goes on while it is changed.

    Parameters
    ----------
    setting : Setting
        That it starts with; a shaft of constant speed has turned for a while, as in a recording.
    rate : float
        Of the sound [Hz].
    n : int
        Samples of a block.
    library : mapping of str to Effect, optional
        As for `sim.run.simulate`.
    seed : int
        Of the sensors' noise and of effects that scatter.
    paths : callable, optional
        From setting to impulse responses, at the rate of the computation, or to None while they are
        not known, for which those before stay; by default they are computed at once.

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.shaft import ConstantSpeed
    >>> setting = Setting(load_material_rig("PDMS"), ConstantSpeed(5.0), 0.279e-3, 2214.0)
    >>> run = LiveRun(setting)
    >>> run.block().pressure.shape
    (960,)
    >>> faster = replace(setting, shaft=ConstantSpeed(6.0))
    >>> round(run.block(faster).speed, 1), round(run.block().speed, 1)
    (6.0, 6.0)
    """

    def __init__(
        self,
        setting: Setting,
        *,
        rate: float = 48e3,
        n: int = 960,
        library: Mapping[str, Effect] | None = None,
        seed: int = 0,
        paths: PathsOf | None = None,
    ) -> None:
        factor = SIMULATION.decimation(rate)
        self._rate, self._n, self._block = factor * rate, n, factor * n
        self._output_rate, self._library, self._seed = rate, library, seed
        self._paths = paths or KnownPaths(rate, library, seed)
        self._setting = setting
        self._plan = plan_of(setting, rate, library, n)
        self._solver = self._solver_of(self._plan, float(setting.shaft.speed(np.zeros(1))[0]))
        self._driving: Memories = {}  # what effects of the drive keep, and those of the sensors
        self._sensing: Memories = {}
        self._sensed_by = self._plan.effects
        self._time = 0  # of the shaft's clock, in samples of the computation
        self._lookahead = round(LOOKAHEAD * self._rate)
        self._seen = round(_SEEN * self._rate)
        self._held = self._advance(self._lookahead)
        self._emitted = 0  # samples of `held` that have gone out
        self._first_torque = float(self._held.torque[0])
        found = self._paths(setting) or paths_of(setting, rate, library=library, seed=seed)
        self._found = found
        self._convolution = LiveConvolution(
            _to_pressure(found), self._block, round(_LONGEST_RESPONSE * self._rate)
        )
        acquisition = Acquisition(rate=rate).over(setting.rig.sensors)
        corner = acquisition.sensors.of("pressure").antialias
        n_settling = self._plan.n_settling
        self._filter = AnalogueFilter(corner, self._rate, n_settling)
        self._decimations = [Decimation(factor, n_settling) for _ in range(2)]
        self._acquisition = acquisition
        self._noise = streams(seed)[0].spawn(4)[2]  # torque, acceleration, pressure, angle
        self._ready = np.zeros((2, 0))

    @property
    def setting(self) -> Setting:
        """As it is now."""
        return self._setting

    def block(self, setting: Setting | None = None) -> LiveBlock:
        """Return the next samples, in which another setting takes over if one is given.

        Raises
        ------
        ParameterError
            If the setting cannot be used, or the friction not be followed; the run can go on as it
            was.
        """
        change = setting is not None and setting != self._setting
        while self._ready.shape[1] < self._n:
            motion = self._changed(setting) if change and setting else self._advance(self._block)
            change = False
            self._emit(motion)
        found, self._ready = self._ready[:, : self._n], self._ready[:, self._n :]
        pressure = digitise(found[0], "pressure", self._acquisition, self._noise)
        return LiveBlock(pressure, found[1], float(self._held.shaft_speed[-1]))

    def _emit(self, motion: Motion) -> None:
        """Send the next block of motion, and what it shows of the one before, to the microphone."""
        drop = max(0, self._emitted - self._seen)
        self._held = self._held.since(drop).followed_by(motion)
        start = self._emitted - drop
        stop = start + self._block
        force = self._force(start, stop)
        found = self._paths(self._setting)
        if found is not None and found is not self._found:
            self._found = found
            self._convolution.exchange(_to_pressure(found))
        torque = self._held.torque[start:stop]
        pressure = self._convolution([torque - self._first_torque, force])
        self._emitted = stop
        sensed = self._sensed({"torque": torque, "pressure": pressure})
        signals = self._filter(sensed["pressure"]), sensed["torque"]
        rows = [
            decimate(signal) for decimate, signal in zip(self._decimations, signals, strict=True)
        ]
        self._ready = np.hstack([self._ready, np.stack(rows)])

    def _sensed(self, signals: Signals) -> Signals:
        """Signals of a block as effects on sensors change them; effects that differ cross over."""
        effects, before = self._plan.effects, self._sensed_by
        memories = begun(effects, self._seed) | self._sensing
        made, kept = sensors_block(signals, self._rate, effects, memories)
        if before != effects:
            memories = begun(before, self._seed) | self._sensing
            old, _ = sensors_block(signals, self._rate, before, memories)
            coming = crossing(self._block)
            made = {name: old[name] + coming * (made[name] - old[name]) for name in made}
        self._sensed_by = effects
        self._sensing = _of(effects, kept)
        return made

    def _force(self, start: int, stop: int) -> NDArray[np.float64]:
        """Force of the effects over samples of what is held [N]."""
        if all(active.effect.force is None for active in self._plan.effects):
            return np.zeros(stop - start)
        return pulse_force(_ended(self._held), self._plan.effects)[start:stop]

    def _advance(self, n: int) -> Motion:
        even = self._drive(self._setting.shaft, n + steps_beyond(self._rate))
        drive, driving = self._uneven(even, n, self._plan.effects)
        with blaming_the_unusual(self._plan.rig):
            motion = self._solver.advance(drive, n)
        self._time += n
        self._driving = driving
        return motion

    def _changed(self, setting: Setting) -> Motion:
        """Motion of a block in which a setting takes over."""
        before, n, beyond = self._setting, self._block, steps_beyond(self._rate)
        restarted = type(setting.shaft) is not type(before.shaft)
        plan = plan_of(setting, self._output_rate, self._library, self._n)
        coming = np.concatenate([crossing(n), np.ones(beyond)])
        old = self._drive(before.shaft, n + beyond)
        new = self._drive(setting.shaft, n + beyond, 0 if restarted else self._time)
        even = old + coming * (new - old)
        drive, driving = self._uneven(even, n, plan.effects)
        if plan.effects != self._plan.effects:
            uneven, _ = self._uneven(even, n, self._plan.effects)
            drive = uneven + coming * (drive - uneven)
        solver = self._solver_of(plan, float(drive[0]))
        solver.go_on_from(self._solver, float(drive[0]))
        with blaming_the_unusual(plan.rig):
            motion = solver.advance(drive, n)
        if not setting.moves_as(before):
            motion = _crossed(self._solver.advance(drive, n), motion)
        self._setting, self._plan, self._solver = setting, plan, solver
        self._driving = driving
        self._time = n if restarted else self._time + n
        return motion

    def _drive(self, shaft: ShaftMotion, n: int, first: int | None = None) -> NDArray[np.float64]:
        first = self._time if first is None else first
        return shaft.speed(np.arange(first, first + n, dtype=np.float64) * (1.0 / self._rate))

    def _uneven(
        self, even: NDArray[np.float64], n: int, effects: Sequence[ActiveEffect]
    ) -> tuple[NDArray[np.float64], Memories]:
        memories = begun(effects, self._seed) | self._driving
        driven, kept = drive_block(even, n, self._rate, effects, memories)
        return driven, _of(effects, kept)

    def _solver_of(self, plan: Plan, start_speed: float) -> MotionSolver:
        with blaming_the_unusual(plan.rig):
            return MotionSolver(
                plan.rig, plan.interference, plan.support_stiffness, plan.rate, plan.effects,
                streams(self._seed)[1], start_speed=start_speed,
                top_speed=plan.shaft.top_speed(math.inf), tolerance=None,
            )  # fmt: skip


def _of(effects: Sequence[ActiveEffect], memories: Memories) -> Memories:
    names = {active.effect.name for active in effects}
    return {name: memory for name, memory in memories.items() if name in names}


def _to_pressure(paths: ImpulseResponses) -> list[NDArray[np.float64]]:
    return [paths.torque_to_pressure, paths.pulse_to_pressure]


def _crossed(old: Motion, new: Motion) -> Motion:
    coming = crossing(new.torque.size)
    names = [field.name for field in fields(Motion) if field.name != "rate"]
    crossed = {}
    for name in names:
        before = getattr(old, name)
        crossed[name] = before + coming * (getattr(new, name) - before)
    return Motion(new.rate, **crossed)


def _ended(held: Motion) -> Motion:
    """Return a motion whose last fall of the torque is over, for what waits to count it."""
    last = held.part(held.torque.size - 1)
    way = -1.0 if last.shaft_speed[0] < 0.0 else 1.0
    risen = last.torque + way * float(np.ptp(held.torque))
    return held.followed_by(replace(last, torque=risen))
