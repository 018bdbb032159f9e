"""Whether vibration dies, persists or breaks out, against long runs that share no code with it."""

import math
from dataclasses import replace

import pytest

from models.rig_file import load_material_rig
from noise.screening.advice import Offer, advise, changed
from noise.screening.summary import advice_words, limit_words
from noise.screening.vibration import Condition, growth_at, vibration_at
from tests.helpers.quick_screens import evaluate_point
from tests.screening.long_runs import vibrates_after

FLUOROCARBON = load_material_rig("fluorocarbon")
AT = Condition(5.0, 0.279e-3, 2214.0)
"""Of squawk, at whose upper boundary stable sliding and a limit cycle coexist."""


@pytest.mark.parametrize("speed", [7.25, 7.625, 8.0, 8.5, 9.5, 12.0])
def test_beside_the_boundary_of_squawk_runs_from_rest_and_from_vibration_agree(speed):
    at = replace(AT, speed=speed)
    state = vibration_at(FLUOROCARBON, at).state
    from_rest = vibrates_after(FLUOROCARBON, at, [speed], seconds=8.0)
    running = vibrates_after(FLUOROCARBON, at, [7.0, speed], seconds=8.0)
    assert state == ("breaks out" if from_rest else "persists" if running else "none")


def test_a_constant_torque_vibrates_only_from_stick():
    rig = load_material_rig("fluorocarbon-thesis")
    at = Condition(5.0, 0.279e-3, 3745.0)
    assert growth_at(rig, at) < 0.0
    assert vibration_at(rig, at).state == "breaks out"
    assert vibration_at(rig, replace(at, speed=9.0)).state == "none"


def test_bursts_seconds_apart_beside_unstable_sliding_are_no_silence():
    at = Condition(0.375, 0.381e-3, 2214.0)
    assert vibration_at(FLUOROCARBON, at).state == "breaks out"
    assert vibrates_after(FLUOROCARBON, at, [at.speed], seconds=8.0)


def test_sliding_that_is_stable_everywhere_is_silent():
    for speed in (0.5, 5.0, 12.0):
        found = evaluate_point(load_material_rig("PDMS"), replace(AT, speed=speed))
        assert (found.label, found.persists, math.isnan(found.level)) == ("none", False, True)


def test_each_offer_ends_the_squawk_in_long_runs_and_the_rig_file_takes_it():
    offers = advise(FLUOROCARBON, AT)
    ending = [offer for offer in offers if offer.ends]
    assert {offer.name for offer in ending} >= {"damping"}
    for offer in ending:
        assert offer.percent % 5 == 0
        rig, at = changed(FLUOROCARBON, AT, offer.name, offer.percent)
        assert not vibrates_after(rig, at, [at.speed], seconds=10.0)
        assert not vibrates_after(rig, at, [0.5 * at.speed, at.speed], seconds=10.0)
    assert any(offer.limit for offer in offers)
    less_torque = next(o for o in offers if o.name == "critical_torque" and o.percent < 0)
    assert (less_torque.ends, less_torque.from_rest) == (False, -20)
    assert any("critical torque -20 %" in words for words in limit_words(offers, "squawk"))
    assert all(offer.limit or abs(offer.percent) in (50, 200) for offer in offers if not offer.ends)


def test_where_nothing_vibrates_there_is_nothing_to_advise():
    assert advise(FLUOROCARBON, replace(AT, speed=12.5)) == ()


def test_the_first_change_names_what_it_silences_and_what_stays_noisy():
    worst = replace(AT, speed=8.0, interference=0.381e-3)
    some = Offer("damping", 0.1, 50, True, quiet_elsewhere=2, elsewhere=3, left=worst)
    first, second, left = advice_words("squawk", AT, [some, some])
    assert first.startswith("damping +50 % to 0.15 Nm s/rad silences the loudest point (squawk at ")
    assert first.endswith(" and 2 of 3 other noisy points")
    assert second.startswith("damping +50 % to 0.15 Nm s/rad silences it, too, and 2 of 3 ")
    assert left == "damping +50 % is not enough at 8 rad/s, 0.381 mm, 2214 Nm/rad"
    (none,) = advice_words("squawk", AT, [replace(some, ends=False)])
    assert none.startswith("no single change that was tried silences the loudest point (squawk at ")
