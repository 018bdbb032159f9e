"""What is computed beside the sound: maps, suggestions, sets."""

from __future__ import annotations

import html
import json
import math
import time
from dataclasses import replace
from pathlib import Path

import pytest

from models.errors import ParameterError
from noise.app.design import DesignExport, design_of
from noise.app.design_chart import ChartRequest, SuggestionRequest, suggestions_of
from noise.app.design_controls import bases_of
from noise.app.opened import open_paths
from noise.app.worker_process import WorkerProcess
from noise.recordings import read_recording

BASES = bases_of(open_paths([]))
PATIENCE = 120.0


def waited(found):
    end = time.monotonic() + PATIENCE
    while not (known := found()):
        assert time.monotonic() < end
        time.sleep(0.05)
    return known


def setting(values, base="fluorocarbon"):
    return design_of({"base": base, "values": values}, BASES).setting


def test_only_the_newest_question_is_answered_and_each_once():
    beside = WorkerProcess("operator:neg")
    try:
        assert beside.answer_to(1) is None
        for question in range(2, 50):
            beside.answer_to(question)
        assert waited(lambda: beside.answer_to(49)) == (-49, "")
        assert not beside.busy
        assert beside.newest == (49, -49, "")
    finally:
        beside.stop()


def test_what_cannot_be_answered_is_told_and_the_next_question_is_answered():
    beside = WorkerProcess("noise.app.design_chart:chart_of")
    wrong = ChartRequest(setting({}).rig, -5.0, 23.0)
    try:
        answer, error = waited(lambda: beside.answer_to(wrong))
        assert answer is None
        assert "support" in error
        assert waited(lambda: beside.answer_to(ChartRequest.of(setting({}, "PDMS"))))[0]
    finally:
        beside.stop()


@pytest.mark.slow
def test_the_change_that_is_suggested_ends_the_noise():
    values = {"speed": 5.0}
    found = suggestions_of(SuggestionRequest.of(setting(values), {}))
    assert found["noise"] == "squawk"
    names = [one["name"] for one in found["changes"]]
    assert "damping" in names
    more = found["changes"][names.index("damping")]["factor"]
    quiet = suggestions_of(
        SuggestionRequest.of(setting({**values, "change.damping": more * 1.02}), {})
    )
    assert quiet["noise"] == "none"
    assert quiet["changes"] == []


def test_the_speed_at_which_help_is_asked_for_is_that_which_is_heard():
    run_up = setting({"motion": "run_up"})
    assert SuggestionRequest.of(run_up, {"speed": -6.5}).speed == 6.5
    assert SuggestionRequest.of(setting({"speed": -3.0}), {}).speed == 3.0
    for wrong in ("5", math.nan, 1e9):
        with pytest.raises(ParameterError, match="speed"):
            SuggestionRequest.of(run_up, {"speed": wrong})


def test_charts_are_the_same_whatever_the_motion():
    one = setting({"motion": "swing", "interference": 0.2})
    assert ChartRequest.of(one) == ChartRequest.of(setting({}))
    assert ChartRequest.of(one) != ChartRequest.of(replace(one, temperature=60.0))


def kept(keeping, said):
    keeping.start(said)
    state = waited(lambda: None if keeping.state()["running"] else keeping.state())
    assert state["error"] == ""
    return state["result"]


@pytest.mark.slow
def test_both_designs_are_kept_as_sounds_at_one_gain_and_as_a_page(tmp_path):
    keeping = DesignExport(BASES, tmp_path)
    designs = {
        "A": {"base": "fluorocarbon", "values": {}},
        "B": {"base": "fluorocarbon", "values": {"change.damping": 2.0, "motion": "swing"}},
    }
    said = {"name": "both", "designs": designs, "seconds": 0.5}
    assert kept(keeping, said) == str(tmp_path / "both")
    recording = read_recording(tmp_path / "both" / "recordings" / "B.wav")
    assert recording.rate == 48e3
    sounds = [tmp_path / "both" / "sounds" / f"{slot}.json" for slot in "AB"]
    told = [json.loads(path.read_text(encoding="utf-8"))["render"] for path in sounds]
    assert told[0]["full_scale_Pa"] == told[1]["full_scale_Pa"]
    with pytest.raises(ParameterError, match="is there already"):
        keeping.start(said)
    page = kept(keeping, {**said, "page": True, "replace": True})
    assert page == str(tmp_path / "both.html")
    text = html.unescape(Path(page).read_text(encoding="utf-8"))
    assert "A: fluorocarbon unchanged (--speed 5" in text
    assert "B: fluorocarbon with damping x2 (--oscillate 15,2" in text
    saved = bases_of(open_paths([tmp_path / "both" / f"{slot}.toml" for slot in "AB"]))
    for slot, base in zip("AB", ["rig 0", "rig 1"], strict=True):
        again = design_of({"base": base, "values": {}}, saved)
        assert again.options == design_of(designs[slot], BASES).options
    keeping.stop()


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({"designs": {}}, "A, B or both"),
        ({"designs": {"C": {}}}, "A, B or both"),
        ({"seconds": 1e9}, "from 0.5 to 60"),
        ({"seconds": "4"}, "a number"),
        ({"name": "../x"}, "must begin"),
    ],
)
def test_sets_that_cannot_be_are_refused_in_a_line(said, told, tmp_path):
    plain = {"name": "x", "designs": {"A": {"base": "PDMS", "values": {}}}}
    with pytest.raises(ParameterError, match=told):
        DesignExport(BASES, tmp_path).start(plain | said)
    assert list(tmp_path.iterdir()) == []
