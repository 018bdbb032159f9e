"""How parameters scatter, and quasi-random parts."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import stats

from models.errors import ParameterError
from noise.screening.parts.scatter import Scatter, Shape, names_of, parts, sobol_points

SHAPES = st.sampled_from(list(Shape))
PROBABILITIES = np.linspace(0.001, 0.999, 41)


def drawn(scatter, n=4096):
    points = sobol_points(1, np.random.default_rng(3)).random(n)
    return parts([scatter], points)[:, 0]


@given(SHAPES, st.floats(0.0, 0.15), st.floats(1e-4, 1e4))
def test_a_relative_spread_is_the_same_share_of_any_nominal_value(shape, spread, nominal):
    one = Scatter("k", shape, spread).quantile(PROBABILITIES)
    np.testing.assert_allclose(
        Scatter("k", shape, spread, nominal=nominal).quantile(PROBABILITIES), nominal * one
    )


@given(SHAPES, st.floats(0.001, 0.15), st.floats(1e-4, 1e4))
def test_relative_and_absolute_say_the_same(shape, spread, nominal):
    relative = Scatter("k", shape, spread, nominal=nominal)
    absolute = Scatter("k", shape, spread * nominal, nominal=nominal, relative=False)
    np.testing.assert_allclose(
        relative.quantile(PROBABILITIES), absolute.quantile(PROBABILITIES), rtol=1e-9
    )


@given(SHAPES, st.floats(0.001, 0.15))
def test_quantiles_rise_through_the_nominal_value(shape, spread):
    values = Scatter("k", shape, spread).quantile(PROBABILITIES)
    assert (np.diff(values) > 0.0).all()
    assert values[20] == pytest.approx(1.0)


def test_a_normal_spread_is_a_standard_deviation():
    values = drawn(Scatter("k", "normal", 20.0, nominal=600.0, relative=False))
    assert values.mean() == pytest.approx(600.0, abs=0.5)
    assert values.std() == pytest.approx(20.0, rel=0.01)


def test_inspection_cuts_a_normal_distribution():
    values = drawn(Scatter("k", "truncated-normal", 0.1, cut=1.5))
    reference = stats.truncnorm(-1.5, 1.5, loc=1.0, scale=0.1)
    assert 0.85 <= values.min() < 0.851
    assert 1.149 < values.max() <= 1.15
    assert values.std() == pytest.approx(reference.std(), rel=0.01)


def test_a_uniform_spread_is_half_the_width():
    values = drawn(Scatter("k", "uniform", 0.2))
    assert (values.min(), values.max()) == pytest.approx((0.8, 1.2), abs=1e-3)
    assert values.std() == pytest.approx(0.2 / np.sqrt(3.0), rel=0.01)


def test_a_lognormal_spread_is_the_standard_deviation_over_the_mean():
    values = drawn(Scatter("k", "lognormal", 0.5, nominal=8.0), 2**15)
    assert np.median(values) == pytest.approx(8.0, rel=0.01)
    assert values.std() / values.mean() == pytest.approx(0.5, rel=0.03)
    assert values.min() > 0.0


def test_parts_follow_from_the_generator_alone():
    def points(seed):
        return sobol_points(3, np.random.default_rng(seed)).random(16)

    np.testing.assert_array_equal(points(1), points(1))
    assert (points(1) != points(2)).any()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"shape": "triangular"}, "unknown shape 'triangular'"),
        ({"spread": -0.1}, "spread = -0.1"),
        ({"spread": float("nan")}, "spread = nan"),
        ({"spread": 0.2}, "reaches to zero"),
        ({"shape": "uniform", "spread": 1.0}, "reaches to zero"),
        ({"shape": "truncated-normal", "cut": 0.0}, "cut = 0"),
        ({"nominal": 0.0}, "nominal = 0"),
        ({"shape": "lognormal", "nominal": -1.0}, "above 0"),
    ],
)
def test_what_cannot_scatter_is_refused_by_name(options, message):
    given = {"shape": "normal", "spread": 0.1} | options
    with pytest.raises(ParameterError, match=f"scatter of damping: .*{message}"):
        Scatter("damping", **given)


def test_a_parameter_scatters_once():
    one = Scatter("damping", "normal", 0.1)
    assert names_of([one]) == ("damping",)
    with pytest.raises(ParameterError, match="damping is given twice"):
        names_of([one, one])
    with pytest.raises(ParameterError, match="at least one"):
        names_of([])
