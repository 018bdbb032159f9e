"""Recordings read, refused and written: the files as a whole."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from models.condition import FIXED, Condition
from models.errors import ParameterError
from models.recording import Channel, Recording
from models.units import CHANNEL_UNITS
from noise.recordings import read_recording, write_recording
from noise.recordings.formats import formats
from tests.helpers.files import HALF, named, refusal, sound


@pytest.mark.parametrize("ending", sorted(formats()))
def test_empty_files_text_and_noise_are_refused(tmp_path, ending):
    path = tmp_path / f"run{ending}"
    assert "no such file" in refusal(path)
    path.touch()
    assert "is empty (0 bytes)" in refusal(path)
    path.write_text("dear diary, today the bushing squealed again\n" * 20)
    assert re.search(f"no ({formats()[ending].name}|universal) file", refusal(path))


def test_folders_and_other_files_are_refused(tmp_path):
    (tmp_path / "run.wav").mkdir()
    assert "is a folder" in refusal(tmp_path / "run.wav")
    (tmp_path / "run.txt").write_text("torque")
    assert "no ending of a recording" in refusal(tmp_path / "run.txt")
    (tmp_path / "memo.M4A").write_bytes(b"ftypM4A ")
    assert "convert others, as by ffmpeg" in refusal(tmp_path / "memo.M4A")


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_sample_that_is_no_number_is_named(tmp_path, value):
    samples = np.zeros((480, 2), np.float32)
    samples[[24, 300], 1] = value
    path = sound(tmp_path / "run.wav", samples, "FLOAT", channels=named("torque", "angle"))
    assert f"channel 'angle' is {value} at sample 24 (0.0005 s)" in refusal(path)


def test_file_and_sidecar_must_not_contradict_each_other(tmp_path):
    path = sound(tmp_path / "run.wav", channels=named("torque", "angle"))
    assert "run.json: names 2 channels, run.wav has 1" in refusal(path)
    path.with_suffix(".json").write_text("{")
    assert "run.json: is no JSON" in refusal(path)


# Writing


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.lists(st.sampled_from(list(CHANNEL_UNITS)), min_size=1, unique=True),
    st.integers(16, 400),
    st.booleans(),
    st.sampled_from([None, FIXED, 2214.0]),
)
def test_a_recording_comes_back_as_it_was_written(tmp_path, names, n, calibrated, stiffness):
    samples = np.random.default_rng(n).normal(0, 30, (len(names), n)).astype(np.float32)
    condition = Condition(-5.0, 0.25e-3, stiffness, "PDMS", 23.0)
    channels = tuple(Channel(name, (0.08, 0.0, -1.5)) for name in names)
    run = Recording(samples.astype(np.float64), 30e3, channels, condition, calibrated, "run.wav")
    found = read_recording(write_recording(tmp_path / "run", run))
    assert np.array_equal(found.samples, run.samples)
    assert found.samples.dtype == np.float64
    for key in ("rate", "channels", "condition", "calibrated", "name"):
        assert getattr(found, key) == getattr(run, key)


def torque(samples=HALF, rate=30e3):
    return Recording(np.atleast_2d(samples), rate, (Channel("torque"),))


@pytest.mark.parametrize(
    ("name", "written"), [("run07", "run07.wav"), ("v2.5", "v2.5.wav"), ("A.WAV", "A.WAV")]
)
def test_the_file_and_its_sidecar_are_named_alike(tmp_path, name, written):
    path = write_recording(tmp_path / "new" / name, torque())
    assert path == tmp_path / "new" / written
    assert {file.name for file in path.parent.iterdir()} == {written, f"{Path(written).stem}.json"}


@pytest.mark.parametrize(
    ("recording", "reason"),
    [
        (torque(HALF[:15]), "15 samples"),
        (torque(np.full(20, math.nan)), "'torque' holds samples that are not finite"),
        (torque(np.full(20, 1e39)), "'torque' holds samples that are not finite"),
        (torque(rate=610.35), "610.35 Hz, but WAV holds whole hertz"),
        (torque(np.broadcast_to(0.0, (1, 1 << 30))), "4 GiB"),
    ],
)
def test_what_could_not_be_read_back_is_not_written(tmp_path, recording, reason):
    with pytest.raises(ParameterError, match=reason):
        write_recording(tmp_path / "run.wav", recording)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("samples", "rate", "channels", "reason"),
    [
        (np.zeros((2, 20)), 30e3, ("torque",), "do not fit 1 channels"),
        (np.zeros(20), 30e3, ("torque",), "do not fit"),
        (np.zeros((1, 20)), math.nan, ("torque",), "rate = nan"),
        (np.zeros((2, 20)), 30e3, ("torque", "torque"), "same name"),
    ],
)
def test_a_recording_that_contradicts_itself_is_refused(samples, rate, channels, reason):
    with pytest.raises(ParameterError, match=reason):
        Recording(samples, rate, tuple(Channel(name) for name in channels))
