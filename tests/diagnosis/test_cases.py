"""What a folder holds is diagnosed, or it is said in a line why not."""

from __future__ import annotations

import json
import wave
from dataclasses import replace

import numpy as np
import pytest

from models.errors import ParameterError
from models.rig_file import load_rig
from noise.cli import main
from noise.diagnosis.case import read_case, usable
from tests.helpers.small_rigs import RATE, RIG, RIG_FILE, at, only, run, write_case


@pytest.fixture(scope="module")
def recordings():
    return [run(at(v), seed=i) for i, v in enumerate((1.0, 2.0))]


def _answer(capsys, *arguments):
    code = main(["diagnose", *map(str, arguments)])
    out, err = capsys.readouterr()
    assert "Traceback" not in err
    return code, out, err


def _refused(capsys, *arguments):
    code, out, err = _answer(capsys, *arguments)
    assert out == ""
    lines = [line for line in err.splitlines() if line.startswith("bushing-noise: ")]
    assert len(lines) == 1, err
    return code, lines[0]


def _music(folder, seconds=1.0):
    folder.mkdir(parents=True, exist_ok=True)
    time = np.arange(int(44100 * seconds)) / 44100
    tone = (20000 * np.sin(2 * np.pi * 440 * time)).astype("<i2")
    with wave.open(str(folder / "song.wav"), "wb") as file:
        file.setnchannels(2)
        file.setsampwidth(2)
        file.setframerate(44100)
        file.writeframes(np.repeat(tone, 2).tobytes())


def _without(recording, **conditions):
    return replace(recording, condition=replace(recording.condition, **conditions))


def test_a_folder_of_music_gets_a_line_and_no_name(tmp_path, capsys):
    _, rig = write_case(tmp_path, [])
    _music(tmp_path / "music")
    code, line = _refused(capsys, tmp_path / "music", "--rig", rig)
    assert code == 1
    assert "song.wav" in line
    assert "sidecar" in line


def test_a_song_and_a_broken_file_are_refused_and_the_rest_diagnosed(recordings, tmp_path, capsys):
    data, rig = write_case(tmp_path, recordings)
    _music(data)
    (data / "broken.wav").write_bytes(b"RIFF....")
    out = tmp_path / "out"
    code, _, err = _answer(capsys, data, "--rig", rig, "--quick", "--out", out)
    assert code == 1
    notes = json.loads((out / "diagnosis.json").read_text())["notes"]
    for name in ("song.wav", "broken.wav"):
        assert name in err
        assert any(name in note for note in notes)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda r: _without(only(r, "pressure"), speed=None), "speed_rad_s"),
        (lambda r: _without(r, speed=0.0, support_stiffness=None), "speed"),
        (
            lambda r: _without(only(r, "pressure"), support_stiffness=None),
            "support_stiffness_Nm_rad",
        ),
        (lambda r: only(r, "angle"), "no channel of torque"),
        (lambda r: replace(r, samples=r.samples[:, :1500]), "lasts"),
        (lambda r: replace(r, rate=4e3), "4000 Hz"),
        (lambda r: replace(r, calibrated=False), "physical units"),
    ],
)
def test_what_a_recording_lacks_is_said(recordings, change, said):
    lacking = change(recordings[0])
    if said == "speed":
        lacking = only(lacking, "torque", "pressure")
    with pytest.raises(ParameterError) as refused:
        usable(lacking, RIG)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_an_interference_that_the_rig_file_does_not_reach_is_refused(recordings):
    with pytest.raises(ParameterError, match=r"interference_mm = 0\.381.*0\.279"):
        usable(_without(recordings[0], interference=0.381e-3), RIG)


def test_recordings_of_a_support_whose_response_was_not_measured_are_refused(
    recordings, tmp_path, capsys
):
    entry = """
[[measured_response]]
support_stiffness_Nm_rad = 3745
torque_to_acceleration = "a.npz"
"""
    data, rig = write_case(tmp_path, recordings, RIG_FILE + entry)
    frequency = np.arange(2.0, 12e3, 2.0)
    np.savez(
        tmp_path / "a.npz", frequency_hz=frequency, response=np.ones(frequency.size) + 0j,
        input_unit="N m", output_unit="m/s^2",
    )  # fmt: skip
    code, line = _refused(capsys, data, "--rig", rig)
    assert code == 1
    assert "2214" in line
    assert "3745" in line


@pytest.mark.parametrize("kind", ["torque", "acceleration", "pressure"])
def test_one_channel_of_one_recording_is_answered_with_notes(recordings, tmp_path, capsys, kind):
    data, rig = write_case(tmp_path, [only(recordings[0], kind)])
    code, out, _ = _answer(capsys, data, "--rig", rig, "--quick")
    assert code == 0
    told = json.loads(out)
    assert any("one recording" in note for note in told["notes"])
    missing = {"torque", "acceleration", "pressure", "angle"} - {kind}
    words = {"pressure": "no sound", "angle": "no shaft angle"}
    for other in missing:
        assert any(words.get(other, f"no {other}") in note for note in told["notes"]), other


def test_recordings_of_several_rates_are_answered(recordings, tmp_path, capsys):
    mixed = [recordings[0], run(at(1.0), seed=5, rate=48e3), run(at(2.0), rate=30e3, seconds=0.5)]
    data, rig = write_case(tmp_path, mixed)
    code, out, _ = _answer(capsys, data, "--rig", rig, "--quick")
    assert code == 0
    assert json.loads(out)["gap"] > 0


def test_a_file_of_effects_that_cannot_be_used_is_named(recordings, tmp_path, capsys):
    data, rig = write_case(tmp_path, recordings)
    (tmp_path / "mine.py").write_text("EFFECT = 1 / 0\n")
    code, line = _refused(capsys, data, "--rig", rig, "--effects", tmp_path / "mine.py")
    assert code == 2
    assert "mine.py" in line


def test_a_case_names_what_it_holds_and_what_it_refused(recordings, tmp_path):
    data, rig = write_case(tmp_path, recordings)
    _music(data / "sub")
    case = read_case([data], load_rig(rig))
    assert case.names == ("run01.wav", "run02.wav")
    assert [name for name, _ in case.refused] == ["sub/song.wav"]
    assert case.recordings[0].rate == RATE
