from __future__ import annotations

import numpy as np
import pytest
import soundfile

from models.errors import ParameterError
from noise.recordings.formats.float_wav import write_float_wav


@pytest.mark.parametrize("n_channels", [1, 2, 5])
def test_other_programs_read_what_was_written(tmp_path, n_channels):
    samples = np.random.default_rng(1).normal(0, 30, (n_channels, 70_001))
    write_float_wav(tmp_path / "run.wav", samples, 30_000)
    found, rate = soundfile.read(tmp_path / "run.wav", dtype="float32", always_2d=True)
    assert rate == 30_000
    assert soundfile.info(tmp_path / "run.wav").subtype == "FLOAT"
    assert np.array_equal(found.T, samples.astype(np.float32))


def test_nothing_but_the_samples_makes_the_bytes(tmp_path):
    samples = np.ones((2, 20))
    write_float_wav(tmp_path / "a.wav", samples, 48_000)
    content = (tmp_path / "a.wav").read_bytes()
    assert len(content) == 58 + samples.size * 4
    assert b"PEAK" not in content


def test_more_than_four_gibibytes_are_refused_before_writing(tmp_path):
    long = np.broadcast_to(np.zeros((1, 1)), (4, 1 << 28))
    with pytest.raises(ParameterError, match="4 GiB"):
        write_float_wav(tmp_path / "run.wav", long, 48_000)
    assert not (tmp_path / "run.wav").exists()
