from __future__ import annotations

import argparse
import json
import math

import numpy as np
import pytest

from models.condition import FIXED
from models.errors import ParameterError
from models.sensors import Sensors
from noise.cli import main
from noise.recordings import read_recording
from sim.acquisition import THESIS_CONVERTER
from sim.shaft import ConstantSpeed, LoggedSpeed, Oscillation, SpeedRamp


@pytest.fixture
def simulated(monkeypatch):
    """Calls of the simulator, which fails as soon as it is called."""
    calls = []

    def simulate(rig, shaft, **about):
        calls.append(argparse.Namespace(rig=rig, shaft=shaft, **about))
        raise ParameterError("that is enough")

    monkeypatch.setattr("sim.run.simulate", simulate)
    return calls


def call(simulated, *arguments):
    assert main(["simulate", *arguments]) == 2
    (made,) = simulated
    return made


def refusal(capsys, *arguments):
    """The one line on standard error of a call that is refused."""
    assert main(list(arguments)) == 2
    out, err = capsys.readouterr()
    assert out == ""
    line = err.splitlines()[-1]
    assert line.startswith("bushing-noise: error: ")
    assert sum("error" in part for part in err.splitlines()) == 1
    return line


def test_a_condition_has_the_documented_defaults(simulated):
    made = call(simulated, "--speed", "5")
    assert made.shaft == ConstantSpeed(5.0)
    assert made.rig.material == "fluorocarbon"
    assert made.interference == pytest.approx(0.279e-3, rel=1e-12)
    assert (made.support_stiffness, made.temperature, made.seconds) == (2214.0, 23.0, 1.0)
    assert (made.acquisition.rate, made.acquisition.sensors) == (30e3, Sensors())


def test_a_condition_is_passed_on_in_si_units(simulated):
    made = call(
        simulated,
        *("--speed=2.5", "--interference", "0.381", "--support-stiffness", "fixed"),
        *("--material", "pdms", "--temperature", "-10", "--seconds", "0.5", "--rate", "48000"),
        "--converter",
    )
    assert made.rig.material == "PDMS"
    assert made.interference == pytest.approx(0.381e-3, rel=1e-12)
    assert (made.support_stiffness, made.temperature, made.seconds) == (FIXED, -10.0, 0.5)
    assert (made.acquisition.rate, made.acquisition.sensors) == (48e3, THESIS_CONVERTER)


@pytest.mark.parametrize(
    ("given", "shaft"),
    [
        (["--speed", "-5"], ConstantSpeed(-5.0)),
        (["--speed", "-.5e1"], ConstantSpeed(-5.0)),
        (["--speed=-5"], ConstantSpeed(-5.0)),
        (["--speed", "0..10"], SpeedRamp(0.0, 10.0, 2.0)),
        (["--speed", "-2.5..-1e1"], SpeedRamp(-2.5, -10.0, 2.0)),
        (["--oscillate", "15,2"], Oscillation(math.radians(15.0), 2.0)),
    ],
)
def test_the_shaft_turns_either_way_on_a_ramp_or_to_and_fro(simulated, given, shaft):
    assert call(simulated, *given, "--seconds", "2").shaft == shaft


@pytest.mark.parametrize(
    "text",
    [
        "0,1\n1,3\n",
        "time_s,speed_rad_s\n0,1\n1,3\n",
        "\ufeffspeed_rad_s, temperature_C, time_s\n1,20,0\n\n3,21,1\n",
        "time_s,speed_rad_s\r\n0,1\r\n1,3\r\n",
    ],
)
def test_a_log_gives_the_speed_with_or_without_header(simulated, tmp_path, text):
    log = tmp_path / "log.csv"
    log.write_text(text, encoding="utf-8")
    shaft = call(simulated, "--speed", str(log)).shaft
    assert isinstance(shaft, LoggedSpeed)
    assert shaft.speed(np.array([0.0, 0.5, 1.0])).tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("log", "said"),
    [("0,1\n9,1\n", "its first 1 s"), ("0.5,1\n0.7,1\n", "covers 0.5 to 0.7 s, the run 0 to 1 s")],
)
def test_a_log_that_does_not_fit_the_run_is_noted(simulated, tmp_path, capsys, log, said):
    (tmp_path / "log.csv").write_text(log)
    call(simulated, "--speed", str(tmp_path / "log.csv"))
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("log", "said"),
    [
        (b"0,1\n1,x\n", "line 2 is '1,x'"),
        (b"0;1\n1;2\n", "has the columns 0;1"),
        (b"time_s,speed_rpm\n0,1\n1,2\n", "expected time_s and speed_rad_s"),
        (b"0,1\n0,2\n", "time does not rise"),
        (b"0,1\n1,nan\n", "no finite number"),
        (b"", "two or more samples"),
        (b"\xff\xfe\x00", "is damaged"),
    ],
)
def test_a_bad_log_is_refused(capsys, tmp_path, log, said):
    path = tmp_path / "log.csv"
    path.write_bytes(log)
    assert f"--speed {path}: " in (line := refusal(capsys, "simulate", "--speed", str(path)))
    assert said in line


def test_an_effect_replaces_the_rigs_of_the_same_name(simulated):
    made = call(simulated, "--speed", "1", "--effect", "slip_pulse:amplitude=7")
    pulses = [str(spec) for spec in made.rig.effects if spec.name == "slip_pulse"]
    assert pulses == ["slip_pulse:amplitude=7"]


def test_an_effect_is_added_to_those_of_the_rig(simulated):
    made = call(simulated, "--speed", "1", "--material", "PDMS", "--effect", "slip_pulse")
    assert [spec.name for spec in made.rig.effects] == ["slip_pulse"]


def test_a_rig_file_names_its_material_itself(simulated, tmp_path, capsys):
    rig = tmp_path / "rig.toml"
    rig.write_text('material = "PDMS"\nname = "other"\n')
    made = call(simulated, "--speed", "1", "--rig", str(rig), "--material", "pdms")
    assert (made.rig.name, made.rig.material) == ("other", "PDMS")
    capsys.readouterr()
    line = refusal(
        capsys, "simulate", "--speed", "1", "--rig", str(rig), "--material", "fluorocarbon"
    )
    assert "--material fluorocarbon contradicts --rig" in line


@pytest.mark.parametrize(
    ("interference", "nearest"),
    [("0.1", "0.178"), ("0.178", None), ("0.381", None), ("1", "0.381")],
)
def test_an_interference_outside_the_fits_is_noted(simulated, capsys, interference, nearest):
    call(simulated, "--speed", "1", "--interference", interference)
    err = capsys.readouterr().err
    assert ("bushing-noise: note: " in err) == (nearest is not None)
    assert nearest is None or f"those of {nearest} mm are used" in err


@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "five", "", "1..x", "1..nan"])
@pytest.mark.parametrize(
    "option",
    ["--speed", "--interference", "--support-stiffness", "--temperature", "--seconds", "--rate"],
)
def test_what_is_no_number_is_refused_by_the_option(capsys, option, value):
    speed = [] if option == "--speed" else ["--speed", "1"]
    assert option in refusal(capsys, "simulate", *speed, option, value)


@pytest.mark.parametrize(
    "given",
    [
        ["--interference", "0"],
        ["--interference", "-0.1"],
        ["--support-stiffness", "-2214"],
        ["--temperature", "-300"],
        ["--seconds", "1e9"],
        ["--seconds", "1e-9"],
        ["--rate", "44100.5"],
        ["--rate", "1"],
        ["--oscillate", "15"],
        ["--oscillate", "15,0"],
        ["--oscillate", "nan,2"],
        ["--material", "teflon"],
        ["--effect", "wobble"],
        ["--effect", "slip_pulse:amplitude"],
        ["--effect", "slip_pulse:amplitude=nan"],
        ["--effect", "slip_pulse:loudness=2"],
        ["--rig", "no-such-rig.toml"],
        ["--seed", "-1"],
        ["--seed", "1.5"],
        ["--sped", "5"],
        ["--seconds"],
    ],
)
def test_values_that_cannot_be_used_are_refused_by_the_option(capsys, given):
    speed = [] if given[0] == "--oscillate" else ["--speed", "1"]
    assert given[0] in refusal(capsys, "simulate", *speed, *given)


@pytest.mark.parametrize("given", [[], ["--speed", "1", "--oscillate", "15,2"]])
def test_exactly_one_way_of_turning_is_needed(capsys, given):
    line = refusal(capsys, "simulate", *given)
    assert "--speed" in line
    assert "--oscillate" in line


def test_simulate_without_out_prints_one_line_of_json(capsys):
    assert main(["simulate", "--speed", "5", "--seconds", "0.1", "--material", "PDMS"]) == 0
    out, err = capsys.readouterr()
    summary = json.loads(out)
    assert out.count("\n") == 1
    assert "simulating 0.1 s" in err
    assert summary["conditions"]["speed_rad_s"] == 5.0
    assert summary["torque_mean_Nm"] > 1.0 > summary["torque_rms_about_mean_Nm"] > 0.0
    assert 20.0 < summary["level_db"] < 20.0 * math.log10(summary["peak_pressure_Pa"] / 20e-6)


@pytest.mark.parametrize("name", ["run07", "run07.wav"])
def test_simulate_writes_a_recording_and_prints_its_names(capsys, tmp_path, name):
    out = tmp_path / "new" / name
    assert main(["simulate", "--speed", "-5", "--seconds", "0.1", "--out", str(out)]) == 0
    written = capsys.readouterr().out.splitlines()
    assert written == [str(out.parent / "run07.wav"), str(out.parent / "run07.json")]
    run = read_recording(written[0])
    assert (run.condition.speed, run.duration, run.calibrated) == (-5.0, 0.1, True)
    assert run["torque"].mean() < 0


def test_simulate_tells_the_sound_power(capsys, tmp_path):
    table = tmp_path / "new" / "power.csv"
    run = ["simulate", "--speed", "10", "--support-stiffness", "3745", "--seconds", "0.3"]
    assert main([*run, "--sound-power", str(table)]) == 0
    out, err = capsys.readouterr()
    assert out == f"{table}\n"
    assert "dB(A) re 1 pW in a baffle" in err
    header, *rows = table.read_text(encoding="utf-8").splitlines()
    assert header.split(",")[:3] == ["band_hz", "power_level_db", "power_level_dba"]
    levels = {band: float(level) for band, level, *_ in (row.split(",") for row in rows) if level}
    assert max(levels, key=levels.get) == "total"
    assert levels["1000"] == pytest.approx(levels["total"], abs=1.0)  # a squeal


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("power.ods",), "tables end in .csv, .xlsx, .jsonl or .parquet"),
        (("power.csv", "--seconds", "0.1"), "--sound-power: --seconds 0.1 is too short"),
        (("power.csv", "--seconds", "61"), "--sound-power takes the whole run in memory"),
    ],
)
def test_a_sound_power_that_cannot_be_told_is_refused_before_the_work(
    simulated, capsys, tmp_path, given, said
):
    where = str(tmp_path / given[0])
    line = refusal(capsys, "simulate", "--speed", "1", "--sound-power", where, *given[1:])
    assert said in line
    assert simulated == []


def test_the_seed_decides_the_run(tmp_path):
    def bytes_of(name, seed):
        out = tmp_path / name
        given = ["--speed", "5", "--seconds", "0.05", "--seed", seed, "--out", str(out)]
        assert main(["simulate", *given]) == 0
        return out.with_suffix(".wav").read_bytes()

    assert bytes_of("one", "3") == bytes_of("two", "3") != bytes_of("three", "4")


@pytest.mark.parametrize("inside", ["run07", "folder/run07"])
def test_a_target_below_a_file_is_refused_before_the_work(simulated, capsys, tmp_path, inside):
    (tmp_path / "file.txt").touch()
    line = refusal(capsys, "simulate", "--speed", "1", "--out", f"{tmp_path}/file.txt/{inside}")
    assert "--out" in line
    assert simulated == []


def test_a_long_run_is_written_in_blocks(tmp_path, monkeypatch):
    from noise.commands import condition

    monkeypatch.setattr(condition, "_LONG", 0.1)
    monkeypatch.setattr("sim.run.simulate", None)  # held in memory it would be
    run = ["simulate", "--speed", "5", "--seconds", "0.3", "--out", str(tmp_path / "run")]
    assert main(run) == 0
    assert read_recording(tmp_path / "run.wav").duration == 0.3


def test_a_rig_file_states_what_its_run_is_recorded_through(tmp_path, capsys):
    rig = tmp_path / "rig.toml"
    rig.write_text(
        """[sensors]
noise = "from recordings"
range = { torque = 9.0, pressure = 30.0 }
bits = { torque = 8 }
antialias_hz = 16000
"""
    )
    options = ["simulate", "--rig", rig, "--speed", "2.5", "--seconds", "0.3"]
    assert main([str(word) for word in (*options, "--out", tmp_path / "run")]) == 0
    said = capsys.readouterr().err
    back = read_recording(tmp_path / "run.wav")
    steps = back["torque"] / (2.0 * 9.0 / 2**8)
    assert np.array_equal(steps, np.round(steps))
    assert back["torque"].max() == 9.0 * (1.0 - 2.0**-7)
    notes = json.loads((tmp_path / "run.json").read_text())["notes"]
    assert any('noise = "from recordings"' in note for note in notes)
    assert any("antialias_hz = 16000 lies above half the sampling rate" in note for note in notes)
    assert any("torque reaches the range of its sensor, 9 N m" in note for note in notes)
    assert all(note in said for note in notes)


def test_a_rig_of_another_fit_is_simulated_at_its_own(simulated, tmp_path):
    rig = tmp_path / "rig.toml"
    rig.write_text(
        "[[fit]]\ninterference_mm = 0.5\nelastomer_stiffness_Nm_rad = 900\n"
        'critical_torque_Nm = 20\nkinetic_torque_Nm = 16\ndamping_Nms_rad = { "2214" = 0.1 }\n',
        encoding="utf-8",
    )
    made = call(simulated, "--speed", "1", "--rig", str(rig))
    assert made.interference == pytest.approx(0.5e-3, rel=1e-12)
