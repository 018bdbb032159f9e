"""A diagnosis answers with the channels that there are and says what the others would tell."""

from __future__ import annotations

import math

import pytest

from noise.diagnosis.causes.advice import unseen_causes
from noise.diagnosis.diagnose import diagnose
from tests.helpers.small_rigs import at, only, run, write_case


@pytest.fixture(scope="module")
def plain():
    return [run(at(speed), seed=i) for i, speed in enumerate((1.0, 1.6, 1.6))]


@pytest.mark.parametrize(
    ("kinds", "words"),
    [
        (("pressure",), "no torque"),
        (("torque",), "no acceleration and no sound"),
        (("torque", "pressure"), "no acceleration"),
        (("acceleration", "pressure"), "by acceleration and sound alone"),
        (("torque", "acceleration", "pressure"), "no shaft angle"),
    ],
)
def test_each_set_is_answered_and_its_cost_is_said(plain, tmp_path, kinds, words):
    data, rig = write_case(tmp_path, [only(one, *kinds) for one in plain])
    told = diagnose(data, rig, quick=True)
    assert math.isfinite(told.gap)
    assert any(words in note for note in told.notes)
    assert all(told.probabilities[name] == 0.0 for name in unseen_causes(kinds))
    assert told.bench == ()


def test_a_sound_shows_structure_and_room_and_a_torque_does_not():
    assert unseen_causes({"pressure"}) == frozenset()
    assert {"beam_modes", "slip_pulse", "plate_modes"} <= unseen_causes({"torque", "angle"})
