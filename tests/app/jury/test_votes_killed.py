"""The server is killed at any moment while votes are given: none that was answered is lost."""

from __future__ import annotations

import time
from http.client import HTTPException
from threading import Thread

import numpy as np
import pytest

from noise.app.jury.store import Votes
from tests.helpers.jury_sounds import write_tones
from tests.helpers.opened_app import quick_processes, started_app

MOST = 4
"""So many votes are never answered before the kill comes."""

LATER = 0.05
"""After the last that is waited for, within what one takes [s]."""


@pytest.fixture(scope="module")
def processes():
    return quick_processes()


def kill_while_voting(processes, folder, rng):
    """Vote until the kill; return what was answered, and what was under way."""
    app = started_app(processes, folder)
    answered, under_way = [], []

    def vote():
        place = len(Votes(folder / "votes.csv").jury(1).votes)
        while True:
            said = str(rng.choice(["first", "second", "equal"]))
            under_way[:] = [said]
            try:
                app.json("api/juries/1/vote", {"place": place, "vote": said, "seconds": 1.0})
            except (OSError, HTTPException):  # it is dead
                return
            answered.append(said)
            place += 1

    n_answers, later = int(rng.integers(1, MOST)), float(rng.uniform(0.0, LATER))
    voting = Thread(target=vote)
    voting.start()
    while len(answered) < n_answers and voting.is_alive():
        time.sleep(1e-3)
    time.sleep(later)
    app.process.kill()
    app.process.join()
    voting.join()
    return answered, under_way


@pytest.mark.parametrize("tries", [10, pytest.param(200, marks=pytest.mark.slow)])
def test_no_vote_is_lost_by_a_kill_and_the_order_stays(processes, tmp_path, tries):
    rng = np.random.default_rng(tries)
    write_tones(tmp_path, ("a.wav", "b.wav"))
    table = Votes(tmp_path / "votes.csv")
    about = {"listener": "", "question": "?", "played": "one gain", "seed": 0}
    pairs = [tuple(rng.permutation(2).tolist()) for _ in range(10 * tries)]
    order = table.begin(["a.wav", "b.wav"], lambda _: pairs, **about).pairs
    said, n_answered = [], 0
    for _ in range(tries):
        answered, under_way = kill_while_voting(processes, tmp_path, rng)
        said += answered
        n_answered += len(answered)
        found = table.jury(1)
        assert found.pairs == order
        if list(found.votes) != said:  # what was under way may be in the table, or not
            said += under_way
        assert list(found.votes) == said
    assert n_answered >= tries
