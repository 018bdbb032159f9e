"""Effects that no library has, for the diagnosis to learn what it does not know.

Each is made of the same parts as the effects of `sim.effects` but is none of them: contact and
elastomer modulated over time or angle, springs that harden, drives that stall or have play, what
sounds beside the rig, sensors that leak into each other, lose samples, bits, contact or the beat.
What they have in common is only that the cause posterior must not give them a name.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.training.causes.cases.unknown_effects.bystanders import BYSTANDERS
from noise.training.causes.cases.unknown_effects.mechanics import MECHANICS
from noise.training.causes.cases.unknown_effects.recorders import RECORDERS

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np

    from noise.training.causes.cases.unknown_effects.parts import Recipe
    from sim.effects.effect import Effect

__all__ = ["UNKNOWN_EFFECTS", "draw_unknown_effect"]

UNKNOWN_EFFECTS: Mapping[str, Recipe] = {**MECHANICS, **BYSTANDERS, **RECORDERS}
"""Each takes strength, kinetic torque, stiffness and a generator."""


def draw_unknown_effect(
    name: str, strength: float, kinetic_torque: float, stiffness: float, rng: np.random.Generator
) -> Effect:
    """Draw an unknown effect.

    Parameters
    ----------
    name : str
        Of `UNKNOWN_EFFECTS`.
    strength : float
        From 0 to 1 [-].
    kinetic_torque, stiffness : float
        Of the rig [Nm], [Nm/rad].
    rng : numpy.random.Generator

    Returns
    -------
    Effect

    Examples
    --------
    >>> import numpy as np
    >>> draw_unknown_effect("wow", 0.5, 8.0, 665.0, np.random.default_rng(0)).stage.value
    'measurement'
    """
    return UNKNOWN_EFFECTS[name](strength, kinetic_torque, stiffness, rng)
