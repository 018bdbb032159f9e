"""Tolerances as distributions of factors, and quasi-random parts."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from noise.screening.design.tolerances import Tolerance
from noise.screening.parts.sampling import parts, sobol_points

PROBABILITIES = np.linspace(0.001, 0.999, 41)


def drawn(tolerance, nominal=1.0, n=2**15):
    points = sobol_points(1, np.random.default_rng(3)).random(n)
    return nominal * parts({tolerance.name: tolerance.factor(nominal)}, points)[:, 0]


@given(st.floats(0.001, 0.5), st.floats(1e-2, 1e4))
def test_relative_and_absolute_say_the_same(spread, nominal):
    relative = Tolerance("damping", "relative", spread).factor(nominal)
    absolute = Tolerance("damping", "absolute", spread * nominal).factor(nominal)
    np.testing.assert_allclose(relative.ppf(PROBABILITIES), absolute.ppf(PROBABILITIES), rtol=1e-8)


@given(st.floats(0.001, 0.5))
def test_quantiles_rise_through_the_nominal_value(spread):
    values = Tolerance("damping", "relative", spread).factor(1.0).ppf(PROBABILITIES)
    assert (np.diff(values) > 0.0).all()
    assert values[20] == pytest.approx(1.0)


def test_a_small_tolerance_is_a_standard_deviation():
    values = drawn(Tolerance("support_stiffness", "absolute", 20.0), 600.0)
    assert values.mean() == pytest.approx(600.0, abs=0.5)
    assert values.std() == pytest.approx(20.0, rel=0.01)


def test_limits_hold_all_parts_alike():
    values = drawn(Tolerance("damping", "limits", 0.8, 1.2))
    assert (values.min(), values.max()) == pytest.approx((0.8, 1.2), abs=1e-3)
    assert values.std() == pytest.approx(0.2 / np.sqrt(3.0), rel=0.01)


def test_a_wide_tolerance_stays_above_zero():
    values = drawn(Tolerance("damping", "relative", 0.5), 8.0)
    assert np.median(values) == pytest.approx(8.0, rel=0.01)
    assert values.std() / values.mean() == pytest.approx(0.5, rel=0.03)
    assert values.min() > 0.0


def test_a_tolerance_of_zero_does_not_vary():
    assert set(drawn(Tolerance("damping", "relative", 0.0))) == {1.0}


def test_a_temperature_varies_by_a_factor_on_the_absolute_one():
    values = 300.0 * Tolerance("temperature", "absolute", 3.0).factor(26.85).ppf(PROBABILITIES)
    assert values[20] == pytest.approx(300.0)
    assert np.std(drawn(Tolerance("temperature", "absolute", 3.0), 26.85)) / 26.85 == pytest.approx(
        0.01, rel=0.02
    )


def test_parts_follow_from_the_generator_alone():
    def points(seed):
        return sobol_points(3, np.random.default_rng(seed)).random(16)

    np.testing.assert_array_equal(points(1), points(1))
    assert (points(1) != points(2)).any()


def test_something_must_vary():
    with pytest.raises(ParameterError, match="at least one"):
        sobol_points(0, np.random.default_rng(0))
