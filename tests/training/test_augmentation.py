"""Rooms, microphones, recorders and codecs change a sound as they state."""

import numpy as np
import pytest

from noise.training.classifier.places import in_a_room
from noise.training.classifier.recorder import (
    RATES,
    augmented,
    coded,
    through_a_microphone,
)
from noise.training.draws import coloured_noise


def test_coloured_noise_falls_as_its_slope_says():
    noise = coloured_noise(2**16, 2.0, np.random.default_rng(0))
    power = np.abs(np.fft.rfft(noise)) ** 2
    fall = 10 * np.log10(power[100:200].mean() / power[1000:2000].mean())
    assert fall == pytest.approx(20.0, abs=1.5)


def test_a_room_adds_sound_after_a_click_that_dies_away():
    click = np.zeros(48_000)
    click[100] = 1.0
    clip = in_a_room(click, 48e3, np.random.default_rng(3))
    early, late = np.sum(clip[200:10_000] ** 2), np.sum(clip[20_000:] ** 2)
    assert not clip[:100].any() or np.abs(clip[:100]).max() < 1e-9
    assert early > 1e-3
    assert late < 0.1 * early


@pytest.mark.parametrize(("kind", "above"), [("phone", 20e3), ("pocket", 8e3)])
def test_a_microphone_has_a_band(kind, above):
    noise = np.random.default_rng(0).standard_normal(2**16)
    clip = through_a_microphone(noise, 48e3, np.random.default_rng(1), kind=kind)
    power = np.abs(np.fft.rfft(clip)) ** 2
    hertz = np.fft.rfftfreq(clip.size, 1 / 48e3)
    middle = power[(hertz > 300) & (hertz < 600)].mean()
    assert power[hertz < 40].mean() < 0.2 * middle
    assert power[hertz > above].mean() < 0.2 * middle


@pytest.mark.parametrize("seed", range(3))
def test_a_codec_keeps_a_tone_and_its_length(seed):
    tone = 0.5 * np.sin(2 * np.pi * 1000.0 * np.arange(30_000) / 44_100)
    clip = coded(tone, 44_100, np.random.default_rng(seed))
    assert clip.shape == tone.shape
    middle = slice(6_000, 24_000)
    line = np.abs(np.fft.rfft(clip[middle] * np.hanning(18_000))).argmax() * 44_100 / 18_000
    assert line == pytest.approx(1000.0, abs=5.0)


@pytest.mark.parametrize("seed", range(12))
def test_what_is_heard_fits_full_scale_and_is_silent_about_its_span(seed):
    sound = np.random.default_rng(0).standard_normal(40_000)
    clip, span = augmented(sound, 48e3, np.random.default_rng(seed))
    assert clip.rate in RATES
    (samples,) = clip.samples
    assert np.abs(samples).max() <= 1.0
    first, last = (round(time * clip.rate) for time in span)
    assert last - first == pytest.approx(40_000 / 48e3 * clip.rate, abs=2)
    inside = samples[first:last].std()
    for outside in (samples[: max(first - 2000, 0)], samples[last + 2000 :]):
        assert outside.size == 0 or outside.std() < 0.05 * inside
