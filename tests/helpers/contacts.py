"""The lumped model solved from rest, with any law and effects, apart from a run."""

import numpy as np

from sim.bushing import lumped_bushing
from sim.effects import EFFECTS
from sim.friction import friction_law
from sim.parameters import resolve
from sim.solvers.contact_solver import ContactRun, Hook
from sim.solvers.stick_slip import advance_stick_slip, rest_state


def hook(name, seed=0, **given):
    active = EFFECTS[name].active(given)
    values = active.packed(np.random.default_rng(seed))
    return Hook(active.effect.contact, values, active.effect.n_states)


def contact_of(rig, interference, stiffness, name=None, given=None):
    """What `solve_contact` takes of a rig, with its own law or another, but for drive and step."""
    law, fit = friction_law(name or rig.friction.name), rig.fit(interference)
    own = rig.friction.parameters if law.name == rig.friction.name and given is None else given
    options = {
        "law": law.torque,
        "coefficients": law.coefficients(resolve(law.name, law.parameters, own or {})),
        "law_state": law.state(),
        "tolerance": law.tolerance,
    }
    packed = lumped_bushing(rig, interference, stiffness).packed()
    return (packed, fit.critical_torque, fit.kinetic_torque), options


def solve_contact(system, critical, kinetic, speed, step, *, refined=1, tolerance=1e-7, **options):
    """States, shape (n, 7), and direction of the sliding, as of `ContactRun.advance`.

    Steps are shorter by `refined`: their error goes with the fifth power of their length.
    """
    options["tolerance"] = tolerance / refined**5
    run = ContactRun(system, critical, kinetic, float(speed[0]), step, **options)
    return run.advance(speed, speed.size)


def solve_stick_slip(system, critical, kinetic, speed, step):
    """States, direction and events, as of `advance_stick_slip`."""
    state = rest_state(float(speed[0]))
    return advance_stick_slip(system, critical, kinetic, speed, step, state, speed.size)
