from __future__ import annotations

import json
import math
import re
import struct
from pathlib import Path

import numpy as np
import pytest
import soundfile
from hypothesis import HealthCheck, given, settings, strategies as st

from models.condition import FIXED, Condition
from models.errors import ParameterError, RecordingError
from models.recording import Channel, Recording
from models.units import CHANNEL_UNITS
from noise.recordings import find_recordings, read_recording, write_recording
from noise.recordings.formats import formats

RATE = 48_000
HALF = np.full(480, 0.5)
BEXT = b"Sound: 0dBFS = 114 dBSPL"
METER = "run_FS94.0dB(PK).wav"
PASCAL_AT_94 = 20e-6 * 10 ** (94 / 20)
PASCAL_AT_114 = 20e-6 * 10 ** (114 / 20)


def sound(path: Path, samples: np.ndarray = HALF, subtype: str = "PCM_16", **sidecar) -> Path:
    soundfile.write(path, samples, RATE, subtype=subtype)
    if sidecar:
        path.with_suffix(".json").write_text(json.dumps(sidecar))
    return path


def with_bext(path: Path) -> Path:
    content = path.read_bytes()
    path.write_bytes(content + b"bext" + struct.pack("<I", 602) + BEXT.ljust(602, b"\0"))
    return path


def named(*names: str, **more: object) -> list[dict[str, object]]:
    return [{"name": name, "unit": Channel(name).unit, **more} for name in names]


def refusal(path: Path) -> str:
    with pytest.raises(RecordingError) as raised:
        read_recording(path)
    message = str(raised.value)
    assert message.startswith(str(path.with_suffix("")))
    assert "\n" not in message
    return message


# What the samples mean


def test_a_plain_sound_file_is_uncalibrated_pressure_on_every_track(tmp_path):
    run = read_recording(sound(tmp_path / "run.wav", np.stack([HALF, -HALF, HALF], axis=1)))
    assert run.channel_names == ("pressure", "pressure_2", "pressure_3")
    assert (run.calibrated, run.rate, run.name) == (False, 48_000.0, "run.wav")
    assert run.condition == Condition()
    assert np.array_equal(run["pressure_2"], -HALF)
    assert all(channel.full_scale == 1.0 for channel in run.channels)


def test_float_samples_with_a_sidecar_are_in_the_units_named(tmp_path):
    run = read_recording(sound(tmp_path / "run.wav", 60 * HALF, "FLOAT", channels=named("torque")))
    assert run.calibrated
    assert np.array_equal(run["torque"], 60 * HALF)


def test_the_scale_of_integer_samples_is_applied_and_kept(tmp_path):
    run = read_recording(sound(tmp_path / "run.flac", channels=named("torque", scale=100.0)))
    assert run.calibrated
    assert np.array_equal(run["torque"], 100 * HALF)
    assert run.channels == (Channel("torque", full_scale=100.0),)


def test_integer_samples_without_a_scale_stay_fractions(tmp_path):
    pair = np.stack([HALF, HALF], axis=1)
    channels = named("torque", scale=100.0) + named("angle")
    run = read_recording(sound(tmp_path / "run.wav", pair, channels=channels, calibrated=True))
    assert not run.calibrated
    assert np.array_equal(run.samples, pair.T)
    assert [channel.full_scale for channel in run.channels] == [1.0, 1.0]


@pytest.mark.parametrize("subtype", ["FLOAT", "PCM_16"])
def test_what_the_sidecar_calls_uncalibrated_is(tmp_path, subtype):
    scale = {"scale": 3.0} if subtype == "PCM_16" else {}
    channels = named("pressure", **scale)
    path = sound(tmp_path / METER, HALF, subtype, channels=channels, calibrated=False)
    run = read_recording(path)
    assert not run.calibrated
    assert np.array_equal(run["pressure"], HALF)


def test_conditions_alone_calibrate_nothing(tmp_path):
    path = sound(tmp_path / "run.wav", HALF, "FLOAT", conditions={"speed_rad_s": 2})
    run = read_recording(path)
    assert (run.condition.speed, run.calibrated) == (2.0, False)


def test_calibration_goes_option_sidecar_description_name_comment(tmp_path):
    path = tmp_path / METER
    with soundfile.SoundFile(path, "w", RATE, 1, "PCM_16") as file:
        file.comment = "0dBFS = 120 dBSPL"
        file.write(HALF)
    commented = tmp_path / "commented.wav"
    commented.write_bytes(path.read_bytes())

    def full_scale(file: Path, option: float | None = None) -> float:
        run = read_recording(file, full_scale=option)
        assert run.calibrated
        assert run["pressure"] == pytest.approx(0.5 * run.channels[0].full_scale)
        return run.channels[0].full_scale

    assert full_scale(commented) == pytest.approx(20.0)
    assert full_scale(path) == pytest.approx(PASCAL_AT_94)
    assert full_scale(with_bext(path)) == pytest.approx(PASCAL_AT_114)
    sidecar = path.with_suffix(".json")
    sidecar.write_text(json.dumps({"channels": named("pressure")}))
    assert full_scale(path) == pytest.approx(PASCAL_AT_114)
    sidecar.write_text(json.dumps({"channels": named("pressure", scale=7.0)}))
    assert full_scale(path) == 7.0
    assert full_scale(path, 3.0) == 3.0


def test_a_meter_calibrates_only_what_it_measures(tmp_path):
    assert not read_recording(sound(tmp_path / METER, channels=named("torque"))).calibrated


def test_a_vibration_meter_makes_the_track_an_acceleration(tmp_path):
    path = tmp_path / "run.wav"
    with soundfile.SoundFile(path, "w", RATE, 1, "PCM_16") as file:
        file.comment = "Vibration: 0dBFS = 2.40 mps2"
        file.write(HALF)
    assert read_recording(path)["acceleration"] == pytest.approx(1.2)
    assert read_recording(path, full_scale=10.0)["pressure"] == pytest.approx(5.0)


def test_the_option_alone_calibrates_even_what_the_sidecar_does_not(tmp_path):
    path = sound(tmp_path / "run.wav", channels=named("pressure"), calibrated=False)
    assert read_recording(path, full_scale=4.0)["pressure"] == pytest.approx(2.0)


@pytest.mark.parametrize("full_scale", [0, -1.0, math.nan, math.inf])
def test_full_scale_is_a_positive_number(tmp_path, full_scale):
    with pytest.raises(ParameterError, match="expected a positive number"):
        read_recording(sound(tmp_path / "run.wav"), full_scale=full_scale)


def test_silence_is_a_recording(tmp_path):
    assert not read_recording(sound(tmp_path / "none.wav", 0 * HALF))["pressure"].any()


# What is refused


@pytest.mark.parametrize("ending", sorted(formats()))
def test_empty_files_text_and_noise_are_refused(tmp_path, ending):
    path = tmp_path / f"run{ending}"
    assert "no such file" in refusal(path)
    path.touch()
    assert "is empty (0 bytes)" in refusal(path)
    path.write_text("dear diary, today the bushing squealed again\n" * 20)
    assert re.search("no (sound|universal|TDMS|MDF|HDF5) file", refusal(path))


def test_folders_and_other_files_are_refused(tmp_path):
    (tmp_path / "run.wav").mkdir()
    assert "is a folder" in refusal(tmp_path / "run.wav")
    (tmp_path / "run.txt").write_text("torque")
    assert "no ending of a recording" in refusal(tmp_path / "run.txt")


@pytest.mark.parametrize(("n_samples", "held"), [(0, "0 samples"), (1, "1 samples"), (15, "15")])
def test_a_few_samples_are_no_recording(tmp_path, n_samples, held):
    message = refusal(sound(tmp_path / "run.wav", HALF[:n_samples]))
    assert f"holds {held}" in message
    assert "expected at least 16" in message


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_sample_that_is_no_number_is_named(tmp_path, value):
    samples = np.zeros((480, 2), np.float32)
    samples[[24, 300], 1] = value
    path = sound(tmp_path / "run.wav", samples, "FLOAT", channels=named("torque", "angle"))
    assert f"channel 'angle' is {value} at sample 24 (0.0005 s)" in refusal(path)


def test_file_and_sidecar_must_not_contradict_each_other(tmp_path):
    path = sound(tmp_path / "run.wav", channels=named("torque", "angle"))
    assert "run.json: names 2 channels, run.wav has 1" in refusal(path)
    path = sound(tmp_path / "run.wav", HALF, "FLOAT", channels=named("torque", scale=2.0))
    assert "run.json: gives a scale, but run.wav holds floating-point" in refusal(path)
    path.with_suffix(".json").write_text("{")
    assert "run.json: is no JSON" in refusal(path)


def test_what_no_sensor_measures_is_refused(tmp_path):
    path = sound(tmp_path / "run.wav", 4e37 * HALF, "FLOAT")
    assert "at sample 0 (0 s), expected finite numbers up to 1e+15" in refusal(path)
    assert read_recording(sound(tmp_path / "run.wav", 1e15 * HALF, "DOUBLE")).samples.max() == 5e14


def test_a_scale_beyond_all_numbers_is_refused(tmp_path):
    path = sound(tmp_path / "run.wav", 1e300 * HALF, "DOUBLE")
    with pytest.raises(RecordingError, match="is inf at sample 0"):
        read_recording(path, full_scale=1e300)


# Writing and finding


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


def torque(samples: np.ndarray = HALF, rate: float = 30e3) -> Recording:
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
        (np.zeros((1, 20)), 0.0, ("torque",), "rate = 0.0"),
        (np.zeros((2, 20)), 30e3, ("torque", "torque"), "same name"),
    ],
)
def test_a_recording_that_contradicts_itself_is_refused(samples, rate, channels, reason):
    with pytest.raises(ParameterError, match=reason):
        Recording(samples, rate, tuple(Channel(name) for name in channels))


@pytest.mark.parametrize("name", ["run.flac", "run.json", ""])
def test_recordings_are_written_as_wav_only(name):
    with pytest.raises(ParameterError):
        write_recording(name, torque())


@pytest.mark.parametrize("blocked", ["run.wav", "run.json"])
def test_both_files_are_written_or_none(tmp_path, blocked):
    (tmp_path / blocked).mkdir()
    with pytest.raises(ParameterError, match="is a folder"):
        write_recording(tmp_path / "run.wav", torque())
    assert [path.name for path in tmp_path.iterdir()] == [blocked]


def test_recordings_are_found_at_any_depth_in_order(tmp_path):
    files = ["b.wav", "a/z.FLAC", "a/b/c.ogg", "a.wav", "a.json", "notes.txt"]
    hidden = [".part.wav", ".git/x.wav", "a/._z.wav"]
    for name in files + hidden:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    (tmp_path / "folder.wav").mkdir()
    found = find_recordings([tmp_path])
    assert [name for _, name in found] == ["a.wav", "a/b/c.ogg", "a/z.FLAC", "b.wav"]
    assert all(file == tmp_path / name for file, name in found)
    assert find_recordings(str(tmp_path)) == found


def test_a_file_stands_for_itself_under_its_own_name(tmp_path):
    (tmp_path / "a").mkdir()
    for name in ("a/notes.txt", "a/.hidden.wav"):
        (tmp_path / name).touch()
        assert find_recordings([tmp_path / name]) == [(tmp_path / name, Path(name).name)]


@pytest.mark.parametrize("name", ["nowhere", "nowhere.wav", "x" * 5000])
def test_a_path_that_does_not_exist_is_refused(tmp_path, name):
    with pytest.raises(ParameterError):
        find_recordings([tmp_path, tmp_path / name])
    with pytest.raises(RecordingError):
        read_recording(tmp_path / f"{name}.wav")
