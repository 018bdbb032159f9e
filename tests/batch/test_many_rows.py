"""Recordings of many rows: kept in files, sent, written and found again as those of few are."""

import gc
import json
import os
import pickle
import zlib
from dataclasses import dataclass

import pytest

from noise.base import parquet as parquet_module
from noise.base.tables import read_table, write_table
from noise.batch import Job, open_journal, rows as rows_module
from noise.batch.identity import file_identity
from noise.batch.journal import JournalReader
from noise.batch.lines import journal_path
from noise.batch.rows import StoredRows, stored
from noise.batch.work import perform_all

ROWS = [[f"window {i}", 0.1 * i] for i in range(7)]


@dataclass
class Numbering:
    """Work with as many rows a recording."""

    count: int = 7

    doing, columns = "numbering", ("file", "number", "error")

    def prepare(self):
        pass

    def identity(self):
        return {}

    def rows(self, _, name):
        return ({"file": name, "number": 0.1 * i} for i in range(self.count)), True


@pytest.fixture(autouse=True)
def two_rows_a_part(monkeypatch):
    monkeypatch.setattr(rows_module, "_A_PART", 2)


@pytest.fixture
def jobs(tmp_path):
    paths = [tmp_path / f"{letter}.wav" for letter in "abc"]
    for path in paths:
        path.write_bytes(b"sound")
    return [Job(index, path, path.name) for index, path in enumerate(paths)]


def done_in(table, jobs):
    with open_journal(table, Numbering()) as journal:
        found = journal.known(jobs)
        return {index: [list(row) for row in done.rows] for index, done in found.items()}


def written(table, jobs):
    with open_journal(table, Numbering()) as journal:
        for _ in perform_all(Numbering(), jobs, journal=journal):
            pass
    return journal_path(table)


def test_many_rows_come_back_in_their_order_as_often_as_one_likes():
    kept = stored(iter(ROWS))
    assert isinstance(kept, StoredRows)
    assert len(kept) == 7
    assert list(kept) == list(kept) == ROWS
    assert pickle.loads(pickle.dumps(kept)) == ROWS


def test_two_recordings_that_are_gone_through_at_once_do_not_mix():
    one, other = stored(iter(ROWS)), stored([name.upper(), n] for name, n in ROWS)
    assert [(a, b.lower()) for (a, _), (b, _) in zip(one, other, strict=True)] == [
        (name, name) for name, _ in ROWS
    ]


def test_the_file_goes_with_the_last_rows_in_it():
    kept = stored(iter(ROWS))
    assert rows_module._file._file is not None
    del kept
    gc.collect()
    assert rows_module._file._file is None


def test_a_journal_finds_recordings_of_many_rows_again(tmp_path, jobs):
    written(tmp_path / "t.csv", jobs)
    again = done_in(tmp_path / "t.csv", jobs)
    assert sorted(again) == [0, 1, 2]
    assert [row[1] for row in again[1]] == [0.1 * i for i in range(7)]


def test_a_recording_that_a_line_is_missing_of_is_done_again(tmp_path, jobs):
    journal = written(tmp_path / "t.csv", jobs)
    lines = journal.read_bytes().splitlines(keepends=True)
    assert len(lines) == 1 + 3 * 4
    for damaged in range(1, len(lines)):
        garbled = lines[damaged].replace(b"0.", b"9.").replace(b'.wav",', b'.wav" ')
        journal.write_bytes(b"".join([*lines[:damaged], garbled, *lines[damaged + 1 :]]))
        of = (damaged - 1) // 4
        assert sorted(done_in(tmp_path / "t.csv", jobs)) == sorted({0, 1, 2} - {of})


def test_a_journal_torn_anywhere_keeps_the_recordings_that_are_whole(tmp_path, jobs):
    journal = written(tmp_path / "t.csv", jobs)
    content = journal.read_bytes()
    lines = content.splitlines(keepends=True)
    ends = [sum(map(len, lines[: 1 + 4 * n])) for n in (1, 2, 3)]
    for torn in range(len(lines[0]), len(content), 7):
        journal.write_bytes(content[:torn])
        assert len(done_in(tmp_path / "t.csv", jobs)) == sum(torn >= end for end in ends)
        written(tmp_path / "t.csv", [])  # the next call cuts off what is torn, and adds
        left = [job for job in jobs if job.index not in done_in(tmp_path / "t.csv", jobs)]
        written(tmp_path / "t.csv", left)
        assert len(done_in(tmp_path / "t.csv", jobs)) == 3


def test_who_watches_a_journal_gets_a_recording_when_its_last_line_is_there(tmp_path, jobs):
    journal = written(tmp_path / "t.csv", jobs[:1])
    lines = journal.read_bytes().splitlines(keepends=True)
    reader = JournalReader(tmp_path / "t.csv", Numbering())
    journal.write_bytes(b"")
    with journal.open("ab", buffering=0) as file:
        for number, line in enumerate(lines):
            file.write(line)
            assert len(reader.news(jobs)) == (number == len(lines) - 1)


def test_a_journal_of_one_long_line_is_still_read(tmp_path, jobs):
    with open_journal(tmp_path / "t.csv", Numbering()):
        pass
    rows = [[f"window {i}", 0.1 * i, None] for i in range(7)]
    key = f"{jobs[0].name}\n{jobs[0].path.absolute()}"
    entry = json.dumps([key, file_identity(jobs[0].path), True, rows]).encode()
    with journal_path(tmp_path / "t.csv").open("ab") as file:
        file.write(b"%s %08x\n" % (entry, zlib.crc32(entry)))
    assert done_in(tmp_path / "t.csv", jobs) == {0: rows}


def test_other_processes_send_rows_in_parts(jobs):
    performed = perform_all(Numbering(2500), jobs, workers=2)
    found = {job.index: done for job, done in performed}
    assert sorted(found) == [0, 1, 2]
    for job in jobs:
        assert [row[:2] for row in found[job.index].rows] == [
            [job.name, 0.1 * i] for i in range(2500)
        ]


@pytest.mark.parametrize("ending", [".csv", ".jsonl", ".parquet"])
def test_a_table_is_the_same_written_in_parts(tmp_path, monkeypatch, ending):
    if ending == ".parquet":
        pytest.importorskip("pyarrow")
    rows = [
        {"a": None if i < 3 else f"n{i}", "b": i if i < 4 else i / 3, "c": None} for i in range(9)
    ]
    write_table(tmp_path / f"whole{ending}", "abc", rows)
    monkeypatch.setattr(parquet_module, "_CELLS_AT_ONCE", 6)
    write_table(tmp_path / f"parts{ending}", "abc", iter(rows))
    whole, parts = (read_table(tmp_path / f"{name}{ending}") for name in ("whole", "parts"))
    assert parts == whole


def test_a_disk_that_is_full_is_said_in_one_line_of_the_table(monkeypatch, jobs):
    def dump(*_, **__):
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(rows_module.pickle, "dump", dump)
    ((_, done),) = perform_all(Numbering(), jobs[:1])
    assert done.error == "a temporary file cannot be written (No space left on device)"
    assert [row[-1] for row in done.rows] == [done.error]
