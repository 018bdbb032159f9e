"""What is computed beside the sound: maps, suggestions, sets."""

from __future__ import annotations

import time

import pytest

from noise.app.design import design_of
from noise.app.design_chart import ChartRequest, SuggestionRequest, suggestions_of
from noise.app.design_controls import bases_of
from noise.app.opened import open_paths
from noise.app.worker_process import WorkerProcess, report_share

BASES = bases_of(open_paths([]))
PATIENCE = 120.0


def waited(found):
    end = time.monotonic() + PATIENCE
    while not (known := found()):
        assert time.monotonic() < end
        time.sleep(0.05)
    return known


def suggested(values):
    of = design_of({"base": "fluorocarbon", "values": values}, BASES).setting
    chart = ChartRequest(of.rig, of.support_stiffness, of.temperature)
    return suggestions_of(SuggestionRequest(chart, of.interference, values["speed"]))


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


def half_done(seconds):
    report_share(0.5)
    time.sleep(seconds)


def test_the_share_that_is_done_is_known_while_it_is_computed():
    beside = WorkerProcess(f"{__name__}:half_done")
    try:
        beside.answer_to(1.0)
        assert waited(lambda: beside.share_of(1.0)) == 0.5
        assert beside.share_of(2.0) == 0.0
        assert waited(lambda: beside.answer_to(1.0)) == (None, "")
        beside.answer_to(3.0)
        assert beside.share_of(1.0) == 0.0
    finally:
        beside.stop()


@pytest.mark.slow
def test_the_change_that_is_suggested_ends_the_noise():
    values = {"speed": 5.0}
    found = suggested(values)
    assert found["noise"] == "squawk"
    names = [one["name"] for one in found["changes"]]
    assert "damping" in names
    more = found["changes"][names.index("damping")]["factor"]
    quiet = suggested({**values, "change.damping": more * 1.02})
    assert quiet["noise"] == "none"
    assert quiet["changes"] == []
