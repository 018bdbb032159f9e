"""The motion of a run that is too long to be held in memory: solved block by block.

Each block starts from the state in which the one before ended, so the blocks joined are the motion
of one run. What belongs to a run as a whole cannot be cut: effects that change the drive are given
the speed from its first sample to its last, so such runs are refused.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from sim.bushing import lumped_bushing
from sim.friction import friction_law
from sim.motion import Motion, _friction, _integral, _refuse_fast, _refuse_overflow, contact_hooks
from sim.parameters import resolve
from sim.solvers.contact_solver import LONGEST_STEP, ContactRun
from sim.solvers.stick_slip import advance_stick_slip, rest_state

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from models.rig import Rig
    from sim.effects.effect import ActiveEffect
    from sim.shaft import ShaftMotion

__all__ = ["motion_blocks", "refuse_whole_run_effects", "whole_run_effects"]


def whole_run_effects(effects: Sequence[ActiveEffect]) -> list[str]:
    """Names of the effects that need the whole run at once: those of drive and sensors."""
    return [
        active.effect.name
        for active in effects
        if active.effect.drive is not None or active.effect.sensors is not None
    ]


def refuse_whole_run_effects(effects: Sequence[ActiveEffect]) -> None:
    """Refuse effects that need the whole run at once.

    Raises
    ------
    ParameterError
        Naming them.
    """
    names = whole_run_effects(effects)
    if names:
        raise ParameterError(
            f"effect {', '.join(names)}: acts on a run as a whole, so it cannot act on one that "
            "is computed in blocks; make the run shorter, or leave the effect out"
        )


def motion_blocks(
    rig: Rig,
    shaft: ShaftMotion,
    *,
    interference: float,
    support_stiffness: float,
    n_samples: int,
    rate: float,
    block: int,
    effects: Sequence[ActiveEffect] = (),
    rng: np.random.Generator | None = None,
) -> Iterator[Motion]:
    """Simulate the rig from rest, block by block.

    Parameters
    ----------
    rig, shaft, interference, support_stiffness, rate, effects, rng
        As for `sim.motion.simulate_motion`.
    n_samples, block : int
        Of the run, and of a block; the last one may be shorter.

    Yields
    ------
    Motion
        Joined they are what `simulate_motion` gives, to rounding.

    Raises
    ------
    ParameterError
        As `simulate_motion`, or if an effect needs the whole run at once.

    Examples
    --------
    >>> from models.rig_files.rig_file import load_material_rig
    >>> from sim.shaft import ConstantSpeed
    >>> blocks = motion_blocks(
    ...     load_material_rig("fluorocarbon-thesis"), ConstantSpeed(1.0), interference=0.279e-3,
    ...     support_stiffness=3745.0, n_samples=2500, rate=30e3, block=1000,
    ... )
    >>> [block.torque.size for block in blocks]
    [1000, 1000, 500]
    """
    refuse_whole_run_effects(effects)
    rng = rng or np.random.default_rng(0)
    step = 1.0 / rate
    system = lumped_bushing(rig, interference, support_stiffness)
    packed, fit = system.packed(), rig.fit(interference)
    law = friction_law(rig.friction.name)
    values = resolve(f"friction law {law.name!r}", law.parameters, rig.friction.parameters)
    hooks = contact_hooks(effects, rng)
    torques = fit.critical_torque, fit.kinetic_torque
    starts = range(0, n_samples, block)
    start_speed = float(shaft.speed(np.zeros(1))[0])
    state, contact = rest_state(start_speed), None
    if law.torque is not None or hooks:
        coefficients = law.coefficients(values)
        top = max(float(np.abs(_speed(shaft, i, block, step)).max()) for i in starts)
        _refuse_fast(system, rig, fit.kinetic_torque, values, np.array([top]))
        contact = ContactRun(
            packed, *torques, start_speed, step, law=law.torque, coefficients=coefficients,
            law_state=law.state(coefficients), hooks=hooks, name=_friction(law.name, effects),
            tolerance=law.tolerance,
        )  # fmt: skip
    angle = 0.0
    for start in starts:
        n = min(block, n_samples - start)
        drive = _speed(shaft, start, n, step)
        if contact is None:
            states, _, _ = advance_stick_slip(packed, *torques, drive, step, state, n)
            speed = drive[:-1]
        else:
            # Steps reach beyond the block.
            beyond = _speed(shaft, start, n + math.ceil(LONGEST_STEP / step), step)
            states, _ = contact.advance(beyond, n)
            speed = states[:, 6]
        _refuse_overflow(states, system, rig, drive)
        angles = angle + _integral(drive, step)
        angle = angles[-1]
        yield Motion(
            rate=rate,
            torque=states[:, 1],
            friction_torque=states[:, 0],
            shaft_angle=angles[:-1],
            shaft_speed=speed,
            interface_angle=states[:, 2],
            interface_speed=states[:, 3],
            clamp_angle=states[:, 4],
            clamp_speed=states[:, 5],
        )


def _speed(shaft: ShaftMotion, start: int, n: int, step: float) -> NDArray[np.float64]:
    """Speed of the drive at `n` samples and the one after them."""
    return shaft.speed(np.arange(start, start + n + 1, dtype=np.float64) * step)
