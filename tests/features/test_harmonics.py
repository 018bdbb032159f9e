from __future__ import annotations

import numpy as np
import pytest

from features.kernels.conditioning import band_signal, forward
from features.kernels.harmonics import analyse_harmonics

RATE = 16e3


def times(seconds=1.0, rate=RATE):
    return np.arange(round(seconds * rate)) / rate


def sawtooth(frequency, seconds=1.0, rate=RATE):
    """Only the harmonics below 0.43 times the rate: what a recorder would have let through."""
    number = np.arange(1, int(0.43 * rate / frequency) + 1)
    phase = 2 * np.pi * frequency * np.outer(number, times(seconds, rate))
    return -(np.sin(phase) / number[:, np.newaxis]).sum(axis=0)


def noise(n, seed=0):
    return np.random.default_rng(seed).normal(size=n)


@pytest.mark.parametrize("rate", [16e3, 30e3, 44.1e3])
def test_a_sawtooth_has_many_harmonics_of_its_fundamental(rate):
    found = analyse_harmonics(sawtooth(155, rate=rate), rate)
    assert found.fundamental == pytest.approx(155, rel=0.005)
    assert found.count >= 25
    assert found.harmonicity > 0.95


@pytest.mark.parametrize("seconds", [0.25, 0.5, 1.0])
@pytest.mark.parametrize("ratio", [5.0, 10.0, 20.0])
@pytest.mark.parametrize("frequency", [155, 500])
def test_the_harmonic_to_noise_ratio_is_that_of_the_mixture(frequency, ratio, seconds):
    tones = sawtooth(frequency, seconds)
    hiss = band_signal(forward(noise(2 * tones.size, 3), RATE), 5.0, 7000.0)[0][: tones.size]
    x = tones + hiss * (tones.std() / hiss.std() * 10 ** (-ratio / 20))
    allowed = 1.0 if seconds < 0.5 else 0.5
    assert analyse_harmonics(x, RATE).harmonic_to_noise == pytest.approx(ratio, abs=allowed)


@pytest.mark.parametrize("stiffness", [0.0, 1e-5, 1e-4, 5e-4])
def test_a_stiff_string_is_as_inharmonic_as_its_b_says(stiffness):
    number = np.arange(1, 11)
    frequency = 200.0 * number * np.sqrt(1.0 + stiffness * number**2)
    amplitude = 1.0 / number
    x = amplitude @ np.sin(2 * np.pi * np.outer(frequency, times()) + number[:, np.newaxis] ** 2)
    found = analyse_harmonics(x, RATE)
    order = frequency / found.fundamental
    power = amplitude**2 / (amplitude**2).sum()
    assert found.fundamental == pytest.approx(200.0, rel=0.01)
    assert found.inharmonicity == pytest.approx(2 * power @ abs(order - number), abs=0.003)
