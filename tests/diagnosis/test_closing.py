"""How much closes, and with what certainty."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, strategies as st

from noise.diagnosis.fit.closing import closed_interval, closed_share
from noise.diagnosis.fit.fit import pattern_search

squares = st.lists(st.floats(0.2, 400.0), min_size=1, max_size=6).map(np.array)


@given(squares, st.floats(0.0, 1.0))
def test_an_interval_holds_its_share(before, kept):
    after = before * kept
    share = closed_share(before, after)
    interval = closed_interval(before, after)
    assert (share is None) == (interval is None)
    if share is not None:
        low, high = interval
        assert low <= share <= high <= 1.0


def test_more_recordings_make_an_interval_narrower():
    few, many = (closed_interval(np.full(n, 25.0), np.full(n, 9.0)) for n in (1, 16))
    assert 0.0 < many[1] - many[0] < few[1] - few[0]


def test_both_ends_of_an_interval_follow_what_the_fit_leaves():
    before = np.full(3, 36.0)
    ends = [closed_interval(before, np.full(3, left)) for left in (30.0, 16.0, 4.0)]
    assert sorted(ends) == ends
    for (_, high), (low, _) in itertools.pairwise(ends):
        assert high < low


def test_nothing_closes_where_there_is_no_gap():
    assert closed_share(np.ones(3), np.ones(3)) is None
    assert closed_interval(np.ones(3), np.ones(3)) is None


def test_a_search_walks_over_steps_and_stays_within_what_is_finite():
    def cost(x):
        return float("inf") if x[0] > 2.0 else float(np.floor(10.0 * abs(x[0] - 1.6)) + abs(x[1]))

    found, least = pattern_search(cost, np.array([0.0, 0.5]), np.array([0.5, 0.0]), (1.0, 0.5, 0.2))
    assert found[0] == pytest.approx(1.6, abs=0.11)
    assert found[1] == 0.5
    assert least < 2.0
