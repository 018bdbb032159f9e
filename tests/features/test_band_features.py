from __future__ import annotations

import math

import numpy as np
import pytest

from features.kernels.levels import NOMINAL_THIRD_OCTAVES, sound_levels
from features.recording import feature_vector

RATE = 48e3
OCTAVES = tuple(f"third_octave_{name}" for name in NOMINAL_THIRD_OCTAVES)


def noise(seconds=1.0, seed=0):
    return np.random.default_rng(seed).normal(size=round(RATE * seconds))


def test_they_are_the_levels_that_a_meter_shows():
    x = noise(2.0)
    found, levels = feature_vector(x, RATE, "pressure"), sound_levels(x, RATE)
    for name, level in levels.third_octaves.items():
        value = found[f"third_octave_{name}"]
        assert value == pytest.approx(level, abs=1e-6, nan_ok=True)


def test_half_a_second_is_too_short_for_the_lowest_bands():
    found = feature_vector(noise(0.5), RATE, "pressure")
    missing = {name for name in OCTAVES if math.isnan(found[name])}
    assert missing == {"third_octave_25", "third_octave_31.5", "third_octave_20000"}


def test_the_bands_of_the_thesis_hold_their_share_of_white_noise():
    found = feature_vector(noise(4.0), RATE, "pressure")
    for name, width in (("band_0_2000", 2000), ("band_2000_5000", 3000), ("band_5000_15000", 1e4)):
        assert found[name] == pytest.approx(10 * math.log10(width / 6850), abs=0.15)
