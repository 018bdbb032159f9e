"""The search that found the fluorocarbon, and what it may claim."""

import math
from dataclasses import replace

import numpy as np
import pytest

from models.condition import FIXED
from models.rig_file import load_material_rig
from noise.identification.table_fit import fit_table, score_table
from noise.training.calibrate import (
    CELLS,
    MEAN_TORQUE,
    SPEEDS_ALONE,
    THESIS_TABLE,
    UNKNOWNS,
    measured_speeds,
    rig_of,
    start,
    values_at,
)
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed


@pytest.fixture(scope="module")
def rig():
    return replace(load_material_rig("fluorocarbon"), effects=())


def test_every_unknown_starts_inside_its_limits_and_is_taken_back_to_them():
    assert all(u["low"] < u[key] < u["high"] for u in UNKNOWNS.values()
               for key in ("start", "round_start"))  # fmt: skip
    assert values_at(start()) == pytest.approx({k: u["start"] for k, u in UNKNOWNS.items()})
    highest = {name: unknown["high"] for name, unknown in UNKNOWNS.items()}
    assert values_at(start() + 100.0) == pytest.approx(highest)


def test_torque_at_5_rad_s_is_held_whatever_the_unknowns():
    values = values_at(start()) | {"torque_drop": 6.0, "weakening": 1.0}
    made = rig_of(values)
    motion = simulate_motion(
        # So much damping that it slides steadily.
        replace(
            made,
            elastomer_damping_share=0.5,
            fits=tuple(replace(f, damping={FIXED: 5.0}) for f in made.fits),
        ),
        ConstantSpeed(5.0),
        interference=0.279e-3,
        support_stiffness=FIXED,
        seconds=0.5,
        rate=15e3,
    )
    assert motion.torque[-1] == pytest.approx(MEAN_TORQUE, rel=1e-3)


def test_the_shipped_material_is_where_the_search_starts(rig):
    made = rig_of(values_at(start()))
    assert made.friction.parameters == pytest.approx(dict(rig.friction.parameters), rel=2e-3)
    for mine, its in zip(made.fits, rig.fits, strict=True):
        assert its.critical_torque == pytest.approx(mine.critical_torque, rel=2e-3)
        assert dict(its.damping) == pytest.approx(dict(mine.damping), rel=2e-3)


def test_values_that_leave_no_kinetic_torque_make_no_rig_and_cost_much():
    assert rig_of(values_at(start()) | {"weakening": 50.0, "weakening_speed": 200.0}) is None
    assert score_table(None, THESIS_TABLE).cost > 50.0


def test_rubbers_a_tenth_away_from_the_shipped_one_cost_much_more():
    shipped = score_table(load_material_rig("fluorocarbon"), SPEEDS_ALONE)
    away = start() + 0.1 * np.random.default_rng(3).standard_normal(len(UNKNOWNS))
    assert score_table(rig_of(values_at(away)), SPEEDS_ALONE).cost > 2.0 * shipped.cost


def test_the_searchs_critical_speeds_are_those_reported_to_a_step_of_its_grid(rig):
    seen = score_table(rig, SPEEDS_ALONE).found
    cell = CELLS[5]
    reported = measured_speeds(rig, (cell,))[cell]
    assert abs(math.log(seen[cell] / reported)) < 0.13


@pytest.mark.slow
def test_a_search_from_a_perturbed_rubber_goes_back_towards_it():
    away = start() + 0.1 * np.random.default_rng(3).standard_normal(len(UNKNOWNS))
    before = score_table(rig_of(values_at(away)), SPEEDS_ALONE).cost
    found = fit_table(lambda point: rig_of(values_at(point)), SPEEDS_ALONE, away, rounds=1)
    shipped = score_table(load_material_rig("fluorocarbon"), SPEEDS_ALONE).cost
    assert found.score.cost - shipped < 0.2 * (before - shipped)
