"""Recordings as 32-bit float WAV: the bytes, whole or by blocks."""

from __future__ import annotations

import numpy as np
import pytest
import soundfile
from scipy.io import wavfile

from models.condition import Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.recordings import write_recording
from noise.recordings.writing import write_blocks


def recording(samples, rate=48_000):
    channels = tuple(Channel(f"pressure_{i + 2}") for i in range(len(samples)))
    return Recording(samples, float(rate), channels)


@pytest.mark.parametrize("n_channels", [1, 2, 5])
def test_other_programs_read_what_was_written(tmp_path, n_channels):
    samples = np.random.default_rng(1).normal(0, 30, (n_channels, 70_001))
    path = write_recording(tmp_path / "run", recording(samples, 30_000))
    found, rate = soundfile.read(path, dtype="float32", always_2d=True)
    assert rate == 30_000
    assert soundfile.info(path).subtype == "FLOAT"
    assert np.array_equal(found.T, samples.astype(np.float32))


@pytest.mark.parametrize("n_channels", [1, 3])
def test_the_bytes_are_those_that_scipy_writes_however_they_arrive(tmp_path, n_channels):
    samples = np.random.default_rng(1).normal(0, 30, (n_channels, 1000))
    run = recording(samples)
    whole = write_recording(tmp_path / "whole", run)
    blocks = write_blocks(
        tmp_path / "blocks",
        np.split(samples, [1, 300], axis=1),
        n_samples=1000,
        rate=run.rate,
        channels=run.channels,
        condition=Condition(),
    )
    wavfile.write(tmp_path / "scipy.wav", 48_000, np.squeeze(samples.T.astype("<f4")))
    assert whole.read_bytes() == blocks.read_bytes() == (tmp_path / "scipy.wav").read_bytes()
    assert whole.with_suffix(".json").read_bytes() == blocks.with_suffix(".json").read_bytes()


def test_more_than_four_gibibytes_are_refused_before_writing(tmp_path):
    long = np.broadcast_to(np.zeros((1, 1)), (4, 1 << 28))
    with pytest.raises(ParameterError, match="4 GiB"):
        write_recording(tmp_path / "run", recording(long))
    assert not (tmp_path / "run.wav").exists()
