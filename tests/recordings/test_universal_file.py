"""Universal files as recordings."""

import os
from pathlib import Path

import numpy as np
import pytest

from models.errors import RecordingError
from models.transfer_functions.uff import (
    FREQUENCY_RESPONSE,
    TIME_RESPONSE,
    UffFunction,
    write_uff_functions,
)
from noise.recordings import read_recording

TIME = np.arange(400) / 51200
WAVE = np.sin(700 * TIME)


def written(path, *functions):
    write_uff_functions(path, [UffFunction(TIME_RESPONSE, *parts) for parts in functions])
    return path


def test_functions_become_channels_in_si(tmp_path):
    path = written(
        tmp_path / "run.unv",
        (TIME, WAVE, "Pa"),
        (TIME, WAVE, "g"),
        (TIME, WAVE, "N m"),
        (TIME, 2 * WAVE, "Pa"),
    )
    run = read_recording(path)
    assert run.channel_names == ("pressure", "acceleration", "torque", "pressure_2")
    assert run.rate == 51200.0
    assert run.calibrated
    np.testing.assert_allclose(run["acceleration"], 9.80665 * WAVE, atol=1e-9)
    np.testing.assert_allclose(run["pressure_2"], 2 * WAVE, atol=1e-9)


def test_a_sidecar_has_the_last_word_on_channels(tmp_path):
    path = written(tmp_path / "run.uff", (TIME, WAVE, "Pa"))
    path.with_suffix(".json").write_text(
        '{"channels": [{"name": "acceleration"}], "conditions": {"speed_rad_s": 5.0}}'
    )
    run = read_recording(path)
    assert run.channel_names == ("acceleration",)
    assert run.condition.speed == 5.0


@pytest.mark.parametrize(
    ("functions", "message"),
    [
        ([(TIME, WAVE, "furlong")], "has unit 'furlong'"),
        ([(TIME, WAVE, "")], "states no unit"),
        ([(TIME, WAVE, "Pa"), (TIME[:100], WAVE[:100], "Pa")], "must be sampled together"),
        ([(TIME, WAVE, "Pa"), (2 * TIME, WAVE, "Pa")], "must be sampled together"),
    ],
)
def test_functions_that_are_no_channels_are_refused(tmp_path, functions, message):
    path = written(tmp_path / "run.uff", *functions)
    with pytest.raises(RecordingError) as refused:
        read_recording(path)
    assert message in str(refused.value)
    assert str(refused.value).startswith(str(path))


def test_a_response_function_is_no_recording(tmp_path):
    path = tmp_path / "frf.uff"
    write_uff_functions(path, [UffFunction(FREQUENCY_RESPONSE, 1 + TIME, WAVE + 0j, "Pa", "N m")])
    with pytest.raises(RecordingError, match="holds no time functions"):
        read_recording(path)


def test_a_damaged_file_is_one_line(tmp_path):
    path = tmp_path / "bad.uff"
    path.write_bytes(b"    -1\n    58\nnothing\n    -1\n")
    with pytest.raises(RecordingError, match=r"bad\.uff: is damaged"):
        read_recording(path)


DATA = os.environ.get("BUSHING_NOISE_REAL_DATA")


@pytest.mark.skipif(not DATA, reason="BUSHING_NOISE_REAL_DATA names no folder of real recordings")
def test_a_real_binary_file_is_read_in_pascals():
    run = read_recording(Path(DATA) / "uff" / "Sample_UFF58b_bin.uff")
    assert run.channel_names == ("pressure",)
    assert run.rate == 65536.0
    assert run.samples.shape == (1, 79292)
    assert run.calibrated
