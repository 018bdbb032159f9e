"""Slips and regimes as the torque shows them: sawteeth, oscillators, the solver's own slips."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.condition import FIXED
from models.rig_file import load_material_rig
from sim.analysis.critical_speeds import with_damping
from sim.analysis.regime import Regime, find_slips, friction_regime, motion_slips
from sim.bushing import lumped_bushing
from sim.effects import constant_version
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed
from tests.helpers.contacts import solve_stick_slip

RATE = 30e3
OWN = 1e-3
TIME = np.arange(round(RATE)) / RATE
THESIS = load_material_rig("fluorocarbon-thesis")
FLUOROCARBON = constant_version(load_material_rig("fluorocarbon"))
SUPPORTS = (2214.0, 3745.0, FIXED)
PLACES = [(fit, support) for fit in (0.178e-3, 0.279e-3, 0.381e-3) for support in SUPPORTS]


def motion(rig, speed, interference=0.279e-3, support=FIXED, seconds=1.0, rate=RATE):
    return simulate_motion(
        rig, ConstantSpeed(speed), interference=interference, support_stiffness=support,
        seconds=seconds, rate=rate,
    )  # fmt: skip


def sawtooth(drops, speed=5.0, fall=0.4e-3):
    """Twist that is loaded by the shaft and drops by each of `drops` in turn, over and over."""
    drops = np.resize(drops, 400)
    steps = np.column_stack([drops / speed, np.full(drops.size, fall)])
    corners = np.append(0.0, np.cumsum(steps))
    level = np.append(0.0, np.column_stack([drops, np.zeros(drops.size)]))
    slips = corners[1::2]
    return np.interp(TIME, corners, level), slips[slips < TIME[-1] - fall]


# The measure


@pytest.mark.parametrize("shape", [np.sin, lambda x: 2.0 / np.pi * np.arcsin(np.sin(x))])
@settings(max_examples=25)
@given(frequency=st.floats(50.0, 900.0), reach=st.floats(0.05, 1.0))
def test_an_oscillation_that_does_not_outrun_the_shaft_has_no_sudden_fall(shape, frequency, reach):
    turn = 2.0 * np.pi * frequency
    steepest = 1.0 if shape is np.sin else 2.0 / np.pi
    twist = reach * 5.0 / (steepest * turn) * shape(turn * TIME)
    assert find_slips(twist, 5.0, RATE, own_period=OWN).sudden_share < 1e-3


def test_a_sawtooth_that_falls_as_slowly_as_it_rises_does_not_slip_and_a_sudden_one_does():
    slow, sudden = (
        find_slips(sawtooth([0.02], fall=fall)[0], 5.0, RATE, own_period=OWN)
        for fall in (4e-3, 0.4e-3)
    )
    assert slow.times.size == 0
    assert 0.8 < sudden.sudden_share < 1.0 - 5.0 * 0.4e-3 / 0.02


@pytest.mark.parametrize("speed", [1.0, 3.0, 6.0, 9.0])
def test_undamped_stick_slip_has_the_share_and_the_period_of_its_formula(speed):
    fit = THESIS.fit(0.279e-3)
    turn = np.sqrt(fit.elastomer_stiffness / THESIS.elastomer_inertia)
    drop = fit.critical_torque - fit.kinetic_torque
    x = drop * turn / (fit.elastomer_stiffness * speed)
    found = motion_slips(motion(with_damping(THESIS, 1e-6), speed, rate=90e3).part(9000))
    share = (x - np.arctan(x)) / np.hypot(1.0, x)
    assert share - 0.1 < found.sudden_share < share  # the torque is smoothed to 2 kHz
    period = 2.0 * np.pi / turn + 2.0 / turn * (x - np.arctan(x))
    assert found.rate == pytest.approx(1.0 / period, rel=1e-4)
    assert found.pattern == 1


# Slips


@pytest.mark.parametrize("lesser", [1.0, 0.95, 0.9, 0.8, 0.7])
def test_slips_of_alternate_size_are_counted_each_and_their_doubled_period_is_stated(lesser):
    twist, slips = sawtooth([0.02, 0.02 * lesser])
    found = find_slips(twist, 5.0, RATE, own_period=OWN)
    rate = (slips.size - 1) / (slips[-1] - slips[0])
    assert found.rate == pytest.approx(rate, rel=5e-3)
    assert found.pattern == (1 if lesser == 1.0 else 2)


@pytest.mark.parametrize(("fit", "support"), PLACES)
def test_with_true_stick_slips_are_those_of_the_solver(fit, support):
    for speed in (0.5, 1.0, 1.5):
        system, of = lumped_bushing(THESIS, fit, support).packed(), THESIS.fit(fit)
        _, _, events = solve_stick_slip(
            system, of.critical_torque, of.kinetic_torque, np.full(round(RATE), speed), 1 / RATE
        )
        starts = events[::2][events[::2] > 0.25]
        run = motion(THESIS, speed, fit, support).part(round(0.25 * RATE))
        by_solver = (starts.size - 1) / (starts[-1] - starts[0])
        assert motion_slips(run).rate == pytest.approx(by_solver, rel=0.02)


# Regimes


def test_grazing_the_shafts_speed_is_no_stick_slip():
    run = motion(FLUOROCARBON, 7.0, support=2214.0)
    assert run.part(15000).stuck.mean() > 0.01
    assert friction_regime(run) is Regime.QUASI_HARMONIC
