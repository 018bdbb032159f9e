"""Effects that extend the plain model of the rig, one file each.

A new effect is a file with an ``EFFECT`` of the same name; users' own effects are files anywhere,
read by `noise.base.user_effects`.
"""

from collections.abc import Mapping
from dataclasses import replace

from models.rig import LawSpec, Rig
from sim.effects.effect import Effect
from sim.parameters import Library

__all__ = ["EFFECTS", "Effect", "constant_version", "irregular_effects"]

EFFECTS: Library[Effect] = Library(__name__, __path__, "EFFECT", besides=("effect",))
"""Every shipped effect by name."""


def constant_version(rig: Rig, library: Mapping[str, Effect] = EFFECTS) -> Rig:
    """Return a rig without the effects that make slips differ at random.

    Parameters
    ----------
    rig : Rig
    library : mapping of str to Effect
        Effects by name; an effect that is not among them stays on.

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
    """Return the effects that `constant_version` removes from a rig."""
    return tuple(
        spec for spec in rig.effects if spec.name in library and library[spec.name].irregular
    )
