"""Advice: what a change is said to bring is what it brings."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.errors import ParameterError
from models.rig_file import load_material_rig
from noise.screening.parts.advice import increase_margin, remove_noise
from noise.screening.parts.design_variable import DesignVariable
from sim.analysis.critical_damping import critical_damping, with_damping
from sim.analysis.critical_speeds import critical_speeds, regime_at
from sim.analysis.regime import Regime

VARIABLES = [DesignVariable("damping", 0.5, 2.0), DesignVariable("friction", 0.6, 1.2, cost=3.0)]
FIT, SUPPORT = 0.279e-3, 3745.0


def linear(slopes, offset=0.0):
    def margin(designs):
        return offset + designs @ np.array(slopes)

    return margin


@given(
    st.lists(st.floats(0.5, 50.0), min_size=2, max_size=2),
    st.lists(st.sampled_from([-1.0, 1.0]), min_size=2, max_size=2),
    st.floats(0.05, 20.0),
    st.floats(-5.0, 5.0),
)
def test_on_a_straight_margin_the_change_is_the_gain_over_the_slope(sizes, signs, gain, offset):
    slopes = dict(zip(("damping", "friction"), np.multiply(sizes, signs), strict=True))
    margin = linear(list(slopes.values()), offset)
    for advice in increase_margin(margin, VARIABLES, gain):
        variable = next(variable for variable in VARIABLES if variable.name == advice.name)
        slope = slopes[advice.name]
        room = variable.high - 1.0 if slope > 0.0 else 1.0 - variable.low
        assert advice.slope == pytest.approx(slope, rel=1e-6)
        assert advice.gain == pytest.approx(slope * advice.change, rel=1e-6)
        # The bracket is halved to a 256th of the way to the end of the range.
        resolution = room / 256.0
        if gain / abs(slope) < room - resolution:
            assert advice.enough
            assert advice.change * np.sign(slope) == pytest.approx(
                gain / abs(slope) + 0.5 * resolution, abs=0.51 * resolution
            )
        elif gain / abs(slope) > room + resolution:
            assert not advice.enough
            assert abs(advice.change) == pytest.approx(room)


@given(st.floats(0.55, 1.9), st.floats(0.5, 8.0))
def test_a_curved_margin_is_widened_by_what_was_asked(optimum, gain):
    def margin(designs):
        return -40.0 * (designs[:, 0] - optimum) ** 2

    [advice] = increase_margin(margin, VARIABLES[:1], gain)
    lost = 40.0 * (1.0 - optimum) ** 2
    ends = (VARIABLES[0].low, VARIABLES[0].high)
    tried = np.concatenate([np.linspace(1.0, end, 9) for end in ends])  # what is tried first
    if gain < lost - 40.0 * np.min((tried - optimum) ** 2):
        assert advice.enough
        assert gain <= advice.gain <= lost
        assert advice.change * (optimum - 1.0) > 0.0
    if gain > lost:
        assert not advice.enough


def test_the_cheapest_sufficient_change_stands_first():
    found = increase_margin(linear([1.0, -2.0]), VARIABLES, 0.3)
    assert [advice.name for advice in found] == ["damping", "friction"]
    assert found[0].change > found[1].change
    assert found[0].cost < found[1].cost == pytest.approx(3.0 * 0.15, rel=0.02)


def test_a_budget_limits_what_is_tried():
    seen = []

    def margin(designs):
        seen.append(designs.copy())
        return designs.sum(axis=1)

    found = {one.name: one for one in increase_margin(margin, VARIABLES, 0.4, budget=0.3)}
    tried = np.vstack(seen)
    assert np.abs(tried[:, 0] - 1.0).max() <= 0.3 + 1e-12
    assert np.abs(tried[:, 1] - 1.0).max() <= 0.1 + 1e-12
    assert not found["damping"].enough
    assert found["damping"].value == pytest.approx(1.3)
    assert all(one.cost <= 0.3 + 1e-12 for one in found.values())


def test_one_parameter_is_changed_at_a_time():
    def margin(designs):
        assert ((designs != 1.0).sum(axis=1) <= 1).all()
        return designs[:, 0]

    increase_margin(margin, VARIABLES, 0.1)


def test_an_island_is_not_steady():
    def margin(designs):
        return np.where(np.abs(designs[:, 0] - 1.25) < 0.03, 5.0, 0.0)

    [advice] = increase_margin(margin, VARIABLES[:1], 1.0)
    assert advice.enough
    assert not advice.steady
    assert abs(advice.value - 1.25) < 0.03


def test_of_two_ways_the_smaller_change_is_advised():
    def margin(designs):
        return np.where((designs[:, 0] < 0.8) | (designs[:, 0] > 1.3), 1.0, 0.0)

    [advice] = increase_margin(margin, VARIABLES[:1], 1.0)
    assert advice.value == pytest.approx(0.8, abs=0.01)


def test_a_margin_without_end_is_enough():
    def margin(designs):
        return np.where(designs[:, 0] > 1.4, np.inf, 0.0)

    [advice] = increase_margin(margin, VARIABLES[:1], 1.0)
    assert advice.gain == np.inf
    assert advice.value == pytest.approx(1.4, abs=0.01)


def test_the_change_that_ends_a_noise_is_the_smallest():
    def label(designs):
        return np.where(
            designs[:, 0] < 1.37, "creak", np.where(designs[:, 0] < 1.7, "squeal", "none")
        )

    [creak] = remove_noise(label, VARIABLES[:1], {"creak"})
    assert (creak.label, creak.enough) == ("squeal", True)
    assert creak.value == pytest.approx(1.37, abs=1.0 / 256.0)
    [every] = remove_noise(label, VARIABLES[:1], {"creak", "squeal"})
    assert every.label == "none"
    assert every.value == pytest.approx(1.7, abs=1.0 / 256.0)
    [never] = remove_noise(lambda designs: ["creak"] * len(designs), VARIABLES[:1], {"creak"})
    assert (never.enough, never.label, never.change) == (False, "creak", 0.0)


def test_a_silent_design_needs_no_change():
    found = remove_noise(lambda designs: ["none"] * len(designs), VARIABLES, {"creak"})
    assert {(one.change, one.enough, one.steady) for one in found} == {(0.0, True, True)}


@pytest.mark.parametrize(
    ("low", "high", "options", "message"),
    [
        (1.1, 2.0, {}, "holds the nominal value 1"),
        (0.5, np.inf, {}, "holds the nominal value 1"),
        (1.0, 1.0, {}, "holds the nominal value 1"),
        (-1.0, 1.0, {"nominal": 0.0}, "must not be 0"),
        (0.5, 2.0, {"cost": -1.0}, "cost = -1"),
    ],
)
def test_a_lever_that_cannot_be_is_refused_by_name(low, high, options, message):
    with pytest.raises(ParameterError, match=f"design variable damping: .*{message}"):
        DesignVariable("damping", low, high, **options)


def test_what_cannot_be_asked_is_refused():
    with pytest.raises(ParameterError, match="gain = 0"):
        increase_margin(linear([1.0, 1.0]), VARIABLES, 0.0)
    with pytest.raises(ParameterError, match="budget = 0"):
        increase_margin(linear([1.0, 1.0]), VARIABLES, 1.0, budget=0.0)
    with pytest.raises(ParameterError, match="no design variable"):
        increase_margin(linear([1.0, 1.0]), [], 1.0)
    with pytest.raises(ParameterError, match="nothing to widen"):
        increase_margin(lambda designs: np.full(len(designs), np.inf), VARIABLES, 1.0)
    with pytest.raises(ParameterError, match="not a number"):
        increase_margin(lambda designs: np.full(len(designs), np.nan), VARIABLES, 1.0)
    with pytest.raises(ParameterError, match="results of shape"):
        increase_margin(lambda designs: designs, VARIABLES, 1.0)
    with pytest.raises(ParameterError, match="no noise"):
        remove_noise(lambda designs: ["none"] * len(designs), VARIABLES, set())


def changed(rig, *, damping=1.0, stiffness=1.0, drop=1.0):
    """Rig with a factor on each damping, stiffness, and excess of static friction."""
    return replace(
        rig,
        fits=tuple(
            replace(
                fit,
                damping={support: damping * c for support, c in fit.damping.items()},
                elastomer_stiffness=stiffness * fit.elastomer_stiffness,
                critical_torque=fit.kinetic_torque
                + drop * (fit.critical_torque - fit.kinetic_torque),
            )
            for fit in rig.fits
        ),
    )


def boundary(rig, step, seconds=1.0):
    """Last speed that vibrates, of speeds `step` apart."""
    speeds = [step * i for i in range(1, round(13.0 / step) + 1)]
    return critical_speeds(rig, FIT, SUPPORT, speeds, seconds=seconds).v_crit2


def moved_as_predicted(rig, variables, gain, step, seconds=1.0):
    """Each advice with the move of the boundary that follows when it is made, judged anew."""
    names = [variable.name for variable in variables]

    def margin(designs):
        rigs = [changed(rig, **dict(zip(names, row, strict=True))) for row in designs]
        return [-boundary(one, step, seconds) for one in rigs]

    fine = 0.5 * step
    before = boundary(rig, fine)
    advice = increase_margin(margin, variables, gain)
    return [(one, before - boundary(changed(rig, **{one.name: one.value}), fine)) for one in advice]


@pytest.mark.slow
def test_the_advised_change_made_moves_the_boundary_as_predicted():
    rig = load_material_rig("fluorocarbon-thesis")
    variables = [
        DesignVariable("damping", 0.5, 2.0),
        DesignVariable("stiffness", 0.6, 1.6),
        DesignVariable("drop", 0.4, 1.3),
    ]
    found = moved_as_predicted(rig, variables, 1.5, step=0.1)
    assert all(advice.enough for advice, _ in found)
    for advice, moved in found:
        assert moved == pytest.approx(advice.gain, rel=0.2)


@pytest.mark.slow
def test_advice_holds_for_a_contact_with_memory():
    rig = load_material_rig("fluorocarbon")
    variables = [DesignVariable("damping", 0.7, 1.5), DesignVariable("drop", 0.6, 1.2)]
    found = moved_as_predicted(rig, variables, 2.0, step=0.25, seconds=0.7)
    assert all(advice.enough for advice, _ in found)
    for advice, moved in found:
        assert moved == pytest.approx(advice.gain, rel=0.2)


def test_the_damping_that_ends_stick_is_the_critical_damping():
    rig = load_material_rig("fluorocarbon-thesis")
    speed, nominal = 7.5, 0.06

    def label(designs):
        regimes = [regime_at(with_damping(rig, c), speed, FIT, SUPPORT) for [c] in designs]
        return ["creak" if regime is Regime.STICK_SLIP else "none" for regime in regimes]

    [advice] = remove_noise(
        label, [DesignVariable("damping", 0.05, 0.1, nominal=nominal)], {"creak"}
    )
    critical = critical_damping(
        rig, speed, interference=FIT, support_stiffness=SUPPORT, highest=0.1
    )
    assert advice.enough
    assert advice.value == pytest.approx(critical, abs=0.04 / 256.0)
