"""How much closes, with what certainty; and what fits say of which cause it is."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from noise.diagnosis.closing import Scores, closed_interval, closed_share
from noise.diagnosis.fit_evidence import gaps_left, reranked
from noise.diagnosis.pattern_search import pattern_search

squares = st.lists(st.floats(0.2, 400.0), min_size=1, max_size=6).map(np.array)


@given(squares, st.floats(0.0, 1.0))
def test_an_interval_holds_its_share(before, kept):
    after = before * kept
    share = closed_share(before, after)
    interval = closed_interval(Scores(before, before, after))
    assert (share is None) == (interval is None)
    if share is not None:
        low, high = interval
        assert low <= 1.0 <= high
        assert share <= high


def test_more_recordings_make_an_interval_narrower():
    few, many = (
        closed_interval(Scores(np.full(n, 25.0), np.full(n, 20.0), np.full(n, 1.0)))
        for n in (1, 16)
    )
    assert many[1] - many[0] < few[1] - few[0]


def test_nothing_closes_where_there_is_no_gap():
    assert closed_share(np.ones(3), np.ones(3)) is None
    assert closed_interval(Scores(np.ones(3), np.ones(3), np.ones(3))) is None


def test_the_cause_that_leaves_less_gains_and_the_rest_stays():
    first = {"clipping": 0.45, "gain_error": 0.45, "none": 0.05, "unknown": 0.05}
    scores = {
        name: Scores(np.full(2, 16.0), np.full(2, 16.0), np.full(2, left))
        for name, left in (("clipping", 9.0), ("gain_error", 0.5))
    }
    gaps = gaps_left(scores)
    assert gaps == {"clipping": 3.0, "gain_error": 1.0}
    again = reranked(first, gaps)
    assert again["gain_error"] > 2.0 * again["clipping"]
    assert (again["none"], again["unknown"]) == (0.05, 0.05)
    assert sum(again.values()) == pytest.approx(1.0)
    assert reranked(first, gaps, 0.0) == pytest.approx(first)


def test_a_search_walks_over_steps_and_stays_within_what_is_finite():
    def cost(x):
        return float("inf") if x[0] > 2.0 else float(np.floor(10.0 * abs(x[0] - 1.6)) + abs(x[1]))

    found, least = pattern_search(cost, np.array([0.0, 0.5]), np.array([0.5, 0.0]), (1.0, 0.5, 0.2))
    assert found[0] == pytest.approx(1.6, abs=0.11)
    assert found[1] == 0.5
    assert least < 2.0
