"""The blow in the anchors' joint at each slip."""

import numpy as np
import pytest

from models.errors import ParameterError
from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.effects import effect
from sim.effects.slip_pulse import SlipPulse, torque_drops
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

RIG = load_material_rig("fluorocarbon")


def run(speed=2.5, interference=0.381e-3):
    return simulate_motion(
        RIG, ConstantSpeed(speed), interference=interference, support_stiffness=2214.0,
        seconds=0.3, rate=96e3,
    )  # fmt: skip


def test_without_amplitude_there_is_no_force():
    assert not SlipPulse(0.0, 5.2, 50e-6).force(run()).any()


def test_force_is_proportional_to_the_amplitude():
    motion = run()
    single = SlipPulse(10.0, 5.2, 50e-6).force(motion)
    double = SlipPulse(20.0, 5.2, 50e-6).force(motion)
    assert single.any()
    assert double == pytest.approx(2.0 * single)


def test_slips_that_stay_below_the_threshold_strike_nothing():
    settled = run(2.5, 0.279e-3).since(14_400)
    assert torque_drops(settled.torque, 1.0)[0].size > 10
    assert not effect(RIG.effects[0]).force(settled).any()


def test_blows_follow_the_direction_of_the_shaft():
    forward, backward = SlipPulse(10.0, 5.2, 50e-6).force(run()), None
    backward = SlipPulse(10.0, 5.2, 50e-6).force(run(-2.5))
    assert np.array_equal(forward, -backward)


def test_each_fall_of_a_sawtooth_is_found_once():
    sawtooth = 8.0 * ((np.arange(1000) / 100.0) % 1.0)
    where, size = torque_drops(sawtooth, 2.0)
    assert where.tolist() == list(range(100, 1000, 100))
    assert size == pytest.approx(np.full(9, 7.92))


def test_unknown_effects_and_parameters_are_refused_by_name():
    with pytest.raises(ParameterError, match="'slip_puls' is unknown"):
        effect(LawSpec("slip_puls"))
    with pytest.raises(ParameterError, match="no parameter 'amplitud'"):
        effect(LawSpec("slip_pulse", {"amplitud": 1.0}))
    with pytest.raises(ParameterError, match="out of range"):
        effect(LawSpec("slip_pulse", {"amplitude": -1.0}))
    with pytest.raises(ParameterError, match="is no number"):
        effect(LawSpec("slip_pulse", {"amplitude": "loud"}))
