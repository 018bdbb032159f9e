from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.errors import ParameterError
from noise.audio.gain import (
    CEILING,
    full_scale_without_clipping,
    loudness,
    matched_full_scale,
    matched_loudness,
    true_peak,
)
from noise.recordings.wav import wav_bytes

RATE = 48000


def tone(frequency, seconds=1.0, phase=0.0, rate=RATE):
    return np.sin(2 * np.pi * frequency * np.arange(round(seconds * rate)) / rate + phase)


@pytest.mark.parametrize("rate", [44100, 48000])
def test_the_peak_between_samples_is_found(rate):
    faded = tone(rate / 4, 0.1, np.pi / 4, rate) * np.hanning(rate // 10)
    assert np.abs(faded).max() < 0.72
    assert true_peak(faded, rate) == pytest.approx(1.0, abs=0.01)


def test_the_largest_sample_is_never_above_the_true_peak():
    noise = np.random.default_rng(0).uniform(-1, 1, 1000)
    assert true_peak(noise, RATE) >= np.abs(noise).max()
    assert true_peak(np.zeros(480), RATE) == 0.0


# ITU-R BS.1770-5, Annex 1: a sine of 997 Hz at full scale on one channel reads -3.01 LKFS.
@pytest.mark.parametrize("rate", [44100, 48000])
def test_loudness_of_the_standards_sine(rate):
    assert loudness(tone(997, 2.0, rate=rate), rate) == pytest.approx(-3.01, abs=0.01)


def test_pauses_do_not_make_a_sound_less_loud():
    sound = np.concatenate([tone(997, 2.0), np.zeros(6 * RATE)])
    assert loudness(0.1 * sound, RATE) == pytest.approx(-23.0, abs=0.5)


@given(st.floats(1e-6, 1e3), st.floats(-60.0, -10.0))
@settings(max_examples=10)
def test_matched_sounds_have_the_loudness_asked_for(peak, target):
    rng = np.random.default_rng(3)
    bursts = rng.standard_normal(RATE) * (np.arange(RATE) % 12000 < 600)
    sound = peak * bursts
    full_scale = matched_full_scale(sound, RATE, target)
    assert loudness(sound / full_scale, RATE) == pytest.approx(target, abs=0.05)


def test_a_set_is_as_loud_as_its_peakiest_sound_allows():
    assert matched_loudness([-10.0, -15.0]) == -23.0
    assert matched_loudness([-10.0, -40.0]) == -41.0


def test_what_has_no_loudness_is_refused():
    with pytest.raises(ParameterError, match="silent"):
        matched_full_scale(np.zeros(RATE), RATE, -23.0)
    with pytest.raises(ParameterError, match=r"0\.2 s has no loudness.*0\.4 s"):
        loudness(tone(997, 0.2), RATE)


@given(st.floats(1e-6, 1e6))
def test_the_full_scale_told_is_enough_and_hardly_too_much(peak):
    least = full_scale_without_clipping(peak)
    assert peak <= CEILING * least
    assert peak > 0.998 * CEILING * least
    assert float(f"{least:g}") == least


def integers(data, n):
    return np.frombuffer(data[-2 * n :], dtype="<i2").astype(float)


def test_dither_makes_noise_of_what_rounding_would_distort():
    quiet = 0.7 * 2.0**-15 * tone(1000)  # less than a step of 16 bit
    frequency_of_third = 3000
    spectra = []
    for dither in (None, np.random.default_rng(0)):
        steps = integers(wav_bytes(quiet, RATE, 16, dither=dither), RATE)
        spectra.append(np.abs(np.fft.rfft(steps)) * 2 / RATE)
    rounded, dithered = spectra
    assert rounded[frequency_of_third] > 0.1
    assert dithered[frequency_of_third] < 0.02
    assert dithered[1000] == pytest.approx(0.7, abs=0.03)


def test_dither_never_carries_a_sample_beyond_full_scale():
    most = np.full(1000, 1.0 - 2.0**-15)
    steps = integers(wav_bytes(most, RATE, 16, dither=np.random.default_rng(0)), 1000)
    assert steps.min() > 32000
