"""A run of any length as a stream of blocks: what `sim.run.simulate` gives, without holding it.

Solver, structure, plate and anti-alias filter carry their state from block to block. Two things
differ from a run held in memory: each channel's noise is a stream of its own, so that it does not
depend on the blocks, and the filter sees the signal before the first and after the last sample
where the other extends it by a line (10 samples at either end). An effect that makes a force of the
motion sees it half a second to both sides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np

from models.condition import Condition
from models.errors import ParameterError
from models.radiation.rig_response import response
from sim.acquisition import Acquisition, sample
from sim.chain import changed_chain
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import at_temperature
from sim.motion import Motion
from sim.motion_blocks import motion_blocks, refuse_whole_run_effects
from sim.run import _LEAST_SOUND_RATE, _channels, _check, motion_and_settling
from sim.shaft import ConstantSpeed
from sim.streams import Convolution, Decimation

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from models.radiation.impulse_responses import ImpulseResponses
    from models.recording import Channel
    from models.rig import Rig
    from sim.effects.effect import ActiveEffect, Effect
    from sim.shaft import ShaftMotion

__all__ = ["BlockRun", "simulate_blocks"]

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
        In the units of the channels; can be run through once.
    """

    rate: float
    channels: tuple[Channel, ...]
    condition: Condition
    n_samples: int
    blocks: Iterator[NDArray[np.float64]]


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
        If a value cannot be used, or an effect needs the whole run at once (those of the drive
        and of the sensors do).

    Examples
    --------
    >>> from models.rig_files.rig_file import load_material_rig
    >>> run = simulate_blocks(load_material_rig("PDMS"), 5.0, seconds=0.5, block_seconds=0.2)
    >>> run.n_samples, sum(block.shape[1] for block in run.blocks)
    (15000, 15000)
    """
    acquisition = acquisition or Acquisition()
    noise_rng, effect_rng = (rng or np.random.default_rng(0)).spawn(2)
    shaft, settling = motion_and_settling(shaft, settling)
    _check(min(seconds, 1.0), settling, acquisition.rate, interference, temperature)
    rig = replace(rig, friction=at_temperature(rig.friction, temperature))
    if not 0.0 < block_seconds < math.inf or not seconds < math.inf:
        raise ParameterError(
            f"seconds = {seconds:g} and block_seconds = {block_seconds:g} must be above 0, finite"
        )
    effects = activated(rig.effects, library or EFFECTS)
    refuse_whole_run_effects(effects)
    decimation = math.ceil(_LEAST_SOUND_RATE / acquisition.rate)
    rate = decimation * acquisition.rate
    n_samples, n_settling = round(seconds * acquisition.rate), round(settling * rate)
    decimations = [Decimation(decimation, n_settling) for _ in _channels(rig)]
    motions = motion_blocks(
        rig,
        shaft,
        interference=interference,
        support_stiffness=support_stiffness,
        n_samples=n_settling + n_samples * decimation + decimations[0].lookahead,
        rate=rate,
        block=max(2, round(block_seconds * rate)),
        effects=effects,
        rng=effect_rng,
    )
    signals = _signals(
        _with_force(motions, [a for a in effects if a.effect.force is not None], rate),
        changed_chain(
            response(rig, interference, support_stiffness, rate), effects, effect_rng.spawn(1)[0]
        ),
        n_settling,
    )
    return BlockRun(
        rate=acquisition.rate,
        channels=_channels(rig),
        condition=Condition(
            speed=shaft.value if isinstance(shaft, ConstantSpeed) else None,
            interference=interference,
            support_stiffness=support_stiffness,
            material=rig.material,
            temperature=temperature,
        ),
        n_samples=n_samples,
        blocks=_sampled(signals, decimations, acquisition, noise_rng.spawn(4), n_samples),
    )


def _with_force(
    motions: Iterator[Motion], effects: Sequence[ActiveEffect], rate: float
) -> Iterator[tuple[Motion, NDArray[np.float64] | None]]:
    """Each block with the force of the effects; with any, blocks come a margin later."""
    if not effects:
        yield from ((motion, None) for motion in motions)
        return
    margin = round(_MARGIN * rate)
    held: Motion | None = None
    emitted = 0  # samples of `held` that have gone out already
    for motion in motions:
        held = motion if held is None else _joined(held, motion)
        ready = held.torque.size - margin
        if ready > emitted:
            yield _piece(held, effects, emitted, ready)
            first = max(0, ready - margin)
            held, emitted = _cut(held, first, None), ready - first
    if held is not None:
        yield _piece(held, effects, emitted, held.torque.size)


def _piece(
    motion: Motion, effects: Sequence[ActiveEffect], start: int, stop: int
) -> tuple[Motion, NDArray[np.float64]]:
    force = np.zeros_like(motion.torque)
    for active in effects:
        if active.effect.force is not None:
            force += active.effect.force(motion, active.form, active.values)
    return _cut(motion, start, stop), force[start:stop]


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


def _sampled(
    blocks: Iterator[tuple[dict[str, NDArray[np.float64]], float]],
    decimations: Sequence[Decimation],
    acquisition: Acquisition,
    noise: Sequence[np.random.Generator],
    n_samples: int,
) -> Iterator[NDArray[np.float64]]:
    left = n_samples
    for signals, start_angle in blocks:
        rows = []
        for (kind, signal), decimate, rng in zip(signals.items(), decimations, noise, strict=True):
            values = decimate(signal)[:left]
            if kind == "angle":
                values = values - start_angle
            rows.append(sample({kind: values}, 1, acquisition, rng)[kind])
        left -= rows[0].size
        if rows[0].size:
            yield np.stack(rows)


def _arrays(motion: Motion) -> dict[str, NDArray[np.float64]]:
    names = (field.name for field in fields(motion) if field.name != "rate")
    return {name: getattr(motion, name) for name in names}


def _joined(left: Motion, right: Motion) -> Motion:
    both = {
        name: np.concatenate([values, getattr(right, name)])
        for name, values in _arrays(left).items()
    }
    return Motion(rate=left.rate, **both)


def _cut(motion: Motion, start: int, stop: int | None) -> Motion:
    kept = {name: values[start:stop] for name, values in _arrays(motion).items()}
    return Motion(rate=motion.rate, **kept)
