from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
import soundfile
from hypothesis import given, strategies as st

from models.errors import RecordingError
from noise.recordings import find_recordings, read_recording

if TYPE_CHECKING:
    from models.recording import Recording


def read_or_refuse(path: Path) -> Recording | None:
    try:
        run = read_recording(path)
    except RecordingError as error:
        assert "\n" not in str(error)  # noqa: PT017
        return None
    assert np.isfinite(run.samples).all()
    assert run.samples.shape[1] >= 16
    return run


@given(st.sampled_from([".wav", ".flac"]), st.sampled_from([b"", b"RIFF", b"fLaC"]), st.binary())
def test_random_bytes_are_read_or_refused(tmp_path_factory, ending, head, content):
    path = tmp_path_factory.mktemp("bytes") / f"run{ending}"
    path.write_bytes(head + content)
    read_or_refuse(path)


@pytest.fixture(scope="module")
def valid(tmp_path_factory):
    folder = tmp_path_factory.mktemp("valid")
    samples = np.random.default_rng(7).normal(0, 0.1, (2000, 2))
    files = [("run.flac", "PCM_16"), ("run.wav", "PCM_16"), ("float.wav", "FLOAT")]
    for name, subtype in files:
        soundfile.write(folder / name, samples, 48_000, subtype=subtype)
    return [(folder / name).read_bytes() for name, _ in files]


@given(index=st.integers(0, 2), share=st.floats(0, 1, exclude_max=True))
def test_a_valid_file_cut_anywhere_is_refused(tmp_path_factory, valid, index, share):
    path = tmp_path_factory.mktemp("cut") / ("run.flac" if index == 0 else "run.wav")
    path.write_bytes(valid[index][: int(share * len(valid[index]))])
    assert read_or_refuse(path) is None


@given(
    index=st.integers(0, 2),
    changes=st.lists(st.tuples(st.integers(0, 100), st.integers(0, 255)), max_size=6),
)
def test_a_valid_file_with_a_wrong_header_is_read_or_refused(
    tmp_path_factory, valid, index, changes
):
    content = bytearray(valid[index])
    for position, byte in changes:
        content[position] = byte
    path = tmp_path_factory.mktemp("header") / ("run.flac" if index == 0 else "run.wav")
    path.write_bytes(content)
    read_or_refuse(path)


@pytest.mark.skipif(
    "BUSHING_NOISE_REAL_DATA" not in os.environ,
    reason="BUSHING_NOISE_REAL_DATA names no folder of real recordings",
)
def test_every_real_sound_is_read():
    found = find_recordings([Path(os.environ["BUSHING_NOISE_REAL_DATA"]) / "audio"])
    assert len(found) == 49
    for path, _ in found:
        run = read_recording(path)
        assert not run.calibrated
        assert run.samples.shape == (soundfile.info(path).channels, soundfile.info(path).frames)
