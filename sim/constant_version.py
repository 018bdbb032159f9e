"""The constant version of a rig: what a bushing does that is alike at every slip.

Materials state under their effects how irregular they are, and a recording has it. What is told of
a rig as a whole, its critical speeds, the boundaries of its regimes, the numbers of the thesis, is
told of its constant version: a boundary that moves with the seed is none.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sim.effects import EFFECTS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from models.rig import LawSpec, Rig
    from sim.effects.effect import Effect

__all__ = ["constant_version", "irregular_effects"]


def constant_version(rig: Rig, library: Mapping[str, Effect] = EFFECTS) -> Rig:
    """Return a rig without the effects by which one slip differs from the next by chance.

    Parameters
    ----------
    rig : Rig
    library : mapping of str to Effect
        Effects that the rig's can be found among; one that is not there is kept.

    Returns
    -------
    Rig

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("natural-rubber")
    >>> [str(spec) for spec in rig.effects], constant_version(rig).effects
    (['critical_torque_scatter:scatter=0.3'], ())
    """
    irregular = irregular_effects(rig, library)
    if not irregular:
        return rig
    return replace(rig, effects=tuple(spec for spec in rig.effects if spec not in irregular))


def irregular_effects(rig: Rig, library: Mapping[str, Effect] = EFFECTS) -> tuple[LawSpec, ...]:
    """Return what the constant version of a rig is without."""
    return tuple(
        spec for spec in rig.effects if spec.name in library and library[spec.name].irregular
    )
