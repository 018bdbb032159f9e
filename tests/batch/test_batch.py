"""Work on many recordings: nothing lost, nothing done twice, whoever dies."""

from __future__ import annotations

import multiprocessing
import sys
from contextlib import closing

import pytest

from models.errors import ParameterError
from noise.batch.journal import Journal, journal_path, open_journal, temporary_journal
from noise.batch.work import DIED, JobResult, file_identity, perform_all
from tests.helpers.batch_work import Counting, in_order, make_jobs

NAMES = ("a", "bad", "c", "d", "e", "f")


@pytest.fixture
def work(tmp_path):
    return Counting(tmp_path / "log")


@pytest.fixture
def jobs(tmp_path):
    return make_jobs(tmp_path, NAMES)


def performed(work, jobs, **how):
    with closing(Journal()) as journal:
        return in_order(perform_all(work, jobs, journal, **how))


def test_the_rows_are_the_same_however_many_processes_there_are(work, jobs):
    alone = performed(work, jobs)
    shared = performed(work, jobs, workers=2)
    assert shared == alone
    assert [done.error is not None for done in alone] == [False, True, *[False] * 4]


def test_a_process_that_dies_once_costs_nothing(work, tmp_path):
    jobs = make_jobs(tmp_path, ["a", "fragile", "c"])
    found = performed(work, jobs, workers=2)
    assert [done.error for done in found] == [None, None, None]
    assert sorted(work.log.read_text().split()) == sorted(
        ["a.wav", "c.wav", "fragile.wav", "fragile.wav"]
    )


def test_a_recording_that_no_process_survives_is_refused_and_the_others_are_not(work, tmp_path):
    jobs = make_jobs(tmp_path, ["a", "deadly", "c", "d"])
    found = performed(work, jobs, workers=2)
    assert [done.error for done in found] == [None, DIED, None, None]
    assert found[1].rows == [["deadly.wav", None, DIED]]
    assert work.log.read_text().split().count("deadly.wav") == 2


def test_where_no_process_can_be_started_the_work_is_done_all_the_same(work, jobs):
    multiprocessing.set_executable("/nowhere/python")
    try:
        shared = performed(work, jobs, workers=2)
    finally:
        multiprocessing.set_executable(sys.executable)
    assert shared == performed(work, jobs)


def keep(table, work, jobs, *, fresh=False):
    """What the journal knew, having then added the rest."""
    with open_journal(table, work, fresh=fresh) as journal:
        known = [journal.find(job) for job in jobs]
        left = [job for job, done in zip(jobs, known, strict=True) if done is None]
        for _ in perform_all(work, left, journal):
            pass
    return known


def test_what_is_kept_comes_back_bit_for_bit_and_refused_ones_are_tried_again(work, jobs, tmp_path):
    table = tmp_path / "t.csv"
    assert keep(table, work, jobs) == [None] * 6
    computed = performed(work, jobs)
    computed[1] = None
    assert keep(table, work, jobs) == computed


@pytest.mark.parametrize(
    "content", [b'[2, "of an earlier program"]\n', b"\0" * 5000, b"SQLite format 3"]
)
def test_a_journal_that_is_none_begins_again_with_a_note(work, jobs, tmp_path, capsys, content):
    table = tmp_path / "t.csv"
    journal_path(table).write_bytes(content)
    assert keep(table, work, jobs) == [None] * 6
    assert "everything is computed again" in capsys.readouterr().err
    assert [done is None for done in keep(table, work, jobs)] == [False, True, *[False] * 4]


def test_a_journal_that_cannot_be_written_is_refused(work, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(ParameterError, match="cannot be written"):
        open_journal(tmp_path / "file" / "t.csv", work).__enter__()


@pytest.mark.skipif(sys.platform == "win32", reason="has no limits on files")
def test_a_full_disk_says_that_it_is_the_journal_and_what_is_in_it_can_be_gone_on_with(
    work, jobs, tmp_path
):
    import resource

    table, long = tmp_path / "t.csv", JobResult([["x" * 100_000, 1.0, None]], calibrated=True)
    _, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    with open_journal(table, work) as journal:
        list(perform_all(work, jobs[:1], journal))
        size = journal_path(table).stat().st_size
        resource.setrlimit(resource.RLIMIT_FSIZE, (size + 50, hard))
        try:
            with pytest.raises(OSError, match=r"cannot be written.*\.t\.csv\.journal"):
                journal.add_result(jobs[2], file_identity(jobs[2].path), long)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
    assert [done is None for done in keep(table, work, jobs)] == [False, *[True] * 5]


# What is kept until a call is done


def call(target, identity, end=None):
    """Keep one result, then end; return what was there before."""
    with temporary_journal(target, identity) as journal:
        there = journal.get("a")
        journal.add("a", [0.1, float("inf")], "said")
        if end is not None:
            raise end
    return there


def test_what_is_kept_is_there_until_the_call_has_come_to_its_end(tmp_path, capsys):
    target = tmp_path / "new" / "set"
    for end in (KeyboardInterrupt(), ParameterError("no space left on device")):
        with pytest.raises(type(end)):
            call(target, "same", end)
    assert call(target, "same") == [[0.1, float("inf")], "said"]
    assert not target.parent.exists() or not list(target.parent.iterdir())
    with pytest.raises(KeyboardInterrupt):
        call(target, "one", KeyboardInterrupt())
    assert call(target, "another") is None
    assert "holds results of other options" in capsys.readouterr().err


def test_results_of_another_version_are_not_used_and_a_line_says_so(tmp_path, monkeypatch, capsys):
    with pytest.raises(KeyboardInterrupt):
        call(tmp_path / "set", "same", KeyboardInterrupt())
    monkeypatch.setattr("noise.batch.journal.RESULTS_VERSION", 2)
    assert call(tmp_path / "set", "same") is None
    assert "another program version; everything is computed again" in capsys.readouterr().err
