"""Which recording is checked next: one that is likely wrong, and unlike those asked before."""

from __future__ import annotations

from noise.app.labels.next_check import NextCheck
from tests.helpers.labelled_folder import made_row


def one(p_creak, p_squeal, source="classifier"):
    shares = {"p_creak": p_creak, "p_squawk": 0.0, "p_squeal": p_squeal, "p_none": 0.0}
    shares["p_unknown"] = 1.0 - p_creak - p_squeal
    return [made_row("x.wav", "creak", label_source=source, frequency_hz=100.0, **shares)]


def order(recordings):
    check, found = NextCheck(), []
    while (index := check.next(recordings, None)["id"]) is not None:
        found.append(index)
    return found


def test_the_least_sure_comes_first_and_each_comes_once():
    assert order([one(0.9, 0.1), one(0.5, 0.5), one(0.7, 0.3)])[0] == 1
    assert sorted(order([one(0.9, 0.1), one(0.5, 0.5), one(0.7, 0.3)])) == [0, 1, 2]


def test_what_is_unlike_those_before_comes_before_what_is_like_them():
    alike, unlike = one(0.5, 0.49), one(0.6, 0.0)
    assert order([one(0.5, 0.5), alike, unlike]) == [0, 2, 1]


def test_what_a_person_has_said_is_not_asked():
    assert order([one(0.5, 0.5, "human"), one(0.9, 0.1)]) == [1]


def test_what_was_looked_at_does_not_come_again():
    check, recordings = NextCheck(), [one(0.5, 0.5), one(0.9, 0.1)]
    assert check.next(recordings, 0)["id"] == 1
    assert check.next(recordings, 1) == {"id": None}


def test_a_recording_without_labels_is_nothing_to_check():
    assert order([[], [made_row("x.wav", None, error="is empty")]]) == []
