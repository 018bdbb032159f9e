"""Blocks of errors keep their mean square, and resampling them covers the truth."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from hypothesis import given, strategies as st

from tests.studies.oscillator_terms.blocks import block_errors, cut, drawn_blocks


@given(st.integers(1, 20), st.integers(1, 10), st.integers(0, 2**31))
def test_whole_blocks_keep_the_mean_square(length, count, seed):
    errors = np.random.default_rng(seed).standard_normal(length * count)
    found = block_errors([errors], length)
    assert len(found.squares) == count
    np.testing.assert_allclose(found.rms, np.sqrt(np.mean(errors**2)))


@given(st.integers(0, 1000), st.integers(4, 1000), st.integers(2, 4))
def test_parts_of_a_span_are_the_span(start, length, parts):
    dealt = [spans[0] for spans in cut([(start, start + length)], parts)]
    assert dealt[0][0] == start
    assert dealt[-1][1] == start + length
    assert all(one[1] == other[0] for one, other in pairwise(dealt))


def test_nine_of_ten_intervals_hold_the_true_rms_of_correlated_errors():
    rng = np.random.default_rng(0)
    kernel = np.hanning(20)
    kernel /= np.linalg.norm(kernel)
    inside = 0
    for _ in range(300):
        errors = np.convolve(rng.standard_normal(60 * 200 + 19), kernel, "valid")
        found = block_errors([errors], 200)
        low, high = np.quantile(found.resampled(drawn_blocks(60, 400, rng)), (0.05, 0.95))
        inside += low <= 1.0 <= high
    assert 0.85 < inside / 300 < 0.95
