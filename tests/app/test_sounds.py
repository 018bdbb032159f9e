"""What the app tells of one recording: its samples, levels, spectrogram."""

from __future__ import annotations

import io

import numpy as np
import pytest
import soundfile

from features.kernels.weighting import sound_levels
from models.errors import ParameterError, RecordingError
from models.recording import Channel, Recording
from noise.app.opened import open_paths
from noise.app.sounds import SoundCache, bands, outline, spectrogram, wav
from noise.recordings.wav import write_recording

RATE = 48000


def tone(seconds=2.0, frequency=1000.0, pascal=1.0):
    return np.sqrt(2.0) * pascal * np.sin(2 * np.pi * frequency * np.arange(seconds * RATE) / RATE)


@pytest.fixture(scope="module")
def sounds(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sounds")
    channels = (Channel("torque"), Channel("pressure"))
    samples = np.vstack([np.linspace(0.0, 1.0, 2 * RATE), tone()])
    write_recording(folder / "a.wav", Recording(samples, RATE, channels, calibrated=True))
    soundfile.write(folder / "b.wav", 0.5 * tone(0.3), RATE, subtype="FLOAT")
    (folder / "c.wav").write_bytes(b"no sound")
    return SoundCache(open_paths([folder]))


def test_by_default_the_sound_pressure_is_heard_in_pascals(sounds):
    samples, rate = soundfile.read(io.BytesIO(wav(sounds.track(0), {})))
    assert rate == RATE
    np.testing.assert_allclose(samples[1000:-1000], tone()[1000:-1000], atol=1e-5)


def test_a_channel_has_the_levels_of_its_kind(sounds):
    assert sounds.track(0).level_unit == "dB re 20 µPa"
    assert sounds.track(0, "torque").level_unit == "dB re 1 N m"
    assert sounds.track(1).level_unit == "dBFS"
    with pytest.raises(ParameterError, match="torque, pressure"):
        sounds.track(0, "angle")


def test_a_tone_of_94_db_is_read_as_that(sounds):
    facts, values = spectrogram(sounds.track(0), {"width": "200", "height": "300"})
    levels = facts["floor"] + facts["step"] * values.astype(float)
    assert levels.max() == pytest.approx(94.0, abs=0.5)
    row = int(levels[:, 100].argmax())
    at = facts["high"] * (facts["low"] / facts["high"]) ** ((row + 0.5) / facts["height"])
    assert at == pytest.approx(1000.0, rel=0.02)


def test_the_outline_holds_every_extreme(sounds):
    track = sounds.track(1)
    _, ends = outline(track, {"width": "77"})
    samples = track.read(0, track.n)
    assert (ends[0].min(), ends[1].max()) == pytest.approx((samples.min(), samples.max()))
    assert (ends[0] <= ends[1]).all()


def test_levels_are_those_of_the_meter_of_all_tables(sounds):
    track = sounds.track(0)
    whole = sound_levels(track.read(0, track.n), RATE)
    assert bands(track, {})["level_af_max"] == pytest.approx(whole.level_af_max, abs=0.01)
    found = bands(track, {"start": "0.5", "end": "1.5"})
    assert found["level_a"] == pytest.approx(93.98, abs=0.05)
    assert found["third_octaves"]["1000"] == pytest.approx(93.98, abs=0.05)


@pytest.mark.parametrize(
    "query",
    [
        {"start": "3"},
        {"start": "1", "end": "1"},
        {"start": "nan"},
        {"end": "x"},
        {"width": "1e9"},
    ],
)
def test_what_is_asked_wrongly_is_said(sounds, query):
    with pytest.raises(ParameterError) as refused:
        spectrogram(sounds.track(0), query)
    assert "\n" not in str(refused.value)


def test_what_is_no_recording_is_refused_each_time(sounds):
    for _ in range(2):
        with pytest.raises(RecordingError, match=r"c\.wav"):
            sounds.track(2)
    with pytest.raises(ParameterError, match="no recording 7"):
        sounds.track(7)


def test_a_file_that_has_changed_is_read_again(tmp_path):
    file = tmp_path / "a.wav"
    soundfile.write(file, tone(0.5), RATE, subtype="FLOAT")
    sounds = SoundCache(open_paths([file]))
    assert sounds.track(0).n == RATE // 2
    soundfile.write(file, tone(0.7), RATE, subtype="FLOAT")
    assert sounds.track(0).n == round(0.7 * RATE)
