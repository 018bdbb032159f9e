"""The scale of votes: known values, limits, and how often its intervals hold."""

from __future__ import annotations

import math

import numpy as np
import pytest

from noise.app.jury.likelihood import Likelihood
from noise.app.jury.scale import scale
from noise.app.jury.votes import Vote

BASEBALL = {
    "Milwaukee": (0, 7, 9, 7, 7, 9, 11),
    "Detroit": (6, 0, 7, 5, 11, 9, 9),
    "Toronto": (4, 6, 0, 7, 7, 8, 12),
    "New York": (6, 8, 6, 0, 6, 7, 10),
    "Boston": (6, 2, 6, 7, 0, 7, 12),
    "Cleveland": (4, 4, 5, 6, 6, 0, 6),
    "Baltimore": (2, 4, 1, 3, 1, 7, 0),
}
"""Wins of the American League's eastern division, 1987 (A. Agresti, Categorical Data Analysis)."""

AGRESTI = (1.58, 1.44, 1.29, 1.25, 1.11, 0.68, 0.0)
"""Their published values, Baltimore's being zero."""


def votes_of(wins, times=1):
    return [
        Vote(one, other, "first")
        for one, row in enumerate(wins)
        for other, count in enumerate(row)
        for _ in range(count * times)
    ]


def random_votes(values, rng, ties=0.0, times=1):
    """Each pair so often, on sides by chance, by the model itself."""
    found = []
    for one in range(len(values)):
        for other in range(one):
            odds = np.array([0.5, -0.5]) * (values[one] - values[other])
            odds = np.array([*np.exp(odds), ties])
            said = rng.choice(["first", "second", "equal"], times, p=odds / odds.sum())
            found += [Vote(one, other, str(vote)) for vote in said]
    return found


def values(found):
    return np.array([one.value for one in found.sounds])


def test_published_values_come_out_of_published_votes():
    found = values(scale(list(BASEBALL), votes_of(BASEBALL.values(), times=100)))
    assert found.mean() == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(found - found[-1], AGRESTI, atol=0.006)


@pytest.mark.parametrize(("wins", "losses"), [(700, 300), (5000, 5000), (99, 1)])
def test_two_sounds_differ_by_the_logit_of_their_share(wins, losses):
    votes = [Vote(0, 1, "first")] * wins + [Vote(0, 1, "second")] * losses
    one, other = scale("ab", votes).sounds
    assert one.value == pytest.approx(-other.value)
    share = math.log((wins + 0.5) / (losses + 0.5))  # the half vote of Firth's correction
    assert one.value - other.value == pytest.approx(share, abs=1e-6)


def test_votes_for_no_difference_leave_the_share_of_the_decided():
    decided = [Vote(0, 1, "first")] * 30 + [Vote(0, 1, "second")] * 10
    found = [scale("ab", decided + [Vote(0, 1, "equal")] * n).sounds[0] for n in (0, 40)]
    assert found[1].value == pytest.approx(found[0].value, rel=0.02)  # what is decided decides
    tied = scale("ab", [Vote(0, 1, "equal")] * 10)
    assert [one.value for one in tied.sounds] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert tied.remarks == ("no sound was chosen over another, so nothing tells them apart",)


def test_sides_and_the_order_of_votes_do_not_matter():
    votes = random_votes([1.0, 0.0, -1.0, 0.3], np.random.default_rng(1), ties=0.3, times=2)
    mirror = {"first": "second", "second": "first", "equal": "equal"}
    turned = [Vote(vote.second, vote.first, mirror[vote.said]) for vote in reversed(votes)]
    np.testing.assert_allclose(values(scale("abcd", votes)), values(scale("abcd", turned)))


def test_turning_all_votes_turns_the_scale():
    votes = random_votes([1.0, 0.0, -1.0, 0.3], np.random.default_rng(2), times=2)
    turned = [Vote(vote.second, vote.first, vote.said) for vote in votes]
    one, other = (scale("abcd", of).sounds for of in (votes, turned))
    assert [a.value for a in one] == pytest.approx([-b.value for b in other], abs=1e-6)
    assert [a.low for a in one] == pytest.approx([-b.high for b in other], abs=1e-2)


@pytest.mark.parametrize("ties", [0.0, 0.4])
def test_the_slope_is_that_of_the_value(ties):
    rng = np.random.default_rng(3)
    pairs = np.array([[i, j] for i in range(5) for j in range(i)])
    counts = rng.integers(0, 3, (len(pairs), 3)) * [1.0, 1.0, ties]
    likelihood = Likelihood(5, pairs, counts)
    at = likelihood.free @ rng.normal(size=likelihood.free.shape[1])
    step = 1e-5 * likelihood.free.T
    by_steps = [(likelihood.value(at + d) - likelihood.value(at - d)) / 2e-5 for d in step]
    np.testing.assert_allclose(
        likelihood.free.T @ likelihood.value_and_slope(at)[1], by_steps, atol=1e-6
    )


def test_a_sound_that_never_lost_has_a_value_and_a_remark():
    votes = votes_of([(0, 1, 1, 1), (0, 0, 1, 1), (0, 1, 0, 1), (0, 0, 0, 0)])
    found = scale(["best", "b", "c", "<img onerror>"], votes)
    shown = values(found)
    assert np.isfinite(shown).all()
    assert shown[0] == shown.max()
    assert shown[3] == shown.min()
    assert any(text.startswith("chosen in all comparisons: best;") for text in found.remarks)
    assert any(text.startswith("never chosen: <img onerror>;") for text in found.remarks)


def test_two_that_beat_all_others_are_said_to_stand_apart_by_the_correction():
    both_ways = [(0, 1), (1, 0), (2, 3), (3, 2)]
    votes = [Vote(*pair, "first") for pair in (*both_ways, (0, 2), (0, 3), (1, 2), (1, 3))]
    (remark,) = scale("abcd", votes).remarks
    assert remark.startswith("no vote contradicts the order of 2 groups of sounds")
    assert scale("abcd", [*votes, Vote(2, 0, "first")]).remarks == ()


def test_groups_that_no_vote_joins_are_said():
    votes = [Vote(0, 1, "first"), Vote(1, 0, "first"), Vote(2, 3, "equal"), Vote(3, 4, "first")]
    found = scale("abcdef", votes)
    assert [one.group for one in found.sounds[:5]] == [1, 1, 0, 0, 0]
    assert found.sounds[5].value is None
    assert any("no vote joins these 2 groups" in text for text in found.remarks)
    assert any(text.endswith("not on the scale: f") for text in found.remarks)


def test_no_votes_give_no_values():
    found = scale("abc", [])
    assert [one.value for one in found.sounds] == [None] * 3
    assert found.remarks == ()


@pytest.mark.parametrize(
    ("n", "ties", "times", "juries"),
    [
        (5, 0.0, 3, 40),
        pytest.param(6, 0.3, 1, 400, marks=pytest.mark.slow),
        pytest.param(8, 0.0, 1, 300, marks=pytest.mark.slow),
        pytest.param(10, 0.5, 1, 200, marks=pytest.mark.slow),
    ],
)
def test_a_known_scale_lies_within_its_intervals_in_19_of_20(n, ties, times, juries):
    rng = np.random.default_rng(n)
    held = []
    for _ in range(juries):
        true = rng.normal(size=n)
        true -= true.mean()
        found = scale([""] * n, random_votes(true, rng, ties, times)).sounds
        held += [one.low <= value <= one.high for one, value in zip(found, true, strict=True)]
    assert 0.93 <= np.mean(held) <= 0.985
