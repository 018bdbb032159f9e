"""Steps of the Runge-Kutta pair against the orders that its author states."""

import math

import numpy as np
import pytest
from numba import njit

from sim.solvers.contact_rates import N_STAGES
from sim.solvers.tsitouras import NODES, factor_of_step, fill_between, fill_stage, step_error

BEGIN = np.array([1.0, 0.3, -0.5, 0.2])


def pendulums(t, u):
    """Two coupled pendulums, driven: four angles and speeds, nonlinear and dependent on time."""
    pull = 0.7 * math.sin(u[0] - u[2])
    return np.array([u[1], -math.sin(u[0]) - pull + 0.4 * math.cos(1.3 * t), u[3], pull - u[2]])


@njit
def fill(u, start, k, stage, h):  # which compiled code alone can call
    fill_stage(u, start, k, stage, h)


def step(start, t, h):
    """End of a step, and the rates at its stages."""
    k, u = np.zeros((4, N_STAGES)), np.zeros(4)
    for stage in range(N_STAGES):
        fill(u, start, k, stage, h)
        k[:, stage] = pendulums(t + NODES[stage] * h, u)
    return u, k


def steps(n, seconds):
    u = BEGIN
    for i in range(n):
        u, _ = step(u, i * seconds / n, seconds / n)
    return u


EXACT = steps(4000, 2.0)


def test_the_error_of_a_run_falls_with_the_fifth_power_of_the_step():
    errors = [np.abs(steps(n, 2.0) - EXACT).max() for n in (10, 20, 40)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert (orders > 4.7).all()


@pytest.mark.parametrize("share", [0.13, 0.5, 0.77])
def test_between_its_ends_a_step_is_of_fourth_order(share):
    errors = []
    for h in (0.4, 0.2, 0.1):
        u, weights = np.zeros(4), np.zeros(N_STAGES)
        _, k = step(BEGIN, 0.0, h)
        fill_between.py_func(u, BEGIN, k, weights, share, h)
        exact = BEGIN
        for i in range(20):
            exact, _ = step(exact, i * share * h / 20, share * h / 20)
        errors.append(np.abs(u - exact).max())
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert (orders > 4.5).all()  # a power more over one step than over a run


@pytest.mark.parametrize(("share", "stage"), [(0.0, 0), (1.0, N_STAGES - 1)])
def test_a_step_joins_the_next_in_value_and_slope(share, stage):
    end, k = step(BEGIN, 0.0, 0.3)
    u, near, weights = np.zeros(4), np.zeros(4), np.zeros(N_STAGES)
    fill_between.py_func(u, BEGIN, k, weights, share, 0.3)
    fill_between.py_func(near, BEGIN, k, weights, share + 1e-6, 0.3)
    assert u == pytest.approx(end if share else BEGIN, abs=1e-13)
    assert (near - u) / 0.3e-6 == pytest.approx(k[:, stage], abs=1e-5)


def test_the_error_that_is_told_falls_with_the_fifth_power_and_exceeds_the_true_one():
    told, true = [], []
    for h in (0.4, 0.2, 0.1):
        end, k = step(BEGIN, 0.0, h)
        exact = BEGIN
        for i in range(20):
            exact, _ = step(exact, i * h / 20, h / 20)
        told.append(step_error.py_func(k, h, BEGIN, end, 4, 1.0, 1.0))
        true.append(np.abs(end - exact).max())
    assert (np.log2(np.divide(told[:-1], told[1:])) > 4.7).all()
    assert np.greater(told, true).all()


def test_a_step_that_is_not_finite_has_an_infinite_error():
    end, k = step(BEGIN, 0.0, 0.1)
    k[2, 3] = math.nan
    assert step_error.py_func(k, 0.1, BEGIN, end, 4, 1.0, 1.0) == math.inf


@pytest.mark.parametrize("before", [1e-9, 0.1, 1.0])
def test_a_step_is_lengthened_by_little_error_and_shortened_by_much(before):
    errors = np.logspace(-12.0, 9.0, 43)
    factors = np.array([factor_of_step.py_func(error, before) for error in errors])
    for of in (factors[errors <= 1.0], factors[errors > 1.0]):
        assert (np.diff(of) <= 0.0).all()
    assert factors[0] > 1.0
    assert (factors[errors > 1.0] < 0.9).all()
    assert 0.0 < factor_of_step.py_func(math.inf, before) <= factors[-1]
