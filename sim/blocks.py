"""Block-wise simulation of the rig: long recordings, and designs that change while they run.

Solver, structure, plate and filters carry their state from block to block, so without changes the
result is that of `sim.run.simulate`, in bounded memory. Three things differ: each channel has its
own noise stream, effects that scatter draw other numbers, and the decimation filter reads the real
signal before the first and after the last sample, where `simulate` extends it by a straight line
(10 samples at either end).

A change of setting takes one block: the speed is cross-faded, the motion continues from its state
in the old rig and in the new one, and their torques are cross-faded, as are the impulse responses
from torque to sound. Nothing jumps, so nothing clicks.

The sound lags behind the motion by a look-ahead, because an effect that turns slips into forces
needs to know how far the torque falls. Such an effect sees this stretch of the future only, whereas
in `simulate` it sees the whole run. Effects of drive and sensors that need the whole run cannot act
here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from models.condition import Condition
from models.errors import ParameterError
from models.radiation.impulse_responses import ImpulseResponses
from models.radiation.rig_response import first_mode_damping, impulse_responses
from models.recording import Channel
from models.rig import Rig
from sim.acquisition import Acquisition, AnalogueFilter, Decimation, digitise
from sim.analysis.regime import SlidingWatch
from sim.chain import apply_chain_effects
from sim.effects.effect import (
    ActiveEffect,
    Effect,
    Memories,
    Signals,
    drive_block,
    initial_memories,
    sensors_block,
)
from sim.filters import Convolution, fade_in
from sim.motion import Motion, MotionSolver, lookahead_samples, unusual_values_first
from sim.plan import SIMULATION, Plan, Setting, plan_run
from sim.run import pulse_force, sensor_channels
from sim.shaft import ShaftMotion, shaft_motion
from sim.temperature import at_temperature

KINDS = ("torque", "acceleration", "pressure", "angle")
"""Channels of a recording, in the order of their noise."""

LOOKAHEAD = 0.005
"""Lag of the sound behind the motion where a rig is changed [s]."""

_MARGIN = 0.5
"""Motion before and after a block of a recording that effects which exert a force see [s]."""

_HISTORY = 0.2
"""Motion before a block that these effects see where a rig is changed [s]."""

_LONGEST_RESPONSE = 3.0
"""Longest impulse response from torque to sound [s]."""


PathsOf = Callable[[Setting], ImpulseResponses | None]


@dataclass(frozen=True, eq=False)
class Block:
    """Samples of one block.

    Parameters
    ----------
    samples : dict of str to ndarray, shape (n,)
        By kind of channel, as recorded [unit of the channel].
    speed : float
        Speed of the shaft at the end of the block [rad/s].
    """

    samples: Signals
    speed: float


@dataclass(frozen=True, eq=False)
class BlockRun:
    """Recording that is computed while it is read.

    Parameters
    ----------
    rate : float
        [Hz]
    channels : tuple of Channel
    condition : Condition
    n_samples : int
        Number of samples of all blocks together.
    blocks : iterator of ndarray, shape (n_channels, n)
        In the units of the channels [unit]; can be iterated once.
    watch : SlidingWatch
        Monitor of the contact, over the blocks read so far.
    """

    rate: float
    channels: tuple[Channel, ...]
    condition: Condition
    n_samples: int
    blocks: Iterator[NDArray[np.float64]]
    watch: SlidingWatch


def simulate_blocks(
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
    block_seconds: float = 0.5,
) -> BlockRun:
    """Simulate one run of the rig, block by block.

    Parameters
    ----------
    block_seconds : float
        Length of a block [s]; the memory needed is proportional to it.
    rig, shaft, interference, support_stiffness, temperature, seconds, acquisition, settling
        As for `sim.run.simulate`; `seconds` has no upper limit.
    library, rng
        As for `sim.run.simulate`.

    Returns
    -------
    BlockRun

    Raises
    ------
    ParameterError
        If a value cannot be used, or an effect needs the whole run at once.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> run = simulate_blocks(load_material_rig("PDMS"), 5.0, seconds=0.5, block_seconds=0.2)
    >>> run.n_samples, sum(block.shape[1] for block in run.blocks)
    (15000, 15000)
    """
    if not 0.0 < block_seconds < math.inf or not seconds < math.inf:
        raise ParameterError(
            f"seconds = {seconds:g} and block_seconds = {block_seconds:g} must be above 0, finite"
        )
    acquisition = acquisition or Acquisition()
    setting = Setting(rig, shaft_motion(shaft), interference, support_stiffness, temperature)
    plan = plan_run(
        setting, seconds=min(seconds, 1.0), rate=acquisition.rate, settling=settling,
        library=library,
    )  # fmt: skip
    names = whole_run_effects(plan.effects)
    if names:
        raise ParameterError(
            f"effect {', '.join(names)}: acts on a run as a whole, so it cannot act on one that "
            "is computed in blocks; make the run shorter, or leave the effect out"
        )
    forced = any(active.effect.force is not None for active in plan.effects)
    n_samples, watch = round(seconds * acquisition.rate), SlidingWatch()
    engine = BlockEngine(
        setting,
        acquisition=acquisition,
        n=max(2, round(block_seconds * acquisition.rate)),
        library=library,
        rng=rng,
        settling=settling,
        ahead=_MARGIN if forced else 0.0,
        back=_MARGIN,
        watch=watch,
    )

    def blocks() -> Iterator[NDArray[np.float64]]:
        left = n_samples
        while left > 0:
            samples = np.stack(list(engine.block().samples.values()))[:, :left]
            left -= samples.shape[1]
            yield samples

    channels = sensor_channels(rig)
    return BlockRun(acquisition.rate, channels, plan.condition, n_samples, blocks(), watch)


def whole_run_effects(effects: Sequence[ActiveEffect]) -> list[str]:
    """Return the names of the effects that need the whole run at once."""
    return [active.effect.name for active in effects if active.effect.needs_whole_run]


class BlockEngine:
    """Open-ended block-wise simulation of the rig, whose setting can change between blocks.

    Parameters
    ----------
    setting : Setting
        Setting at the start; at constant speed the rig settles first, as in a recording.
    acquisition : Acquisition, optional
        As for `sim.run.simulate`; by default at 48 kHz.
    n : int
        Samples of a block.
    kinds : tuple of str
        Channels to compute, of `KINDS`.
    library, rng, settling
        As for `sim.run.simulate`.
    ahead, back : float
        Motion after and before a block that effects which exert a force see [s].
    paths : callable, optional
        Function of a setting that returns impulse responses at the rate of the computation, or None
        while they are being computed, in which case the previous ones stay; by default they are
        computed at once.
    watch : SlidingWatch, optional
        Monitor that the recorded motion is passed to.

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
    >>> run = BlockEngine(setting)
    >>> run.block().samples["pressure"].shape
    (960,)
    >>> faster = replace(setting, shaft=ConstantSpeed(6.0))
    >>> round(run.block(faster).speed, 1), round(run.block().speed, 1)
    (6.0, 6.0)
    """

    def __init__(
        self,
        setting: Setting,
        *,
        acquisition: Acquisition | None = None,
        n: int = 960,
        kinds: tuple[str, ...] = KINDS,
        library: Mapping[str, Effect] | None = None,
        rng: np.random.Generator | None = None,
        settling: float | None = None,
        ahead: float = LOOKAHEAD,
        back: float = _HISTORY,
        paths: PathsOf | None = None,
        watch: SlidingWatch | None = None,
    ) -> None:
        self._acquisition = (acquisition or Acquisition(48e3)).over(setting.rig.sensors)
        factor = SIMULATION.decimation(self._acquisition.rate)
        self._rate, self._n, self._block = factor * self._acquisition.rate, n, factor * n
        self._kinds, self._library, self._watch = kinds, library, watch
        noise_rng, self._effect_rng = (rng or np.random.default_rng(0)).spawn(2)
        self._noise = dict(zip(KINDS, noise_rng.spawn(len(KINDS)), strict=True))
        self._chain_rng, block_rng = self._effect_rng.spawn(2)
        self._seed = int(block_rng.integers(2**31))
        self._setting = setting
        self._plan = plan_of(setting, self._acquisition.rate, library, settling)
        self._n_settling = self._plan.n_settling
        self._solver = self._solver_of(self._plan, float(setting.shaft.speed(np.zeros(1))[0]))
        self._drive_memories: Memories = {}
        self._sensor_memories: Memories = {}
        self._sensor_effects = self._plan.effects
        self._time = 0  # clock of the shaft, in samples of the computation
        self._n_history = round(back * self._rate)
        self._paths = paths or self._computed_paths
        self._cached: tuple[tuple[object, ...], ImpulseResponses] | None = None
        self.responses = self._paths(setting) or self._computed_paths(setting)
        self._convolution = Convolution(
            self._impulse_responses(self.responses), self._block,
            round(_LONGEST_RESPONSE * self._rate),
        )  # fmt: skip
        sensors = self._acquisition.sensors
        self._filters = [
            AnalogueFilter(sensors.of(kind).antialias, self._rate, self._n_settling)
            for kind in kinds
        ]
        self._decimations = [Decimation(factor, self._n_settling) for _ in kinds]
        self._unread = np.zeros((len(kinds), 0))
        self._motion = self._advance(max(1, round(ahead * self._rate)))
        self._sent = 0  # samples passed to the sensors: of the stored motion, and of the run
        self._position = 0
        self._first_torque, self._start_angle = float(self._motion.torque[0]), 0.0

    @property
    def setting(self) -> Setting:
        """Current setting."""
        return self._setting

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
        samples = {}
        for kind, row in zip(self._kinds, values, strict=True):
            signal = row - self._start_angle if kind == "angle" else row
            samples[kind] = digitise(signal, kind, self._acquisition, self._noise[kind])
        return Block(samples, float(self._motion.shaft_speed[-1]))

    def _sample(self, motion: Motion) -> None:
        """Store the next block of motion, and pass the block before it through the sensors."""
        drop = max(0, self._sent - self._n_history)
        self._motion = self._motion.part(drop).followed_by(motion)
        start = self._sent - drop
        self._sent = start + self._block
        part = self._motion.part(start, self._sent)
        first = self._n_settling - self._position  # first sample of the recording
        self._position += self._block
        if 0 <= first < self._block:
            self._start_angle = float(part.shaft_angle[first])
        if self._watch is not None:
            self._watch.update(part.part(max(0, first)))
        responses = self._paths(self._setting)
        if responses is not None and responses is not self.responses:
            self.responses = responses
            self._convolution.exchange(self._impulse_responses(responses))
        sound = self._convolution([part.torque - self._first_torque, self._force(start)])
        signals = {"torque": part.torque, "angle": part.shaft_angle}
        signals |= dict(zip(self._sounds, sound, strict=True))
        signals = self._apply_sensor_effects(
            {kind: signals[kind] for kind in self._kinds}, max(0, first)
        )
        rows = [
            decimate(low_pass(signals[kind]))
            for kind, low_pass, decimate in zip(
                self._kinds, self._filters, self._decimations, strict=True
            )
        ]
        self._unread = np.hstack([self._unread, np.stack(rows)])

    @property
    def _sounds(self) -> list[str]:
        return [kind for kind in ("acceleration", "pressure") if kind in self._kinds]

    def _impulse_responses(self, paths: ImpulseResponses) -> list[list[NDArray[np.float64]]]:
        """Return the responses to torque and to force, one row per channel of `_sounds`."""
        by_kind = {
            "acceleration": [paths.torque_to_acceleration, paths.pulse_to_acceleration],
            "pressure": [paths.torque_to_pressure, paths.pulse_to_pressure],
        }
        return [by_kind[kind] for kind in self._sounds]

    def _computed_paths(self, setting: Setting) -> ImpulseResponses:
        """Compute the impulse responses of a setting; those of the last one are cached."""
        key = paths_key(setting)
        if self._cached is None or self._cached[0] != key:
            rate = self._acquisition.rate
            rng = deepcopy(self._chain_rng)
            self._cached = key, paths_of(setting, rate, library=self._library, rng=rng)
        return self._cached[1]

    def _force(self, start: int) -> NDArray[np.float64]:
        """Return the force of the effects over a block of the stored motion [N]."""
        if all(active.effect.force is None for active in self._plan.effects):
            return np.zeros(self._block)
        return pulse_force(_with_end_of_fall(self._motion), self._plan.effects)[
            start : start + self._block
        ]

    def _apply_sensor_effects(self, signals: Signals, first: int) -> Signals:
        """Apply the effects on sensors to a block; effects that changed are cross-faded."""
        effects, before = self._plan.effects, self._sensor_effects
        if first >= self._block or not (effects or before):
            return signals
        recorded = {kind: signal[first:] for kind, signal in signals.items()}
        memories = initial_memories(effects, self._seed, self._sensor_memories)
        changed, later_memories = sensors_block(recorded, self._rate, effects, memories)
        if before != effects:
            memories = initial_memories(before, self._seed, self._sensor_memories)
            old, _ = sensors_block(recorded, self._rate, before, memories)
            weight = fade_in(self._block - first)
            changed = {name: old[name] + weight * (changed[name] - old[name]) for name in changed}
        self._sensor_effects = effects
        self._sensor_memories = later_memories
        return {kind: np.concatenate([signals[kind][:first], changed[kind]]) for kind in signals}

    def _advance(self, n: int) -> Motion:
        even = self._drive(self._setting.shaft, n + lookahead_samples(self._rate))
        drive, memories = self._uneven(even, n, self._plan.effects)
        with unusual_values_first(self._plan.rig):
            motion = self._solver.advance(drive, n)
        self._time += n
        self._drive_memories = memories
        return motion

    def _changed(self, setting: Setting) -> Motion:
        """Return the motion of a block that changes to another setting."""
        before, n, beyond = self._setting, self._block, lookahead_samples(self._rate)
        restarted = type(setting.shaft) is not type(before.shaft)
        plan = plan_of(setting, self._acquisition.rate, self._library)
        weight = np.concatenate([fade_in(n), np.ones(beyond)])
        old = self._drive(before.shaft, n + beyond)
        new = self._drive(setting.shaft, n + beyond, 0 if restarted else self._time)
        even = old + weight * (new - old)
        drive, memories = self._uneven(even, n, plan.effects)
        if plan.effects != self._plan.effects:
            uneven, _ = self._uneven(even, n, self._plan.effects)
            drive = uneven + weight * (drive - uneven)
        solver = self._solver_of(plan, float(drive[0]))
        solver.continue_from(self._solver, float(drive[0]))
        with unusual_values_first(plan.rig):
            motion = solver.advance(drive, n)
        if replace(setting, shaft=before.shaft) != before:  # more than the drive changes
            motion = _cross_faded(self._solver.advance(drive, n), motion)
        self._setting, self._plan, self._solver = setting, plan, solver
        self._drive_memories = memories
        self._time = n if restarted else self._time + n
        return motion

    def _drive(self, shaft: ShaftMotion, n: int, first: int | None = None) -> NDArray[np.float64]:
        first = self._time if first is None else first
        return shaft.speed(np.arange(first, first + n, dtype=np.float64) * (1.0 / self._rate))

    def _uneven(
        self, even: NDArray[np.float64], n: int, effects: Sequence[ActiveEffect]
    ) -> tuple[NDArray[np.float64], Memories]:
        memories = initial_memories(effects, self._seed, self._drive_memories)
        return drive_block(even, n, self._rate, effects, memories)

    def _solver_of(self, plan: Plan, start_speed: float) -> MotionSolver:
        with unusual_values_first(plan.rig):
            return MotionSolver(
                plan.rig, plan.interference, plan.support_stiffness, plan.rate, plan.effects,
                deepcopy(self._effect_rng), start_speed=start_speed, tolerance=None,
            )  # fmt: skip


def plan_of(
    setting: Setting,
    rate: float,
    library: Mapping[str, Effect] | None = None,
    settling: float | None = None,
) -> Plan:
    """Return the plan of a setting at a sampling rate [Hz], with the effects that act on blocks."""
    plan = plan_run(
        setting, seconds=max(1.0, 2.0 / rate), rate=rate, settling=settling, library=library
    )
    effects = [active for active in plan.effects if not active.effect.needs_whole_run]
    return replace(plan, effects=effects)


def paths_of(
    setting: Setting,
    rate: float,
    *,
    library: Mapping[str, Effect] | None = None,
    rng: np.random.Generator | None = None,
) -> ImpulseResponses:
    """Return the impulse responses of a setting for a sampling rate [Hz], effects included."""
    plan = plan_of(setting, rate, library)
    paths = impulse_responses(plan.rig, plan.interference, plan.support_stiffness, plan.rate)
    return apply_chain_effects(
        paths, plan.effects, rng or np.random.default_rng(0).spawn(2)[1].spawn(1)[0]
    )


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


def _cross_faded(old: Motion, new: Motion) -> Motion:
    weight = fade_in(new.torque.size)
    pairs = zip(old.arrays, new.arrays, strict=True)
    return Motion(new.rate, *(before + weight * (after - before) for before, after in pairs))


def _with_end_of_fall(motion: Motion) -> Motion:
    """Append a rise of the torque, so that effects count a fall that is still in progress."""
    last = motion.part(motion.torque.size - 1)
    way = -1.0 if last.shaft_speed[0] < 0.0 else 1.0
    risen = last.torque + way * float(np.ptp(motion.torque))
    return motion.followed_by(replace(last, torque=risen))
