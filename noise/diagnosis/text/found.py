"""What a diagnosis holds of one cause, and words for phases and parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.diagnosis.findings import SURE, EffectFinding
from sim.effects import EFFECTS

if TYPE_CHECKING:
    from noise.diagnosis.outcome import Diagnosis


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


def stages_acting(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return the stages that the effects of a verdict act in, each once."""
    stages = (stage_of_effect(diagnosis, name) for name in diagnosis.verdict)
    return tuple(dict.fromkeys(stage for stage in stages if stage))


def begins(diagnosis: Diagnosis) -> bool:
    """Tell whether the gap begins where it is located.

    It does where that stage surely differs, and a verdict's effects, if there are any, act there.

    Examples
    --------
    >>> from noise.diagnosis.outcome import Diagnosis
    >>> begins(Diagnosis((), (), None, {}, (), {"none": 1.0}, {}, "", (), 0.9, 1.0, 0.6, 1.0))
    False
    """
    place = diagnosis.location
    if place is None or place.p_value > SURE:
        return False
    acting = stages_acting(diagnosis)
    return not acting or place.stage in acting


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
