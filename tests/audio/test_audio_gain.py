"""Gain, loudness and true peak; recordings behind one another at one gain."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.condition import FIXED, Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.audio.gain import (
    CEILING,
    full_scale_without_clipping,
    loudness,
    matched_full_scale,
    true_peak,
)
from noise.audio.render import FullScale, measure, render
from noise.audio.sound import joined

RATE = 48000


def tone(frequency, seconds=1.0, phase=0.0, rate=RATE):
    return np.sin(2 * np.pi * frequency * np.arange(round(seconds * rate)) / rate + phase)


@pytest.mark.parametrize("rate", [44100, 48000])
def test_the_peak_between_samples_is_found(rate):
    faded = tone(rate / 4, 0.1, np.pi / 4, rate) * np.hanning(rate // 10)
    assert np.abs(faded).max() < 0.72
    assert true_peak(faded, rate) == pytest.approx(1.0, abs=0.01)


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


def run(name, amplitude, *, rate=RATE, seconds=0.5, condition=None, calibrated=True):
    time = np.arange(round(seconds * rate)) / rate
    samples = amplitude * np.sin(2 * np.pi * 1000 * time)[np.newaxis]
    known = condition or Condition()
    return Recording(samples, rate, (Channel("pressure"),), known, calibrated, name)


def test_parts_keep_their_loudness_and_the_gap_is_silent():
    samples, times = joined([run("A", 1.0), run("B", 0.25, rate=30e3)], gap=0.2)
    assert times == [(0.0, 0.5), pytest.approx((0.7, 1.2))]
    heard = [samples[round(start * RATE) : round(end * RATE)] for start, end in times]
    levels = [20 * np.log10(part[2400:-2400].std()) for part in heard]
    assert levels[0] - levels[1] == pytest.approx(20 * np.log10(4), abs=0.01)
    assert not samples[round(0.5 * RATE) : round(0.7 * RATE)].any()


def test_the_whole_knows_what_holds_for_all_parts(tmp_path):
    a = Condition(speed=5.0, interference=0.279e-3, support_stiffness=FIXED, material="PDMS")
    b = Condition(speed=5.0, interference=0.381e-3, support_stiffness=FIXED)
    runs = [run("A", 1, condition=a), run("B", 1, condition=b)]
    render(tmp_path / "ab.wav", runs, measure(runs), FullScale(2.0, "common"))
    about = json.loads((tmp_path / "ab.json").read_text())
    assert about["conditions"] == {"speed_rad_s": 5.0, "support_stiffness_Nm_rad": None}
    assert [part["conditions"]["interference_mm"] for part in about["parts"]] == [0.279, 0.381]


def test_calibrated_and_uncalibrated_sounds_share_no_gain():
    with pytest.raises(ParameterError, match="A is calibrated and B is not"):
        joined([run("A", 1.0), run("B", 1.0, calibrated=False)])
