"""How an elastomer's rates, stiffness and damping follow the temperature, and what files say."""

import pytest
from hypothesis import given, strategies as st

from models.bushing import TemperatureDependence

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


@given(GLASS, st.floats(0.0, 100.0))
def test_below_the_glass_transition_it_is_held(glass, below):
    rubber = TemperatureDependence(glass + 43.0, glass)
    for factor in (rubber.log_shift, rubber.stiffness_factor, rubber.damping_factor):
        assert factor(glass - below) == factor(glass)
