"""Laws of friction: what is left out, how a rig follows from a vector, which law is found."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from models.condition import KnownCondition
from models.rig_file import load_material_rig, load_rig, rig_text
from noise.identification.bushing_fit import Known
from noise.identification.identify import identify
from noise.identification.law_fit import left_out, starts
from noise.identification.law_model import CANDIDATES, LawModel, Subject
from tests.blind.identify import LAWS, make_rig, write_rig

BASE = load_material_rig("fluorocarbon-thesis")


def at(speed, interference=0.279e-3, support=2214.0):
    return SimpleNamespace(condition=KnownCondition(speed, interference, support))


def test_the_second_rig_has_each_law_that_is_tried():
    assert {candidate.name for candidate in CANDIDATES} == set(LAWS)


def subject(speed, interference=0.279e-3, support=2214.0):
    start = np.log([665.0, 8.0, 2.7, 0.09, 1.5e-5, 8.3e-4, 0.5])
    return Subject(at(speed, interference, support), None, start)


@pytest.mark.parametrize("candidate", CANDIDATES, ids=lambda c: c.name)
def test_every_start_is_a_rig_whose_file_loads(candidate, tmp_path):
    subjects = (subject(1.0), subject(2.0, 0.381e-3), subject(2.0, 0.381e-3, math.inf))
    model = LawModel(candidate, subjects, Known(1.5e-5, 8.3e-4, 0.02))
    for law, choices in starts(model):
        vector = model.vector(choices[0], law)
        low, high = model.limits(vector)
        assert np.all(vector >= low - 1e-9)
        assert np.all(vector <= high + 1e-9)
        rig = model.rig(vector, BASE, "fluorocarbon")
        (tmp_path / "rig.toml").write_text(rig_text(rig))
        loaded = load_rig(tmp_path / "rig.toml")
        assert loaded.friction.name == rig.friction.name
        assert [e.name for e in loaded.effects] == [e.name for e in rig.effects]
        for one, other in zip(loaded.fits, rig.fits, strict=True):
            assert one.critical_torque == pytest.approx(other.critical_torque, rel=1e-3)
            assert set(one.damping) == {2214.0, math.inf}


def test_whole_conditions_are_left_out_and_none_is_left_unknown():
    runs = [at(1.0), at(1.0), at(2.0), at(3.0), at(4.0), at(2.0)]
    held = left_out(runs)
    assert held
    kept = {runs[i].condition.speed for i in range(len(runs)) if i not in held}
    assert not kept & {runs[i].condition.speed for i in held}


def test_two_conditions_leave_nothing_out():
    assert left_out([at(1.0), at(2.0)]) == []


def test_a_lone_interference_is_not_left_out():
    held = left_out([at(1.0), at(2.0), at(3.0), at(1.0, 0.381e-3)])
    assert 3 not in held


@pytest.mark.slow
@pytest.mark.parametrize("index", [0, 3, 4])
def test_the_law_of_a_development_rig_is_found(index, tmp_path):
    made = make_rig(1, index)
    write_rig(made, tmp_path / "data")
    found = identify(tmp_path / "data", tmp_path / "data" / "known.toml")
    assert found.law == made.law.name
