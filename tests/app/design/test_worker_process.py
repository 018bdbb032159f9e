"""What is computed beside the sound: answers to the newest question."""

from __future__ import annotations

import time

from noise.app.worker_process import WorkerProcess, report_share

PATIENCE = 120.0


def waited(found):
    end = time.monotonic() + PATIENCE
    while not (known := found()):
        assert time.monotonic() < end
        time.sleep(0.05)
    return known


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
