"""What a recording was stored at on its way makes no difference to how it is described."""

import numpy as np
import pytest
from scipy.signal import resample_poly

from models.recording import Channel, Recording
from noise.labels.windows import FEATURE_NAMES, describe
from noise.recordings.blocks import RecordingBlocks

TOP = FEATURE_NAMES.index("pressure_top_2")


def described(samples, rate):
    sound = Recording(samples[None, :], float(rate), (Channel("pressure"),), calibrated=False)
    return describe(RecordingBlocks.of(sound)).features


def tone_in_noise(n, rate=48_000):
    noise = np.random.default_rng(0).standard_normal(n)
    return 0.1 * noise + np.sin(2 * np.pi * 900.0 * np.arange(n) / rate)


@pytest.mark.parametrize("stored", [8_000, 16_000, 22_050])
def test_a_recording_brought_back_to_48_khz_is_described_as_it_was_stored(stored):
    low = resample_poly(tone_in_noise(96_000), stored, 48_000)
    back = resample_poly(low, 48_000, stored)
    a, b = described(low, stored), described(back, 48_000)
    assert np.array_equal(np.isnan(a), np.isnan(b))
    known = np.isfinite(a)
    assert np.median(np.abs(a - b)[known]) < 0.01


def test_a_full_recording_is_described_as_far_as_it_reaches():
    assert np.isfinite(described(tone_in_noise(96_000), 48_000)[:, TOP]).all()
    assert np.isnan(described(tone_in_noise(48_000, 24_000), 24_000)[:, TOP]).all()


def test_a_pure_tone_has_no_rate_of_its_own():
    time = np.arange(96_000) / 48e3
    hiss = 1e-4 * np.random.default_rng(0).standard_normal(time.size)
    tone = np.sin(2 * np.pi * 3_200.0 * time) + hiss
    assert np.isfinite(described(tone, 48_000)[:, TOP]).all()
