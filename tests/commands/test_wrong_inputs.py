"""Inputs that are easily got wrong: one line names the cause, on screen and in the sidecar."""

import json

import pytest

from noise.cli import main

BUSHING = """
[[fit]]
interference_mm = {interference}
elastomer_stiffness_Nm_rad = 665.0
critical_torque_Nm = {critical}
kinetic_torque_Nm = {kinetic}
damping_Nms_rad = 0.09
"""


def bushing(folder, name, head="", interference=0.279, critical=13.26, kinetic=8.0):
    path = folder / f"{name}.toml"
    given = {"interference": interference, "critical": critical, "kinetic": kinetic}
    path.write_text(head + BUSHING.format(**given), encoding="utf-8")
    return path


def notes(folder, capsys, *given):
    """What a run is told of on standard error, which is what its sidecar keeps."""
    run = folder / "run"
    assert main(["simulate", *map(str, given), "--out", str(run)]) == 0
    told = [
        line.removeprefix("bushing-noise: note: ")
        for line in capsys.readouterr().err.splitlines()
        if line.startswith("bushing-noise: note: ")
    ]
    assert told == json.loads(run.with_suffix(".json").read_text(encoding="utf-8")).get("notes", [])
    return told


def refusal(capsys, *given):
    assert main([*map(str, given)]) == 2
    (line,) = [text for text in capsys.readouterr().err.splitlines() if "error: " in text]
    return line


@pytest.mark.parametrize(
    ("given", "cause"),
    [
        (("--effect", "partial_slip"), "effect partial_slip cannot act on friction law contact"),
        (("--temperature", "5"), "at 23, shifted by WLF; that is assumed, not measured"),
        (("--temperature", "-40"), "held at -20, its glass transition, below which it is no"),
        (("--temperature", "95"), "WLF holds up to 80, 100 K above its glass transition"),
        (("--temperature", "80", "--material", "fluorocarbon-thesis"),
         "temperature 80 degree Celsius is recorded and changes nothing"),
        (("--support-stiffness", "3000"), "for 3000 Nm/rad it is interpolated between these"),
        (("--support-stiffness", "3e5"), "support_stiffness_Nm_rad = 300000 is outside the usual"),
        (("--interference", "0.000279"), "interference_mm = 0.000279 is outside the usual 0.02 to "
                                         "3 mm (is it in metres?)"),
        (("--change", "critical_torque=x1000"), "outside the usual 0.3 to 500 Nm (is it in Nmm?)"),
        (("--change", "critical_torque=x9999"), "nothing ever slips in this run"),
        (("--change", "elastomer_stiffness=x9999"), "elastomer_stiffness_Nm_rad = "),
    ],
)  # fmt: skip
def test_one_line_names_the_cause(tmp_path, capsys, given, cause):
    told = notes(tmp_path, capsys, "--speed", "5", "--seconds", "0.1", *given)
    assert sum(cause in line for line in told) == 1, told
    assert len(set(told)) == len(told)


def test_a_speed_beyond_what_was_fitted_gets_one_line(tmp_path, capsys):
    (told,) = notes(tmp_path, capsys, "--speed", "30", "--seconds", "0.1")
    assert told.startswith("speed 30 rad/s is beyond 13, the fastest that the numbers of fluoro")


def test_what_is_usual_gets_none(tmp_path, capsys):
    assert notes(tmp_path, capsys, "--speed", "5", "--seconds", "0.1") == []


@pytest.mark.parametrize("command", [["simulate", "--speed", "5", "--rig"], ["screen"]])
def test_a_shipped_name_over_other_fits_must_say_its_law(tmp_path, capsys, command):
    line = refusal(capsys, *command, bushing(tmp_path, "copy", 'material = "fluorocarbon"'))
    assert 'write base = "fluorocarbon"' in line
    assert 'law = "coulomb"' in line


def test_a_fit_in_metres_is_told_as_such_once(tmp_path, capsys):
    rig = bushing(tmp_path, "metres", interference=0.000279)
    told = notes(tmp_path, capsys, "--speed", "5", "--seconds", "0.1", "--rig", rig)
    assert sum("(is it in metres?)" in line for line in told) == 1
    at = ["--speed", "5", "--support-stiffness", "2214", "--out", str(tmp_path / "map")]
    assert main(["screen", str(rig), *at]) == 0
    assert capsys.readouterr().err.count("(is it in metres?)") == 1


@pytest.mark.parametrize("material", ["PDMS", "fluorocarbon"])
def test_torques_in_nmm_are_named_where_no_motion_can_be_computed_or_nothing_slips(
    material, tmp_path, capsys
):
    given = ["simulate", "--speed", "5", "--seconds", "0.1", "--material", material]
    given += ["--change", "critical_torque=x9999", "--change", "kinetic_torque=x9999"]
    code = main([*given, "--out", str(tmp_path / "run")])
    err = capsys.readouterr().err
    last = [line for line in err.splitlines() if "note: " in line or "error: " in line][-1]
    assert "critical_torque_Nm" in last
    assert (code == 2) == ("no motion can be computed" in last)
    assert (code == 0) == ("nothing ever slips" in last)


def test_a_design_in_nmm_is_named_and_not_ranked(tmp_path, capsys):
    rig = bushing(tmp_path, "nmm", critical=13260, kinetic=8000)
    at = ["--speed", "4,5", "--interference", "0.279", "--support-stiffness", "2214"]
    assert main(["screen", str(rig), *at, "--out", str(tmp_path / "map")]) == 0
    out, err = capsys.readouterr()
    assert err.count("critical_torque_Nm = 13260 is outside the usual") == 1
    assert "nmm, dry: no rank; never slips: the contact holds 13260 Nm" in out + err


def test_a_long_run_in_which_nothing_slips_says_so_too(tmp_path, capsys):
    held = ["--speed", "0.5", "--seconds", "60.5", "--rate", "1000"]
    told = notes(tmp_path, capsys, *held, "--change", "critical_torque=x9999")
    assert sum("nothing ever slips" in line for line in told) == 1


@pytest.mark.parametrize("command", ["simulate", "render", "screen", "diagnose", "identify"])
def test_one_file_serves_every_command_and_a_misspelt_key_is_answered_alike(
    tmp_path, capsys, command
):
    rig = tmp_path / "ours.toml"
    rig.write_text('base = "fluorocarbon"\ndesing = 1\n', encoding="utf-8")
    (tmp_path / "data").mkdir()
    calls = {
        "simulate": ["--speed", "5", "--rig", rig],
        "render": [rig, "--speed", "5", "--out", tmp_path / "a.wav"],
        "screen": [rig],
        "diagnose": [tmp_path / "data", "--rig", rig, "--out", tmp_path / "out"],
        "identify": [tmp_path / "data", "--rig", rig, "--out", tmp_path / "out"],
    }
    line = refusal(capsys, command, *calls[command])
    assert "unknown key 'desing'; did you mean 'design'?" in line
    assert "measured_response" in line


def test_of_a_set_each_thing_is_said_once_and_of_which_sound(tmp_path, capsys):
    inputs = ["--interference 0.279", "--interference 0.5", "--change critical_torque=x9999"]
    given = ["--speed", "5", "--seconds", "0.1", "--temperature", "80"]
    assert main(["render", *inputs, *given, "--out", str(tmp_path / "set")]) == 0
    told = [line for line in capsys.readouterr().err.splitlines() if "note: " in line]
    assert len(set(told)) == len(told)
    (warm,) = [line for line in told if "temperature 80" in line]
    assert "note: temperature" in warm
    (beyond,) = [line for line in told if "lies outside the fits" in line]
    assert "note: interference-0.5: " in beyond
    (held,) = [line for line in told if "nothing ever slips" in line]
    assert "note: change-critical_torque-x9999: " in held


@pytest.mark.parametrize(
    ("given", "cause"),
    [
        (("--support-stiffness", "1e300"), "belongs to no beam; possible is 0.001 to 1e+12"),
        (("--support-stiffness", "1e-300"), "belongs to no beam; possible is 0.001 to 1e+12"),
        (("--change", "wall_mm=1e-300"), "sleeve: wall_mm = 1e-300 must be a number from"),
        (("--change", "wall_mm=1e300"), "sleeve: wall_mm = 1e+300 must be a number from"),
        (("--change", "length_mm=1e-300"), "sleeve: length_mm = 1e-300 must be"),
        (("--change", "youngs_modulus_MPa=1e300"), "sleeve: youngs_modulus_MPa = 1e+300 must be"),
        (("--material", ""), "--material: "),
    ],
)
def test_what_cannot_be_is_refused_before_it_overflows(tmp_path, capsys, given, cause):
    call = ("simulate", "--speed", "5", "--seconds", "0.02", "--out", tmp_path / "run")
    assert cause in refusal(capsys, *call, *given)


@pytest.mark.parametrize(
    ("given", "cause"),
    [
        (("--band", "1e-300..1"), "expected a band that begins at 1 Hz"),
        (("--band", "100..100.0001"), "at least 1% wide"),
        (("--pascal-per-full-scale", "1e300"), "at most 1e+09"),
    ],
)
def test_a_band_and_a_gain_that_nothing_can_be_heard_with_are_refused(capsys, given, cause):
    assert cause in refusal(capsys, "render", "run07.wav", "--out", "heard.wav", *given)


@pytest.mark.parametrize(
    "given", [("label", ""), ("frf", ""), ("review", ""), ("simulate", "--out", "")]
)
def test_a_path_of_no_characters_is_not_the_current_folder(given, capsys):
    assert "is '', expected a path" in refusal(capsys, *given)
