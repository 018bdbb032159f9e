"""What single recordings said, freed of what the reading itself adds.

A contact that gives way in stick looks like a softer elastomer; a band limit makes slips rounder.
How much, the identified rig tells: it is simulated at the condition of a recording, read in the
same way, and what comes out is compared with what was put in (indirect inference: Gourieroux,
Monfort and Renault 1993).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.identification.bushing_fit import fit_bushing
from noise.identification.levels import torque_levels
from sim.bushing import lumped_bushing
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from models.rig import Rig
    from noise.identification.bushing_fit import BushingFit, Known
    from noise.identification.levels import Levels
    from noise.identification.measured import Measured
    from noise.identification.outcome import Seen

__all__ = ["corrected", "values_of"]

_SETTLING, _SECONDS = 0.1, 0.6
_MOST = 2.0
"""Factor beyond which a simulation is too unlike its recording to correct it."""


def values_of(fit: BushingFit, levels: Levels) -> dict[str, float]:
    """Name what one recording said."""
    return {
        "elastomer_stiffness": fit.bushing.elastomer_stiffness,
        "damping": fit.damping,
        "elastomer_inertia": fit.bushing.elastomer_inertia,
        "clamp_inertia": fit.bushing.clamp_inertia,
        "critical_torque": levels.critical,
        "kinetic_torque": levels.kinetic,
    }


def corrected(one: Seen, rig: Rig, known: Known) -> Seen:
    """Correct what a recording said by a simulation of it.

    Parameters
    ----------
    one : Seen
    rig : Rig
        As identified so far.
    known : Known

    Returns
    -------
    Seen
        Unchanged where the simulation does not slip or cannot be made.
    """
    like, c = one.measured, one.measured.condition
    try:
        motion = simulate_motion(
            rig, ConstantSpeed(c.speed), interference=c.interference,
            support_stiffness=c.support_stiffness, rate=like.rate,
            seconds=_SETTLING + min(like.recording.duration, _SECONDS),
        ).since(round(_SETTLING * like.rate))  # fmt: skip
    except ParameterError:
        return one
    simulated: Measured = replace(like, torque=motion.torque, shaft_speed=motion.shaft_speed)
    read = fit_bushing(simulated, known)
    levels = torque_levels(read)
    if not levels.slips:
        return one
    bushing = lumped_bushing(rig, c.interference, c.support_stiffness)
    sliding = motion.sliding_speed
    fast = sliding > np.maximum(0.6 * np.quantile(sliding, 0.995), 1.1 * motion.shaft_speed)
    truth = {
        "elastomer_stiffness": bushing.elastomer_stiffness,
        "damping": bushing.elastomer_damping + bushing.support_damping,
        "elastomer_inertia": bushing.elastomer_inertia,
        "clamp_inertia": bushing.clamp_inertia,
        "critical_torque": levels.critical,
        "kinetic_torque": float(np.mean(motion.friction_torque[fast]))
        if fast.any()
        else levels.kinetic,
    }
    factors = {name: truth[name] / value for name, value in values_of(read, levels).items()}
    values = {
        name: value * (factors[name] if 1.0 / _MOST < factors[name] < _MOST else 1.0)
        for name, value in one.values.items()
    }
    return replace(one, values=values)
