"""``simulate``: its options into a run, what is noted of odd ones, and the files that it writes."""

import argparse
import json
import math
import re

import numpy as np
import pytest

from models.condition import FIXED
from models.errors import ParameterError
from models.sensors import Sensors
from models.suspension import SHIPPED, load_suspension
from noise.cli import main
from noise.recordings import read_recording
from sim.shaft import ConstantSpeed, LoggedSpeed

SHORT = ("--speed", "5", "--seconds", "0.1")


@pytest.fixture
def call(monkeypatch):
    """Return what the simulator is called with; it computes nothing."""
    calls = []

    def simulate(rig, shaft, **about):
        calls.append(argparse.Namespace(rig=rig, shaft=shaft, **about))
        raise ParameterError("that is enough")

    def run(*arguments):
        assert main(["simulate", *map(str, arguments)]) == 2
        return calls.pop()

    monkeypatch.setattr("sim.run.simulate", simulate)
    return run


def notes(folder, capsys, *given):
    """What a run is told of on standard error, which is what its sidecar keeps."""
    run = folder / "run"
    assert main(["simulate", *map(str, given), "--out", str(run)]) == 0
    lead = "bushing-noise: note: "
    err = capsys.readouterr().err.splitlines()
    told = [line.removeprefix(lead) for line in err if line.startswith(lead)]
    assert told == json.loads(run.with_suffix(".json").read_text(encoding="utf-8")).get("notes", [])
    assert len(set(told)) == len(told)
    return told


def test_a_condition_has_the_documented_defaults(call):
    made = call("--speed", "5")
    assert made.shaft == ConstantSpeed(5.0)
    assert made.rig.material == "fluorocarbon"
    assert made.interference == pytest.approx(0.279e-3, rel=1e-12)
    assert (made.support_stiffness, made.temperature, made.seconds) == (2214.0, 23.0, 1.0)
    assert (made.acquisition.rate, made.acquisition.sensors) == (30e3, Sensors())


def test_a_condition_is_passed_on_in_si_units(call):
    made = call(
        *("--speed=2.5", "--interference", "0.381", "--support-stiffness", "fixed"),
        *("--material", "pdms", "--temperature", "-10", "--seconds", "0.5", "--rate", "48000"),
        *("--effect", "slip_pulse:amplitude=7"),
    )
    assert made.rig.material == "PDMS"
    assert [str(spec) for spec in made.rig.effects] == ["slip_pulse:amplitude=7"]
    assert made.interference == pytest.approx(0.381e-3, rel=1e-12)
    assert (made.support_stiffness, made.temperature, made.seconds) == (FIXED, -10.0, 0.5)
    assert made.acquisition.rate == 48e3


@pytest.mark.parametrize(
    ("text", "note"),
    [
        ("\ufeffspeed_rad_s, temperature_C, time_s\n1,20,0\n\n3,21,1\n", ""),
        ("time_s,speed_rad_s\r\n0,1\r\n9,19\r\n", "the run takes its first 1 s"),
        ("0.5,2\n0.6,2.2\n", "covers 0.5 to 0.6 s, the run 0 to 1 s"),
        ("Zeit [ms];Drehzahl [rpm]\n0;9,5492966\n1000;28,6478898\n", ""),
    ],
)
def test_a_log_gives_the_speed_with_or_without_header(call, tmp_path, capsys, text, note):
    log = tmp_path / "log.csv"
    log.write_text(text, encoding="utf-8")
    shaft = call("--speed", log).shaft
    assert isinstance(shaft, LoggedSpeed)
    assert shaft.speed(np.array([0.5]))[0] == pytest.approx(2.0, rel=1e-7)
    assert note in capsys.readouterr().err


@pytest.mark.parametrize(
    ("given", "cause"),
    [
        (("--interference", "0.1"), "those of 0.178 mm are used"),
        (("--effect", "partial_slip"), "effect partial_slip cannot act on friction law contact"),
        (("--temperature", "5"), "at 23, shifted by WLF; that is assumed, not measured"),
        (("--temperature", "95"), "WLF holds up to 80, 100 K above its glass transition"),
        (("--temperature", "80", "--material", "fluorocarbon-thesis"),
         "temperature 80 degree Celsius is recorded and changes nothing"),
        (("--support-stiffness", "3000"), "for 3000 Nm/rad it is interpolated, or held beyond"),
        (("--support-stiffness", "3e5"), "support_stiffness_Nm_rad = 300000 is outside the usual"),
        (("--change", "critical_torque=x9999"), "nothing slips in this run"),
        (("--speed", "30"), "speed 30 rad/s is above 13 rad/s, the highest speed to which fluoro"),
    ],
)  # fmt: skip
def test_what_is_odd_is_told_in_one_line_and_kept(tmp_path, capsys, given, cause):
    told = notes(tmp_path, capsys, *SHORT, *given)
    assert sum(cause in line for line in told) == 1, told


def test_what_a_rig_file_says_of_its_sensors_is_recorded_and_noted(tmp_path, capsys):
    rig = tmp_path / "rig.toml"
    rig.write_text(
        '[sensors]\nnoise = "from recordings"\nrange = { torque = 9.0, pressure = 30.0 }\n'
        "bits = { torque = 8 }\n",
        encoding="utf-8",
    )
    told = notes(tmp_path, capsys, "--rig", rig, "--speed", "2.5", "--seconds", "0.3")
    for part in ('noise = "from recordings"',
                 "torque reaches the range of its sensor, 9 N m"):  # fmt: skip
        assert any(part in line for line in told)
    torque = read_recording(tmp_path / "run.wav")["torque"]
    steps = torque / (2.0 * 9.0 / 2**8)
    assert np.array_equal(steps, np.round(steps))
    assert torque.max() == 9.0 * (1.0 - 2.0**-7)


def test_without_out_one_line_of_json_is_printed(capsys):
    assert main(["simulate", *SHORT, "--material", "PDMS"]) == 0
    out, err = capsys.readouterr()
    summary = json.loads(out)
    assert out.count("\n") == 1
    assert "simulating 0.1 s" in err
    assert summary["conditions"]["speed_rad_s"] == 5.0
    assert summary["torque_mean_Nm"] > 1.0 > summary["torque_rms_about_mean_Nm"] > 0.0
    assert 20.0 < summary["level_db"] < 20.0 * math.log10(summary["peak_pressure_Pa"] / 20e-6)


def test_recording_picture_and_sound_power_are_written_and_named(tmp_path, capsys):
    folder = tmp_path / "new"
    given = ["--speed", "-10", "--support-stiffness", "3745", "--seconds", "0.3"]
    paths = [folder / name for name in ("run07.wav", "run07.json", "run.png", "power.csv")]
    asked = ["--out", folder / "run07", "--plot", folder / "run.png"]
    asked += ["--sound-power", folder / "power.csv"]
    assert main(["simulate", *given, *map(str, asked)]) == 0
    out, err = capsys.readouterr()
    assert out.splitlines() == [str(path) for path in paths]
    assert "dB(A) re 1 pW in a baffle" in err
    run = read_recording(paths[0])
    assert (run.condition.speed, run.duration, run.calibrated) == (-10.0, 0.3, True)
    assert run["torque"].mean() < 0
    header, *rows = (row.split(",") for row in paths[3].read_text(encoding="utf-8").splitlines())
    assert header[:3] == ["band_hz", "power_level_db", "power_level_dba"]
    levels = {band: float(level) for band, level, *_ in rows if level}
    assert max(levels, key=levels.get) == "total"
    assert levels["1000"] == pytest.approx(levels["total"], abs=1.0)  # a squeal


ROAD = ["--oscillate", "6,2", "--seconds", "0.1"]


def test_the_shipped_suspension_is_recorded_with_both_bushings(tmp_path, capsys):
    told = notes(tmp_path, capsys, "--rig", "suspension", *ROAD)
    assert any("load a bushing" in note for note in told)
    recording = read_recording(tmp_path / "run.wav")
    assert {"torque", "torque_2", "acceleration_2", "pressure"} <= set(recording.channel_names)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("bar_wall_mm = 2", "bar_wall_mm = 20", "wall = 0.02 m must be at most half"),
        ("arm_length_mm = 250", "arm_lenght_mm = 250", "did you mean 'arm_length_mm'"),
        ("bushing_spacing_mm = 600", "bushing_spacing_mm = 890", "does not lie on the plate"),
        ('wheels = "opposite"', 'wheels = "sideways"', "there are together, opposite, left"),
    ],
)
def test_what_a_suspension_file_says_wrongly_is_named(tmp_path, old, new, says):
    path = tmp_path / "car.toml"
    text = SHIPPED.read_text(encoding="utf-8").replace("width_m = 0.90", "width_m = 0.85")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(ParameterError, match=says) as refused:
        load_suspension(path)
    assert str(refused.value).startswith(f"rig file {path}")


def test_a_recording_of_somebody_else_is_replaced_only_if_told_to(tmp_path, capsys):
    call = ["simulate", "--speed", "5", "--seconds", "0.05", "--quiet", "--out"]
    foreign, own = tmp_path / "foreign.wav", tmp_path / "own"
    foreign.write_bytes(b"measured")
    assert main([*call, str(foreign)]) == 2
    assert "--force to replace it" in capsys.readouterr().err
    assert foreign.read_bytes() == b"measured"
    assert main([*call, str(foreign), "--force"]) == 0
    assert [main([*call, str(own)]), main([*call, str(own)])] == [0, 0]
    assert capsys.readouterr() == ("", "")  # as it is quiet
    assert main([*call[:-2], "--verbose", "--out", str(own)]) == 0
    assert re.match(r"\[ *\d+\.\d\d s\] ", capsys.readouterr().err)  # each line with its time


def test_a_speed_that_may_be_meant_in_rpm_is_asked_about(tmp_path, capsys):
    out = str(tmp_path / "run")
    assert main(["simulate", "--speed", "60", "--seconds", "0.05", "--out", out]) == 0
    assert "if you mean 60 rpm, give --speed 6.28" in capsys.readouterr().err
