"""Work on many recordings: nothing lost, nothing done twice, whoever dies."""

from __future__ import annotations

import json
import multiprocessing
import resource
import sys
import tempfile
import zlib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from models.errors import ParameterError
from noise.batch import Done, Job, file_identity, journal_path, open_journal, perform_all
from noise.batch.processes import DIED
from tests.helpers.batch_work import Counting, in_order, make_jobs

NAMES = ("a", "bad", "c", "d", "e", "f")


@pytest.fixture
def work(tmp_path):
    return Counting(tmp_path / "log")


@pytest.fixture
def jobs(tmp_path):
    return make_jobs(tmp_path, NAMES)


def test_the_rows_are_the_same_however_many_processes_there_are(work, jobs):
    alone = in_order(perform_all(work, jobs))
    shared = in_order(perform_all(work, jobs, workers=2))
    assert shared == alone
    assert [done.error is not None for done in alone] == [False, True, *[False] * 4]


def test_a_process_that_dies_once_costs_nothing(work, tmp_path):
    jobs = make_jobs(tmp_path, ["a", "fragile", "c"])
    found = in_order(perform_all(work, jobs, workers=2))
    assert [done.error for done in found] == [None, None, None]
    assert sorted(work.log.read_text().split()) == sorted(
        ["a.wav", "c.wav", "fragile.wav", "fragile.wav"]
    )


def test_a_recording_that_no_process_survives_is_refused_and_the_others_are_not(work, tmp_path):
    jobs = make_jobs(tmp_path, ["a", "deadly", "c", "d"])
    found = in_order(perform_all(work, jobs, workers=2))
    assert [done.error for done in found] == [None, DIED, None, None]
    assert found[1].rows == [["deadly.wav", None, DIED]]
    assert work.log.read_text().split().count("deadly.wav") == 2


def test_where_no_process_can_be_started_the_work_is_done_all_the_same(work, jobs):
    multiprocessing.set_executable("/nowhere/python")
    try:
        shared = in_order(perform_all(work, jobs, workers=2))
    finally:
        multiprocessing.set_executable(sys.executable)
    assert shared == in_order(perform_all(work, jobs))


def keep(table, work, jobs, *, fresh=False):
    """What the journal knew, having then added the rest."""
    with open_journal(table, work, fresh=fresh) as journal:
        known = [journal.find(job) for job in jobs]
        left = [job for job, done in zip(jobs, known, strict=True) if done is None]
        for job, done in perform_all(work, left):
            journal.add(job, file_identity(job.path), done)
    return known


def test_what_is_kept_comes_back_bit_for_bit_and_refused_ones_are_tried_again(work, jobs, tmp_path):
    table = tmp_path / "t.csv"
    assert keep(table, work, jobs) == [None] * 6
    computed = in_order(perform_all(work, jobs))
    computed[1] = None
    assert keep(table, work, jobs) == computed


@pytest.mark.parametrize("cut", range(1, 60, 7))
def test_a_torn_last_line_is_done_again_and_no_other(work, jobs, tmp_path, cut):
    table = tmp_path / "t.csv"
    keep(table, work, jobs)
    path = journal_path(table)
    path.write_bytes(path.read_bytes()[:-cut])
    known = keep(table, work, jobs)
    assert [done is None for done in known] == [False, True, False, False, False, True]
    assert [done is None for done in keep(table, work, jobs)] == [False, True, *[False] * 4]


def test_a_journal_torn_at_any_byte_can_be_gone_on_with(work, jobs, tmp_path):
    table = tmp_path / "t.csv"
    keep(table, work, jobs[:1])
    path = journal_path(table)
    whole = path.read_bytes()
    for size in range(len(whole)):
        path.write_bytes(whole[:size])
        assert keep(table, work, jobs[:1]) == [None]
        assert path.read_bytes() == whole


@given(st.data())
@settings(max_examples=80, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_journal_torn_or_garbled_anywhere_tells_nothing_wrong_and_can_be_gone_on_with(
    work, tmp_path, data
):
    folder = Path(tempfile.mkdtemp(dir=tmp_path))
    jobs, table = make_jobs(folder, ("a", "c", "d")), folder / "t.csv"
    keep(table, work, jobs)
    path = journal_path(table)
    whole = path.read_bytes()
    first = data.draw(st.integers(0, len(whole) - 1))
    last = data.draw(st.integers(first, min(len(whole), first + 40)))
    garbled = whole[:first] + data.draw(st.binary(max_size=40)) + whole[last:]
    path.write_bytes(data.draw(st.sampled_from([garbled, whole[:first]])))
    computed = in_order(perform_all(work, jobs))
    known = keep(table, work, jobs)
    assert all(done in (None, computed[n]) for n, done in enumerate(known))
    assert keep(table, work, jobs) == computed


def test_a_damaged_line_is_done_again(work, jobs, tmp_path):
    table = tmp_path / "t.csv"
    keep(table, work, jobs)
    path = journal_path(table)
    lines = path.read_bytes().splitlines(keepends=True)
    lines[2] = b"\0" * (len(lines[2]) - 1) + b"\n"
    path.write_bytes(b"".join(lines))
    assert [done is None for done in keep(table, work, jobs)] == [False, True, True, *[False] * 3]


def test_a_changed_recording_or_sidecar_is_done_again(work, jobs, tmp_path):
    table = tmp_path / "t.csv"
    keep(table, work, jobs)
    (tmp_path / "a.wav").write_bytes(b"another")
    (tmp_path / "c.json").write_text("{}")
    known = keep(table, work, jobs)
    assert [done is None for done in known] == [True, True, True, False, False, False]
    assert [done is None for done in keep(table, work, jobs)] == [False, True, *[False] * 4]


def test_other_options_and_fresh_begin_again(work, jobs, tmp_path):
    table = tmp_path / "t.csv"
    keep(table, work, jobs)
    assert keep(table, Counting(work.log, factor=2.0), jobs) == [None] * 6
    assert keep(table, Counting(work.log, factor=2.0), jobs, fresh=True) == [None] * 6


def test_two_at_one_table_are_kept_apart(work, tmp_path):
    pytest.importorskip("fcntl")
    with (
        open_journal(tmp_path / "t.csv", work),
        pytest.raises(ParameterError, match="another process"),
        open_journal(tmp_path / "t.csv", work),
    ):
        pass


def test_a_journal_that_cannot_be_written_is_refused(work, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(ParameterError, match="cannot be written"):
        open_journal(tmp_path / "file" / "t.csv", work).__enter__()


def test_names_that_are_no_text_are_kept(work, tmp_path):
    job = Job(0, tmp_path / "a.wav", "\udcff.wav")
    job.path.touch()
    done = Done([["\udcff.wav", float("inf"), None]], calibrated=True)
    with open_journal(tmp_path / "t.csv", work) as journal:
        journal.add(job, file_identity(job.path), done)
    line = journal_path(tmp_path / "t.csv").read_text(encoding="ascii").splitlines()[1]
    assert json.loads(line.rpartition(" ")[0])
    with open_journal(tmp_path / "t.csv", work) as journal:
        assert journal.find(job) == done


def test_a_full_disk_says_that_it_is_the_journal_and_what_is_in_it_can_be_gone_on_with(
    work, jobs, tmp_path
):
    table = tmp_path / "t.csv"
    _, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    with open_journal(table, work) as journal:
        (_, first), *others = perform_all(work, jobs[:1] + jobs[2:])
        journal.add(jobs[0], file_identity(jobs[0].path), first)
        size = journal_path(table).stat().st_size
        resource.setrlimit(resource.RLIMIT_FSIZE, (size + 50, hard))
        try:
            with pytest.raises(ParameterError, match=r"\.t\.csv\.journal: cannot be written \(F"):
                journal.add(jobs[2], file_identity(jobs[2].path), others[0][1])
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
    assert journal_path(table).stat().st_size == size + 50
    assert [done is None for done in keep(table, work, jobs)] == [False, *[True] * 5]


@pytest.mark.parametrize(
    "line",
    [b"[", b"1", b"null", b"[1, 2, 3]", b'["a", [1, 2], true, 5]', b'["a", [1, 2], true, [5]]',
     b'["a", [1, 2], true, [["x"]]]', b"[" * 5000, b'[["a"], [1, 2], true, [["x", 1, null]]]',
     b"\xff\xfe"],
)  # fmt: skip
def test_a_line_of_the_journal_that_is_none_is_passed_over(work, jobs, tmp_path, line):
    table = tmp_path / "t.csv"
    keep(table, work, jobs)
    with journal_path(table).open("ab") as file:
        file.write(b"%s %08x\n" % (line, zlib.crc32(line)))
    assert [done is None for done in keep(table, work, jobs)] == [False, True, *[False] * 4]
