from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.condition import FIXED, Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.audio.gain import common_full_scale
from noise.audio.render import write_audio
from noise.audio.sound import audible
from noise.recordings import read_recording

SQUEAL = Condition(speed=10.0, interference=0.279e-3, support_stiffness=FIXED, material="PDMS")


def tone(frequency, rate, *, seconds=0.5, amplitude=1.0, offset=0.0, **about):
    time = np.arange(round(seconds * rate)) / rate
    samples = amplitude * np.sin(2 * np.pi * frequency * time)[np.newaxis] + offset
    return Recording(samples, rate, (Channel("pressure", (0.1, 0.0, 0.8)),), SQUEAL, **about)


def amplitude_at(sound, frequency, rate):
    middle = sound[sound.size // 8 : -sound.size // 8]
    window = np.hanning(middle.size)
    phase = np.exp(-2j * np.pi * frequency * np.arange(middle.size) / rate)
    return 2 * abs((middle * window) @ phase) / window.sum()


@pytest.mark.parametrize("rate", [8000.0, 30e3, 44100.0, 48e3, 51200.0, 51199.87, 96e3])
def test_a_tone_keeps_pitch_loudness_and_length(rate):
    sound = audible(tone(1046.0, rate))
    assert amplitude_at(sound, 1046.0, 48000) == pytest.approx(1.0, abs=1e-3)
    assert sound.size / 48000 == pytest.approx(0.5, abs=2 / min(rate, 48000))


def test_nothing_folds_back_or_is_mirrored():
    sound = audible(tone(14e3, 30e3))
    assert amplitude_at(sound, 14e3, 48000) == pytest.approx(1.0, abs=1e-3)
    assert amplitude_at(sound, 16e3, 48000) < 1e-4
    assert np.abs(audible(tone(30e3, 96e3))[1000:-1000]).max() < 1e-4


def test_an_offset_is_not_heard():
    sound = audible(tone(500.0, 30e3, offset=40.0))
    assert np.abs(sound).max() < 1.05
    assert abs(sound.mean()) < 1e-3


def test_sound_fades_in_and_out():
    constant_power = tone(11e3, 48e3)
    sound = audible(constant_power)
    envelope = np.abs(sound).reshape(-1, 48).max(axis=1)  # of each millisecond
    for edge in (envelope[:12], envelope[::-1][:12]):
        assert edge[0] < 0.05
        assert np.all(np.diff(edge[:10]) > 0)
        assert edge[10] > 0.9


amplitudes = st.floats(1e-6, 1e4)


@settings(max_examples=40)
@given(amplitudes, st.integers(0, 9))
def test_written_sound_reads_back_calibrated(tmp_path_factory, peak, seed):
    samples = np.random.default_rng(seed).uniform(-peak, peak, 101)
    full_scale = common_full_scale([samples])
    path = tmp_path_factory.mktemp("audio") / "sound"
    recording = tone(500.0, 48e3)
    file = write_audio(path, samples, full_scale=full_scale, recording=recording)
    read = read_recording(file)
    resolution = full_scale * 2.0**-22
    assert read.calibrated
    assert read.rate == 48000
    assert read.condition == SQUEAL
    assert read.channel_names == ("pressure",)
    assert np.abs(read["pressure"] - samples).max() <= resolution
    file.with_suffix(".json").unlink()  # the file itself tells what full scale is worth
    alone = read_recording(file)
    assert alone.calibrated
    assert alone["pressure"] == pytest.approx(read["pressure"], rel=1e-6)


def test_sound_without_calibration_gets_none(tmp_path):
    recording = replace(tone(500.0, 48e3), calibrated=False)
    path = write_audio(tmp_path / "s", recording["pressure"], full_scale=2.0, recording=recording)
    assert json.loads(path.with_suffix(".json").read_text())["calibrated"] is False
    read = read_recording(path)
    assert not read.calibrated
    assert np.abs(read["pressure"]).max() == pytest.approx(0.5, abs=1e-4)


def test_what_would_clip_is_not_written(tmp_path):
    recording = tone(500.0, 48e3)
    for full_scale in (0.99, 0.0, -1.0, np.nan, np.inf):
        with pytest.raises(ParameterError, match="full scale"):
            write_audio(
                *(tmp_path / "s", recording["pressure"]),
                full_scale=full_scale, recording=recording,
            )  # fmt: skip
    assert list(tmp_path.iterdir()) == []
