"""Recordings read in parts, and labelled from them."""

from __future__ import annotations

import numpy as np
import pytest
import soundfile

from models.errors import RecordingError
from models.recording import Channel, Recording
from noise.classifier import load_classifier
from noise.labels.rows import label_rows
from noise.labels.segments import label_recording
from noise.recordings import read_recording, write_recording
from noise.recordings.files import open_blocks

RATE = 8000


@pytest.fixture(autouse=True)
def small_is_large(monkeypatch):
    monkeypatch.setattr("noise.recordings.files._LARGE", 1)
    monkeypatch.setattr("noise.recordings.files._CHUNK", 5000)


def noise(channels, seconds, seed=0):
    return np.random.default_rng(seed).uniform(-0.5, 0.5, (channels, round(seconds * RATE)))


@pytest.mark.parametrize("ending", ["wav", "flac", "ogg", "aiff", "mp3"])
def test_parts_are_those_of_the_whole_in_any_order(tmp_path, ending):
    path = tmp_path / f"run.{ending}"
    soundfile.write(path, noise(2, 1.0).T, RATE)
    whole = read_recording(path, full_scale=2.0)
    with open_blocks(path, full_scale=2.0) as blocks:
        assert blocks.n_samples == whole.samples.shape[1]
        assert (blocks.channels, blocks.calibrated) == (whole.channels, True)
        for first, last in [(0, 10), (300, 2000), (7000, 8000), (5, 320), (0, 8000)]:
            np.testing.assert_array_equal(blocks.read(first, last), whole.samples[:, first:last])
        np.testing.assert_array_equal(
            np.concatenate([p.samples for p in blocks.track(1).pieces(10, 7990, 999)], axis=1),
            whole.samples[1:, 10:7990],
        )


@pytest.mark.parametrize("kinds", [("pressure", "angle"), ("torque", "speed"), ("acceleration",)])
def test_labels_and_conditions_are_those_of_the_whole(tmp_path, kinds):
    samples = noise(len(kinds), 24.0)
    samples[0, 5 * RATE : 9 * RATE] = np.sin(2 * np.pi * 1500.0 * np.arange(4 * RATE) / RATE)
    samples[0, 12 * RATE : 15 * RATE] = 0.0
    samples[-1] = np.cumsum(samples[-1]) / RATE + np.arange(samples.shape[1]) / RATE
    recording = Recording(samples, float(RATE), tuple(map(Channel, kinds)))
    path = write_recording(tmp_path / "run", recording)
    classifier = load_classifier()
    whole = read_recording(path)
    expected = label_rows("run.wav", whole, label_recording(whole, classifier))
    with open_blocks(path) as blocks:
        found = label_rows("run.wav", blocks, label_recording(blocks, classifier))
    assert found == expected
    assert len(found) > 1 or kinds != ("pressure", "angle")


def test_what_breaks_off_or_is_no_sound_is_refused_with_the_words_of_reading_the_whole(tmp_path):
    path = tmp_path / "run.wav"
    soundfile.write(path, noise(1, 1.0).T, RATE)
    for content in (path.read_bytes()[:-100], b"no sound", b""):
        path.write_bytes(content)
        with pytest.raises(RecordingError) as whole:
            read_recording(path)
        with pytest.raises(RecordingError) as parts, open_blocks(path):
            pass
        assert str(parts.value) == str(whole.value)


@pytest.mark.parametrize(("rate", "channels"), [(48_000, 1), (22_050, 1), (44_100, 2)])
def test_mp3_does_not_click_where_it_is_read_in_parts(tmp_path, rate, channels):
    path = tmp_path / "run.mp3"
    time = np.arange(6 * rate) / rate
    sound = np.where(time % 1.0 < 0.5, np.sin(2 * np.pi * 380.0 * time), 0.0)
    sound = np.stack([0.5 * sound] * channels, axis=1) + 0.2 * noise(channels, time.size / RATE).T
    soundfile.write(path, sound, rate, bitrate_mode="VARIABLE", compression_level=0.5)
    with soundfile.SoundFile(path) as file:
        at_once = file.read(always_2d=True).T
    np.testing.assert_allclose(read_recording(path).samples, at_once, atol=1e-6)
    with open_blocks(path) as blocks:
        for _ in range(2):  # from the beginning again
            pieces = [piece.samples for piece in blocks.pieces(0, blocks.n_samples, 1777)]
            np.testing.assert_allclose(np.concatenate(pieces, axis=1), at_once, atol=1e-6)
