"""Votes in their table: at once, whole, in the order that was drawn."""

from __future__ import annotations

import time
from contextlib import contextmanager

import pytest

from models.errors import BushingNoiseError, ParameterError, RecordingError
from noise.app.jury.store import COLUMNS, Votes
from noise.base.lock import locked
from noise.base.tables import read_table, write_table

NAMES = ["=cmd.wav", "<img src=x onerror=alert(1)>.wav", "c d.wav"]
PAIRS = [(0, 1), (2, 0), (1, 2)]
ABOUT = {"listener": "Ärger", "question": "-Which?", "played": "one gain", "seed": 0}


@pytest.fixture
def votes(tmp_path):
    table = Votes(tmp_path / "votes.csv")
    table.begin(NAMES, lambda _: PAIRS, **ABOUT)
    return table


def test_a_jury_is_in_the_table_from_its_beginning_and_waits_for_its_first_vote(votes):
    jury = votes.jury(1)
    assert jury.pairs == tuple((NAMES[a], NAMES[b]) for a, b in PAIRS)
    assert (jury.waiting, jury.votes, jury.question) == (0, (), "-Which?")
    text = votes.path.read_text(encoding="utf-8")
    assert "'=cmd.wav" in text  # no spreadsheet takes it for a formula
    assert text.splitlines()[0] == ",".join(COLUMNS)


def test_each_vote_is_in_the_table_at_once_and_goes_on_after_a_new_start(votes):
    votes.vote(1, 0, "second", 3.14159)
    rows = read_table(votes.path)[1]
    assert [row["vote"] for row in rows] == ["second", "", ""]
    assert rows[0]["seconds"] == "3.14"
    again = Votes(votes.path)
    assert again.jury(1).waiting == 1
    assert again.vote(1, 1, "equal", 1.0).votes == ("second", "equal")


def test_the_last_vote_is_undone_and_no_more_than_there_are(votes):
    before = votes.path.read_bytes()
    given = votes.vote(1, 0, "first", 1.0)
    assert votes.undo(1, 0, given.last_time).votes == ()
    assert votes.path.read_bytes() == before
    with pytest.raises(ParameterError, match="not the last one any more"):
        votes.undo(1, 0, given.last_time)


def test_an_undo_means_one_vote_and_takes_back_none_that_was_given_in_its_place(votes):
    meant = votes.vote(1, 0, "first", 1.0)
    votes.undo(1, 0, meant.last_time)
    time.sleep(0.002)  # the time of a vote is written in milliseconds
    votes.vote(1, 0, "first", 1.0)
    with pytest.raises(ParameterError, match="vote on comparison 1 that was to be undone"):
        votes.undo(1, 0, meant.last_time)
    later = votes.vote(1, 1, "equal", 1.0)
    with pytest.raises(ParameterError, match="not the last one any more"):
        votes.undo(1, 0, later.last_time)
    assert votes.jury(1).votes == ("first", "equal")


def test_what_is_answered_to_a_vote_ends_with_it_though_another_follows_at_once(votes, monkeypatch):
    @contextmanager
    def followed(path):
        with locked(path):
            yield
        monkeypatch.undo()
        Votes(path).vote(1, 1, "equal", 1.0)

    monkeypatch.setattr("noise.app.jury.store.locked", followed)
    assert votes.vote(1, 0, "first", 1.0).votes == ("first",)
    assert votes.jury(1).votes == ("first", "equal")


@pytest.mark.parametrize(
    ("number", "place", "said"), [(1, 1, "first"), (1, 3, "first"), (1, 0, "a"), (2, 0, "first")]
)
def test_a_vote_that_is_not_asked_for_changes_nothing(votes, number, place, said):
    before = votes.path.read_bytes()
    with pytest.raises(ParameterError):
        votes.vote(number, place, said, 1.0)
    assert votes.path.read_bytes() == before


def test_juries_follow_each_other_and_do_not_touch_each_other(votes):
    votes.vote(1, 0, "first", 1.0)
    second = votes.begin(NAMES, lambda number: PAIRS[: number - 1], **ABOUT)
    votes.vote(second.number, 0, "equal", 1.0)
    assert [jury.votes for jury in votes.juries()] == [("first",), ("equal",)]
    assert votes.jury(2).waiting is None


def test_columns_of_ones_own_stay(votes):
    text = votes.path.read_text(encoding="utf-8").splitlines()
    votes.path.write_text(
        "\n".join([text[0] + ",remark", *(line + ",mine" for line in text[1:])]), encoding="utf-8"
    )
    votes.vote(1, 0, "first", 1.0)
    assert [row["remark"] for row in read_table(votes.path)[1]] == ["mine"] * 3


def test_votes_are_written_as_excel_opens_the_table(votes):
    votes.vote(1, 0, "first", 1.5)
    rows = read_table(votes.path)[1]
    votes.path.write_bytes("\ufefffile;x\r\n1;0,5\r\n".encode())
    rows = [row | {"own": -2.5, "seconds": float(row["seconds"] or 0)} for row in rows]
    write_table(votes.path, (*COLUMNS, "own"), rows)
    before = votes.path.read_text(encoding="utf-8").splitlines()
    votes.vote(1, 1, "equal", 3.25)
    after = votes.path.read_text(encoding="utf-8").splitlines()
    assert [after[0], after[1], after[3]] == [before[0], before[1], before[3]]
    assert ";equal;3,25;" in after[2]
    assert after[2].endswith(";-2,5")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("jury,", "panel,"),
        ("\n1,", "\nx,"),
        (",,,\n1,Ärger,'-Which?,one gain,0,2", ",,,\n1,Ärger,'-Which?,one gain,0,2x"),
        ("c d.wav,'=cmd.wav,", "c d.wav,c d.wav,"),
        ("c d.wav,'=cmd.wav,", "c d.wav,'=cmd.wav,first"),
        (".wav,,,\n", ".wav,yes,,\n"),
    ],
)
def test_what_is_no_table_of_votes_is_refused_in_one_line(votes, old, new):
    text = votes.path.read_text(encoding="utf-8")
    assert old in text
    votes.path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(RecordingError) as told:
        votes.juries()
    assert "votes.csv" in str(told.value)
    assert "\n" not in str(told.value)


def test_a_table_that_cannot_be_written_keeps_its_votes(votes):
    before = votes.path.read_bytes()
    votes.path.parent.chmod(0o500)
    try:
        votes.vote(1, 0, "first", 1.0)
    except BushingNoiseError:
        assert votes.path.read_bytes() == before
    finally:
        votes.path.parent.chmod(0o700)
