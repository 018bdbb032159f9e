"""The course of the pitch."""

import numpy as np
import pytest

from features.kernels.pitch import pitch_track

RATE = 16e3


def test_a_glide_is_followed():
    time = np.arange(16_000) / RATE
    phase = 2 * np.pi * (200.0 * time + 100.0 * time**2)  # from 200 to 400 Hz
    track = pitch_track(np.sin(phase), RATE)
    inside = (track.time > 0.15) & (track.time < 0.85)
    assert track.frequency[inside] == pytest.approx(200.0 + 200.0 * track.time[inside], rel=0.03)
    assert track.range == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize("signal", [np.zeros(8000), np.random.default_rng(0).normal(size=8000)])
def test_silence_and_noise_have_no_pitch_to_speak_of(signal):
    assert pitch_track(signal, RATE).voiced_share < 0.3
