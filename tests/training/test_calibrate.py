"""The search that found the fluorocarbon, and what it may claim."""

from dataclasses import replace

import numpy as np
import pytest

from models.condition import FIXED
from models.rig_file import load_material_rig
from noise.training.calibrate import (
    MEAN_TORQUE,
    SPEEDS_ALONE,
    THESIS_TABLE,
    UNKNOWNS,
    fit,
    rig_of,
    score,
    start,
    values_at,
)
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed


def test_every_unknown_starts_inside_its_limits_and_is_taken_back_to_them():
    assert all(u["low"] < u["start"] < u["high"] for u in UNKNOWNS.values())
    highest = {name: unknown["high"] for name, unknown in UNKNOWNS.items()}
    assert values_at(start() + 100.0) == pytest.approx(highest)


def test_torque_at_5_rad_s_is_held_whatever_the_unknowns():
    made = rig_of(values_at(start()) | {"torque_drop": 6.0, "weakening": 1.0})
    # So much damping that it slides steadily.
    damped = tuple(replace(f, damping={FIXED: 5.0}) for f in made.fits)
    motion = simulate_motion(
        replace(made, elastomer_damping_share=0.5, fits=damped), ConstantSpeed(5.0),
        interference=0.279e-3, support_stiffness=FIXED, seconds=0.5, rate=15e3,
    )  # fmt: skip
    assert motion.torque[-1] == pytest.approx(MEAN_TORQUE, rel=1e-3)


def test_the_shipped_material_is_where_the_search_starts():
    made, rig = rig_of(values_at(start())), load_material_rig("fluorocarbon")
    assert made.friction.parameters == pytest.approx(dict(rig.friction.parameters), rel=2e-3)
    for mine, its in zip(made.fits, rig.fits, strict=True):
        assert its.critical_torque == pytest.approx(mine.critical_torque, rel=2e-3)
        assert dict(its.damping) == pytest.approx(dict(mine.damping), rel=2e-3)


def test_values_that_leave_no_kinetic_torque_make_no_rig_and_cost_much():
    assert rig_of(values_at(start()) | {"weakening": 50.0, "weakening_speed": 200.0}) is None
    assert score(None, THESIS_TABLE).cost > 50.0


def test_rubbers_a_tenth_away_from_the_shipped_one_cost_much_more():
    shipped = score(load_material_rig("fluorocarbon"), SPEEDS_ALONE)
    away = start() + 0.1 * np.random.default_rng(3).standard_normal(len(UNKNOWNS))
    assert score(rig_of(values_at(away)), SPEEDS_ALONE).cost > 2.0 * shipped.cost


@pytest.mark.slow
def test_a_search_from_a_perturbed_rubber_goes_back_towards_it():
    away = start() + 0.1 * np.random.default_rng(3).standard_normal(len(UNKNOWNS))
    before = score(rig_of(values_at(away)), SPEEDS_ALONE).cost
    found = rig_of(values_at(fit(SPEEDS_ALONE, away, rounds=1, step=0.1)))
    shipped = score(load_material_rig("fluorocarbon"), SPEEDS_ALONE).cost
    assert score(found, SPEEDS_ALONE).cost - shipped < 0.2 * (before - shipped)
