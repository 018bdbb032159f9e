"""Steps of the contact with memory that are made in registers, against those of any law."""

import numpy as np
import pytest

from models.rig_file import load_material_rig
from sim.bushing import lumped_bushing
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import friction_law
from sim.motion import contact_hooks
from sim.parameters import resolve
from sim.solvers.contact_solver import ContactRun, Hook
from sim.solvers.stand_ins import no_hook

IDLE = Hook(no_hook, np.zeros(1), 0)
"""With an effect besides, one that does nothing, all goes through pointers."""

RATE = 30e3
DRIVES = {
    "constant": np.full(3000, 1.0),
    "ramp": np.linspace(0.5, 9.0, 3000),
    "to and fro": 4.0 * np.sin(np.linspace(0.0, 12.0, 3000)),
    "rough": 2.0 + np.random.default_rng(1).normal(0.0, 0.2, 3000),
}


def torque(material, drive, support, *, scatter, besides=()):
    rig = load_material_rig(material)
    law, fit = friction_law(rig.friction.name), rig.fit(0.279e-3)
    values = resolve(law.name, law.parameters, rig.friction.parameters)
    effects = [e for e in activated(rig.effects, EFFECTS) if e.effect.irregular]
    hooks = contact_hooks(effects, np.random.default_rng(3)) if scatter else ()
    run = ContactRun(
        lumped_bushing(rig, 0.279e-3, support).packed(), fit.critical_torque, fit.kinetic_torque,
        float(drive[0]), 1.0 / RATE, law=law.torque, coefficients=law.coefficients(values),
        law_state=law.state(), hooks=(*hooks, *besides), tolerance=law.tolerance,
    )  # fmt: skip
    return np.vstack(
        [run.advance(drive[i : i + 1200], min(1000, 3000 - i))[0] for i in range(0, 3000, 1000)]
    )


@pytest.mark.parametrize("scatter", [False, True])
@pytest.mark.parametrize("material", ["fluorocarbon", "natural-rubber"])
@pytest.mark.parametrize("support", [2214.0, np.inf])
@pytest.mark.parametrize("drive", DRIVES)
def test_not_a_bit_differs_from_what_goes_through_pointers(material, drive, support, scatter):
    own = torque(material, DRIVES[drive], support, scatter=scatter)
    general = torque(material, DRIVES[drive], support, scatter=scatter, besides=(IDLE,))
    assert np.ptp(own[:, 1]) > 0.1
    assert np.array_equal(own, general)
