"""What a diagnosis holds of one cause, and words for phases and parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.effects import EFFECTS

if TYPE_CHECKING:
    from noise.diagnosis.findings import EffectFinding
    from noise.diagnosis.outcome import Diagnosis

__all__ = ["PHASES", "finding_of", "parameter_name", "stage_of_effect"]

PHASES = {
    "stick": "while the contact sticks",
    "slip": "while the contact slips",
    "cycle": "in the stick-slip cycle as a whole",
}
"""Phases of the stick-slip cycle that a difference can be in."""


def stage_of_effect(diagnosis: Diagnosis, name: str) -> str:
    """Return the stage that an effect acts in; empty where it is not known."""
    finding = finding_of(diagnosis, name)
    if finding is not None:
        return str(finding.stage)
    return str(EFFECTS[name].stage) if name in EFFECTS else ""


def finding_of(diagnosis: Diagnosis, name: str) -> EffectFinding | None:
    """Return what was found about an effect, None where nothing was."""
    return next((effect for effect in diagnosis.effects if effect.name == name), None)


def parameter_name(name: str) -> str:
    """Return a parameter's name in words.

    Examples
    --------
    >>> parameter_name("elastomer_stiffness")
    'elastomer stiffness'
    """
    return name.replace("_", " ")
