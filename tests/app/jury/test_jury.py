"""Juries: votes in their table at once and whole; the scale against published values."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest

from models.errors import ParameterError, RecordingError
from noise.app.jury import COLUMNS, Jury, Votes, bradley_terry, random_pairs, scale
from noise.base.tables import read_table

NAMES = ["=cmd.wav", "<img src=x onerror=alert(1)>.wav", "c d.wav"]
ABOUT = {"listener": "Ärger", "question": "-Which?", "played": "one gain", "seed": 0}

BASEBALL = [
    (0, 7, 9, 7, 7, 9, 11), (6, 0, 7, 5, 11, 9, 9), (4, 6, 0, 7, 7, 8, 12), (6, 8, 6, 0, 6, 7, 10),
    (6, 2, 6, 7, 0, 7, 12), (4, 4, 5, 6, 6, 0, 6), (2, 4, 1, 3, 1, 7, 0),
]  # fmt: skip
"""Wins of the American League's eastern division, 1987 (A. Agresti, Categorical Data Analysis)."""

AGRESTI = (1.58, 1.44, 1.29, 1.25, 1.11, 0.68, 0.0)
"""Their published values, that of the last team being zero."""


@pytest.fixture
def votes(tmp_path):
    table = Votes(tmp_path / "votes.csv")
    table.begin(NAMES, **ABOUT)
    return table


def test_a_jury_is_in_the_table_from_its_beginning_with_all_pairs_in_random_order(votes):
    jury = votes.jury(1)
    assert {frozenset(pair) for pair in jury.pairs} == set(map(frozenset, combinations(NAMES, 2)))
    assert (jury.waiting, jury.votes, jury.question) == (0, (), "-Which?")
    text = votes.path.read_text(encoding="utf-8")
    assert "'=cmd.wav" in text  # no spreadsheet takes it for a formula
    assert text.splitlines()[0] == ",".join(COLUMNS)
    orders = {votes.begin(NAMES, **ABOUT).pairs for _ in range(8)}
    assert len(orders) > 4


@pytest.mark.parametrize("count", [4, 5, 9])
def test_fewer_comparisons_than_pairs_still_join_all_sounds(count):
    for seed in range(20):
        pairs = random_pairs("abcde", np.random.default_rng(seed), count)
        assert len({frozenset(pair) for pair in pairs}) == count
        rows = scale(Jury(1, "", "?", "one gain", tuple(pairs), ("first",) * count))
        assert all(row["value"] is not None for row in rows)
    with pytest.raises(ParameterError, match="need 4 to 10"):
        random_pairs("abcde", np.random.default_rng(0), 3)


def test_each_vote_is_in_the_table_at_once(votes):
    votes.vote(1, 0, "second", 3.14159)
    rows = read_table(votes.path)[1]
    assert [row["vote"] for row in rows] == ["second", "", ""]
    assert rows[0]["seconds"] == "3.14"
    again = Votes(votes.path)  # as after a new start
    assert again.vote(1, 1, "equal", 1.0).votes == ("second", "equal")


@pytest.mark.parametrize(
    ("number", "place", "vote"), [(1, 1, "first"), (1, 3, "first"), (1, 0, "a"), (2, 0, "first")]
)
def test_a_vote_that_is_not_asked_for_changes_nothing(votes, number, place, vote):
    before = votes.path.read_bytes()
    with pytest.raises(ParameterError):
        votes.vote(number, place, vote, 1.0)
    assert votes.path.read_bytes() == before


def test_juries_do_not_touch_each_other_and_columns_of_ones_own_stay(votes):
    head, *lines = votes.path.read_text(encoding="utf-8").splitlines()
    remarked = "\n".join([f"{head},remark", *(f"{line},mine" for line in lines)])
    votes.path.write_text(remarked, encoding="utf-8")
    votes.vote(1, 0, "first", 1.0)
    votes.vote(votes.begin(NAMES, **ABOUT).number, 0, "equal", 1.0)
    assert [jury.votes for jury in votes.juries()] == [("first",), ("equal",)]
    assert [row["remark"] for row in read_table(votes.path)[1]] == ["mine"] * 3 + [""] * 3


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("jury,", "panel,"), ("\n1,", "\nx,"), ("one gain,0,2", "one gain,0,2x"),
        (".wav,,,\n", ".wav,yes,,\n"), ("'=cmd.wav", "c d.wav"),
    ],
)  # fmt: skip
def test_what_is_no_table_of_votes_is_refused_in_one_line(votes, old, new):
    text = votes.path.read_text(encoding="utf-8")
    assert old in text
    votes.path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(RecordingError, match=r"votes\.csv.*") as refused:
        votes.juries()
    assert "\n" not in str(refused.value)


def test_published_values_come_out_of_published_votes():
    found = bradley_terry(100.0 * np.array(BASEBALL))  # so many that what is added is nothing
    assert found.mean() == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(found - found[-1], AGRESTI, atol=0.006)


def jury_of(n, votes):
    """A jury whose votes are pairs of numbers, the one that was chosen first."""
    names = [f"{number}.wav" for number in range(n)]
    pairs = [(names[a], names[b]) for a, b in votes] + list(combinations(names, 2))
    return Jury(1, "", "?", "one gain", tuple(pairs), ("first",) * len(votes))


def test_a_sound_that_never_lost_has_a_finite_value_and_no_vote_none():
    rows = scale(jury_of(4, [(0, 1), (0, 2), (1, 2), (2, 1)]))
    assert [row["sound"] for row in rows] == ["0.wav", "1.wav", "2.wav", "3.wav"]
    assert all(math.isfinite(row["value"]) for row in rows[:3])
    assert rows[3]["value"] is rows[3]["low_95"] is None


def test_a_known_scale_lies_within_its_intervals_in_19_of_20():
    rng = np.random.default_rng(5)
    held = []
    for _ in range(40):
        true = rng.normal(size=6)
        true -= true.mean()
        pairs = list(combinations(range(6), 2)) * 2
        votes = [
            (a, b) if rng.random() < 1.0 / (1.0 + math.exp(true[b] - true[a])) else (b, a)
            for a, b in pairs
        ]
        for row in scale(jury_of(6, votes)):
            value = true[int(row["sound"].partition(".")[0])]
            held.append(row["low_95"] - 0.005 <= value <= row["high_95"] + 0.005)
    assert 0.91 <= np.mean(held) <= 0.99
