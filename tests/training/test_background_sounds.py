"""Background sounds are as their rows state."""

import numpy as np
import pytest

from features.kernels.harmonics import analyse_harmonics
from noise.base.labels import SURROUNDINGS
from noise.training.classifier.background_sounds import BACKGROUND_SOUNDS, background_sound
from noise.training.classifier.synthesis import synthesised, voiced

RATE = 48e3


def made(name, seed, n=96_000):
    return synthesised(BACKGROUND_SOUNDS[name], n, RATE, np.random.default_rng(seed))


def spectrum(sound):
    return np.abs(np.fft.rfft(sound)) ** 2


@pytest.mark.parametrize("name", BACKGROUND_SOUNDS)
def test_every_row_makes_a_sound(name):
    for rate in (8_000, 48_000):
        sound = background_sound(rate // 2, float(rate), np.random.default_rng(0), name)
        assert sound.shape == (rate // 2,)
        assert np.isfinite(sound).all()
    assert {*BACKGROUND_SOUNDS[name]["surroundings"]} <= {*SURROUNDINGS}


def peaks_of_bursts(sound):
    """Strongest frequency [Hz], to 20 Hz, of every loud piece of 50 ms."""
    pieces = [sound[a : a + 2400] * np.hanning(2400) for a in range(0, 93_600, 1200)]
    return [20 * spectrum(p)[15:].argmax() + 300 for p in pieces if p.std() > 0.4 * sound.std()]


def test_an_alarm_has_a_few_exact_notes_where_a_bird_has_many():
    def distinct(name, seed):
        peaks = peaks_of_bursts(made(name, seed))
        return len(set(peaks)) / len(peaks)

    alarms = [distinct("alarm", seed) for seed in range(12)]
    birds = [distinct("birds", seed) for seed in range(12)]
    assert np.median(alarms) < 0.25 < np.median(birds)


def test_a_voice_has_the_pitch_asked_for():
    sound = voiced(48_000, RATE, np.full(48_000, 310.0), (900.0,), np.random.default_rng(0))
    assert analyse_harmonics(sound, RATE).fundamental == pytest.approx(310.0, rel=0.05)


def test_ticks_of_a_clock_keep_their_beat():
    for seed in range(6):
        sound = made("clock_tick", seed, 144_000)
        envelope = np.convolve(np.abs(sound), np.ones(480), mode="same")
        above = envelope > 0.3 * envelope.max()
        starts = np.flatnonzero(np.diff(above.astype(int)) > 0)
        gaps = np.diff(starts[np.concatenate([[True], np.diff(starts) > 2400])]) / RATE
        assert gaps.std() < 0.25 * gaps.mean() + 0.01
