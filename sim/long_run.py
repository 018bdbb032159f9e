"""A run of any length as a stream of blocks: what `sim.run.simulate` gives, without holding it.

Solver, structure, plate and anti-alias filter carry their state from block to block. Two things
differ from a run held in memory: each channel's noise is a stream of its own, so that it does not
depend on the blocks, and the filter sees the signal before the first and after the last sample
where the other extends it by a line (10 samples at either end). An effect that makes a force of the
motion sees it half a second to both sides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.radiation.rig_response import impulse_responses
from sim.acquisition import Acquisition, digitise
from sim.analysis.regime import SlidingWatch
from sim.chain import changed_chain
from sim.effect_blocks import begun, sensors_block
from sim.motion import motion_blocks
from sim.pipeline import pulse_force
from sim.run import plan_run, sensor_channels
from sim.streams import AnalogueFilter, Convolution, Decimation
from sim.timing import SIMULATION

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from models.condition import Condition
    from models.radiation.impulse_responses import ImpulseResponses
    from models.recording import Channel
    from models.rig import Rig
    from sim.effects.effect import ActiveEffect, Effect
    from sim.motion import Motion
    from sim.pipeline import Plan
    from sim.shaft import ShaftMotion

__all__ = ["BlockRun", "simulate_blocks", "whole_run_effects"]

_MARGIN = 0.5
"""Of the motion, to both sides of a block, that effects which make a force see [s]."""


@dataclass(frozen=True, eq=False)
class BlockRun:
    """A recording that is computed while it is read.

    Parameters
    ----------
    rate : float
        [Hz]
    channels : tuple of Channel
    condition : Condition
    n_samples : int
        Of all blocks together.
    blocks : iterator of ndarray, shape (n_channels, n)
        In the units of the channels [unit]; can be run through once.
    watch : SlidingWatch
        Of the contact; knows as much of the run as has been read of the blocks.
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
        Length of a block [s]; the memory that is needed grows with it.
    rig, shaft, interference, support_stiffness, temperature, seconds, acquisition, settling
        As for `sim.run.simulate`; `seconds` is not bounded.
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
    acquisition = (acquisition or Acquisition()).over(rig.sensors)
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
        in_blocks=True,
    )
    _refuse_whole_run_effects(plan.effects)
    channels, n_samples = sensor_channels(rig), round(seconds * acquisition.rate)
    decimation = SIMULATION.decimation(acquisition.rate)
    filters = [
        AnalogueFilter(acquisition.sensors.of(channel.kind).antialias, plan.rate, plan.n_settling)
        for channel in channels
    ]
    decimations = [Decimation(decimation, plan.n_settling) for _ in channels]
    chain_rng, block_rng = effect_rng.spawn(2)
    seed = int(block_rng.integers(2**31))
    motions = motion_blocks(
        plan.rig,
        plan.shaft,
        interference=interference,
        support_stiffness=support_stiffness,
        n_samples=plan.n_settling + plan.n_kept + decimations[0].lookahead,
        rate=plan.rate,
        block=max(2, round(block_seconds * plan.rate)),
        effects=plan.effects,
        rng=effect_rng,
        seed=seed,
    )
    watch = SlidingWatch()
    paths = impulse_responses(plan.rig, interference, support_stiffness, plan.rate)
    signals = _signals(
        _with_force(_watched(motions, watch, plan.n_settling), plan),
        changed_chain(paths, plan.effects, chain_rng),
        plan.n_settling,
    )
    signals = _sensed(signals, plan, seed)
    return BlockRun(
        rate=acquisition.rate,
        channels=channels,
        condition=plan.condition,
        n_samples=n_samples,
        blocks=_sampled(signals, filters, decimations, acquisition, noise_rng.spawn(4), n_samples),
        watch=watch,
    )


def whole_run_effects(effects: Sequence[ActiveEffect]) -> list[str]:
    """Names of the effects that need the whole run at once."""
    return [active.effect.name for active in effects if active.effect.needs_whole_run]


def _refuse_whole_run_effects(effects: Sequence[ActiveEffect]) -> None:
    names = whole_run_effects(effects)
    if names:
        raise ParameterError(
            f"effect {', '.join(names)}: acts on a run as a whole, so it cannot act on one that "
            "is computed in blocks; make the run shorter, or leave the effect out"
        )


def _watched(motions: Iterator[Motion], watch: SlidingWatch, n_settling: int) -> Iterator[Motion]:
    """Pass a motion on, and let what is kept of it be seen."""
    position = 0
    for motion in motions:
        watch.see(motion.since(max(0, n_settling - position)))
        position += motion.torque.size
        yield motion


def _with_force(
    motions: Iterator[Motion], plan: Plan
) -> Iterator[tuple[Motion, NDArray[np.float64] | None]]:
    """Each block with the force of the effects; with any, blocks come a margin later."""
    if all(active.effect.force is None for active in plan.effects):
        yield from ((motion, None) for motion in motions)
        return
    margin = round(_MARGIN * plan.rate)
    held: Motion | None = None
    emitted = 0  # samples of `held` that have gone out already
    for motion in motions:
        held = motion if held is None else held.followed_by(motion)
        ready = held.torque.size - margin
        if ready > emitted:
            force = pulse_force(held, plan.effects)
            yield held.part(emitted, ready), force[emitted:ready]
            first = max(0, ready - margin)
            held, emitted = held.since(first), ready - first
    if held is not None:
        yield held.since(emitted), pulse_force(held, plan.effects)[emitted:]


def _signals(
    blocks: Iterator[tuple[Motion, NDArray[np.float64] | None]],
    paths: ImpulseResponses,
    n_settling: int,
) -> Iterator[tuple[dict[str, NDArray[np.float64]], float]]:
    """Signals of each block as the sensors see them, and the angle where the recording starts."""
    by_torque = Convolution([paths.torque_to_acceleration, paths.torque_to_pressure])
    by_force = Convolution([paths.pulse_to_acceleration, paths.pulse_to_pressure])
    first_torque: float | None = None
    start_angle, position = 0.0, 0
    for motion, force in blocks:
        if first_torque is None:
            first_torque = float(motion.torque[0])
        acceleration, pressure = by_torque(motion.torque - first_torque)
        if force is not None:
            more_acceleration, more_pressure = by_force(force)
            acceleration, pressure = acceleration + more_acceleration, pressure + more_pressure
        if position <= n_settling < position + motion.torque.size:
            start_angle = float(motion.shaft_angle[n_settling - position])
        position += motion.torque.size
        signals = {
            "torque": motion.torque,
            "acceleration": acceleration,
            "pressure": pressure,
            "angle": motion.shaft_angle,
        }
        yield signals, start_angle


def _sensed(
    blocks: Iterator[tuple[dict[str, NDArray[np.float64]], float]], plan: Plan, seed: int
) -> Iterator[tuple[dict[str, NDArray[np.float64]], float]]:
    """Each block as effects on sensors change it from where the recording starts."""
    memories, position = begun(plan.effects, seed), 0
    for signals, start_angle in blocks:
        n, first = signals["torque"].size, max(0, plan.n_settling - position)
        position += n
        if first < n and plan.effects:
            kept = {kind: signal[first:] for kind, signal in signals.items()}
            read, memories = sensors_block(kept, plan.rate, plan.effects, memories)
            signals = {
                kind: np.concatenate([signal[:first], read[kind]])
                for kind, signal in signals.items()
            }
        yield signals, start_angle


def _sampled(
    blocks: Iterator[tuple[dict[str, NDArray[np.float64]], float]],
    filters: Sequence[AnalogueFilter],
    decimations: Sequence[Decimation],
    acquisition: Acquisition,
    noise: Sequence[np.random.Generator],
    n_samples: int,
) -> Iterator[NDArray[np.float64]]:
    left = n_samples
    for signals, start_angle in blocks:
        rows = []
        steps = zip(signals.items(), filters, decimations, noise, strict=True)
        for (kind, signal), low_pass, decimate, rng in steps:
            values = decimate(low_pass(signal))[:left]
            if kind == "angle":
                values = values - start_angle
            rows.append(digitise(values, kind, acquisition, rng))
        left -= rows[0].size
        if rows[0].size:
            yield np.stack(rows)
