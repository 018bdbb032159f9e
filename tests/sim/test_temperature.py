"""A rig in the cold and in the heat: its friction, its vibration, what a law of any kind makes."""

from dataclasses import replace

import numpy as np
import pytest

from models.bushing import TemperatureDependence
from models.rig import LawSpec
from models.rig_file import load_material_rig
from sim.analysis.critical_speeds import motion_from_rest
from sim.friction import LAWS
from sim.run import simulate
from sim.temperature import at_temperature

RIG = load_material_rig("fluorocarbon")
AT = (0.279e-3, 2214.0)


def with_law(name, temperature):
    rig = replace(RIG, friction=LawSpec(name), effects=())
    return at_temperature(rig, temperature)


def mean_torque(rig, speed=5.0, seconds=0.3):
    motion = motion_from_rest(rig, speed, *AT, seconds=seconds)
    return motion.torque[motion.torque.size // 2 :].mean()


def test_at_the_reference_temperature_a_run_is_to_the_bit_as_without():
    plain = simulate(replace(RIG, temperature=None), 5.0, seconds=0.1)
    run = simulate(RIG, 5.0, temperature=23.0, seconds=0.1)
    assert np.array_equal(run.recording.samples, plain.recording.samples)


@pytest.mark.parametrize("name", LAWS)
def test_any_law_rubs_less_far_from_the_peak_of_friction(name):
    usual = mean_torque(with_law(name, 23.0))
    for t in (-5.0, 80.0):
        found = mean_torque(with_law(name, t))
        assert np.isfinite(found)
        assert found < 0.97 * usual


def test_the_torque_of_a_smooth_law_is_on_the_bell():
    rubber = TemperatureDependence(23.0, -20.0, friction_peak=1.0)
    rig = replace(RIG, friction=LawSpec("lugre", {"stribeck_speed": 1e-4}), effects=(),
                  temperature=rubber)  # fmt: skip
    floor, shift = rubber.friction_floor, rubber.log_shift(60.0)

    def bell(decades):
        return floor + (1.0 - floor) * np.exp(-0.5 * (decades / rubber.friction_width) ** 2)

    v = np.log10(8.0)
    ratio = mean_torque(at_temperature(rig, 60.0), 8.0) / mean_torque(rig, 8.0)
    assert ratio == pytest.approx(bell(v + shift) / bell(v), rel=2e-3)
