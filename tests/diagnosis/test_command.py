"""What ``bushing-noise diagnose`` answers: files, keys, verdicts; own effects."""

from __future__ import annotations

import contextlib
import io
import json
import math
from dataclasses import replace

import pytest

from models.condition import FIXED
from noise.base.user_effects import effect_library
from noise.cli import main
from noise.diagnosis.causes.posterior import load_posterior
from noise.diagnosis.diagnose import diagnose
from noise.diagnosis.outcome import as_json
from sim.effects import EFFECTS
from tests.helpers.answered_diagnoses import as_the_contract_has_it
from tests.helpers.made_diagnoses import one_effect
from tests.helpers.small_rigs import at, only, run, write_case

RECTIFIER = """
import numpy as np

from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter


def sensors(signals, rate, form, values, rng):
    def half(x):
        away = x - x.mean()
        return x.mean() + (1.0 - values["share"]) * away + values["share"] * np.abs(away)

    names = ("torque", "acceleration", "pressure")
    return signals | {name: half(signals[name]) for name in names}


SHARE = {"share": Parameter(0.2, "", 0.0, 1.0, "of all signals that is rectified")}
EFFECT = Effect("rectifier", Stage.MEASUREMENT, ("plain",), SHARE, "share", sensors=sensors)
"""

CONDITIONS = [at(v, FIXED) for v in (1.0, 1.6, 1.6, 2.5)]
WEAK = ("velocity_weakening", {"share": 0.4, "speed": 5.0})


def _recordings(*effects, conditions=CONDITIONS, library=EFFECTS):
    return [run(c, *effects, seed=60 + i, library=library) for i, c in enumerate(conditions)]


def _told(capsys, *arguments, code=0):
    assert main(["diagnose", *map(str, arguments)]) == code
    out, err = capsys.readouterr()
    assert "Traceback" not in err
    return json.loads(out)


@pytest.fixture(scope="module")
def plain():
    return _recordings()


@pytest.fixture(scope="module")
def answered(plain, tmp_path_factory):
    """The quick answer of recordings that the rig file explains."""
    data, rig = write_case(tmp_path_factory.mktemp("plain"), plain)
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        assert main(["diagnose", str(data), "--rig", str(rig), "--quick"]) == 0
    return json.loads(printed.getvalue())


def test_the_quick_answer_has_the_contracts_keys(answered):
    told = answered
    as_the_contract_has_it(told)
    assert told["held_out"] == []
    assert all(place["p_value"] <= 0.05 for place in told["map"])
    assert all(effect["closed"] is None for effect in told["effects"])


CLIPPED = {"amount": 0.7, "pressure": 1.0, "torque": 0.0, "acceleration": 0.0}


@pytest.mark.parametrize("effect", [("clipping", CLIPPED), ("mains_hum", {})])
def test_a_fault_of_the_sensors_is_named(tmp_path, effect):
    assert diagnose(*write_case(tmp_path, _recordings(effect)), quick=True).verdict == effect[:1]


@pytest.mark.slow
def test_the_same_call_gives_the_same_answer(plain, tmp_path, capsys):
    data, rig = write_case(tmp_path, plain)
    one, other = (_told(capsys, data, "--rig", rig, "--quick", "--seed", "3") for _ in range(2))
    assert one | {"seconds": 0} == other | {"seconds": 0}


@pytest.mark.parametrize(
    ("kinds", "how"),
    [
        (("torque", "acceleration", "pressure"), ["--quick"]),
        pytest.param(("torque", "acceleration", "pressure"), [], marks=pytest.mark.slow),
        pytest.param(("pressure",), [], marks=pytest.mark.slow),
        pytest.param(("torque",), [], marks=pytest.mark.slow),
    ],
)
def test_fewer_signals_are_answered_to_the_end(tmp_path, capsys, kinds, how):
    ill = _recordings(WEAK, conditions=CONDITIONS[1:])
    data, rig = write_case(tmp_path, [only(r, *kinds) for r in ill])
    told = _told(capsys, data, "--rig", rig, *how)
    as_the_contract_has_it(told)
    assert any(note.startswith("no ") for note in told["notes"])
    assert told["next_measurement"].startswith("record ") or not told["verdict"]


def test_a_shaft_that_turns_backwards_is_answered_alike(plain, answered, tmp_path, capsys):
    backwards = [
        replace(r, samples=-r.samples, condition=replace(r.condition, speed=-r.condition.speed))
        for r in plain
    ]
    data, rig = write_case(tmp_path, backwards)
    answers = answered, _told(capsys, data, "--rig", rig, "--quick")
    assert answers[0]["verdict"] == answers[1]["verdict"]
    friction = [a["stages"]["friction"]["gap"] for a in answers]
    assert friction[1] == pytest.approx(friction[0], rel=0.2)


@pytest.fixture
def alarmed(monkeypatch):
    """A posterior that finds something to explain everywhere, so that all is fitted."""
    shipped = load_posterior()
    monkeypatch.setattr(
        "noise.diagnosis.diagnose.load_posterior", lambda: replace(shipped, alarm=2.0)
    )


@pytest.mark.slow
def test_an_effect_of_the_users_own_takes_the_verdict_when_it_is_the_cause(
    alarmed, tmp_path, capsys
):
    mine = tmp_path / "rectifier.py"
    mine.write_text(RECTIFIER)
    library = effect_library(mine)
    recordings = _recordings(("rectifier", {"share": 0.8}), library=library)
    data, rig = write_case(tmp_path, recordings)
    told = _told(capsys, data, "--rig", rig, "--effects", mine)
    as_the_contract_has_it(told)
    assert told["verdict"] == ["rectifier"]
    first = told["effects"][0]
    assert (first["name"], first["stage"]) == ("rectifier", "measurement")
    assert first["parameters"]["share"] == pytest.approx(0.8, abs=0.2)
    assert first["closed"] > 0.5
    assert told["location"]["stage"] == "measurement"


def test_numbers_that_are_none_become_null():
    strange = replace(one_effect(), gap=math.nan, p_value=math.inf)
    told = json.loads(json.dumps(as_json(strange), allow_nan=False))
    assert told["gap"] is None
    assert told["p_value"] is None
