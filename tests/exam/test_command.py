"""Cases are made and scored by command; the sealed set is opened in one way, which is logged."""

import ast
import json
import sys
import types
from pathlib import Path

import numpy as np
import pytest

from tests.blind import generate as generating
from tests.blind.__main__ import main
from tests.blind.cases import run_case
from tests.blind.design import draw_design
from tests.blind.effects import DEVELOPMENT
from tests.blind.gap import gaps_of
from tests.blind.generate import Wanted, commit, generate_sealed
from tests.blind.score.improving import table
from tests.blind.score.run import Asked, score_sealed

BLIND = Path(__file__).parents[1] / "blind"


def _lines(log):
    return [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]


def nothing(_folder, _rig):
    """Find nothing."""
    return {"verdict": []}


def test_development_cases_are_written_answers_apart_and_scored(tmp_path, capsys, monkeypatch):
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
    main(["generate", "--out", str(where), "--seed", "167", "--cases", "2", "--workers", "1",
          "--bench", "quiet", "--block", "shares"])  # fmt: skip
    assert {p.name for p in where.iterdir()} == {"data", "answers"}
    answer = json.loads((where / "answers" / "case-0001.json").read_text())
    assert answer["set"] == DEVELOPMENT
    main(["score", str(where), "--diagnose", "a_diagnosis:diagnose", "--workers", "1",
          "--out", str(tmp_path / "scores")])  # fmt: skip
    assert seen[0][0] == "case"
    assert seen[0][2]
    assert ".toml" in seen[0][1]
    out = capsys.readouterr()
    assert "ValueError: no sense in it" in out.err
    figures = json.loads((tmp_path / "scores" / "score.json").read_text())["figures"]
    assert figures["failed"][:2] == [2, 0.5]
    assert {p.name for p in (tmp_path / "scores").iterdir()} == {"score.json", "score.txt"}
    answer = json.loads((where / "answers" / "case-0001.json").read_text())
    assert answer["gap"] >= 1.0
    with pytest.raises(SystemExit, match="there already"):
        main(["generate", "--out", str(where), "--cases", "1", "--workers", "1"])


def test_a_diagnosis_that_is_not_there_is_said_in_one_line(tmp_path):
    with pytest.raises(SystemExit, match=r"^--diagnose nowhere\.at_all:x: there is no such"):
        main(["score", str(tmp_path), "--diagnose", "nowhere.at_all:x", "--out", str(tmp_path)])
    with pytest.raises(SystemExit, match="either a folder"):
        main(["score", "--out", str(tmp_path)])
    with pytest.raises(SystemExit, match="either a folder"):
        main(["score", str(tmp_path), "--sealed", "--out", str(tmp_path)])


@pytest.mark.slow
def test_each_opening_of_the_sealed_set_is_logged_with_commit_and_figures(tmp_path):
    log = tmp_path / "log.jsonl"
    asked = Asked("tests.exam.test_command:nothing")
    for seed in (1, 2):
        score_sealed(Wanted(seed, 1), asked, tmp_path / "scores", log)
    lines = _lines(log)
    assert len(lines) == 4
    for opening, figures, seed in zip(lines[::2], lines[1::2], (1, 2), strict=True):
        assert figures["figures_of"] == opening["opened"]
        assert opening["commit"] == commit()[0]
        assert {"dirty", "cases", "about"} <= set(opening)
        assert opening["seed"] == seed
        assert "failed" in figures["figures"]


def test_an_opening_that_breaks_off_is_logged_all_the_same(tmp_path, monkeypatch):
    def broken(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(generating, "_make", broken)
    with pytest.raises(KeyboardInterrupt):
        generate_sealed(tmp_path / "d", tmp_path / "a", Wanted(1, 5), 1,
                        log=tmp_path / "log", about="x")  # fmt: skip
    assert [line["cases"] for line in _lines(tmp_path / "log")] == [5]


def test_sealed_cases_cannot_be_generated_by_command(tmp_path):
    with pytest.raises(SystemExit):
        main(["generate", "--out", str(tmp_path), "--cases", "1", "--sealed"])
    assert not list(tmp_path.iterdir())


def test_no_code_but_the_logged_one_asks_for_the_sealed_set():
    asking = set()
    for path in BLIND.rglob("*.py"):
        if path.parent.name == "effects":
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for top in tree.body:
            if any(isinstance(n, ast.Name) and n.id == "SEALED" for n in ast.walk(top)):
                asking.add((path.name, getattr(top, "name", None)))
    assert asking == {("generate.py", "generate_sealed")}
    calls = {
        path.name
        for path in BLIND.rglob("*.py")
        for n in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(n, ast.Call) and getattr(n.func, "id", "") == "generate_sealed"
    }
    assert calls == {"run.py"}


@pytest.mark.parametrize("kind", ["none", "parameters", "pair"])
def test_the_gap_is_one_where_nothing_is_the_matter_and_above_elsewhere(kind):
    design = next(d for d in (draw_design(2, i, DEVELOPMENT) for i in range(60)) if d.kind == kind)
    found = gaps_of(run_case(design))
    assert (found["gap"] == 1.0) == (kind == "none")
    assert found["gap"] >= 1.0
    assert set(found["gap_alone"]) == {form.effect for form, _ in design.forms}


def test_fresh_repeats_are_of_the_same_truth_and_other_chance():
    design = draw_design(3, 0, DEVELOPMENT)
    case, fresh = run_case(design), run_case(design, again=1)
    assert case.answer == fresh.answer
    for one, other in zip(case.recordings, fresh.recordings, strict=True):
        assert one.shape == other.shape
        assert not np.array_equal(one, other)
        assert 0.5 < np.abs(one[0]).mean() / np.abs(other[0]).mean() < 2.0


def test_only_fresh_repeats_without_a_gap_count_as_closed():
    rows = [
        {"effect": "clipping", "verdict": ["clipping"], "written": written,
         "fresh": {"verdict": ["clipping"] if left else []}}
        for written, left in (("improved.toml", 0), ("improved.toml", 1), (None, 1), (None, 0))
    ]  # fmt: skip
    said = table(rows)
    assert "all cases (aim 0.60): 0.50 (2 of 4" in said
    assert "file written (aim 0.85): 0.50 (1 of 2" in said
    assert "file written: 0.50 (2 of 4" in said
