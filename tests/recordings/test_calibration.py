"""What a sample is worth: option, sidecar, description, name, comment, calibrator's tone."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
import soundfile

from models.errors import ParameterError, RecordingError
from models.recording import Channel
from noise.recordings import read_recording
from noise.recordings.calibrator import read_calibrator
from noise.recordings.interpretation import stated_full_scale
from tests.helpers.files import HALF, RATE, named, sound

METER = "run_FS94.0dB(PK).wav"
PASCAL_AT_94 = 20e-6 * 10 ** (94 / 20)


def test_a_plain_sound_file_is_uncalibrated_pressure_on_every_track(tmp_path):
    run = read_recording(sound(tmp_path / "run.wav", np.stack([HALF, -HALF, HALF], axis=1)))
    assert run.channel_names == ("pressure", "pressure_2", "pressure_3")
    assert (run.calibrated, run.rate, run.name) == (False, 48_000.0, "run.wav")
    assert np.array_equal(run["pressure_2"], -HALF)
    assert all(channel.full_scale == 1.0 for channel in run.channels)


def test_float_samples_with_a_sidecar_are_in_the_units_named(tmp_path):
    run = read_recording(sound(tmp_path / "run.wav", 60 * HALF, "FLOAT", channels=named("torque")))
    assert run.calibrated
    assert np.array_equal(run["torque"], 60 * HALF)


def test_the_scale_of_integer_samples_is_applied_and_all_channels_need_one(tmp_path):
    run = read_recording(sound(tmp_path / "run.flac", channels=named("torque", scale=100.0)))
    assert run.channels == (Channel("torque", full_scale=100.0),)
    assert np.array_equal(run["torque"], 100 * HALF)
    pair, channels = np.stack([HALF, HALF], axis=1), named("torque", scale=100.0) + named("angle")
    run = read_recording(sound(tmp_path / "run.wav", pair, channels=channels, calibrated=True))
    assert not run.calibrated
    assert np.array_equal(run.samples, pair.T)
    assert [channel.full_scale for channel in run.channels] == [1.0, 1.0]


@pytest.mark.parametrize("subtype", ["FLOAT", "PCM_16"])
def test_what_the_sidecar_calls_uncalibrated_is_but_for_an_option(tmp_path, subtype):
    scale = {"scale": 3.0} if subtype == "PCM_16" else {}
    channels = named("pressure", **scale)
    path = sound(tmp_path / METER, HALF, subtype, channels=channels, calibrated=False)
    run = read_recording(path)
    assert not run.calibrated
    assert np.array_equal(run["pressure"], HALF)
    assert read_recording(path, full_scale=4.0)["pressure"] == pytest.approx(2.0)


def test_calibration_goes_option_sidecar_description_name_comment(tmp_path):
    path = sound(tmp_path / METER, comment="0dBFS = 120 dBSPL")
    commented = tmp_path / "commented.wav"
    commented.write_bytes(path.read_bytes())

    def full_scale(file, option=None):
        run = read_recording(file, full_scale=option)
        assert run.calibrated
        assert run["pressure"] == pytest.approx(0.5 * run.channels[0].full_scale)
        return run.channels[0].full_scale

    assert full_scale(commented) == pytest.approx(20.0)
    assert full_scale(path) == pytest.approx(PASCAL_AT_94)
    text = b"Sound: 0dBFS = 114 dBSPL".ljust(602, b"\0")
    path.write_bytes(path.read_bytes() + b"bext" + (602).to_bytes(4, "little") + text)
    assert full_scale(path) == pytest.approx(10 * PASCAL_AT_94)
    sidecar = path.with_suffix(".json")
    sidecar.write_text(json.dumps({"channels": named("pressure")}))
    assert full_scale(path) == pytest.approx(10 * PASCAL_AT_94)
    sidecar.write_text(json.dumps({"channels": named("pressure", scale=7.0)}))
    assert full_scale(path) == 7.0
    assert full_scale(path, 3.0) == 3.0


def test_a_meter_calibrates_what_it_measures_and_names_it(tmp_path):
    assert not read_recording(sound(tmp_path / METER, channels=named("torque"))).calibrated
    path = sound(tmp_path / "run.wav", comment="Vibration: 0dBFS = 2.40 mps2")
    assert read_recording(path)["acceleration"] == pytest.approx(1.2)
    assert read_recording(path, full_scale=10.0)["pressure"] == pytest.approx(5.0)


@pytest.mark.parametrize("full_scale", [0, -1.0, math.nan, math.inf])
def test_full_scale_is_a_positive_number(tmp_path, full_scale):
    with pytest.raises(ParameterError, match="expected a positive number"):
        read_recording(sound(tmp_path / "run.wav"), full_scale=full_scale)


# What meters write


@pytest.mark.parametrize(
    ("text", "level"),
    [
        ("2019-10-17_SLM_012_Audio_FS129.9dB(PK)_00.wav", 129.9),
        ("run_fs94dB_PK_.wav", 94.0),
        ("run FS117,8 dB(PK)", 117.8),
        ("Sound: 0dBFS = 109.7 dBSPL Time Zone: UTC-06:00 (DST)", 109.7),
        ("0 dBFS=94 dB SPL", 94.0),
    ],
)
def test_a_level_is_that_of_the_peak_at_full_scale(text, level):
    found = stated_full_scale(text)
    assert found.kind == "pressure"
    assert 20 * math.log10(found.value / 20e-6) == pytest.approx(level, abs=1e-9)


@pytest.mark.parametrize("unit", ["mps2", "m/s2", "m/s^2", "m/s²"])
def test_a_vibration_meter_states_an_acceleration(unit):
    found = stated_full_scale(f"Vibration: 0dBFS = 2.40 {unit} Time Zone: UTC-09:00")
    assert (found.kind, found.value) == ("acceleration", 2.4)


def test_other_texts_state_nothing():
    for text in (
        *("", "run07.wav", "OFFS94.0dB(PK).wav", "FS94.0dB(PKW).wav", "FS48000.wav"),
        *("FS99999dB(PK)", "0dBFS = 0 mps2", "0dBFS = -3 mps2", "0dBFS = 94 dBSPLASH"),
    ):
        assert stated_full_scale(text) is None, text


# A calibrator's tone


def tone(frequency=1000.0, amplitude=0.1, seconds=2.0, rate=RATE):
    time = np.arange(round(seconds * rate)) / rate
    return amplitude * np.sin(2 * np.pi * frequency * time + 0.3)


def written(folder, samples, rate=RATE, subtype="PCM_24"):
    soundfile.write(folder / "tone.wav", samples, rate, subtype=subtype)
    return folder / "tone.wav"


def test_a_tone_in_float_samples_counts_as_they_are(tmp_path):
    found = read_calibrator(written(tmp_path, tone(amplitude=3.0), subtype="FLOAT"), 94.0)
    assert found.full_scale == pytest.approx(1.0024 * np.sqrt(2.0) / 3.0, rel=1e-3)


HISS = 0.01 * np.random.default_rng(0).standard_normal(2 * RATE)
SPOILT = {
    "437": (tone(437.0), "strongest tone is at 437 Hz"),
    "silence": (np.zeros(RATE), "is silent"),
    "short": (tone(seconds=0.2), "lasts 0.2 s; 0.5 s at least"),
    "clipped": (np.clip(tone(amplitude=2.0), -1.0, 1.0 - 2**-23), "reaches full scale"),
    "cut": (np.clip(tone(amplitude=0.5), -0.45, 0.45), "components are 4.2% of the tone"),
    "drift": (tone() * np.linspace(1.0, 1.2, 2 * RATE), "changes by 1.5 dB between 0 and 1.9 s"),
    "late": (np.concatenate([np.zeros(RATE), tone()]), "tone is interrupted|level changes by"),
    "harmonics": (tone() + tone(2000.0, 0.006), "are 6.0% of the tone, more than the allowed 4%"),
    "hum": (tone() + tone(50.0, 0.03), "are 30.0% of the tone"),
    "hiss": (tone() + HISS, "of the tone, more than the allowed 4%"),
    "of a track": (np.stack([tone(), tone(440.0)], axis=1), "it has 2 tracks"),
}


@pytest.mark.parametrize("name", SPOILT)
def test_what_is_not_one_stable_tone_is_refused_with_the_reason(tmp_path, name):
    samples, reason = SPOILT[name]
    with pytest.raises(RecordingError, match=reason) as refused:
        read_calibrator(written(tmp_path, samples), 94.0)
    assert "is no calibrator's tone: " in str(refused.value)
    assert "\n" not in str(refused.value)
