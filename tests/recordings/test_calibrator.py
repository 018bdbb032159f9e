"""A calibrator's tone tells what full scale is worth, or why it does not."""

import numpy as np
import pytest
import soundfile
from hypothesis import given, strategies as st

from models.errors import RecordingError
from noise.recordings import read_recording
from noise.recordings.calibrator import read_calibrator

RATE = 48_000


def tone(frequency=1000.0, amplitude=0.1, seconds=2.0, rate=RATE, phase=0.3):
    time = np.arange(round(seconds * rate)) / rate
    return amplitude * np.sin(2 * np.pi * frequency * time + phase)


def written(folder, samples, rate=RATE, subtype="PCM_24"):
    path = folder / "tone.wav"
    soundfile.write(path, samples, rate, subtype=subtype)
    return path


@given(
    gain_db=st.floats(-60.0, -1.0),
    noise_db=st.sampled_from([-300.0, -60.0, -30.0]),
    level=st.sampled_from([93.8, 94.0, 114.0, 124.0]),
    nominal=st.sampled_from([250.0, 251.2, 1000.0]),
    off=st.one_of(st.just(0.0), st.floats(-0.01, 0.01)),
    rate=st.sampled_from([8000, 44_100, 48_000, 51_200]),
    seed=st.integers(0, 2**32 - 1),
)
def test_the_level_is_found_whatever_the_gain_with_noise_30_db_below_or_none(
    tmp_path_factory, gain_db, noise_db, level, nominal, off, rate, seed
):
    amplitude = 10.0 ** (gain_db / 20.0) / 1.3  # room for the noise
    pure = tone(nominal * (1.0 + off), 1.0, 1.3, rate)
    noise = np.random.default_rng(seed).standard_normal(pure.size) * 10 ** (noise_db / 20.0)
    noisy = amplitude * (pure + np.sqrt(0.5) * noise)
    path = written(tmp_path_factory.mktemp("tone"), noisy, rate, "PCM_16")
    (found,) = read_calibrator(path, level)
    rms = np.sqrt(0.5) * amplitude * found.full_scale
    assert 20.0 * np.log10(rms / 20e-6) == pytest.approx(level, abs=0.1)
    assert found.frequency == pytest.approx(nominal * (1.0 + off), rel=1e-3)


def test_each_track_has_its_own(tmp_path):
    path = written(tmp_path, np.stack([tone(amplitude=0.1), tone(amplitude=0.2)], axis=1))
    first, second = read_calibrator(path, 94.0)
    assert first.full_scale == pytest.approx(2.0 * second.full_scale, rel=1e-3)
    sound = tmp_path / "run.wav"
    soundfile.write(sound, np.full((100, 2), 0.5), RATE)
    run = read_recording(sound, full_scale=(first.full_scale, second.full_scale))
    assert run.calibrated
    assert run["pressure"][0] == pytest.approx(2.0 * run["pressure_2"][0], rel=1e-3)
    mono = tmp_path / "mono.wav"
    soundfile.write(mono, np.full(100, 0.5), RATE)
    with pytest.raises(RecordingError, match="has 1 tracks, and full scale is given for 2"):
        read_recording(mono, full_scale=(1.0, 2.0))


def test_a_tone_in_float_samples_counts_as_they_are(tmp_path):
    path = written(tmp_path, tone(amplitude=3.0), subtype="FLOAT")
    (found,) = read_calibrator(path, 94.0)
    assert found.full_scale == pytest.approx(1.0024 * np.sqrt(2.0) / 3.0, rel=1e-3)


def rising(samples):
    return samples * np.linspace(1.0, 1.2, samples.size)


HISS = 0.01 * np.random.default_rng(0).standard_normal(2 * RATE)

SPOILT = {
    "437": (tone(437.0), "strongest tone is at 437 Hz"),
    "silence": (np.zeros(RATE), "is silent"),
    "short": (tone(seconds=0.2), "lasts 0.2 s; 0.5 s at least"),
    "clipped": (np.clip(tone(amplitude=2.0), -1.0, 1.0 - 2**-23), "reaches full scale"),
    "cut": (np.clip(tone(amplitude=0.5), -0.45, 0.45), "tops are cut off"),
    "drift": (rising(tone()), "level changes by 1.5 dB between 0 and 1.9 s"),
    "late": (np.concatenate([np.zeros(RATE), tone()]), "tone is not there|level changes by"),
    "harmonics": (tone() + tone(2000.0, 0.006), "harmonics are 6.0% of the tone, and may be 4%"),
    "hum": (tone() + tone(50.0, 0.03), "other sound lies only 10 dB below"),
    "hiss": (tone() + HISS, "other sound lies only 17 dB below"),
}


@pytest.mark.parametrize("name", SPOILT)
def test_what_is_not_one_stable_tone_is_refused_with_the_reason(tmp_path, name):
    samples, reason = SPOILT[name]
    with pytest.raises(RecordingError, match=reason) as refused:
        read_calibrator(written(tmp_path, samples), 94.0)
    assert "tone.wav: is no calibrator's tone: " in str(refused.value)
    assert "\n" not in str(refused.value)


def test_the_track_at_fault_is_named(tmp_path):
    path = written(tmp_path, np.stack([tone(), tone(440.0)], axis=1))
    with pytest.raises(RecordingError, match=r"tone\.wav: track 2: is no calibrator's tone"):
        read_calibrator(path, 94.0)
