"""Spectra and bands against scipy and closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import welch

from features.kernels.conditioning import band_analytic, band_signal, forward
from features.kernels.spectra import autospectrum
from models.errors import ParameterError


def tone(frequency, rate, seconds=1.0, amplitude=1.0):
    t = np.arange(round(rate * seconds)) / rate
    return amplitude * np.sin(2 * np.pi * frequency * t + 0.3)


def noise(n, seed=0):
    return np.random.default_rng(seed).normal(size=n)


def test_density_is_that_of_scipy_where_its_segments_fit():
    x = noise(48_000)
    ours = autospectrum(x, 48e3, resolution=10.0)
    frequency, density = welch(x, 48e3, "hann", nperseg=4800, noverlap=2400, detrend="constant")
    assert ours.n_segments == 19
    assert ours.frequency == pytest.approx(frequency)
    assert ours.density == pytest.approx(density)


@pytest.mark.parametrize(
    ("signal", "rate", "resolution", "words"),
    [
        (np.zeros((2, 100)), 1e3, 4.0, "one channel"),
        (np.zeros(3), 1e3, 4.0, "at least 16"),
        ([1.0] * 20 + [math.nan], 1e3, 4.0, "sample 20 is nan"),
        (np.zeros(100), 0.0, 4.0, "rate is 0.0"),
        (np.zeros(100), 1e3, -1.0, "resolution is -1.0"),
    ],
)
def test_what_cannot_be_analysed_is_refused_in_one_line(signal, rate, resolution, words):
    with pytest.raises(ParameterError, match=words) as error:
        autospectrum(signal, rate, resolution=resolution)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("rate", [16e3, 30e3, 44.1e3, 48e3, 65536.0, 96e3])
def test_a_band_keeps_what_lies_inside_and_drops_what_lies_outside(rate):
    inside, outside = tone(3000, rate, 0.5), tone(300, rate, 0.5) + tone(7960, rate, 0.5)
    kept, kept_rate = band_signal(forward(inside + outside, rate), 1000.0, 7000.0)
    assert kept_rate == pytest.approx(16e3, rel=1e-3)
    assert np.mean(kept**2) == pytest.approx(0.5, rel=0.01)
    envelope, _ = band_analytic(forward(inside, rate), 2000.0, 7000.0)
    assert abs(envelope) == pytest.approx(np.ones(envelope.size), abs=0.01)
