"""Corrections in the app: what they do to the label table, and what they leave alone."""

from __future__ import annotations

import csv
from itertools import count

import numpy as np
import pytest

from models.errors import ParameterError, RecordingError
from models.recording import Channel, Recording
from noise.app.labels.corrections import Correction, read_corrections
from noise.app.labels.store import Labels
from noise.base.tables import write_table
from noise.batch import find_jobs, open_journal
from noise.batch.identity import file_identity
from noise.batch.work import Done
from noise.labels.labelling import COLUMNS, Labelling
from noise.labels.table import read_label_table, with_corrections
from noise.recordings import write_recording
from tests.helpers.labelled_folder import made_row as row, write_folder

NAMES = ("a.wav", "b.wav", "c.wav")


@pytest.fixture
def folder(tmp_path):
    return write_folder(tmp_path, NAMES)


@pytest.fixture
def tabled(folder):
    return write_folder(folder, NAMES, [row(name) for name in NAMES])


def labels_of(folder):
    return Labels(find_jobs([folder]), folder / "labels.csv", Labelling())


def in_table(folder):
    rows = read_label_table(folder / "labels.csv")
    return [(r["file"], r["start_s"], r["end_s"], r["label"], r["label_source"]) for r in rows]


def test_a_correction_is_in_the_table_and_all_else_stays(tabled):
    labels_of(tabled).correct(1, [Correction(0.0, 0.5, "creak"), Correction(0.5, 2.0, "none")])
    assert in_table(tabled) == [
        ("a.wav", 0.0, 2.0, "none", "classifier"),
        ("b.wav", 0.0, 0.5, "creak", "human"),
        ("b.wav", 0.5, 2.0, "none", "human"),
        ("c.wav", 0.0, 2.0, "none", "classifier"),
    ]


def test_segments_that_are_as_they_were_keep_the_classifiers_numbers(folder):
    first, last = row("a.wav", end=1.0), row("a.wav", "squeal", start=1.0, level_dba=61.5)
    write_table(folder / "labels.csv", COLUMNS, [first, last])
    found = labels_of(folder).correct(
        0, [Correction(0.0, 1.0, "none"), Correction(1.0, 2.0, "creak")]
    )
    assert found[0] == first
    assert (found[1]["level_dba"], found[1]["p_creak"]) == (61.5, None)


def test_what_a_person_agrees_with_is_by_a_person(tabled):
    assert (
        labels_of(tabled).correct(0, [Correction(0.0, 2.0, "none")])[0]["label_source"] == "human"
    )


def test_undo_goes_back_one_correction_at_a_time(tabled):
    before = in_table(tabled)
    labels = labels_of(tabled)
    labels.correct(0, [Correction(0.0, 2.0, "creak")])
    after_one = in_table(tabled)
    labels.correct(2, [Correction(0.0, 2.0, "squeal")])
    labels.undo()
    assert in_table(tabled) == after_one
    labels.undo()
    assert in_table(tabled) == before
    with pytest.raises(ParameterError, match="no correction"):
        labels.undo()


def test_a_correction_before_there_is_a_table_outlives_the_labelling(folder):
    labels = labels_of(folder)
    labels.correct(1, [Correction(0.0, 2.0, "squawk")])
    rows = with_corrections(folder / "labels.csv", [row(name) for name in NAMES])
    assert [r["label"] for r in rows] == ["none", "squawk", "none"]


def test_rows_arrive_from_the_journal_and_never_over_a_correction(folder):
    work, jobs = Labelling(), find_jobs([folder])
    labels = labels_of(folder)
    labels.correct(1, [Correction(0.0, 2.0, "squawk")])
    with open_journal(folder / "labels.csv", work) as journal:
        for job in jobs[:2]:
            rows = [list(row(job.name, "creak").values())]
            journal.add(job, file_identity(job.path), Done(rows, True))
        assert [one["label"] for one in labels.summaries()] == ["creak", "squawk", None]
    assert labels_of(folder).rows(0)[0]["label"] == "creak"
    assert labels.undo()[1][0]["label"] == "creak"


def test_what_others_write_into_the_table_is_taken_and_kept(tabled):
    labels = labels_of(tabled)
    write_table(tabled / "labels.csv", COLUMNS, [row(name, "creak") for name in NAMES])
    labels.correct(0, [Correction(0.0, 2.0, "squeal")])
    assert [label for *_, label, _ in in_table(tabled)] == ["squeal", "creak", "creak"]


def test_rows_and_columns_that_are_not_ours_stay(folder):
    rows = [row("a.wav") | {"remark": "left door"}, row("gone.wav") | {"remark": "sold"}]
    write_table(folder / "labels.csv", (*COLUMNS, "remark"), rows)
    labels_of(folder).correct(0, [Correction(0.0, 1.0, "creak")])
    with (folder / "labels.csv").open() as file:
        found = [(r["file"], r["label"], r["remark"]) for r in csv.DictReader(file)]
    assert found == [("a.wav", "creak", ""), ("gone.wav", "none", "sold")]


def test_a_table_that_is_none_is_left_as_it_is(folder):
    (folder / "labels.csv").write_text("x,y\n1,2\n")
    with pytest.raises(RecordingError, match="no label table"):
        labels_of(folder)


@pytest.mark.parametrize(
    "rows",
    [
        None,
        [],
        [7],
        [{"start_s": 1.0, "end_s": 1.0, "label": "creak"}],
        [{"start_s": -1.0, "end_s": 1.0, "label": "creak"}],
        [{"start_s": 0.0, "end_s": float("inf"), "label": "creak"}],
        [{"start_s": 0.0, "end_s": 10**400, "label": "creak"}],
        [{"start_s": True, "end_s": 2, "label": "creak"}],
        [{"start_s": 0.0, "end_s": 1.0, "label": "hiss"}],
        [{"start_s": 0.0, "end_s": 1.0, "label": ["creak"]}],
        [{"start_s": 0.0, "end_s": 1.0, "label": "creak", "channel": "../1"}],
        [{"start_s": at, "end_s": at + 1.0, "label": "creak"} for at in (0.0, 0.5)],
    ],
)
def test_what_is_no_segment_is_refused_in_one_line(rows):
    with pytest.raises(ParameterError) as refused:
        read_corrections(rows)
    assert "\n" not in str(refused.value)


def test_a_table_that_cannot_be_written_leaves_all_as_it_was(tabled, monkeypatch):
    labels, calls = labels_of(tabled), count()

    def fail(*_):
        next(calls)
        raise ParameterError("the disk is full")

    monkeypatch.setattr("noise.app.labels.table_cache.write_table", fail)
    with pytest.raises(ParameterError, match="full"):
        labels.correct(0, [Correction(0.0, 2.0, "creak")])
    assert labels.rows(0)[0]["label"] == "none"
    assert next(calls) == 1


def test_a_segment_with_new_borders_has_the_numbers_that_label_would_give_it(tmp_path):
    time = np.arange(48_000) / 16_000.0
    tone = np.where(time < 1.5, 0.01, 1.0) * np.sin(2.0 * np.pi * 800.0 * time)
    write_recording(tmp_path / "a.wav", Recording(tone[None], 16_000.0, (Channel("pressure"),)))
    write_folder(tmp_path, (), [row("a.wav", end=3.0, level_db=88.0, frequency_hz=None)])
    quiet, loud = labels_of(tmp_path).correct(
        0, [Correction(0.0, 1.5, "none"), Correction(1.5, 3.0, "squeal")]
    )
    assert loud["level_db"] - quiet["level_db"] == pytest.approx(40.0, abs=0.1)
    assert loud["level_db"] == pytest.approx(90.97, abs=0.02)
    assert loud["frequency_hz"] == pytest.approx(800.0, rel=0.01)
