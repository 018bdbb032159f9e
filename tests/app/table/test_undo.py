"""Whose labels a correction and an undo are of: what has changed since is left."""

from __future__ import annotations

import pytest

from models.errors import ParameterError
from noise.app.corrected_segments import Correction
from noise.base.tables import write_table
from noise.labels.corrections import version, with_corrections
from noise.labels.table import COLUMNS
from tests.helpers.corrected_table import NAMES, correct, in_table, labels_of
from tests.helpers.labelled_folder import made_row as row


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
