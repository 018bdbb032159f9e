"""What a model foretells of a cycle, begun where a recording shows a slip."""

import numpy as np
import pytest

from models.rig import LawSpec
from models.rig_file import load_material_rig
from noise.identification.prediction import excerpts_of, friction_of, predicted_torque
from sim.bushing import lumped_bushing
from sim.effects import constant_version
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed
from tests.identification.test_bushing_fit import recorded


@pytest.fixture(scope="module", params=["fluorocarbon-thesis", "fluorocarbon"])
def case(request):
    """A rig with true stick, one with an elastic contact; its bushing, friction and excerpts."""
    rig = constant_version(load_material_rig(request.param))
    motion = simulate_motion(
        rig, ConstantSpeed(1.2), interference=0.279e-3, support_stiffness=2214.0, seconds=0.8,
        rate=30e3,
    ).part(9000)  # fmt: skip
    bushing = lumped_bushing(rig, 0.279e-3, 2214.0)
    excerpts = excerpts_of(recorded(motion.torque, 1.2, support=2214.0), bushing)
    return rig, bushing, excerpts


def missed(case, friction=None, **torques):
    rig, bushing, excerpts = case
    fit = rig.fit(0.279e-3)
    levels = {"critical": fit.critical_torque, "kinetic": fit.kinetic_torque} | torques
    torque = predicted_torque(excerpts, bushing, friction_of(friction or rig.friction), **levels)
    return float(np.std(torque - excerpts.torque) / np.std(excerpts.torque))


def test_a_rig_foretells_its_own_recording(case):
    assert missed(case) < 0.03


def test_a_torque_that_is_off_is_seen(case):
    fit = case[0].fit(0.279e-3)
    assert missed(case, kinetic=1.03 * fit.kinetic_torque) > 2.0 * missed(case)


def test_another_law_foretells_less(case):
    other = "coulomb" if case[0].friction.name != "coulomb" else "lugre"
    assert missed(case, LawSpec(other)) > 5.0 * missed(case)


def test_excerpts_begin_in_sliding(case):
    _, bushing, excerpts = case
    v = excerpts.spectrum.contact(bushing).sliding_speed
    assert np.all(v[excerpts.starts] > excerpts.spectrum.shaft_speed[excerpts.starts])
