"""What is said of votes that contradict each other, and of those that do not."""

from __future__ import annotations

import numpy as np
import pytest

from noise.app.jury.consistency import circular_triads, consistency
from noise.app.jury.order import Design, ordered_pairs
from noise.app.jury.votes import Vote


def rng():
    return np.random.default_rng(1)


def voted(n, choose, repeats=0.0):
    pairs = ordered_pairs(Design(n, n, repeats), rng())
    return [Vote(first, second, choose(first, second)) for first, second in pairs]


def by_number(first, second):
    return "first" if first > second else "second"


def test_circles_are_counted_as_by_hand():
    beats = np.zeros((5, 5), bool)
    for step in (1, 2):  # each over the next two: as many circles as five sounds can have
        beats |= np.roll(np.eye(5, dtype=bool), step, axis=1)
    assert circular_triads(beats) == (5, 10)
    votes = [Vote(*map(int, pair), "first") for pair in np.argwhere(beats)]
    assert consistency(5, votes, rng()).zeta == 0.0


def test_votes_by_an_order_have_no_circle_and_no_remark():
    found = consistency(10, voted(10, by_number, 0.2), rng())
    assert (found.circular, found.triads, found.zeta) == (0, 120, 1.0)
    assert (found.alike, found.repeats) == (9, 9)
    assert found.remarks == ()


def test_votes_by_tossing_a_coin_are_distrusted():
    coin = np.random.default_rng(2)
    found = consistency(10, voted(10, lambda *_: str(coin.choice(["first", "second"])), 0.4), rng())
    assert found.zeta < 0.4
    assert any("go in a circle" in text and "distrust" in text for text in found.remarks)


def test_a_favoured_side_is_said_and_repeats_show_it():
    found = consistency(9, voted(9, lambda *_: "first", 0.3), rng())
    assert (found.first, found.decided) == (47, 47)
    assert found.alike == 0
    assert any("repeated pairs" in text and "distrust" in text for text in found.remarks)
    assert any(text.startswith("the first of two was chosen in 47 of 47") for text in found.remarks)


def test_no_difference_decides_no_triad_and_favours_no_side():
    found = consistency(5, voted(5, lambda *_: "equal", 0.4), rng())
    assert (found.triads, found.zeta, found.decided) == (0, None, 0)
    assert (found.alike, found.repeats) == (4, 4)
    assert found.remarks == ()


@pytest.mark.parametrize("n", [3, 4])
def test_few_sounds_are_too_few_to_tell(n):
    circle = [Vote(0, 1, "first"), Vote(1, 2, "first"), Vote(2, 0, "first")]
    (remark,) = consistency(n, circle, rng()).remarks
    assert remark.endswith("too few to tell votes from chance")


@pytest.mark.slow
def test_a_careful_person_is_seldom_distrusted():
    chance, told = np.random.default_rng(3), 0
    for _ in range(100):
        values = chance.normal(scale=2.0, size=10)

        def choose(first, second, values=values):
            odds = 1.0 / (1.0 + np.exp(values[second] - values[first]))
            return "first" if chance.random() < odds else "second"

        told += any(
            "distrust" in text for text in consistency(10, voted(10, choose), rng()).remarks
        )
    assert told <= 10  # the side, by chance, in one of twenty
