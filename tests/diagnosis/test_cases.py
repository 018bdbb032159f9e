"""What a folder holds is diagnosed, or it is said in a line why not."""

from __future__ import annotations

import json
import math
import wave
from dataclasses import replace

import numpy as np
import pytest

from models.condition import Condition
from models.errors import ParameterError
from models.rig_file import load_material_rig, load_rig
from noise.cli import main
from noise.diagnosis.case import Case, usable, with_conditions
from noise.diagnosis.causes.advice import unseen_causes
from noise.diagnosis.diagnose import assumed_fit, case_remarks, diagnose
from sim.effects import EFFECTS
from tests.helpers.small_rigs import RIG, RIG_FILE, at, only, run, write_case


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


@pytest.mark.parametrize("text", ['base = "fluorocarbon-thesis"', 'material = "PDMS"', ""])
def test_the_bushing_that_was_not_stated_is_named(tmp_path, text):
    path = tmp_path / "rig.toml"
    path.write_text(text, encoding="utf-8")
    assert assumed_fit(load_rig(path)).startswith("no [[fit]] of its own")
    path.write_text(RIG_FILE, encoding="utf-8")
    assert assumed_fit(load_rig(path)) == ""


@pytest.mark.parametrize(("heat", "far"), [(25.0, False), (60.0, True)])
def test_recordings_far_from_the_temperature_of_a_shipped_bushing_say_so(heat, far):
    recording = run(at(1.0))
    hot = replace(recording, condition=replace(recording.condition, temperature=heat))
    case = Case(load_material_rig("fluorocarbon-thesis"), ("run",), (hot,))
    assert far == any("temperature 60" in text for text in case_remarks(case, EFFECTS))


@pytest.mark.parametrize("speed", [0.6, -4.0])
def test_the_speed_is_the_angles(speed):
    recorded = only(run(at(speed), seconds=0.3), "torque", "angle")
    stated = Condition(support_stiffness=2214.0, interference=0.279e-3)
    taken = with_conditions(replace(recorded, condition=stated), RIG)
    assert taken.condition.speed == pytest.approx(speed, rel=0.05)
    assert taken.notes[0].startswith("speed taken as ")


def test_the_only_fit_and_the_only_support_are_taken():
    (fit, *_) = RIG.fits
    one = replace(RIG, measured=(), fits=(replace(fit, damping={math.inf: 0.1}),))
    taken = with_conditions(replace(run(at(1.0)), condition=Condition(speed=1.0)), one)
    assert taken.condition.interference == fit.interference
    assert taken.condition.support_stiffness == math.inf


def test_what_nothing_tells_is_asked_for():
    recorded = replace(only(run(at(0.8)), "pressure"), name="run03.wav", condition=Condition())
    several = replace(RIG, fits=(RIG.fits[0], replace(RIG.fits[0], interference=0.3e-3)))
    with pytest.raises(
        ParameterError, match=r"states no speed_rad_s.*write into run03\.json"
    ) as no:
        usable(recorded, several)
    assert '"interference_mm" (of the rig file: 0.279, 0.3)' in str(no.value)


@pytest.fixture(scope="module")
def plain():
    return [run(at(speed), seed=i) for i, speed in enumerate((1.0, 1.6, 1.6))]


@pytest.mark.parametrize(
    ("kinds", "words"),
    [
        (("pressure",), "no torque"),
        (("torque",), "not assessed, by these channels: beam modes"),
        (("torque", "pressure"), "no acceleration"),
        (("torque", "acceleration", "pressure"), "no shaft angle"),
    ],
)
def test_each_set_is_answered_and_its_cost_is_said(plain, tmp_path, kinds, words):
    data, rig = write_case(tmp_path, [only(one, *kinds) for one in plain])
    told = diagnose(data, rig, quick=True)
    assert math.isfinite(told.gap)
    assert any(words in note for note in told.notes)
    assert all(told.probabilities[name] == 0.0 for name in unseen_causes(kinds))
    assert told.bench == ()


def test_a_sound_shows_structure_and_room_and_a_torque_does_not():
    assert unseen_causes({"pressure"}) == frozenset()
    assert {"beam_modes", "slip_pulse", "plate_modes"} <= unseen_causes({"torque", "angle"})
