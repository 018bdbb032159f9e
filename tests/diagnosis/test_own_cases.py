"""Cases that `sim` makes are laid out and answered as blind ones, with forms of its library."""

import json

import numpy as np
import pytest

from sim.effects import EFFECTS
from tests.blind.effects import CAUSES
from tests.helpers.own_cases import STRONG, main, own_case, own_design


def _first(kind):
    designs = (own_design(6, index) for index in range(60))
    return next(d for d in designs if d is not None and d.kind == kind)


def test_every_cause_has_forms_of_its_own_and_a_strong_value_that_is_allowed():
    assert set(STRONG) == set(EFFECTS) == set(CAUSES)
    for name, strong in STRONG.items():
        for form in EFFECTS[name].forms:
            assert not EFFECTS[name].active({"form": form, EFFECTS[name].strength: strong}).is_off


def test_own_forms_are_those_of_the_library_and_strangers_are_passed_over():
    designs = [own_design(6, index) for index in range(40)]
    assert sum(d is None for d in designs) == 4
    for design in (d for d in designs if d is not None):
        for form, strength in design.forms:
            assert form.name in EFFECTS[form.effect].forms
            assert 0.0 < strength <= 1.0


@pytest.mark.parametrize("kind", ["none", "one"])
def test_the_same_seed_gives_the_same_case_and_only_a_cause_makes_a_gap(kind):
    design = _first(kind)
    one, other = own_case(design), own_case(design)
    assert one.answer == other.answer
    for a, b in zip(one.recordings, other.recordings, strict=True):
        assert a.tobytes() == b.tobytes()
        assert np.isfinite(a).all()
    assert (one.answer["gap"] == 1.0) == (kind == "none")


@pytest.mark.slow
def test_own_cases_are_scored_beside_others(tmp_path, capsys):
    from tests.blind.__main__ import main as blind

    quiet = ["--bench", "quiet", "--block", "shares"]
    for command in (main, lambda call: blind(["generate", *call, *quiet])):
        where = tmp_path / ("own" if command is main else "blind")
        command(["--out", str(where), "--seed", "4", "--cases", "1", "--workers", "1"])
    own = {p.name for p in (tmp_path / "own" / "data" / "case-0001").iterdir()}
    assert own == {p.name for p in (tmp_path / "blind" / "data" / "case-0001").iterdir()}
    blind(["score", str(tmp_path / "blind"), "--own", str(tmp_path / "own"), "--baseline", "oracle",
           "--workers", "1", "--out", str(tmp_path / "scores")])  # fmt: skip
    figures = json.loads((tmp_path / "scores" / "score.json").read_text())
    assert figures["own forms: failed"]["value"] == 0.0
    assert "Own forms" in capsys.readouterr().out
