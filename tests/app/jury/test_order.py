"""The order of comparisons: every pair, both sides, no sound twice in a row."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components

from noise.app.jury.order import Design, ordered_pairs


def drawn(*design, seed=1):
    return ordered_pairs(Design(*design), np.random.default_rng(seed))


@pytest.mark.parametrize("n", [2, 3, 6, 11])
def test_every_pair_comes_once(n):
    pairs = {frozenset(pair) for pair in drawn(n, n, 0.0)}
    assert len(pairs) == n * (n - 1) // 2 == len(drawn(n, n, 0.0))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("n", "each"), [(5, 4), (8, 7), (12, 11), (20, 8), (31, 6)])
def test_sides_are_balanced_and_no_sound_comes_twice_in_a_row(n, each, seed):
    order = drawn(n, each, 0.0, seed=seed)
    firsts, seconds = (np.bincount(side, minlength=n) for side in zip(*order, strict=True))
    assert abs(firsts - seconds).max() <= 1
    assert all(set(one).isdisjoint(other) for one, other in pairwise(order))


@pytest.mark.parametrize(("n", "each"), [(9, 2), (20, 5), (40, 12)])
def test_fewer_pairs_join_all_sounds_and_compare_them_equally_often(n, each):
    order = drawn(n, each, 0.0)
    met = np.zeros((n, n))
    met[tuple(np.transpose(order))] = 1
    assert connected_components(met, directed=False)[0] == 1
    assert len(order) == Design(n, each, 0.0).pairs < n * (n - 1) // 2
    assert set(np.bincount(np.ravel(order))) == {each - each % 2}


def test_repeats_come_with_sides_changed_in_the_second_half():
    order = drawn(10, 9, 0.2)
    assert len(order) == 45 + 9
    seen, again = [], []
    for place, pair in enumerate(order):
        if pair[::-1] in seen:
            again.append(place)
        assert pair not in seen
        seen.append(pair)
    assert len(again) == 9
    assert min(again) >= 22


def test_the_same_seed_gives_the_same_order():
    assert drawn(9, 8, 0.2) == drawn(9, 8, 0.2) != drawn(9, 8, 0.2, seed=2)
