"""Corrections in the app: what they do to the label table, how segments are measured, undo."""

from __future__ import annotations

import csv
from itertools import count

import numpy as np
import pytest
import soundfile

from models.errors import ParameterError, RecordingError
from models.recording import Channel, Recording
from noise.app.corrected_segments import NOT_MEASURED, Correction, read_corrections
from noise.base.tables import write_table
from noise.labels.corrections import version, with_corrections
from noise.labels.labelling import label
from noise.labels.summary import ASSUMED
from noise.labels.table import COLUMNS
from noise.recordings import write_recording
from tests.helpers.corrected_table import NAMES, correct, in_table, labels_of
from tests.helpers.labelled_folder import made_row as row, write_folder


@pytest.fixture
def folder(tmp_path):
    return write_folder(tmp_path, NAMES)


@pytest.fixture
def tabled(folder):
    return write_folder(folder, NAMES, [row(name) for name in NAMES])


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


def test_a_correction_that_ends_after_the_recording_may_be_of_another_one(folder, capsys):
    correct(labels_of(folder), 1, [Correction(0.0, 2.0, "squawk")])
    rows = with_corrections(folder / "labels.csv", [row(name, end=1.0) for name in NAMES])
    assert [r["label"] for r in rows] == ["none", "squawk", "none"]
    assert f"{NAMES[1]} ends at 2.00 s, the recording at 1.00 s" in capsys.readouterr().err


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


def logged_run(path, seconds):
    """A tone that grows twentyfold in its middle, and hiss beside it."""
    time = np.arange(int(8000 * seconds)) / 8000.0
    tone = np.where(time < 0.5 * seconds, 0.002, 0.04) * np.sin(2.0 * np.pi * 800.0 * time)
    hiss = 1e-4 * np.random.default_rng(0).normal(size=time.size)
    return write_recording(path, Recording((tone + hiss)[None], 8000.0, (Channel("pressure"),)))


LOGGED = {
    "speed_rad_s": 5.0, "speed_rad_s_source": "logged", "interference_mm": 0.2,
    "interference_mm_source": "logged", "material": "EPDM", "material_source": "logged",
    "note": "heard at the left rear", "calibrated": True,
}  # fmt: skip


def test_a_segment_that_is_split_keeps_what_was_logged_and_is_measured(tmp_path):
    logged_run(tmp_path / "a.wav", 20.0)
    write_table(tmp_path / "labels.csv", COLUMNS, [row("a.wav", end=20.0, level_db=50.0, **LOGGED)])
    found = correct(
        labels_of(tmp_path), 0, [Correction(0.0, 10.0, "none"), Correction(10.0, 20.0, "squeal")]
    )
    assert [{name: one[name] for name in LOGGED} for one in found] == [LOGGED] * 2
    quiet, loud = found
    assert loud["level_dba"] - quiet["level_dba"] == pytest.approx(26.0, abs=0.2)
    assert loud["snr_dba"] == pytest.approx(26.0, abs=0.5)
    assert loud["frequency_hz"] == pytest.approx(800.0, rel=0.01)


def test_of_a_long_recording_what_is_new_is_measured_and_the_rest_says_that_it_is_not(tmp_path):
    logged_run(tmp_path / "a.wav", 150.0)
    numbers = {"level_db": 50.0, "level_dba": 50.0, "snr_dba": 3.0}
    before = row("a.wav", end=150.0, **numbers, **LOGGED)
    write_table(tmp_path / "labels.csv", COLUMNS, [before])
    rest, piece = correct(
        labels_of(tmp_path), 0, [Correction(0.0, 140.0, "none"), Correction(140.0, 150.0, "squeal")]
    )
    kept = LOGGED | {"note": f"{LOGGED['note']}; {NOT_MEASURED}"}
    assert {name: rest[name] for name in LOGGED} == kept
    assert rest["level_db"] is rest["snr_dba"] is None
    assert {name: piece[name] for name in LOGGED} == LOGGED
    assert piece["level_db"] == pytest.approx(20.0 * np.log10(0.04 / np.sqrt(2.0) / 2e-5), abs=0.1)
    assert piece["snr_dba"] is None  # the background is that of the whole recording


def test_a_split_segment_is_as_calibrated_as_its_table(tmp_path):
    tone = 0.1 * np.sin(2.0 * np.pi * 800.0 * np.arange(32_000) / 16_000.0)
    soundfile.write(tmp_path / "a.wav", tone, 16_000)
    (before,) = label([tmp_path], out=tmp_path / "labels.csv", full_scale=2.0)
    found = correct(
        labels_of(tmp_path), 0, [Correction(0.0, 1.0, "squeal"), Correction(1.0, 2.0, "none")]
    )
    for one in found:
        assert one["calibrated"] is True
        for name in ("level_db", "level_dbfs", "level_dba"):
            assert one[name] == pytest.approx(before[name], abs=0.05), name


def test_another_label_ends_what_was_inferred_by_the_one_before(tabled):
    inferred = {"speed_rad_s": 5.0, "speed_rad_s_low": 4.0, "speed_rad_s_high": 6.0}
    inferred |= {"speed_rad_s_source": "inferred", "snr_dba": 7.5}
    inferred["note"] = f"left door; conditions inferred {ASSUMED}"
    write_table(tabled / "labels.csv", COLUMNS, [row("a.wav", "creak", **inferred)])
    (found,) = correct(labels_of(tabled), 0, [Correction(0.0, 2.0, "none")])
    assert (found["speed_rad_s"], found["speed_rad_s_source"]) == (None, "missing")
    assert (found["note"], found["snr_dba"]) == ("left door", 7.5)


def test_undo_and_redo_go_one_correction_at_a_time(tabled):
    before = in_table(tabled)
    labels = labels_of(tabled)
    correct(labels, 0, [Correction(0.0, 2.0, "creak")])
    after_one = in_table(tabled)
    correct(labels, 2, [Correction(0.0, 2.0, "squeal")])
    after_both = in_table(tabled)
    for redo, then in ((False, after_one), (False, before), (True, after_one), (True, after_both)):
        labels.undo(redo=redo)
        assert in_table(tabled) == then
    with pytest.raises(ParameterError, match="no correction to redo"):
        labels.undo(redo=True)
    labels.undo()
    correct(labels, 1, [Correction(0.0, 2.0, "squawk")])
    with pytest.raises(ParameterError, match="no correction to redo"):
        labels.undo(redo=True)


def test_what_was_said_of_other_labels_than_those_of_the_table_is_refused(tabled):
    labels = labels_of(tabled)
    seen = version(labels.rows(0))
    write_table(tabled / "labels.csv", COLUMNS, [row(name, "creak") for name in NAMES])
    with pytest.raises(ParameterError, match=r"a\.wav: .*changed elsewhere"):
        labels.correct(0, [Correction(0.0, 1.0, "none"), Correction(1.0, 2.0, "squeal")], seen)
    assert in_table(tabled)[0] == ("a.wav", 0.0, 2.0, "creak", "classifier")
    with pytest.raises(ParameterError, match="no correction"):
        labels.undo()


def test_who_names_a_recording_before_the_classifier_has_is_heard_and_not_over_another(folder):
    labels, other = labels_of(folder), labels_of(folder)
    seen = version(labels.rows(0))
    write_table(folder / "labels.csv", COLUMNS, [row("a.wav", "creak")])
    labels.correct(0, [Correction(0.0, 2.0, "squeal")], seen)
    with pytest.raises(ParameterError, match="changed elsewhere"):
        other.correct(0, [Correction(0.0, 2.0, "squawk")], seen)
    assert in_table(folder)[0][3:] == ("squeal", "human")


def test_undo_leaves_what_somebody_has_changed_since(tabled):
    labels = labels_of(tabled)
    correct(labels, 0, [Correction(0.0, 2.0, "creak")])
    correct(labels, 1, [Correction(0.0, 2.0, "creak")])
    correct(labels_of(tabled), 1, [Correction(0.0, 2.0, "squeal")])
    with pytest.raises(ParameterError, match=r"b\.wav: .*changed since"):
        labels.undo()
    assert in_table(tabled)[1][3:] == ("squeal", "human")
    assert labels.undo()[0] == 0
    assert [label for *_, label, _ in in_table(tabled)] == ["none", "squeal", "none"]


def test_undo_of_one_track_leaves_the_other_as_the_classifier_has_named_it_since(folder):
    def rows(second):
        return [row("a.wav", channel="1"), row("a.wav", second, channel="2")]

    write_table(folder / "labels.csv", COLUMNS, rows("none"))
    labels = labels_of(folder)
    said = [Correction(0.0, 2.0, "creak", "1"), Correction(0.0, 2.0, "none", "2")]
    correct(labels, 0, said)
    new = with_corrections(folder / "labels.csv", rows("squeal"))
    write_table(folder / "labels.csv", COLUMNS, new)
    labels.undo()
    assert [label for *_, label, _ in in_table(folder)] == ["none", "squeal"]
