"""Corrections in the app: what they do to the label table, and what they leave alone."""

from __future__ import annotations

import csv
from itertools import count

import pytest

from models.errors import ParameterError, RecordingError
from noise.app.corrected_segments import Correction, read_corrections
from noise.base.tables import write_table
from noise.labels.corrections import version, with_corrections
from noise.labels.table import COLUMNS
from tests.helpers.corrected_table import NAMES, correct, in_table, labels_of
from tests.helpers.labelled_folder import made_row as row


def test_a_correction_is_in_the_table_and_all_else_stays(tabled):
    correct(labels_of(tabled), 1, [Correction(0.0, 0.5, "creak"), Correction(0.5, 2.0, "none")])
    assert in_table(tabled) == [
        ("a.wav", 0.0, 2.0, "none", "classifier"),
        ("b.wav", 0.0, 0.5, "creak", "human"),
        ("b.wav", 0.5, 2.0, "none", "classifier"),  # what is left of it nobody has named
        ("c.wav", 0.0, 2.0, "none", "classifier"),
    ]


def test_segments_that_are_as_they_were_keep_the_classifiers_numbers(folder):
    first, last = row("a.wav", end=1.0), row("a.wav", "squeal", start=1.0, level_dba=61.5)
    write_table(folder / "labels.csv", COLUMNS, [first, last])
    found = correct(
        labels_of(folder), 0, [Correction(0.0, 1.0, "none"), Correction(1.0, 2.0, "creak")]
    )
    assert found[0] == first
    assert (found[1]["level_dba"], found[1]["p_creak"]) == (61.5, None)


def test_what_a_person_agrees_with_is_by_a_person_and_what_nobody_touched_is_not(folder):
    write_table(folder / "labels.csv", COLUMNS, [row("a.wav", end=1.0), row("a.wav", start=1.0)])
    said = [Correction(0.0, 1.0, "none"), Correction(1.0, 2.0, "none", confirmed=True)]
    found = correct(labels_of(folder), 0, said)
    assert [r["label_source"] for r in found] == ["classifier", "human"]


def test_a_correction_before_there_is_a_table_outlives_the_labelling(folder):
    labels = labels_of(folder)
    correct(labels, 1, [Correction(0.0, 2.0, "squawk")])
    rows = with_corrections(folder / "labels.csv", [row(name) for name in NAMES])
    assert [r["label"] for r in rows] == ["none", "squawk", "none"]


def test_rows_and_columns_that_are_not_ours_stay(folder):
    rows = [row("a.wav") | {"remark": "left door"}, row("gone.wav") | {"remark": "sold"}]
    write_table(folder / "labels.csv", (*COLUMNS, "remark"), rows)
    correct(labels_of(folder), 0, [Correction(0.0, 1.0, "creak")])
    with (folder / "labels.csv").open() as file:
        found = [(r["file"], r["label"], r["remark"]) for r in csv.DictReader(file)]
    assert found == [("a.wav", "creak", "left door"), ("gone.wav", "none", "sold")]


def test_times_with_more_decimals_than_are_told_apart_leave_a_segment_as_it_was(folder):
    third, rest = (
        row("a.wav", end=2 / 3, p_none=0.9),
        row("a.wav", "creak", start=2 / 3, p_none=0.1),
    )
    write_table(folder / "labels.csv", COLUMNS, [third, rest])
    said = read_corrections(
        [
            {"start_s": 0.0, "end_s": 2 / 3, "label": "none"},
            {"start_s": 2 / 3, "end_s": 2.0, "label": "squeal"},
        ]
    )
    found = correct(labels_of(folder), 0, said)
    assert [(r["label_source"], r["p_none"]) for r in found] == [
        ("classifier", 0.9),
        ("human", None),
    ]


def test_a_table_that_has_become_none_is_not_written_over_however_often_it_is_read(tabled):
    labels = labels_of(tabled)
    seen = version(labels.rows(0))
    broken = (tabled / "labels.csv").read_bytes().replace(b"a.wav", b'"a.wav')
    (tabled / "labels.csv").write_bytes(broken)
    for _ in range(2):
        with pytest.raises(RecordingError):
            labels.rows(0)
    with pytest.raises(RecordingError):
        labels.correct(0, [Correction(0.0, 2.0, "creak")], seen)
    assert (tabled / "labels.csv").read_bytes() == broken


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

    monkeypatch.setattr("noise.labels.table.write_table", fail)
    with pytest.raises(ParameterError, match="full"):
        correct(labels, 0, [Correction(0.0, 2.0, "creak")])
    assert labels.rows(0)[0]["label"] == "none"
    assert next(calls) == 1
