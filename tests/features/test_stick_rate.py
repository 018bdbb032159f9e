from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from features.recording import recording_features, stick_rate_of
from features.transformer import RecordingFeatures
from models.condition import Condition
from models.recording import Channel, Recording

RATE = 30e3
KNOWN = Condition(5.0, 0.279e-3, 2214.0, "fluorocarbon-thesis")
SERIES = 665.0 * 2214.0 / (665.0 + 2214.0)


def recording(condition=KNOWN, seconds=0.5, calibrated=True, **channels):
    t = np.arange(round(RATE * seconds)) / RATE
    rows = {"torque": 8.0 + 0.0 * t} | {name: of(t) for name, of in channels.items()}
    names = tuple(Channel(name) for name in rows)
    return Recording(np.stack(list(rows.values())), RATE, names, condition, calibrated)


@pytest.mark.parametrize(("speed", "of"), [(5.0, 5.0), (-5.0, 5.0), (1.0, 1.0)])
def test_torque_rises_at_effective_stiffness_times_speed(speed, of):
    assert stick_rate_of(recording(replace(KNOWN, speed=speed))) == pytest.approx(SERIES * of)


@pytest.mark.parametrize(
    "condition",
    [
        replace(KNOWN, speed=None),
        replace(KNOWN, speed=0.0),
        replace(KNOWN, interference=None),
        replace(KNOWN, support_stiffness=None),
        replace(KNOWN, material=None),
        replace(KNOWN, material="unobtainium"),
        Condition(),
    ],
)
def test_what_is_not_known_is_missing(condition):
    assert math.isnan(stick_rate_of(recording(condition)))


def test_speed_from_its_own_channels_goes_before_that_of_the_sidecar():
    turning = recording(angle=lambda t: 0.3 - 2.0 * t)
    assert stick_rate_of(turning) == pytest.approx(SERIES * 2.0, rel=1e-6)
    measured = recording(speed=lambda t: 3.0 + 0.0 * t, angle=lambda t: 2.0 * t)
    assert stick_rate_of(measured) == pytest.approx(SERIES * 3.0)


def test_a_noisy_angle_of_12_bit_tells_the_speed():
    rng = np.random.default_rng(2)
    step = 6e-3
    turning = recording(
        angle=lambda t: step * np.rint((5.0 * t + 2e-3 * rng.normal(size=t.size)) / step)
    )
    assert stick_rate_of(turning) == pytest.approx(SERIES * 5.0, rel=0.02)


def test_the_slope_ratio_tells_stick_from_what_merely_oscillates():
    t = np.arange(15_000) / RATE
    rises, drop = SERIES * 5.0, 12.0
    period = drop / rises / 0.95
    phase = t / period % 1.0
    sawtooth = 8.0 + drop * np.interp(phase, [0.0, 0.95, 1.0], [0.0, 1.0, 0.0])
    slow = 8.0 + 0.1 * (sawtooth - 8.0)
    channels = (Channel("torque"),)
    for torque, ratio in ((sawtooth, 1.0), (-sawtooth, 1.0), (slow, 0.1)):
        run = Recording(torque[np.newaxis], RATE, channels, KNOWN)
        found = recording_features(run)["torque_slope_ratio"]
        assert found == pytest.approx(ratio, rel=0.02)
        transformer = RecordingFeatures(("torque",))
        column = transformer.get_feature_names_out().tolist().index("torque_slope_ratio")
        assert transformer.fit_transform([run])[0, column] == found
    assert math.isnan(
        recording_features(Recording(sawtooth[np.newaxis], RATE, channels))["torque_slope_ratio"]
    )
