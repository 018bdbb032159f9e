"""The rebuilt friction torque, drawn over what it may depend on, is that of the contact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from models.condition import FIXED
from noise.diagnosis.evidence.contact_summary import friction_curves
from noise.pages.diagnosis_evidence import contact_panels
from tests.helpers.small_rigs import RIG, at, only, run

FIT = RIG.fits[0]


def _curves(*effects, speed=1.5, support=FIXED):
    return friction_curves(run(at(speed, support), *effects, seconds=0.8), RIG)


@pytest.fixture(scope="module")
def plain():
    return _curves()


def test_a_plain_contact_slides_at_the_kinetic_torque_at_any_speed(plain):
    curve = plain.sliding_speed
    assert curve.x.size >= 3
    middle = curve.x < 0.8 * curve.x.max()
    assert curve.torque[middle] == pytest.approx(FIT.kinetic_torque, rel=0.06)


@pytest.mark.parametrize("over", ["time_stuck", "time", "angle"])
def test_a_plain_contact_lets_go_at_the_critical_torque_whatever_went_before(plain, over):
    curve = getattr(plain, over)
    assert curve.torque == pytest.approx(FIT.critical_torque, rel=0.06)
    assert (curve.low < curve.torque).all()
    assert (curve.high > curve.torque).all()
    assert (np.diff(curve.x) >= 0).all()


def test_an_ageing_contact_holds_more_the_longer_it_stuck():
    ageing = ("static_ageing", {"share": 0.6, "ageing_time": 0.004})
    slow, fast = (_curves(ageing, speed=v).time_stuck for v in (0.6, 1.2))
    assert slow.x.mean() > fast.x.mean()
    assert slow.torque.mean() > fast.torque.mean()


def test_a_heated_contact_loses_torque_over_time_and_angle():
    hot = _curves(("frictional_heating", {"softening": 0.02}), speed=3.0)
    for curve in (hot.time, hot.angle):
        assert curve.torque[-1] < curve.torque[0]


def test_a_shaft_that_turns_the_other_way_has_the_same_contact():
    recording = run(at(2.0), seconds=0.5)
    mirrored = replace(recording, samples=-recording.samples, condition=at(-2.0))
    one, other = friction_curves(recording, RIG), friction_curves(mirrored, RIG)
    assert other.time.torque == pytest.approx(one.time.torque)
    assert other.angle.x == pytest.approx(one.angle.x)


def test_without_torque_or_slips_there_is_nothing_to_draw():
    assert friction_curves(only(run(at(2.0)), "pressure"), RIG) is None
    assert _curves(speed=30.0) is None
    assert contact_panels({}) == ()
