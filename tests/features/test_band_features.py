from __future__ import annotations

import math

import numpy as np
import pytest

from features.kernels.levels import NOMINAL_THIRD_OCTAVES, sound_levels, third_octave_edges
from features.table import feature_names, feature_vector

RATE = 48e3
OCTAVES = tuple(f"third_octave_{name}" for name in NOMINAL_THIRD_OCTAVES)


def tone(frequency, seconds=1.0, rms=1.0):
    return np.sqrt(2) * rms * np.sin(2 * np.pi * frequency * np.arange(RATE * seconds) / RATE)


def noise(seconds=1.0, seed=0):
    return np.random.default_rng(seed).normal(size=round(RATE * seconds))


@pytest.mark.parametrize("kind", ["pressure", "acceleration"])
def test_one_third_octaves_are_there_by_their_nominal_frequencies(kind):
    assert set(OCTAVES) <= set(feature_names(kind))
    assert not set(OCTAVES) & set(feature_names("torque"))


@pytest.mark.parametrize("at", range(len(NOMINAL_THIRD_OCTAVES) - 1))
def test_a_pascal_in_the_middle_of_a_band_is_94_db_there_and_nowhere_else(at):
    _, middle, _ = third_octave_edges()
    found = feature_vector(tone(middle[at], 2.0), RATE, "pressure")
    levels = [found[name] for name in OCTAVES[:-1]]
    assert levels[at] == pytest.approx(93.98, abs=0.1)
    assert all(level < 60 for i, level in enumerate(levels) if i != at)


def test_they_are_the_levels_that_a_meter_shows():
    x = noise(2.0)
    found, levels = feature_vector(x, RATE, "pressure"), sound_levels(x, RATE)
    for name, level in levels.third_octaves.items():
        value = found[f"third_octave_{name}"]
        assert value == pytest.approx(level, abs=1e-6, nan_ok=True)


def test_they_sum_to_the_level_of_what_they_cover():
    found = feature_vector(noise(2.0), RATE, "pressure")
    powers = [10 ** (found[name] / 10) for name in OCTAVES[:-1]]
    covered = (third_octave_edges()[2][-2] - third_octave_edges()[0][0]) / (RATE / 2)
    level = found["level"] + 10 * math.log10(covered)
    assert 10 * math.log10(sum(powers)) == pytest.approx(level, abs=0.1)


def test_a_hum_below_the_common_band_has_its_level_too():
    found = feature_vector(tone(50.0, 2.0), RATE, "pressure")
    assert found["third_octave_50"] == pytest.approx(93.98, abs=0.1)
    assert math.isnan(found["centroid"])


def test_a_band_that_is_not_there_lies_80_db_below_the_whole():
    found = feature_vector(tone(1000.0), RATE, "acceleration")
    assert found["third_octave_16000"] == pytest.approx(found["level"] - 80.0)


def test_half_a_second_is_too_short_for_the_lowest_bands():
    found = feature_vector(noise(0.5), RATE, "pressure")
    missing = {name for name in OCTAVES if math.isnan(found[name])}
    assert missing == {"third_octave_25", "third_octave_31.5", "third_octave_20000"}


def test_the_bands_of_the_thesis_hold_their_share_of_white_noise():
    found = feature_vector(noise(4.0), RATE, "pressure")
    for name, width in (("band_0_2000", 2000), ("band_2000_5000", 3000), ("band_5000_15000", 1e4)):
        assert found[name] == pytest.approx(10 * math.log10(width / 6850), abs=0.15)


def test_two_tones_lie_in_the_bands_of_the_thesis_by_their_power():
    found = feature_vector(tone(600.0) + tone(11_000.0, rms=0.1), RATE, "pressure")
    assert found["band_0_2000"] == pytest.approx(0.0, abs=0.02)
    assert found["band_5000_15000"] == pytest.approx(-20.0, abs=0.02)
    hum = feature_vector(tone(600.0) + tone(50.0), RATE, "pressure")
    assert hum["band_0_2000"] == pytest.approx(10 * math.log10(2), abs=0.02)
