"""Bushings are irregular as their files state; what is told of a rig as a whole is constant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.rig import LawSpec
from models.rig_file import load_material_rig
from noise.noise_definition import label_by_physics
from sim.analysis.critical_speeds import motion_from_rest
from sim.rig_effects import constant_version
from sim.run import simulate
from tests.helpers.rig_measures import creak_measures

TIGHT = {"interference": 0.381e-3, "support_stiffness": 2214.0}


def _scattered(material, scatter):
    rig = constant_version(load_material_rig(material))
    spec = LawSpec("critical_torque_scatter", {"scatter": scatter})
    return replace(rig, effects=(spec, *rig.effects))


def _creak(rig, speed):
    run = simulate(rig, speed, seconds=1.0, **TIGHT)
    return label_by_physics(run), *creak_measures(run.pressure, run.motion.rate)


@pytest.mark.parametrize("speed", [1.0, 2.5])
def test_a_creak_is_irregular(speed):
    rig = load_material_rig("fluorocarbon")
    label, jitter, harmonicity, flatness = _creak(rig, speed)
    assert label == "creak"
    assert (jitter >= 0.25, harmonicity <= 0.6, flatness >= -15.0) == (True, True, True)
    label, even, periodic, tonal = _creak(constant_version(rig), speed)
    assert label == "creak"
    assert even < 0.5 * jitter
    assert periodic > harmonicity
    assert tonal < flatness


def test_an_effect_of_the_users_own_stays():
    own = LawSpec("rattle", {})
    rig = replace(load_material_rig("PDMS"), effects=(own, LawSpec("speed_fluctuation", {})))
    assert constant_version(rig).effects == (own,)


def test_critical_speeds_do_not_hang_on_what_scatters():
    even, scattered = (
        motion_from_rest(_scattered("fluorocarbon", s), 2.5, 0.279e-3, 2214.0, seconds=0.2).torque
        for s in (0.0, 0.9)
    )
    assert np.array_equal(even, scattered)
