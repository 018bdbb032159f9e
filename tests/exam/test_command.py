"""Cases are made and scored by command."""

import json
import sys
import types

import pytest

from tests.blind.__main__ import main
from tests.blind.cases import run_case
from tests.blind.design import draw_design
from tests.blind.effects import DEVELOPMENT
from tests.blind.gap import gaps_of


def test_cases_are_written_answers_apart_and_scored(tmp_path, capsys, monkeypatch):
    module = types.ModuleType("a_diagnosis")
    seen = []

    def diagnose(folder, rig_path):
        seen.append((folder.name, sorted(p.suffix for p in folder.iterdir()), rig_path.is_file()))
        assert not [p for p in folder.parent.iterdir() if p.name != "case"]
        if len(seen) == 2:
            raise ValueError("no sense in it")
        return {"verdict": [], "effects": [], "location": {"stage": None}}

    module.diagnose = diagnose
    monkeypatch.setitem(sys.modules, "a_diagnosis", module)
    where = tmp_path / "cases"
    make = ["generate", "--out", str(where), "--seed", "167", "--cases", "2", "--workers", "1",
            "--bench", "quiet", "--block", "shares"]  # fmt: skip
    main(make)
    assert {p.name for p in where.iterdir()} == {"data", "answers"}
    answer = json.loads((where / "answers" / "quiet-0001.json").read_text())
    assert answer["set"] == DEVELOPMENT
    assert answer["gap"] >= 1.0
    main(["score", str(where), "--diagnose", "a_diagnosis:diagnose", "--workers", "1",
          "--out", str(tmp_path / "scores")])  # fmt: skip
    assert seen[0][0] == "case"
    assert seen[0][2]
    assert ".toml" in seen[0][1]
    assert "ValueError: no sense in it" in capsys.readouterr().err
    failed = json.loads((tmp_path / "scores" / "score.json").read_text())["failed"]
    assert (failed["cases"], failed["value"]) == (2, 0.5)
    with pytest.raises(SystemExit, match="there already"):
        main(make)


def test_a_diagnosis_that_is_not_there_is_said_in_one_line(tmp_path):
    with pytest.raises(SystemExit, match=r"^--diagnose nowhere\.at_all:x: there is no such"):
        main(["score", str(tmp_path), "--diagnose", "nowhere.at_all:x", "--out", str(tmp_path)])
    with pytest.raises(SystemExit, match="holds no answers"):
        main(["score", str(tmp_path), "--out", str(tmp_path)])


@pytest.mark.parametrize("kind", ["none", "parameters", "pair"])
def test_the_gap_is_one_where_nothing_is_the_matter_and_above_elsewhere(kind):
    design = next(d for d in (draw_design(2, i, DEVELOPMENT) for i in range(60)) if d.kind == kind)
    gaps = gaps_of(run_case(design))
    assert (gaps["gap"] == 1.0) == (kind == "none")
    assert gaps["gap"] >= 1.0
    assert set(gaps["gap_alone"]) == {form.effect for form, _ in design.forms}
