"""Whether the contact ever lets go, which is told from its sliding speed."""

import math

import pytest

from models.rig_file import load_material_rig, material_names
from sim.analysis.regime import never_slips
from sim.run import simulate
from sim.shaft import Oscillation

FIRM = tuple(name for name in material_names() if name != "natural-rubber-film")
"""The film's torque does not come from the critical torque."""


def motion(rig, shaft, seconds=0.3):
    interference = rig.fits[0].interference
    return simulate(rig, shaft, interference=interference, seconds=seconds).motion


@pytest.mark.parametrize("material", FIRM)
def test_a_contact_that_holds_is_not_taken_for_one_that_slips(material):
    held = load_material_rig(material).changed(critical_torque="x9999")
    assert never_slips(motion(held, 5.0))
    assert never_slips(motion(held, Oscillation(math.radians(15.0), 2.0)))


@pytest.mark.parametrize("material", material_names())
def test_one_that_lets_go_is_seen(material):
    rig = load_material_rig(material)
    assert not never_slips(motion(rig, 5.0))
    assert not never_slips(motion(rig, Oscillation(math.radians(15.0), 2.0)))
