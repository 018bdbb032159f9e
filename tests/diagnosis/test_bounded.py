"""What is left of long and finely sampled recordings."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.recording import Channel, Recording
from models.rig_file import load_material_rig
from models.sensors import Sensor, Sensors
from noise.diagnosis.prepare import HIGHEST_RATE, LONGEST, bounded

RIG = load_material_rig("fluorocarbon-thesis")


def _tone(rate, seconds, frequency=1000.0):
    time = np.arange(round(seconds * rate)) / rate
    samples = np.sin(2 * np.pi * frequency * time)[np.newaxis]
    return Recording(samples, rate, (Channel("torque"),))


@settings(max_examples=20)
@given(rate=st.sampled_from([8e3, 30e3, 51.2e3, 65.536e3, 96e3, 192e3]), seconds=st.floats(0.3, 4))
def test_no_recording_is_longer_or_finer_than_is_looked_at(rate, seconds):
    before = _tone(rate, seconds)
    rig, (after,), notes = bounded(RIG, [before])
    assert after.rate <= HIGHEST_RATE
    assert after.duration <= LONGEST + 1 / after.rate
    assert after.duration == pytest.approx(min(before.duration, LONGEST), abs=2 / after.rate)
    assert len(notes) == (rate > HIGHEST_RATE) + (before.duration > LONGEST)
    if not notes:
        assert after is before
        assert rig is RIG


def test_what_is_audible_stays_and_what_would_fold_back_goes():
    _, (low,), _ = bounded(RIG, [_tone(96e3, 1.0, 10e3)])
    _, (high,), _ = bounded(RIG, [_tone(96e3, 1.0, 40e3)])
    inside = slice(100, -100)
    assert low.samples[0, inside].std() == pytest.approx(np.sqrt(0.5), rel=0.01)
    assert high.samples[0, inside].std() < 0.01


def test_the_noise_of_a_thinned_sensor_is_what_is_left_of_it():
    rng = np.random.default_rng(0)
    stated = Sensors({"torque": Sensor(noise=0.3, full_scale=2.0, bits=4)})
    rounded = 0.25 * np.round(1.2 * rng.standard_normal((1, 192_000)))
    rig, (kept,), _ = bounded(
        replace(RIG, sensors=stated), [Recording(rounded, 96e3, (Channel("torque"),))]
    )
    assert rig.sensors.of("torque").step == 0.0
    assert rig.sensors.of("torque").noise == pytest.approx(kept.samples.std(), rel=0.1)
