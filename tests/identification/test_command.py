"""What ``bushing-noise identify`` writes and refuses, end to end on the second simulator's rigs."""

import io
import json
import shutil
from contextlib import redirect_stderr

import numpy as np
import pytest

from models.rig_file import load_rig
from noise.cli import main
from noise.identification import law_fit
from noise.identification.law_model import CANDIDATES
from tests.blind.identify import make_rig, write_rig


@pytest.fixture(scope="module", autouse=True)
def few_laws():
    """Try one law: what is asked here does not depend on how many there are."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(law_fit, "CANDIDATES", CANDIDATES[:1])
        yield


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    where = tmp_path_factory.mktemp("rig") / "data"
    made = make_rig(1, 0, recordings=3)
    write_rig(made, where)
    return where


@pytest.fixture(scope="module")
def answered(folder, tmp_path_factory):
    """Exit code, folder of answers and what is said, one recording being unusable."""
    mixed = tmp_path_factory.mktemp("mixed") / "data"
    shutil.copytree(folder, mixed)
    for path in mixed.glob("run*.json"):
        content = json.loads(path.read_text())
        content["conditions"]["temperature_C"] = 30.0
        path.write_text(json.dumps(content))
    with (mixed / "known.toml").open("a") as file:
        file.write("[temperature]\nreference_C = 23\nglass_transition_C = -20\n")
    shutil.copy(mixed / "run01.wav", mixed / "bad.wav")
    sidecar = json.loads((mixed / "run01.json").read_text())
    del sidecar["conditions"]["interference_mm"]
    (mixed / "bad.json").write_text(json.dumps(sidecar))
    out, err = mixed.parent / "mine", io.StringIO()
    with redirect_stderr(err):
        code = main(["identify", str(mixed), "--rig", str(mixed / "known.toml"), "--out", str(out)])
    return code, out, err.getvalue()


def test_a_bad_recording_is_refused_by_name(answered):
    code, _, err = answered
    assert code == 1
    assert "bad.wav: states no interference_mm" in err


def test_it_prints_the_law_and_the_numbers_of_the_rig_file(answered):
    fit, last = load_rig(answered[1] / "rig.toml").fits[0], answered[2].splitlines()[-1]
    assert last.startswith('law = "')
    for words, value in (("stiffness", fit.elastomer_stiffness),
                         ("critical torque", fit.critical_torque),
                         ("kinetic torque", fit.kinetic_torque)):  # fmt: skip
        assert f"{words} {value:.4g} (" in last


def test_speeds_are_written_as_they_were_logged(folder, answered):
    sidecars = [json.loads(path.read_text()) for path in folder.glob("*.json")]
    logged = {sidecar["conditions"].get("speed_rad_s") for sidecar in sidecars}
    assert load_rig(answered[1] / "rig.toml").fastest_fitted in logged
    found = json.loads((answered[1] / "identification.json").read_text())
    assert {one["speed_rad_s"] for one in found["recordings"]} <= logged


def test_the_dependence_on_temperature_starts_at_that_of_the_recordings(answered):
    dependence = load_rig(answered[1] / "rig.toml").temperature
    assert dependence.reference == 30.0
    assert dependence.glass_transition == -20.0


def test_numbers_have_intervals_that_hold_them(answered):
    found = json.loads((answered[1] / "identification.json").read_text())
    assert found["numbers"]
    assert all(n["low"] <= n["value"] <= n["high"] for n in found["numbers"])
    assert all(n["recordings"] > 0 for n in found["numbers"])


def test_numbers_are_near_the_truth(answered):
    truth = make_rig(1, 0, recordings=3).truth
    assert (answered[1] / "report.html").stat().st_size > 50_000
    (fit,) = load_rig(answered[1] / "rig.toml").fits
    stiffness, critical, kinetic = next(iter(truth["fits"].values()))
    assert fit.elastomer_stiffness == pytest.approx(stiffness, rel=0.06)
    assert fit.critical_torque == pytest.approx(critical, rel=0.06)
    assert fit.kinetic_torque == pytest.approx(kinetic, rel=0.06)


def test_the_identified_rig_can_be_simulated(answered, tmp_path):
    assert main([
        "simulate", "--rig", str(answered[1] / "rig.toml"), "--speed", "1", "--seconds", "0.1",
        "--interference", "0.178", "--out", str(tmp_path / "run"),
    ]) == 0  # fmt: skip


def test_sound_alone_is_told_what_is_needed(tmp_path, capsys):
    import soundfile

    soundfile.write(tmp_path / "sound.wav", np.zeros(48000), 48000, subtype="FLOAT")
    (tmp_path / "sound.json").write_text(
        json.dumps({"channels": [{"name": "pressure", "unit": "Pa"}], "calibrated": True})
    )
    assert main(["identify", str(tmp_path)]) == 1
    assert "has no channel of torque" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("channel", "factor", "words"),
    [
        ("torque", 1e3, "channel torque looks like N mm, not N m"),
        ("torque", 1e-3, "channel torque looks like kN m, not N m"),
    ],
)
def test_another_unit_is_refused_before_anything_is_fitted(
    folder, tmp_path, capsys, channel, factor, words
):
    import soundfile

    wrong = tmp_path / "wrong"
    shutil.copytree(folder, wrong)
    for path in wrong.glob("run*.wav"):
        samples, rate = soundfile.read(path, always_2d=True)
        named = [
            one["name"] for one in json.loads(path.with_suffix(".json").read_text())["channels"]
        ]
        samples[:, named.index(channel)] *= factor
        soundfile.write(path, samples, rate, subtype="FLOAT")
    assert main(["identify", str(wrong), "--rig", str(folder / "known.toml")]) != 0
    assert words in capsys.readouterr().err
