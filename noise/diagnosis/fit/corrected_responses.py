"""Responses of a structure corrected by what recordings show it to do besides.

What a torque makes of acceleration and sound can be estimated from recordings more exactly than a
mode or a reflection can be fitted. A rig file has no form for that, but it has measured responses:
those of the rig with the estimate in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from models.condition import known_condition, same_support
from models.rig import Rig
from models.transfer_functions.measured import MeasuredResponse
from noise.diagnosis.simulated.transfer_functions import shift_clamp_mode, with_chain_effects
from sim.bushing import lumped_bushing
from sim.effects.effect import ActiveEffect

if TYPE_CHECKING:
    from noise.diagnosis.fit.case_comparison import CaseComparison


def is_in_responses(active: ActiveEffect) -> bool:
    """Tell whether all that an effect does is to change the structure's responses."""
    effect = active.effect
    others = (effect.drive, effect.contact, effect.force, effect.sensors)
    return effect.chain is not None and all(one is None for one in others)


def corrected_responses(
    comparison: CaseComparison, rig: Rig, effects: Sequence[ActiveEffect]
) -> tuple[MeasuredResponse, ...]:
    """Return the responses of a rig with effects in them, one entry a support.

    Parameters
    ----------
    comparison : CaseComparison
        Of recordings with the supports that are wanted.
    rig : Rig
        With the parameters as they were recalibrated.
    effects : sequence of ActiveEffect
        On the structure's responses alone.

    Returns
    -------
    tuple of MeasuredResponse
        Of supports recorded; and those that the rig has of others, as they are.

    Raises
    ------
    ParameterError
        The rig cannot be modelled with a support.
    """
    found: list[MeasuredResponse] = []

    def has(support: float) -> bool:
        return any(same_support(support, one.support_stiffness) for one in found)

    for recording in comparison.recordings:
        at = known_condition(recording.condition)
        where = (at.interference, at.support_stiffness)
        if has(at.support_stiffness):
            continue
        plain, changed = (lumped_bushing(one, *where) for one in (comparison.rig, rig))
        shifted = {
            name: shift_clamp_mode(h, plain, changed)
            for name, h in comparison.runs.transfer_functions.at(*where).items()
        }
        made = with_chain_effects(rig, *where, shifted, effects)
        units = {"acceleration": "m/s^2", "pressure": "Pa"}
        to = {
            f"torque_to_{name}": replace(made[name], coherence=None, input_unit="N m",
                                         output_unit=unit)
            for name, unit in units.items()
        }  # fmt: skip
        found.append(MeasuredResponse(at.support_stiffness, **to))
    found += [one for one in rig.measured if not has(one.support_stiffness)]
    return tuple(found)
