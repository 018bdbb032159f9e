"""Sobol' indices against closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy import stats

from models.errors import ParameterError
from noise.screening.parts.robustness import sobol_indices

ANGLES = {f"x{i}": stats.uniform(-np.pi, 2.0 * np.pi) for i in (1, 2, 3)}
WEIGHTS = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0])
SHARES = {f"x{i}": stats.uniform() for i in range(len(WEIGHTS))}


def ishigami(x):
    """T. Ishigami, T. Homma (1990), with a = 7 and b = 0.1."""
    return np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def ishigami_indices():
    own = 0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 7.0**2 / 8.0, 0.0
    together = 8.0 * 0.1**2 * np.pi**8 / 225.0
    first = np.array(own) / (sum(own) + together)
    return first, first + np.array([1.0, 0.0, 1.0]) * together / (sum(own) + together)


def sobol_g(x):
    """I. M. Sobol' (1998)."""
    return np.prod((np.abs(4.0 * x - 2.0) + WEIGHTS) / (1.0 + WEIGHTS), axis=1)


def sobol_g_indices():
    own = 1.0 / 3.0 / (1.0 + WEIGHTS) ** 2
    variance = np.prod(1.0 + own) - 1.0
    return own / variance, own * np.prod(1.0 + own) / (1.0 + own) / variance


FORMS = [(ishigami, ANGLES, ishigami_indices()), (sobol_g, SHARES, sobol_g_indices())]


def in_order(found):
    return sorted(found, key=lambda index: index.name)


@pytest.mark.parametrize(("form", "distributions", "exact"), FORMS)
def test_indices_are_those_of_the_closed_form(form, distributions, exact):
    found = in_order(sobol_indices(form, distributions, np.random.default_rng(0), samples=4096))
    np.testing.assert_allclose([one.first.value for one in found], exact[0], atol=0.03)
    np.testing.assert_allclose([one.total.value for one in found], exact[1], atol=0.03)


@pytest.mark.slow
@pytest.mark.parametrize(("form", "distributions", "exact"), FORMS)
def test_intervals_hold_the_closed_form_as_often_as_they_state(form, distributions, exact):
    repeats = 40
    held = np.zeros((2, len(distributions)))
    for seed in range(repeats):
        found = in_order(
            sobol_indices(form, distributions, np.random.default_rng(seed), samples=256)
        )
        for i, one in enumerate(found):
            held[0, i] += one.first.low <= exact[0][i] <= one.first.high
            held[1, i] += one.total.low <= exact[1][i] <= one.total.high
    assert held.min() >= stats.binom.ppf(0.001, repeats, 0.95)
    assert held.mean() >= 0.93 * repeats


def test_more_samples_make_narrower_intervals():
    few, many = (
        sobol_indices(ishigami, ANGLES, np.random.default_rng(2), samples=n) for n in (128, 2048)
    )
    assert max(one.total.half_width for one in many) < max(one.total.half_width for one in few) / 2


def test_what_matters_most_stands_first():
    def output(x):
        return x[:, 0] + 5.0 * x[:, 1] + 2.0 * x[:, 2]

    found = sobol_indices(output, ANGLES, np.random.default_rng(0))
    assert [one.name for one in found] == ["x2", "x3", "x1"]


@settings(max_examples=15)
@given(st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=3), st.integers(0, 100))
def test_without_interaction_first_and_total_agree(weights, seed):
    variance = np.square(weights) + 1e-300
    if variance.sum() < 0.01:
        return
    found = sobol_indices(
        lambda x: x @ np.array(weights), ANGLES, np.random.default_rng(seed), samples=1024
    )
    for index in found:
        exact = variance[int(index.name[1]) - 1] / variance.sum()
        assert index.total.value == pytest.approx(exact, abs=0.1)
        assert index.first.value == pytest.approx(exact, abs=0.15)


@pytest.mark.slow
@given(st.floats(-1e3, 1e3), st.floats(0.1, 1e3))
@settings(max_examples=10)
def test_the_unit_of_the_output_does_not_matter(offset, scale):
    plain, changed = (
        sobol_indices(output, ANGLES, np.random.default_rng(0), samples=64)
        for output in (ishigami, lambda x: offset + scale * ishigami(x))
    )
    for one, other in zip(in_order(plain), in_order(changed), strict=True):
        assert other.total.value == pytest.approx(one.total.value, abs=1e-6)
        assert other.first.value == pytest.approx(one.first.value, abs=1e-6)


def test_nothing_matters_to_what_does_not_vary():
    found = sobol_indices(lambda x: np.full(len(x), 4.0), ANGLES, np.random.default_rng(0))
    assert {(one.first.value, one.total.value, one.total.high) for one in found} == {(0, 0, 0)}


@pytest.mark.parametrize("options", [{"samples": 100}, {"samples": 32}, {"confidence": 0.0}])
def test_what_cannot_be_used_is_refused(options):
    with pytest.raises(ParameterError, match="power of two"):
        sobol_indices(ishigami, ANGLES, np.random.default_rng(0), **options)


def test_an_infinite_output_is_refused():
    with pytest.raises(ParameterError, match="finite numbers"):
        sobol_indices(lambda x: np.full(len(x), np.inf), ANGLES, np.random.default_rng(0))
