"""``simulate --rig suspension``: the car's bar on the command line."""

import json

import pytest

from models.errors import ParameterError
from models.rig_file import load_rig
from models.suspension import load_suspension, suspension_file
from noise.cli import main
from noise.recordings import read_recording

ROAD = ["--oscillate", "6,2", "--seconds", "0.1"]


def test_the_shipped_suspension_is_recorded_with_both_bushings(tmp_path, capsys):
    run = tmp_path / "run"
    for name in (run, tmp_path / "again"):
        assert main(["simulate", "--rig", "suspension", *ROAD, "--out", str(name)]) == 0
    assert "left bushing" in capsys.readouterr().err
    recording = read_recording(run.with_suffix(".wav"))
    assert {"torque", "torque_2", "acceleration_2", "pressure"} <= set(recording.channel_names)
    notes = json.loads(run.with_suffix(".json").read_text(encoding="utf-8"))["notes"]
    assert any("load a bushing" in note for note in notes)
    assert run.with_suffix(".wav").read_bytes() == (tmp_path / "again.wav").read_bytes()


def test_a_file_of_ones_own_changes_the_shipped_one(tmp_path, capsys):
    path = tmp_path / "car.toml"
    text = suspension_file().read_text(encoding="utf-8")
    path.write_text(text.replace('"opposite"', '"together"'), encoding="utf-8")
    arguments = ["simulate", "--rig", str(path), *ROAD, "--change", "kinetic_torque=x0.5"]
    arguments += ["--change", "critical_torque_scatter.scatter=0"]  # each slips by its own chance
    assert main(arguments) == 0
    told = json.loads(capsys.readouterr().out)
    left, right = (told[f"{name}_rms_about_mean_Nm"] for name in ("torque", "torque_2"))
    assert left == pytest.approx(right, rel=1e-3)  # but for the sensors' noise


def test_only_simulate_takes_a_suspension(capsys):
    with pytest.raises(ParameterError, match="simulate --rig alone takes"):
        load_rig(suspension_file())
    assert main(["screen", str(suspension_file()), "--out", "x.json"]) == 2
    assert "simulate --rig alone takes" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("bar_wall_mm = 2", "bar_wall_mm = 20", "wall = 0.02 m must be above 0 and at most"),
        ("arm_length_mm = 250", "arm_lenght_mm = 250", "did you mean 'arm_length_mm'"),
        ("arm_length_mm = 250", "", "arm_length_mm is missing"),
        ("bushing_spacing_mm = 600", "bushing_spacing_mm = 890", "does not lie on the plate"),
        ('wheels = "opposite"', 'wheels = "sideways"', "there are together, opposite, left"),
        ("link_stiffness_N_m = 1.5e6", "link_stiffness_N_m = -1", "link_stiffness_N_m = -1 must"),
    ],
)
def test_what_a_file_says_wrongly_is_named(tmp_path, old, new, says):
    path = tmp_path / "car.toml"
    text = suspension_file().read_text(encoding="utf-8").replace("width_m = 0.90", "width_m = 0.85")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(ParameterError, match=says) as refused:
        load_suspension(path)
    assert str(refused.value).startswith(f"rig file {path}")


def test_pictures_of_the_rig_are_refused(capsys):
    assert main(["simulate", "--rig", "suspension", *ROAD, "--plot", "x.png"]) == 2
    assert "--plot is of the rig" in capsys.readouterr().err
