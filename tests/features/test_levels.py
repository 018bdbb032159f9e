from __future__ import annotations

import math

import numpy as np
import pytest

from features.kernels.levels import band_power
from features.kernels.spectra import autospectrum
from features.kernels.weighting import a_weighted, sound_levels
from features.table import feature_vector
from models.errors import ParameterError

PASCAL_DB = 93.9794

# IEC 61672-1:2013, Table 3: nominal frequency, A-weighting in dB.
A_TABLE = {
    31.5: -39.4, 63: -26.2, 125: -16.1, 250: -8.6, 500: -3.2, 1000: 0.0, 2000: 1.2, 4000: 1.0,
    8000: -1.1, 10000: -2.5, 12500: -4.3, 16000: -6.6,
}  # fmt: skip

# IEC 61672-1:2013, Table 4: duration of a 4 kHz burst in ms, largest fast level re steady.
BURSTS = {1000: 0.0, 500: -0.1, 200: -1.0, 100: -2.6, 50: -4.8, 20: -8.3, 10: -11.1, 5: -14.1,
          2: -18.0, 1: -21.0}  # fmt: skip


def tone(frequency, rate=48e3, seconds=1.0):
    """A sine of 1 Pa rms."""
    return np.sqrt(2) * np.sin(2 * np.pi * frequency * np.arange(round(seconds * rate)) / rate)


@pytest.mark.parametrize("rate", [30e3, 44.1e3, 48e3, 51.2e3, 96e3])
def test_one_pascal_is_94_decibels_at_every_rate(rate):
    levels = sound_levels(tone(1000, rate), rate)
    assert levels.level == pytest.approx(PASCAL_DB, abs=0.01)
    assert levels.level_a == pytest.approx(PASCAL_DB, abs=0.01)
    assert levels.level_af_max == pytest.approx(PASCAL_DB, abs=0.02)
    assert levels.third_octaves["1000"] == pytest.approx(PASCAL_DB, abs=0.01)
    assert levels.third_octaves["2000"] < 20


@pytest.mark.parametrize(("nominal", "expected"), A_TABLE.items())
def test_a_weighting_of_a_sound_is_that_of_the_standards_table(nominal, expected):
    exact = 1000 * 10 ** (round(10 * math.log10(nominal / 1000)) / 10)
    levels = sound_levels(tone(exact, 44.1e3), 44.1e3)
    assert levels.level_a - levels.level == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize(("milliseconds", "expected"), BURSTS.items())
def test_a_burst_reads_on_the_fast_scale_as_the_standard_says(milliseconds, expected):
    burst = np.zeros(72000)
    n = 48 * milliseconds
    burst[4800 : 4800 + n] = tone(4000)[:n]
    steady = sound_levels(tone(4000), 48e3).level_af_max
    assert sound_levels(burst, 48e3).level_af_max - steady == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize("measure", [a_weighted, sound_levels])
def test_what_is_no_sound_is_refused(measure):
    with pytest.raises(ParameterError, match="sample 3 is nan"):
        measure(np.array([0.0, 1.0, 2.0, np.nan] * 8), 48e3)


def test_bands_share_out_the_whole_power_whatever_their_edges():
    spectrum = autospectrum(np.random.default_rng(1).normal(size=30_000), 30e3, resolution=7.0)
    edges = np.array([0.0, 3.3, 101.7, 998.2, 5000.1, 15_000.0])
    parts = band_power(spectrum, edges[:-1], edges[1:])
    assert parts.sum() == pytest.approx(spectrum.density.sum() * spectrum.spacing)
    assert (parts > 0).all()


RATE = 48e3


def noise(seconds=1.0, seed=0):
    return np.random.default_rng(seed).normal(size=round(RATE * seconds))


def test_the_bands_of_the_thesis_hold_their_share_of_white_noise():
    found = feature_vector(noise(4.0), RATE, "pressure")
    for name, width in (("band_0_2000", 2000), ("band_2000_5000", 3000), ("band_5000_15000", 1e4)):
        assert found[name] == pytest.approx(10 * math.log10(width / 6850), abs=0.15)
