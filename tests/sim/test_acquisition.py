"""The rig's data acquisition."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.rig_file import load_material_rig
from models.sensors import Sensor, Sensors
from sim.acquisition import (
    Acquisition,
    decimate_sensed,
    digitise,
)  # fmt: skip
from sim.run import simulate

QUIET = Acquisition(noise={})


def rng():
    return np.random.default_rng(0)


@given(
    full_scale=st.floats(1e-3, 1e3),
    bits=st.integers(2, 24),
    share=st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=50),
)
def test_a_converter_errs_by_half_a_step_inside_its_range_and_ends_at_it(full_scale, bits, share):
    sensor = Sensor(full_scale=full_scale, bits=bits)
    through = Acquisition(noise={}, sensors=Sensors({"torque": sensor}))
    values = 1.5 * full_scale * np.array(share)
    read = digitise(values, "torque", through, rng())
    inside = np.abs(values) <= full_scale - sensor.step
    half = 0.5 * sensor.step * (1.0 + 1e-9)
    assert np.abs(read - values)[inside].max(initial=0.0) <= half
    assert np.abs(read - np.clip(values, -full_scale, full_scale)).max() <= 2.0 * half
    assert np.abs(read / sensor.step - np.round(read / sensor.step)).max() < 1e-6


@pytest.mark.parametrize("corner", [500.0, 3e3, 9e3])
@pytest.mark.parametrize(
    ("relative", "gain_db", "within"), [(0.5, 0.0, 0.02), (1.0, -3.01, 0.02), (2.0, -48.2, 2.0)]
)
def test_the_filter_takes_3_db_at_its_corner_and_48_an_octave_above(
    corner, relative, gain_db, within
):
    rate = 20.0 * corner
    tone = np.sin(2.0 * np.pi * relative * corner / rate * np.arange(40_000))
    passed = decimate_sensed(tone, 1, rate, Sensor(antialias=corner))[4000:]
    assert 20.0 * np.log10(np.sqrt(2.0) * passed.std()) == pytest.approx(gain_db, abs=within)


def test_a_rig_records_through_its_sensors():
    coarse = Sensors(
        {
            "torque": Sensor(full_scale=20.0, antialias=2e3),
            "angle": Sensor(noise=0.0, full_scale=12.4, bits=12),
        }
    )
    rig = replace(load_material_rig("fluorocarbon"), sensors=coarse)
    how = {"seconds": 0.3, "acquisition": QUIET}
    one = simulate(rig, 5.0, **how).recording
    plain = simulate(load_material_rig("fluorocarbon"), 5.0, **how).recording
    assert not np.allclose(one["torque"], plain["torque"], atol=1e-3)
    assert np.array_equal(one["acceleration"], plain["acceleration"])
    assert np.abs(one["angle"] - plain["angle"]).max() <= 0.5 * coarse.of("angle").step
