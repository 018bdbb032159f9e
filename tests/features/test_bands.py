from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import fft

from features.kernels.levels import (
    NOMINAL_THIRD_OCTAVES,
    band_power,
    overall_level,
    third_octave_levels,
)
from features.kernels.spectra import autospectrum
from models.errors import ParameterError

PASCAL_DB = 93.979


def sine(frequency, rate=48e3, seconds=2.0):
    return math.sqrt(2) * np.sin(2 * np.pi * frequency * np.arange(round(rate * seconds)) / rate)


def pink(n, rate, seed=0):
    frequency = np.maximum(fft.rfftfreq(n, 1 / rate), 1.0)
    phase = np.random.default_rng(seed).uniform(0, 2 * np.pi, frequency.size)
    return fft.irfft(np.exp(1j * phase) / np.sqrt(frequency), n)


def test_a_pascal_at_1_khz_is_93_98_decibels_in_its_band_overall_and_weighted():
    spectrum = autospectrum(sine(1000), 48e3)
    levels = third_octave_levels(spectrum, reference=2e-5)
    assert levels["1000"] == pytest.approx(PASCAL_DB, abs=0.01)
    assert overall_level(spectrum, reference=2e-5) == pytest.approx(PASCAL_DB, abs=0.01)
    weighted = overall_level(spectrum, reference=2e-5, weighting="A")
    assert weighted == pytest.approx(PASCAL_DB, abs=0.01)
    assert max(levels["800"], levels["1250"]) < PASCAL_DB - 60


def test_pink_noise_is_flat_in_one_third_octaves():
    spectrum = autospectrum(pink(20 * 48_000, 48e3), 48e3, resolution=1.0)
    levels = third_octave_levels(spectrum, reference=1.0)
    inside = np.array([levels[name] for name in NOMINAL_THIRD_OCTAVES if 50 <= float(name) <= 16e3])
    assert np.abs(inside - inside.mean()).max() < 0.5


def test_bands_share_out_the_whole_power_whatever_their_edges():
    spectrum = autospectrum(np.random.default_rng(1).normal(size=30_000), 30e3, resolution=7.0)
    edges = np.array([0.0, 3.3, 101.7, 998.2, 5000.1, 15_000.0])
    parts = band_power(spectrum, edges[:-1], edges[1:])
    assert parts.sum() == pytest.approx(spectrum.density.sum() * spectrum.spacing)
    assert (parts > 0).all()


def test_band_edges_in_the_wrong_order_and_unknown_weightings_are_refused():
    spectrum = autospectrum(sine(1000), 48e3)
    with pytest.raises(ParameterError, match="upper edge lies below"):
        band_power(spectrum, [200.0], [100.0])
    with pytest.raises(ParameterError, match="use 'Z' \\(none\\) or 'A'"):
        overall_level(spectrum, reference=1.0, weighting="C")
