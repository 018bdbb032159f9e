"""Where the contact slides smoothly, units are said to be unchecked."""

from __future__ import annotations

import numpy as np
import pytest

from models.rig_file import load_rig
from noise.diagnosis.bench.check import bench_findings, unchecked_units
from noise.diagnosis.case import Case, read_case
from noise.diagnosis.diagnose import diagnose
from tests.helpers.small_rigs import RIG, at, only, run, write_case
from tests.helpers.wrong_benches import WRONG_BENCHES

SMOOTH = ("velocity_strengthening", {"gain": 0.9, "speed": 2.0})


@pytest.fixture(scope="module")
def smooth():
    return [run(at(speed), SMOOTH, seed=i) for i, speed in enumerate((2.0, 3.0, 4.0))]


def _case(recordings, rig=RIG):
    return Case(rig, tuple(f"run{i}.wav" for i in range(len(recordings))), tuple(recordings))


def test_what_nothing_tells_is_said_to_be_unchecked(smooth, tmp_path):
    (words,) = unchecked_units(_case(smooth))
    assert words.startswith("nothing slips: units, signs and order of acceleration and pressure")
    (words,) = unchecked_units(_case([only(one, "pressure", "angle") for one in smooth]))
    assert words.startswith("no torque: units, signs and order of pressure were not checked")
    assert unchecked_units(_case([run(at(1.6)), *smooth])) == ()
    data, rig = write_case(tmp_path, smooth)
    assert any("were not checked" in note for note in diagnose(data, rig, quick=True).notes)


@pytest.mark.parametrize("effects", [(), (SMOOTH,)])
@pytest.mark.parametrize("other", ["angle", "acceleration"])
def test_a_torque_in_another_channel_is_told_before_a_start_is_looked_for(tmp_path, effects, other):
    right = [run(at(speed), *effects, seed=i) for i, speed in enumerate((2.0, 3.0, 4.0))]
    change, words = WRONG_BENCHES[f"torque and {other} swapped"]
    data, rig = write_case(tmp_path, change(right, np.random.default_rng(0)))
    (told,) = bench_findings(read_case([data], load_rig(rig)))
    assert words in told
