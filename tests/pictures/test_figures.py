from __future__ import annotations

import numpy as np
from hypothesis import given, strategies as st

from models.drawing import thinned
from noise.pages.figures import COLUMNS


@given(st.integers(1, 4000), st.integers(0, 2**32 - 1))
def test_thinning_keeps_ends_order_and_extremes(size, seed):
    x, y = np.arange(float(size)), np.random.default_rng(seed).normal(size=size)
    kept_x, kept_y = thinned(x, y, columns=COLUMNS)
    assert np.all(np.diff(kept_x) > 0)
    assert (kept_x[0], kept_x[-1]) == (x[0], x[-1])
    assert (kept_y.min(), kept_y.max()) == (y.min(), y.max())
