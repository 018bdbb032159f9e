"""A map refined along its boundaries, against the whole of it."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from noise.screening.mapping import refined_map

NOISE = 3
"""Code of the first noise: below are silences of all regimes."""


def brute(shape, code_at):
    return code_at(np.argwhere(np.ones(shape, dtype=bool))).reshape(shape)


@settings(max_examples=12)
@given(st.floats(8, 24), st.floats(25, 75), st.floats(9, 14), st.floats(18, 40))
def test_a_region_larger_than_the_coarse_cells_is_found_to_the_point(row, column, high, wide):
    def inside(points):
        place = ((points[:, 1] - row) / high) ** 2 + ((points[:, 2] - column) / wide) ** 2
        return NOISE * (place < 1.0).astype(np.int64)

    found = refined_map((1, 33, 101), inside)
    assert (found.codes != brute((1, 33, 101), inside)).mean() < 0.005
    assert found.simulated.sum() < 1500
    assert found.open == 0


def test_instability_finds_a_slit_that_falls_between_the_corners():
    slit = lambda points: NOISE * ((points[:, 2] > 18) & (points[:, 2] < 22))  # noqa: E731
    shape = (1, 1, 65)
    assert refined_map(shape, slit).codes.sum() == 0
    seen = refined_map(shape, slit, grows=brute(shape, slit) > 0)
    assert np.array_equal(seen.codes, brute(shape, slit))


def test_stability_ends_no_noise_that_simulation_hears():
    end = lambda points: NOISE * (points[:, 2] < 61).astype(np.int64)  # noqa: E731
    shape = (1, 1, 101)
    found = refined_map(shape, end, grows=np.arange(101)[None, None] < 50)
    assert np.array_equal(found.codes, brute(shape, end))


def test_with_a_budget_silence_goes_first_and_what_is_open_is_counted():
    def code_at(points):  # silence on one side of a diagonal, and a regime every fifth column
        noisy = points[:, 2] > 2 * points[:, 1] + 10
        return np.where(noisy, NOISE + points[:, 2] // 5 % 2, 0)

    shape = (1, 33, 101)
    found = refined_map(shape, code_at, most=450)
    assert found.simulated.sum() < 600
    assert found.open > 0
    assert np.mean((found.codes > 0) == (brute(shape, code_at) > 0)) > 0.97


@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 1, 2), (3, 1, 9), (1, 40, 1), (2, 9, 17)])
def test_maps_of_any_shape_are_filled(shape):
    found = refined_map(shape, lambda points: points.sum(axis=1) % 3)
    assert found.codes.shape == shape
    assert (found.codes >= 0).all()
