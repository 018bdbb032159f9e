"""A fault of a channel shows in that channel's numbers, where it is and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from noise.diagnosis.evidence.channel_summary import (
    BAND_EDGES,
    band_bins,
    path_summary,
)
from noise.diagnosis.evidence.reconstruction import angle_summary
from noise.diagnosis.evidence.summary import summary
from noise.diagnosis.simulated.transfer_functions import torque_transfer_functions
from tests.helpers.small_rigs import RATE, RIG, at, run

CONDITION = at(1.0)


@pytest.fixture(scope="module")
def recording():
    return run(CONDITION, seed=3)


@pytest.fixture(scope="module")
def numbers_of():
    found = torque_transfer_functions(RIG, 0.279e-3, 2214.0)
    return lambda recording: summary(recording, RIG, found)


def _changed(recording, name, change):
    from dataclasses import replace

    samples = recording.samples.copy()
    row = recording.channel_names.index(name)
    samples[row] = change(samples[row])
    return replace(recording, samples=samples)


OTHER = {"acceleration": "pressure", "pressure": "acceleration"}


@pytest.mark.parametrize("name", ["acceleration", "pressure"])
def test_a_gain_is_seen_in_its_channel_alone(recording, numbers_of, name):
    plain = numbers_of(recording)
    louder = numbers_of(_changed(recording, name, lambda x: 1.2 * x))
    assert louder[f"{name}_gain"] - plain[f"{name}_gain"] == pytest.approx(np.log(1.2), abs=5e-3)
    for i in range(3, 10):
        difference = louder[f"{name}_gain_{i}"] - plain[f"{name}_gain_{i}"]
        assert difference == pytest.approx(np.log(1.2), abs=0.01)
    assert louder[f"{name}_delay"] == pytest.approx(plain[f"{name}_delay"], abs=3.0)
    apart = {k for k in plain if not k.startswith((name, "common"))}
    assert all(np.array_equal(louder[k], plain[k], equal_nan=True) for k in apart)


@pytest.mark.parametrize("name", ["torque", "acceleration", "pressure"])
def test_clipping_is_seen_where_it_is(recording, numbers_of, name):
    def clipped(x):
        middle, most = np.median(x), np.abs(x - np.median(x)).max()
        return np.clip(x, middle - 0.4 * most, middle + 0.4 * most)

    plain, cut = numbers_of(recording), numbers_of(_changed(recording, name, clipped))

    def seen(channel):
        return max(cut[f"{channel}_{end}"] - plain[f"{channel}_{end}"] for end in ("top", "bottom"))

    assert seen(name) > 1.0
    assert cut[f"{name}_crest"] < plain[f"{name}_crest"]
    for other in {"torque", "acceleration", "pressure"} - {name}:
        assert seen(other) == 0.0


@pytest.mark.parametrize("mains", [50, 60])
@pytest.mark.parametrize("name", ["torque", "acceleration", "pressure"])
def test_hum_is_seen_where_it_is(recording, numbers_of, name, mains):
    row = recording.channel_names.index(name)
    size = 0.5 * recording.samples[row].std()
    time = np.arange(recording.samples.shape[1]) / RATE
    hum = size * np.sin(2 * np.pi * mains * time)
    plain = numbers_of(recording)
    humming = numbers_of(_changed(recording, name, lambda x: x + hum))

    def stands_out(channel):
        key = f"{channel}_raw_hum_{mains}" if channel == "torque" else f"{channel}_hum_{mains}"
        return humming[key] - plain[key]

    if name == "torque" and mains == 60:
        # a subharmonic of its cycle lies there already, with which the hum may be out of step
        assert humming["torque_raw_hum_level"] != plain["torque_raw_hum_level"]
        return
    assert stands_out(name) > 1.0
    if name != "torque":  # whose cycle has a line of its own there, and what hums in it is expected
        assert humming[f"{name}_hum_level"] > plain[f"{name}_hum_level"] + 0.3
        assert stands_out(OTHER[name]) == 0.0
        assert stands_out("torque") == 0.0


def test_noise_that_the_torque_does_not_explain_is_incoherent_in_its_band_alone():
    from scipy.signal import butter, sosfiltfilt

    rng = np.random.default_rng(4)
    x, more = rng.normal(size=(2, 40000))
    low, high = BAND_EDGES[8], BAND_EDGES[9]
    more = 2 * sosfiltfilt(
        butter(6, [low * 1.05, high / 1.05], "band", fs=RATE, output="sos"), more
    )
    numbers, _ = path_summary(x, x + more, RATE, np.empty(0))
    seen = {i: numbers[f"incoherent_{i}"] for i in band_bins(RATE)[0]}
    assert max(seen, key=seen.get) == 9
    assert all(seen[9] - seen[i] > 2.0 for i in seen if abs(i - 9) > 1)


@pytest.mark.parametrize("frequency", [3.0, 12.0, 30.0])
def test_an_uneven_shaft_is_seen_in_its_angle_with_its_frequency(frequency):
    time = np.arange(25600) / RATE
    wave = 0.02 * np.sin(2 * np.pi * frequency * time) / (2 * np.pi * frequency)
    noise = 1e-5 * np.random.default_rng(0).normal(size=time.size)
    plain = angle_summary(2.0 * time + noise, 2.0, RATE)
    uneven = angle_summary(2.0 * time + 20 * wave + noise, 2.0, RATE)
    assert uneven["speed_spread"] > plain["speed_spread"] + 0.5
    assert uneven["speed_line"] > plain["speed_line"]
    assert np.exp(uneven["speed_line_at"]) == pytest.approx(frequency, abs=1.5)
