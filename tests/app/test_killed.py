"""The server is killed at any moment, while the table is labelled: no correction is lost."""

from __future__ import annotations

import time
from http.client import HTTPException
from threading import Event, Thread

import numpy as np
import pytest

from noise.batch.journal import open_journal
from noise.batch.work import JobResult, file_identity, find_jobs
from noise.labels.labelling import Labelling, label
from noise.labels.table import read_label_table
from tests.helpers.labelled_folder import made_row, write_folder
from tests.helpers.opened_app import started_app

NAMES = [f"run{number:02d}.wav" for number in range(30)]
LABELS = ("creak", "squawk", "squeal", "unknown")
MOST = 5
"""So many corrections are never answered before the kill comes."""

LATER = 0.05
"""After the last that is waited for, within what one takes [s]."""


def labelled_journal(folder):
    """Recordings that are all labelled, of which the journal alone knows."""
    write_folder(folder, NAMES)
    with open_journal(folder / "labels.csv", Labelling()) as journal:
        for job in find_jobs([folder]):
            rows = [list(made_row(job.name).values())]
            journal.add_result(job, file_identity(job.path), JobResult(rows, True))


def kill_while_correcting(folder, rng):
    """Correct until the kill; return what was answered, by file, and what was under way."""
    app = started_app(folder)
    answers, asked, dead = [], {}, Event()

    def correct():
        while True:
            number, said = int(rng.integers(len(NAMES))), str(rng.choice(LABELS))
            asked[NAMES[number]] = said
            try:
                app.correct(number, said, 0.0, 2.0)
            except (OSError, HTTPException):  # it is dead
                return
            answers.append(asked.popitem())

    def relabel():
        while not dead.is_set():
            label([folder], out=folder / "labels.csv")

    others = [Thread(target=work) for work in (correct, relabel)]
    n_answers, later = int(rng.integers(MOST)), float(rng.uniform(0.0, LATER))
    for thread in others:
        thread.start()
    while len(answers) < n_answers and others[0].is_alive():
        time.sleep(1e-3)
    time.sleep(later)
    app.process.kill()
    app.process.join()
    dead.set()
    for thread in others:
        thread.join()
    return answers, asked


@pytest.mark.parametrize("tries", [8, pytest.param(200, marks=pytest.mark.slow)])
def test_no_correction_is_lost_by_a_kill_while_the_table_is_labelled(tmp_path, tries):
    rng, said, n_answered = np.random.default_rng(tries), {}, 0
    labelled_journal(tmp_path)
    for _ in range(tries):
        answers, under_way = kill_while_correcting(tmp_path, rng)
        said |= dict(answers)
        n_answered += len(answers)
        rows = {row["file"]: row for row in read_label_table(tmp_path / "labels.csv")}
        assert list(rows) == NAMES
        for name, found in under_way.items():  # it may be in the table, or not
            assert rows[name]["label"] in (found, said.get(name, "none"))
            said[name] = rows[name]["label"]
        assert {n: rows[n]["label"] for n in said} == said
    assert n_answered > tries
    assert all(rows[n]["label_source"] == "human" for n in said if said[n] != "none")
