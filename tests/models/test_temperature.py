"""How an elastomer's rates, stiffness and damping follow the temperature, and what files say."""

import math

import pytest
from hypothesis import given, strategies as st

from models.bushing import TemperatureDependence
from models.rig_file import load_material_rig

GLASS = st.floats(-120.0, 20.0)
ABOVE = st.floats(0.5, 200.0)


@given(GLASS, ABOVE)
def test_at_the_reference_temperature_nothing_is_shifted(glass, above):
    rubber = TemperatureDependence(glass + above, glass)
    here = rubber.reference
    assert rubber.log_shift(here) == 0.0
    assert rubber.damping_factor(here) == 1.0
    assert rubber.stiffness_factor(here) == pytest.approx(1.0, rel=1e-15)


@given(GLASS, ABOVE, st.floats(0.0, 200.0), st.floats(0.1, 100.0))
def test_warmth_shifts_rates_down_and_takes_damping_away(glass, reference, above, more):
    rubber = TemperatureDependence(glass + reference, glass, exponent=0.5)
    cold, warm = glass + above, glass + above + more
    assert rubber.log_shift(warm) < rubber.log_shift(cold)
    if warm < rubber.range[1]:  # beyond, entropy outgrows what the rates lose
        assert rubber.damping_factor(warm) < rubber.damping_factor(cold)


@given(GLASS, ABOVE, st.floats(0.5, 90.0), st.floats(0.5, 90.0))
def test_numbers_given_at_another_temperature_depend_as_before(glass, reference, between, last):
    rubber = TemperatureDependence(glass + reference, glass, friction_peak=1.8)
    between, last = glass + between, glass + last
    again = rubber.given_at(between)
    for factor in ("stiffness_factor", "damping_factor"):
        ways = getattr(rubber, factor)(between) * getattr(again, factor)(last)
        assert ways == pytest.approx(getattr(rubber, factor)(last))


@given(GLASS)
def test_williams_landel_and_ferry_have_nearly_nine_decades_to_the_glass(glass):
    rubber = TemperatureDependence(glass + 50.0, glass)
    assert rubber.log_shift(glass) == pytest.approx(8.86 * 50.0 / 51.6)


@given(GLASS, st.floats(0.0, 100.0))
def test_below_the_glass_transition_it_is_held(glass, below):
    rubber = TemperatureDependence(glass + 43.0, glass)
    for factor in (rubber.log_shift, rubber.stiffness_factor, rubber.damping_factor):
        assert factor(glass - below) == factor(glass)


def test_far_from_the_glass_stiffness_is_of_entropy_and_towards_it_rises():
    rubber = TemperatureDependence(23.0, -20.0)
    assert rubber.stiffness_factor(120.0) > rubber.stiffness_factor(60.0)
    assert rubber.stiffness_factor(120.0) < 393.15 / 296.15
    assert rubber.stiffness_factor(-20.0) > rubber.stiffness_factor(0.0) > 1.3


def test_the_loss_factor_of_the_model_is_that_of_the_fitted_damping():
    rig, first = load_material_rig("fluorocarbon"), 2.0 * math.pi * 250.0
    rubber, fit = rig.temperature, rig.fit(0.279e-3)
    model = rubber.stiffening * math.tan(0.5 * math.pi * rubber.exponent) / (1 + rubber.stiffening)
    fitted = rig.elastomer_damping_share * fit.damping[2214.0] * first / fit.elastomer_stiffness
    assert model == pytest.approx(fitted, rel=0.5)
