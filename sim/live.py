"""Live simulation of a rig whose setting changes while it runs, block by block.

Solver, path to the microphone and filters carry their state from block to block, so without changes
the sound is that of `sim.run.simulate`, except for noise and for effects that need the whole run:
those of drive and sensors, which are left out.

A change of setting takes one block: the speed is cross-faded, the motion continues from its state
in the old rig and in the new one, and their torques are cross-faded, as are the impulse responses
from torque to sound. Nothing jumps, so nothing clicks.

The sound lags behind the motion by a look-ahead, because an effect that turns slips into forces
needs to know how far the torque falls. Such an effect sees this stretch of the future only, whereas
in `simulate` it sees the whole run.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft

from models.radiation.impulse_responses import ImpulseResponses
from models.radiation.rig_response import first_mode_damping, impulse_responses
from sim.acquisition import Acquisition, Decimation, digitise
from sim.chain import apply_chain_effects
from sim.motion import Motion, MotionSolver, lookahead_samples
from sim.plan import SIMULATION, Plan, Setting, plan_run
from sim.run import pulse_force
from sim.shaft import ShaftMotion
from sim.temperature import at_temperature

_LOOKAHEAD = 0.005
"""Lag of the sound behind the motion [s]."""

_HISTORY = 0.2
"""Motion before a block that effects which exert a force see [s]."""

_LONGEST_RESPONSE = 3.0
"""Longest impulse response from torque to sound [s]."""


PathsOf = Callable[[Setting], ImpulseResponses | None]
"""Function of a setting that returns its impulse responses at the rate of the computation, or None
while they are being computed, in which case the previous ones stay."""


@dataclass(frozen=True, eq=False)
class Block:
    """Samples of one block.

    Parameters
    ----------
    pressure, torque : ndarray, shape (n,)
        As recorded [Pa], [Nm].
    speed : float
        Speed of the shaft at the end of the block [rad/s].
    """

    pressure: NDArray[np.float64]
    torque: NDArray[np.float64]
    speed: float


class LiveSimulation:
    """Open-ended simulation of the rig, whose setting can change between blocks.

    Parameters
    ----------
    setting : Setting
        Setting at the start; at constant speed the rig settles first, as in a recording.
    paths : callable
        Returns impulse responses, such as `paths_of`; the same ones while `paths_key` is the same.
        The first may not be None.
    acquisition : Acquisition, optional
        As for `sim.run.simulate`, without anti-alias filters; by default at 48 kHz.
    n : int
        Samples of a block.

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.plan import Setting
    >>> from sim.shaft import ConstantSpeed
    >>> setting = Setting(load_material_rig("PDMS"), ConstantSpeed(5.0), 0.279e-3, 2214.0)
    >>> responses = paths_of(setting, 48e3)
    >>> run = LiveSimulation(setting, lambda one: responses)
    >>> run.block().pressure.shape
    (960,)
    >>> faster = replace(setting, shaft=ConstantSpeed(6.0))
    >>> round(run.block(faster).speed, 1), round(run.block().speed, 1)
    (6.0, 6.0)
    """

    def __init__(
        self,
        setting: Setting,
        paths: PathsOf,
        *,
        acquisition: Acquisition | None = None,
        n: int = 960,
    ) -> None:
        self._acquisition = (acquisition or Acquisition(48e3)).over(setting.rig.sensors)
        factor = SIMULATION.decimation(self._acquisition.rate)
        self._rate, self._n, self._block = factor * self._acquisition.rate, n, factor * n
        self._noise_rng, self._effect_rng = np.random.default_rng(0).spawn(2)
        self._setting, self._plan = setting, live_plan(setting, self._acquisition.rate)
        self._solver = self._solver_of(self._plan, float(setting.shaft.speed(np.zeros(1))[0]))
        self._time = 0  # clock of the shaft, in samples of the computation
        self._n_history = round(_HISTORY * self._rate)
        self._paths, first = paths, paths(setting)
        assert first is not None
        self.responses = first
        self._convolution = _Convolution(
            _to_pressure(first), self._block, round(_LONGEST_RESPONSE * self._rate)
        )
        self._decimations = [Decimation(factor, self._plan.n_settling) for _ in range(2)]
        self._unread = np.zeros((2, 0))
        self._motion = self._advance(round(_LOOKAHEAD * self._rate))
        self._sent = 0  # samples of the stored motion whose sound is computed
        self._first_torque = float(self._motion.torque[0])

    def block(self, setting: Setting | None = None) -> Block:
        """Return the next samples, changing to another setting if one is passed.

        Raises
        ------
        ParameterError
            If the setting cannot be used, or the solver cannot follow the friction; the run can
            continue with the previous setting.
        """
        change = setting is not None and setting != self._setting
        while self._unread.shape[1] < self._n:
            motion = self._changed(setting) if change and setting else self._advance(self._block)
            change = False
            self._sample(motion)
        values, self._unread = self._unread[:, : self._n], self._unread[:, self._n :]
        pressure, torque = (
            digitise(row, kind, self._acquisition, self._noise_rng)
            for kind, row in zip(("pressure", "torque"), values, strict=True)
        )
        return Block(pressure, torque, float(self._motion.shaft_speed[-1]))

    def _sample(self, motion: Motion) -> None:
        """Store the next block of motion, and compute the sound of the block before it."""
        drop = max(0, self._sent - self._n_history)
        self._motion = self._motion.part(drop).followed_by(motion)
        start = self._sent - drop
        self._sent = start + self._block
        torque = self._motion.torque[start : self._sent]
        responses = self._paths(self._setting)
        if responses is not None and responses is not self.responses:
            self.responses = responses
            self._convolution.exchange(_to_pressure(responses))
        pressure = self._convolution([torque - self._first_torque, self._force(start)])
        rows = zip(self._decimations, (pressure, torque), strict=True)
        sampled = np.stack([decimate(signal) for decimate, signal in rows])
        self._unread = np.hstack([self._unread, sampled])

    def _force(self, start: int) -> NDArray[np.float64]:
        """Return the force of the effects over a block of the stored motion [N]."""
        if all(active.effect.force is None for active in self._plan.effects):
            return np.zeros(self._block)
        return pulse_force(_with_end_of_fall(self._motion), self._plan.effects)[
            start : start + self._block
        ]

    def _advance(self, n: int) -> Motion:
        drive = self._drive(self._setting.shaft, n + lookahead_samples(self._rate), self._time)
        motion = self._solver.advance(drive, n)
        self._time += n
        return motion

    def _changed(self, setting: Setting) -> Motion:
        """Return the motion of a block that changes to another setting."""
        before, n, beyond = self._setting, self._block, lookahead_samples(self._rate)
        restarted = type(setting.shaft) is not type(before.shaft)
        plan = live_plan(setting, self._acquisition.rate)
        old = self._drive(before.shaft, n + beyond, self._time)
        new = self._drive(setting.shaft, n + beyond, 0 if restarted else self._time)
        drive = old + np.concatenate([_fade_in(n), np.ones(beyond)]) * (new - old)
        solver = self._solver_of(plan, float(drive[0]))
        solver.continue_from(self._solver, float(drive[0]))
        motion = solver.advance(drive, n)
        if replace(setting, shaft=before.shaft) != before:  # more than the drive changes
            motion = _cross_faded(self._solver.advance(drive, n), motion)
        self._setting, self._plan, self._solver = setting, plan, solver
        self._time = n if restarted else self._time + n
        return motion

    def _drive(self, shaft: ShaftMotion, n: int, first: int) -> NDArray[np.float64]:
        return shaft.speed(np.arange(first, first + n, dtype=np.float64) * (1.0 / self._rate))

    def _solver_of(self, plan: Plan, start_speed: float) -> MotionSolver:
        return MotionSolver(
            plan.rig, plan.interference, plan.support_stiffness, plan.rate, plan.effects,
            deepcopy(self._effect_rng), start_speed=start_speed, tolerance=None,
        )  # fmt: skip


def live_plan(setting: Setting, rate: float) -> Plan:
    """Return the plan of a setting at a sampling rate [Hz], without effects of drive and sensors.

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.shaft import ConstantSpeed
    >>> setting = Setting(load_material_rig("PDMS"), ConstantSpeed(5.0), 0.279e-3, 2214.0)
    >>> live_plan(setting, 48e3).rate
    96000.0
    """
    plan = plan_run(setting, seconds=1.0, rate=rate)
    acting = [active for active in plan.effects if not active.effect.needs_whole_run]
    return replace(plan, effects=acting)


def paths_of(setting: Setting, rate: float) -> ImpulseResponses:
    """Return the impulse responses of a setting for a sampling rate [Hz], effects included."""
    plan = live_plan(setting, rate)
    paths = impulse_responses(plan.rig, plan.interference, plan.support_stiffness, plan.rate)
    rng = np.random.default_rng(0).spawn(2)[1].spawn(1)[0]  # that of `simulate`
    return apply_chain_effects(paths, plan.effects, rng)


def paths_key(setting: Setting) -> tuple[object, ...]:
    """Return everything that the impulse responses depend on, as a key: equal keys share them.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.plan import Setting
    >>> from sim.shaft import ConstantSpeed
    >>> one = Setting(load_material_rig("PDMS"), ConstantSpeed(5.0), 0.279e-3, 2214.0)
    >>> looser = replace(one, rig=one.rig.changed(kinetic_torque="x0.5"), shaft=ConstantSpeed(1.0))
    >>> damped = replace(one, rig=one.rig.changed(damping="x2"))
    >>> paths_key(one) == paths_key(looser), paths_key(one) == paths_key(damped)
    (True, False)
    """
    rig = at_temperature(setting.rig, setting.temperature)
    support = setting.support_stiffness
    return (
        rig.beams,
        rig.plate,
        rig.microphone,
        rig.clamp_inertia,
        rig.measured,
        support,
        0.0 if math.isinf(support) else first_mode_damping(rig, setting.interference, support),
        rig.effects,
    )


def _to_pressure(paths: ImpulseResponses) -> list[NDArray[np.float64]]:
    return [paths.torque_to_pressure, paths.pulse_to_pressure]


def _cross_faded(old: Motion, new: Motion) -> Motion:
    weight = _fade_in(new.torque.size)
    pairs = zip(old.arrays, new.arrays, strict=True)
    return Motion(new.rate, *(before + weight * (after - before) for before, after in pairs))


def _with_end_of_fall(motion: Motion) -> Motion:
    """Append a rise of the torque, so that effects count a fall that is still in progress."""
    last = motion.part(motion.torque.size - 1)
    way = -1.0 if last.shaft_speed[0] < 0.0 else 1.0
    risen = last.torque + way * float(np.ptp(motion.torque))
    return motion.followed_by(replace(last, torque=risen))


def _fade_in(n: int) -> NDArray[np.float64]:
    """Return the weights of a fade-in over `n` samples, a squared sine."""
    return np.asarray(np.sin(0.5 * np.pi * (np.arange(n) + 0.5) / n) ** 2)


class _Convolution:
    """Causal block-wise convolution of several signals, summed.

    Each response is cut into parts of one block (uniformly partitioned overlap-save), so the
    latency is one block whatever the responses' lengths. Past input is stored as spectra: exchanged
    responses act as if they had always been there, faded in over one block.

    Parameters
    ----------
    responses : sequence of ndarray, shape (m,)
        One per signal.
    block : int
        Samples of each block.
    longest : int
        Samples of past input that are stored; longer responses are cut there.
    """

    def __init__(self, responses: Sequence[NDArray[np.float64]], block: int, longest: int) -> None:
        self._block, self._parts = block, -(-longest // block)
        self._before = np.zeros((len(responses), block))
        self._input_spectra = np.zeros(
            (self._parts, len(responses), block + 1), dtype=np.complex128
        )
        self._newest = 0
        self._current = self._spectra(responses)
        self._next: NDArray[np.complex128] | None = None

    def exchange(self, responses: Sequence[NDArray[np.float64]]) -> None:
        """Fade to other responses over the next block, as many as before."""
        self._next = self._spectra(responses)

    def __call__(self, signals: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        """Return the next samples, shape (block,), for a block of each signal."""
        blocks = np.stack(list(signals))
        self._newest = (self._newest - 1) % self._parts
        self._input_spectra[self._newest] = rfft(np.hstack([self._before, blocks]))
        self._before = blocks
        output = self._convolved(self._current)
        if self._next is not None:
            output += _fade_in(self._block) * (self._convolved(self._next) - output)
            self._current, self._next = self._next, None
        return output

    def _convolved(self, spectra: NDArray[np.complex128]) -> NDArray[np.float64]:
        order = (self._newest + np.arange(len(spectra))) % self._parts
        total = np.zeros(self._block + 1, dtype=np.complex128)
        for part, own in zip(order, spectra, strict=True):
            total += np.einsum("jk,jk->k", self._input_spectra[part], own)
        return np.asarray(irfft(total)[self._block :])

    def _spectra(self, responses: Sequence[NDArray[np.float64]]) -> NDArray[np.complex128]:
        size = min(max(response.size for response in responses), self._parts * self._block)
        parts = -(-size // self._block)
        cut = np.zeros((len(responses), parts * self._block))
        for row, response in zip(cut, responses, strict=True):
            row[: min(response.size, size)] = response[:size]
        by_part = cut.reshape(len(responses), parts, self._block).transpose(1, 0, 2)
        return np.asarray(rfft(by_part, 2 * self._block))
