"""Effects of the user's own, from a file."""

import numpy as np
import pytest

from noise.cli import main
from noise.recordings import read_recording

OFFSET = """
from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter


def sensors(signals, rate, form, values, rng):
    return signals | {"torque": signals["torque"] + values["offset"]}


OFFSET = {"offset": Parameter(0.5, "Nm", -50.0, 50.0, "of the torque cell")}
EFFECT = Effect(
    "zero_offset", Stage.MEASUREMENT, ("constant",), OFFSET, strength="offset", sensors=sensors
)
"""

ECCENTRIC = """
import math

from numba import njit

from sim.contact import CRITICAL, HOOK_SIGNATURE, KINETIC, SHAFT_ANGLE
from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter


@njit(HOOK_SIGNATURE)
def hook(context, values, state, state_rates, contact):
    factor = 1.0 + values[0] * math.cos(context[SHAFT_ANGLE])
    contact[CRITICAL] *= factor
    contact[KINETIC] *= factor


SHARE = {"share": Parameter(0.1, "", 0.0, 0.9, "of the torques, up and down in a turn")}
EFFECT = Effect("eccentric_shaft", Stage.FRICTION, ("cosine",), SHARE, "share", contact=hook)
"""

CONDITION = ("--material", "fluorocarbon-thesis", "--seconds", "0.1", "--speed", "12")


@pytest.fixture
def effects_file(tmp_path):
    def write(text):
        path = tmp_path / "own.py"
        path.write_text(text, encoding="utf-8")
        return str(path)

    return write


@pytest.fixture
def torque(tmp_path):
    def simulated(*arguments):
        assert main(["simulate", *CONDITION, *arguments, "--out", str(tmp_path / "run")]) == 0
        return read_recording(tmp_path / "run.wav")["torque"]

    return simulated


def refusal(capsys, *arguments):
    """The one line that says what is wrong."""
    assert main(["simulate", *CONDITION, *arguments]) == 2
    out, err = capsys.readouterr()
    lines = [line for line in err.splitlines() if line.startswith("bushing-noise: error: ")]
    assert (out, len(lines), "Traceback" in err) == ("", 1, False)
    assert err.splitlines()[-1] == lines[0]
    assert len(lines[0]) < 600
    return lines[0]


def test_an_effect_on_a_sensor_acts_as_its_file_says(effects_file, torque):
    path = effects_file(OFFSET)
    shifted = torque("--effects", path, "--effect", "zero_offset:offset=2.5")
    assert shifted == pytest.approx(torque() + 2.5, abs=1e-5)


def test_an_effect_on_the_contact_acts_as_its_file_says(effects_file, torque):
    path = effects_file(ECCENTRIC)
    plain, eccentric = torque(), torque("--effects", path, "--effect", "eccentric_shaft:share=0.3")
    # Half a second of settling, then 12 rad/s: the contact slides all the time.
    angle = 12.0 * (0.5 + np.arange(plain.size) / 30e3)
    assert eccentric == pytest.approx(plain * (1.0 + 0.3 * np.cos(angle)), rel=0.15)
    assert not np.allclose(eccentric, plain, rtol=0.05)


def test_a_rig_file_may_name_the_users_effect(effects_file, tmp_path, capsys):
    rig = tmp_path / "rig.toml"
    rig.write_text('name = "own"\nmaterial = "PDMS"\neffects = ["zero_offset:offset=4"]\n')
    given = ("simulate", "--speed", "5", "--seconds", "0.1", "--rig", str(rig))
    assert main([*given, "--effects", effects_file(OFFSET)]) == 0
    assert main(list(given)) == 2
    assert "effect 'zero_offset' is unknown" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("EFFECT =", "SyntaxError"),
        ("import no_such_module", "No module named 'no_such_module'"),
        ("raise SystemExit", "cannot be run: SystemExit"),
        ("x = 1", "defines no Effect"),
        (OFFSET.replace("zero_offset", "slip_pulse"), "'slip_pulse' is a shipped effect"),
        (OFFSET.replace('strength="offset"', 'strength="size"'), "'size' is none of its param"),
        (OFFSET.replace('("constant",)', "()"), "not a valid Effect: IndexError"),
        (OFFSET.replace(", sensors=sensors", ""), "needs one of drive, contact, force and sens"),
        (ECCENTRIC.replace("@njit(HOOK_SIGNATURE)", ""), "contact is not compiled"),
        (ECCENTRIC.replace("math.cos", "mathematics.cos"), "'mathematics' is not defined"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_before_the_work(effects_file, capsys, text, said):
    path = effects_file(text)
    line = refusal(capsys, "--effects", path)
    assert f"--effects {path}: " in line
    assert said in line


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ('signals["torqe"]', "sensors: KeyError: 'torqe' (own.py, line 7)"),
        ("None", "sensors: must return a dict of the signals"),
        ('{"torque": signals["torque"]}', "torque, acceleration, pressure, angle"),
        ('signals | {"torque": signals["torque"][1:]}', "as torque"),
        ('signals | {"torque": signals["torque"] * float("nan")}', "must return finite numbers"),
    ],
)
def test_an_effect_that_fails_is_told_with_file_and_line(effects_file, capsys, body, said):
    text = OFFSET.replace('signals | {"torque": signals["torque"] + values["offset"]}', body)
    path = effects_file(text)
    line = refusal(capsys, "--effects", path, "--effect", "zero_offset")
    assert f"--effects {path}: effect 'zero_offset': sensors" in line
    assert said in line
