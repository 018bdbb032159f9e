"""The blow in the anchors' joint at each slip."""

import numpy as np
import pytest

from models.rig_file import load_material_rig
from sim.effects import EFFECTS
from sim.effects.slip_pulse import torque_drops
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed, Oscillation

RIG = load_material_rig("fluorocarbon")


def run(speed=2.5, interference=0.381e-3):
    return simulate_motion(
        RIG, ConstantSpeed(speed), interference=interference, support_stiffness=2214.0,
        seconds=0.3, rate=96e3,
    )  # fmt: skip


def force(motion, **given):
    active = EFFECTS["slip_pulse"].active(given)
    return active.effect.force(motion, active.form, active.values)


def test_slips_that_stay_below_the_threshold_strike_nothing():
    settled = run(2.5, 0.279e-3).part(14_400)
    assert torque_drops(settled.torque, 1.0)[0].size > 10
    assert not force(settled, **RIG.effects[0].parameters).any()


def test_each_fall_of_a_sawtooth_is_found_once():
    sawtooth = 8.0 * ((np.arange(1000) / 100.0) % 1.0)
    where, size = torque_drops(sawtooth, 2.0)
    assert where.tolist() == list(range(100, 1000, 100))
    assert size == pytest.approx(np.full(9, 7.92))


@pytest.mark.parametrize("form", EFFECTS["slip_pulse"].forms)
def test_every_form_of_a_blow_has_the_peak_that_the_drop_gives_it(form):
    motion = run()
    drops = torque_drops(motion.torque, 5.2)[1]
    peak = 60.0 * np.sqrt((drops.max() - 5.2) / (6.94 - 5.2))
    assert np.abs(force(motion, form=form)).max() == pytest.approx(peak, rel=0.2)


def test_turning_back_is_no_slip():
    swing = simulate_motion(
        RIG, Oscillation(np.deg2rad(15.0), 2.0), interference=0.279e-3, support_stiffness=2214.0,
        seconds=0.5, rate=96e3,
    )  # fmt: skip
    assert np.ptp(swing.torque) > 15.0
    assert not force(swing).any()
