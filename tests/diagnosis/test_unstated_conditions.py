"""Conditions that a sidecar leaves out are taken where they are known and asked for otherwise."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from models.condition import Condition
from models.errors import ParameterError
from noise.diagnosis.case import usable, with_conditions
from tests.helpers.small_rigs import RIG, at, only, run


@pytest.mark.parametrize("speed", [0.6, -4.0])
def test_the_speed_is_the_angles(speed):
    recorded = only(run(at(speed), seconds=0.3), "torque", "angle")
    stated = Condition(support_stiffness=2214.0, interference=0.279e-3)
    taken = with_conditions(replace(recorded, condition=stated), RIG)
    assert taken.condition.speed == pytest.approx(speed, rel=0.05)
    assert taken.notes[0].startswith("speed taken as ")


def test_the_only_fit_and_the_only_support_are_taken():
    (fit, *_) = RIG.fits
    one = replace(RIG, measured=(), fits=(replace(fit, damping={math.inf: 0.1}),))
    taken = with_conditions(replace(run(at(1.0)), condition=Condition(speed=1.0)), one)
    assert taken.condition.interference == fit.interference
    assert taken.condition.support_stiffness == math.inf


def test_what_nothing_tells_is_asked_for():
    recorded = replace(only(run(at(0.8)), "pressure"), name="run03.wav", condition=Condition())
    several = replace(RIG, fits=(RIG.fits[0], replace(RIG.fits[0], interference=0.3e-3)))
    with pytest.raises(
        ParameterError, match=r"states no speed_rad_s.*write into run03\.json"
    ) as no:
        usable(recorded, several)
    assert '"interference_mm" (of the rig file: 0.279, 0.3)' in str(no.value)
