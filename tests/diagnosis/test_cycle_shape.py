"""The mean cycle tells how a contact lets go, and how stiff the elastomer is while it rings."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from models.condition import FIXED
from noise.diagnosis.evidence.contact_summary import cycle_shape, slip_starts
from noise.diagnosis.evidence.reconstruction import reconstruct
from sim.bushing import lumped_bushing
from tests.helpers.small_rigs import RATE, RIG, at, run

FIT = RIG.fits[0]


def _shape(*effects, speed=1.5, support=2214.0, rig=RIG, still=False):
    recording = run(at(speed, support), *effects, seconds=0.6, rig=rig)
    torque = recording["torque"]
    bushing = lumped_bushing(RIG, 0.279e-3, support)
    found = reconstruct(torque, np.full(torque.size, speed), RATE, bushing)
    if still:
        found = replace(found, by_stiffness=np.zeros_like(found.by_stiffness))
    return cycle_shape(found, FIT, *slip_starts(found, speed))


@pytest.fixture(scope="module")
def plain():
    return _shape()


def test_a_plain_cycle_rises_to_the_critical_torque_and_falls_below_the_kinetic_one():
    plain = _shape(support=FIXED)
    before = [plain[f"before_{i}_torque"] for i in range(1, 6)]
    assert all(a < b for a, b in itertools.pairwise(before))
    assert before[-1] == pytest.approx(1.0, abs=0.05)
    after = [plain[f"after_{i}_torque"] for i in range(13) if f"after_{i}_torque" in plain]
    assert min(after) < FIT.kinetic_torque / FIT.critical_torque < before[-1]


def test_a_surface_that_sticks_does_not_move(plain):
    creeps = [x for name, x in plain.items() if name.startswith("after") and "creep" in name]
    assert np.abs(np.median(creeps)) < 0.2


def test_a_gradual_release_creeps_before_it_slips(plain):
    gradual = _shape(("partial_slip", {"share": 0.8}))
    assert gradual["before_4_creep"] > plain["before_4_creep"] + 0.1


def test_another_stiffness_is_met_slowly_and_in_the_ringing_alike(plain):
    stiff = replace(RIG, fits=(replace(FIT, elastomer_stiffness=1.15 * FIT.elastomer_stiffness),))
    found = _shape(rig=stiff)
    for name in ("slow_stiffness", "ring_stiffness"):
        assert abs(found[name] - plain[name]) > 0.05, name
    assert np.sign(found["slow_stiffness"] - plain["slow_stiffness"]) == np.sign(
        found["ring_stiffness"] - plain["ring_stiffness"]
    )


def test_without_a_slip_there_is_no_cycle():
    assert _shape(speed=30.0) == {}


def test_a_bolted_clamp_has_no_inertia_to_be_wrong():
    shape = _shape(support=FIXED)
    assert "ring_clamp" not in shape
    assert np.isfinite(list(shape.values())).all()


def test_sticks_whose_torque_stays_say_nothing_of_the_stiffness():
    shape = _shape(still=True)
    assert "ring_damping" in shape
    assert not {"ring_stiffness", "ring_unlike"} & shape.keys()
