"""A map refined along its boundaries, against the whole of it."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from noise.screening.map.mapping import interpolate_levels, refined_map


def brute(shape, code_at):
    points = np.argwhere(np.ones(shape, dtype=bool))
    return code_at(points).reshape(shape)


def counting(code_at):
    asked = []

    def simulate(points):
        asked.extend(map(tuple, points.tolist()))
        return code_at(points)

    return simulate, asked


@settings(max_examples=12)
@given(st.floats(8, 24), st.floats(25, 75), st.floats(9, 14), st.floats(18, 40))
def test_a_region_larger_than_the_coarse_cells_is_found_to_the_point(row, column, high, wide):
    def inside(points):
        place = ((points[:, 1] - row) / high) ** 2 + ((points[:, 2] - column) / wide) ** 2
        return (place < 1.0).astype(np.int64)

    simulate, asked = counting(inside)
    found = refined_map((1, 33, 101), simulate)
    wrong = found.codes != brute((1, 33, 101), inside)
    assert wrong.mean() < 0.005
    assert len(asked) == len(set(asked)) == np.sum(found.how == 0) < 1500
    assert found.open == 0


def test_a_stride_of_one_simulates_every_point():
    found = refined_map((2, 3, 7), lambda points: points[:, 2] % 2, stride=1)
    assert (found.how == 0).all()


def test_few_rows_tell_nothing_of_each_other():
    code_at = lambda points: (points[:, 1] == 1).astype(np.int64)  # noqa: E731
    found = refined_map((1, 3, 100), code_at)
    assert np.array_equal(found.codes, brute((1, 3, 100), code_at))


def test_stability_finds_a_slit_that_falls_between_the_corners():
    slit = lambda points: ((points[:, 2] > 18) & (points[:, 2] < 22)).astype(np.int64)  # noqa: E731
    shape = (1, 1, 65)
    missed = refined_map(shape, slit)
    seen = refined_map(shape, slit, quiet=[0], stable=brute(shape, slit) == 0)
    assert missed.codes.sum() == 0
    assert np.array_equal(seen.codes, brute(shape, slit))


def test_where_stability_tells_the_end_of_a_noise_it_is_not_simulated():
    end = lambda points: (points[:, 2] < 61).astype(np.int64)  # noqa: E731
    shape = (1, 1, 101)
    found = refined_map(shape, end, quiet=[0], stable=brute(shape, end) == 0)
    assert np.array_equal(found.codes, brute(shape, end))
    assert np.sum(found.how == 0) == 13  # the corners of the coarse cells
    assert np.sum(found.how == 1) > 30


def test_stability_that_is_wrong_costs_simulations_and_no_truth():
    # Stick-slip of a constant torque: stable everywhere, noisy below 40.
    end = lambda points: (points[:, 2] < 40).astype(np.int64)  # noqa: E731
    shape = (1, 1, 101)
    found = refined_map(shape, end, quiet=[0], stable=np.ones(shape, dtype=bool))
    assert np.array_equal(found.codes, brute(shape, end))


def test_with_a_budget_labels_go_first_and_what_is_open_is_counted():
    def code_at(points):  # a label on either side of a diagonal, and a regime every fifth column
        label = (points[:, 2] > 2 * points[:, 1] + 10).astype(np.int64)
        return label + 2 * (points[:, 2] // 5 % 2)

    shape = (1, 33, 101)
    simulate, asked = counting(code_at)
    found = refined_map(shape, simulate, label_of=np.array([0, 1, 0, 1]), most=450)
    assert len(asked) < 600
    assert found.open > 0
    assert np.mean(found.codes % 2 == brute(shape, code_at) % 2) > 0.97


@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 1, 2), (3, 1, 9), (1, 40, 1), (2, 9, 17)])
def test_maps_of_any_shape_are_filled(shape):
    found = refined_map(shape, lambda points: points.sum(axis=1) % 3)
    assert found.codes.shape == shape
    assert (found.codes >= 0).all()


def test_carried_values_stay_between_those_of_their_own_code():
    codes = np.array([[[0, 0, 0, 1, 1, 1]]])
    how = np.array([[[0, 2, 0, 0, 2, 0]]])
    filled = interpolate_levels(np.array([[[10.0, np.nan, 20.0, 70.0, np.nan, 90.0]]]), codes, how)
    assert filled[0, 0, 1] == pytest.approx(15.0)
    assert filled[0, 0, 4] == pytest.approx(80.0)
