"""Measures of a creak, by which a change of the model is judged."""

import numpy as np
import pytest

from tests.helpers.rig_measures import creak_measures

RATE = 48e3


def clicks(scatter, rng):
    """Two seconds of decaying bursts, 60 a second, their intervals scattered."""
    intervals = (rng.normal(1.0, scatter, 200).clip(0.3) / 60.0 * RATE).astype(int)
    at = np.cumsum(intervals)
    sound = np.zeros(round(2.0 * RATE))
    sound[at[at < sound.size]] = 1.0
    time = np.arange(480) / RATE
    return np.convolve(sound, np.exp(-time / 1e-3) * np.sin(2.0 * np.pi * 4e3 * time))[: sound.size]


@pytest.mark.parametrize("scatter", [0.0, 0.15, 0.3])
def test_jitter_is_the_scatter_of_the_intervals(scatter):
    jitter, harmonicity, _ = creak_measures(clicks(scatter, np.random.default_rng(1)), RATE)
    assert jitter == pytest.approx(scatter, abs=0.05)
    assert (harmonicity > 0.95) == (scatter == 0.0)


def test_noise_is_flatter_than_a_creak_and_a_tone_less_flat():
    rng = np.random.default_rng(2)
    time = np.arange(round(2.0 * RATE)) / RATE
    sounds = rng.standard_normal(time.size), clicks(0.0, rng), np.sin(2.0 * np.pi * 700.0 * time)
    noise, creak, tone = (creak_measures(sound, RATE)[2] for sound in sounds)
    assert noise > creak > tone
