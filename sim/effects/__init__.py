"""What a rig does beyond its friction law, one effect a file.

A new effect is a file with a class and one line here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.errors import ParameterError
from sim.effects.slip_pulse import SlipPulse

if TYPE_CHECKING:
    from models.rig import LawSpec

__all__ = ["EFFECTS", "effect"]

EFFECTS = {SlipPulse.name: SlipPulse}
"""Every effect by name."""


def effect(spec: LawSpec) -> SlipPulse:
    """Return the effect that a specification names.

    Raises
    ------
    ParameterError
        If there is none of that name, or a parameter cannot be used.

    Examples
    --------
    >>> from models.rig import LawSpec
    >>> effect(LawSpec("slip_pulse", {"amplitude": 5.0})).amplitude
    5.0
    """
    if spec.name not in EFFECTS:
        raise ParameterError(f"effect {spec.name!r} is unknown; there are {', '.join(EFFECTS)}")
    return EFFECTS[spec.name].from_parameters(spec.parameters)
