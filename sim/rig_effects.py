"""Whether an effect can change anything, with a friction law.

A law with an inner state solves the contact itself: what an effect does to the creep of true stick
alone it never reads, nor torques that it does not ask for. Which entries of the contact an effect
changes, and which a law reads, is found by calling them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sim.contact import (
    CREEP,
    CRITICAL,
    KINETIC,
    N_CONTACT,
    N_CONTEXT,
    STICK_TIME,
    STICKS,
    TIME,
    call_hook,
    call_law,
)  # fmt: skip
from sim.effects import EFFECTS
from sim.effects.effect import ActiveEffect, Effect
from sim.friction import friction_law
from sim.parameters import resolve

if TYPE_CHECKING:
    from models.rig import LawSpec, Rig
    from sim.friction.law import FrictionLaw


_PROBES = 64
"""States of the contact that are tried."""


def can_act(active: ActiveEffect, friction: LawSpec) -> bool:
    """Whether an effect can change a run with a friction law.

    Parameters
    ----------
    active : ActiveEffect
    friction : LawSpec

    Raises
    ------
    ParameterError
        The law is unknown, or has no such parameter.

    Examples
    --------
    >>> from models.rig import LawSpec
    >>> from sim.effects import EFFECTS
    >>> creep = EFFECTS["partial_slip"].active({})
    >>> can_act(creep, LawSpec("coulomb")), can_act(creep, LawSpec("contact_with_memory"))
    (True, False)
    """
    law, effect = friction_law(friction.name), active.effect
    if effect.contact is None or law.torque is None:
        return True
    rng = np.random.default_rng(0)
    values = active.packed(rng)
    changed = np.zeros(N_CONTACT, dtype=bool)
    for _ in range(_PROBES):
        context = 10.0 ** rng.uniform(-4.0, 1.0, N_CONTEXT)
        context[STICKS], context[STICK_TIME] = 0.0, context[TIME]  # throughout, with such a law
        contact = rng.uniform(5.0, 50.0, N_CONTACT)
        contact[CREEP] = 0.0
        before = contact.copy()
        state = 10.0 ** rng.uniform(-6.0, 1.0, max(effect.n_states, 1))
        call_hook(effect.contact, context, values, state, np.zeros_like(state), contact)
        changed |= contact != before
    read = set(range(N_CONTACT)) - {CREEP, CRITICAL, KINETIC}
    read |= {entry for entry in (CRITICAL, KINETIC) if _reads(law, friction, entry, rng)}
    return any(changed[entry] for entry in read)


def _reads(law: FrictionLaw, friction: LawSpec, entry: int, rng: np.random.Generator) -> bool:
    """Whether a law's torque, or how its state goes on, depends on an entry of the contact."""
    values = resolve(f"friction law {law.name!r}", law.parameters, friction.parameters)
    coefficients = law.coefficients(values)
    at_rest = law.state()
    for _ in range(_PROBES):
        speed, contact = float(rng.uniform(0.1, 10.0)), rng.uniform(5.0, 50.0, N_CONTACT)
        state = at_rest + rng.uniform(0.0, 1e-3, at_rest.size)
        found = []
        for factor in (1.0, 1.3):
            asked, rates = contact.copy(), np.zeros(max(state.size, 1))
            asked[entry] *= factor
            torque = call_law(law.torque, speed, coefficients, asked, state, rates)
            found.append((torque, *rates))
        if found[0] != found[1]:
            return True
    return False


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
