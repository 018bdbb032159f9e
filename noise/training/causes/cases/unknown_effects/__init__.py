"""Effects that no library has, for the diagnosis to learn what it does not know.

Each is made of the same parts as the effects of `sim.effects` but is none of them: contact and
elastomer modulated over time or angle, springs that harden, drives that stall or have play, what
sounds beside the rig, sensors that leak into each other, lose samples, bits, contact or the beat.
What they have in common is only that the cause posterior must not give them a name. They are rows
of ``unknown_effects.toml``.
"""

from __future__ import annotations

from noise.base import packaged_toml
from noise.base.arrays import Rng
from noise.training.causes.cases.unknown_effects import mechanics, recorders
from noise.training.causes.cases.variants import made
from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter

__all__ = ["UNKNOWN_EFFECTS", "draw_unknown_effect"]

UNKNOWN_EFFECTS = packaged_toml(__name__, "unknown_effects.toml")
"""Rows by name."""

_STRENGTH = {"strength": Parameter(1.0, "", 0.0, 1.0, "nothing at 0")}


def draw_unknown_effect(
    name: str, strength: float, kinetic_torque: float, stiffness: float, rng: Rng
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
    row = UNKNOWN_EFFECTS[name]
    specs = {key: spec for key, spec in row.items() if key != "stage"}
    acting = made(
        name, specs, (mechanics, recorders), strength, rng, torque=kinetic_torque,
        stiffness=stiffness,
    )  # fmt: skip
    return Effect(
        "unknown_effect", Stage(row["stage"]), ("plain",), _STRENGTH, "strength", **acting
    )
