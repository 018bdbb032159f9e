"""Queries on the effects of a rig: which can act on its friction law, which are random per slip."""

from collections.abc import Mapping
from dataclasses import replace

from models.rig import LawSpec, Rig
from sim.effects import EFFECTS
from sim.effects.effect import ActiveEffect, Effect
from sim.friction import friction_law


def can_act(active: ActiveEffect, friction: LawSpec) -> bool:
    """Return whether an effect can change a run with a friction law.

    A law with an inner state solves the contact itself, so it never reads the creep of true stick.

    Parameters
    ----------
    active : ActiveEffect
    friction : LawSpec

    Raises
    ------
    ParameterError
        The law is unknown.

    Examples
    --------
    >>> from models.rig import LawSpec
    >>> from sim.effects import EFFECTS
    >>> creep = EFFECTS["partial_slip"].active({})
    >>> can_act(creep, LawSpec("coulomb")), can_act(creep, LawSpec("contact_with_memory"))
    (True, False)
    """
    return friction_law(friction.name).torque is None or not active.effect.of_true_stick


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
