"""Risk numbers and the ranking of designs."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy import stats

from models.errors import ParameterError
from models.rig_file import load_material_rig
from noise.screening.parts.estimate import Estimate
from noise.screening.parts.probability import label_probabilities
from noise.screening.ranking.risk import Candidate, design_risk, ranked, risk_band, risk_grades
from sim.analysis.critical_damping import with_damping
from sim.analysis.critical_speeds import critical_speeds
from sim.analysis.sweep import sweep

ACCELERATIONS = st.floats(0.0, 1e5)
RATES = st.floats(0.0, 1e5)
RATIOS = st.floats(1.0, 10.0)


def sure(probability):
    return Estimate(probability, probability, probability)


def places(*candidates):
    return ranked(candidates)


@settings(max_examples=50)
@given(ACCELERATIONS, RATES, RATIOS, st.floats(1.0, 10.0))
def test_whatever_grows_the_grade_does_not_fall(acceleration, rate, ratio, factor):
    grade = risk_grades(acceleration, rate, ratio)
    assert 1.0 <= grade <= 10.0 + 1e-9
    assert risk_grades(acceleration * factor, rate, ratio) >= grade
    assert risk_grades(acceleration, rate * factor, ratio) >= grade
    assert risk_grades(acceleration, rate, ratio * factor) >= grade


@given(RATIOS)
def test_what_does_not_vibrate_is_no_risk_whatever_its_friction(ratio):
    assert risk_band(design_risk(risk_grades(0.0, 0.0, ratio))) == "no risk"


@settings(max_examples=50)
@given(st.floats(300.0, 1e4), st.floats(100.0, 1e4), RATIOS)
def test_hard_and_frequent_blows_are_not_free_of_risk_whatever_the_friction(
    acceleration, rate, ratio
):
    assert risk_band(design_risk(risk_grades(acceleration, rate, ratio))) != "no risk"


def test_grades_are_broadcast():
    assert risk_grades(np.ones((3, 1)), np.ones(4), 1.2).shape == (3, 4)


@given(st.lists(st.floats(1.0, 10.0), min_size=1, max_size=50), st.floats(0.0, 0.5))
def test_little_of_the_use_exceeds_a_risk_number(grades, beyond):
    number = design_risk(grades, beyond=beyond)
    assert np.mean(np.array(grades) > number + 0.5) <= beyond + 1e-9
    assert number == design_risk(grades[::-1], beyond=beyond)


@given(st.lists(st.tuples(st.floats(1.0, 10.0), st.integers(1, 5)), min_size=1, max_size=20))
def test_a_weight_counts_as_so_many_conditions(weighted):
    grades, weights = zip(*weighted, strict=True)
    assert design_risk(grades, weights) == design_risk(np.repeat(grades, weights))


def test_bands_cover_the_scale():
    bands = [risk_band(number) for number in range(1, 11)]
    assert bands == ["no risk"] * 3 + ["conditional"] * 2 + ["risk"] * 5
    for number in (0, 11):
        with pytest.raises(ParameterError, match="from 1 to 10"):
            risk_band(number)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((-1.0, 0.0, 1.0), "acceleration must be 0 or more"),
        ((0.0, math.nan, 1.0), "impulse rate must be 0 or more"),
        ((0.0, 0.0, 0.9), "friction ratio must be 1 or more"),
    ],
)
def test_what_cannot_be_graded_is_refused(values, message):
    with pytest.raises(ParameterError, match=message):
        risk_grades(*values)


def test_grades_and_weights_must_fit():
    for grades, weights in (([], None), ([0.5], None), ([2.0], [1.0, 1.0]), ([2.0], [-1.0])):
        with pytest.raises(ParameterError, match="risk: "):
            design_risk(grades, weights)
    with pytest.raises(ParameterError, match="some weight"):
        design_risk([2.0], [0.0])


def test_risk_goes_before_probability_and_probability_before_margin():
    found = places(
        Candidate("a", 3, sure(0.9), -5.0),
        Candidate("b", 4, sure(0.1), 9.0),
        Candidate("c", 4, sure(0.2), 10.0),
        Candidate("d", 4, sure(0.2), 11.0),
    )
    assert found == {"a": 1, "b": 2, "d": 3, "c": 4}


def test_what_samples_cannot_tell_does_not_decide():
    wide = {
        name: Candidate(name, 2, Estimate(p, p - 0.05, p + 0.05), margin)
        for name, p, margin in (("a", 0.30, 1.0), ("b", 0.34, 3.0), ("c", 0.42, 9.0))
    }
    assert places(*wide.values()) == {"b": 1, "a": 2, "c": 3}


def test_equal_designs_share_a_place_and_the_next_is_left_out():
    found = places(
        Candidate("b", 2, sure(0.1), 1.0),
        Candidate("a", 2, sure(0.1), 1.0),
        Candidate("c", 2, sure(0.1), 0.5),
    )
    assert found == {"a": 1, "b": 1, "c": 3}


def test_an_unknown_margin_comes_last_among_equals():
    found = places(
        Candidate("a", 2, sure(0.0), math.nan),
        Candidate("b", 2, sure(0.0), -math.inf),
        Candidate("c", 2, sure(0.0), math.inf),
    )
    assert found == {"c": 1, "a": 2, "b": 2}


@given(
    st.lists(
        st.tuples(st.integers(1, 3), st.floats(0.0, 1.0), st.sampled_from([-1.0, 0.0, math.nan])),
        max_size=8,
    ),
    st.randoms(),
)
def test_the_ranking_does_not_depend_on_the_order_given(designs, random):
    candidates = [
        Candidate(str(i), risk, Estimate(p, max(p - 0.1, 0.0), min(p + 0.1, 1.0)), margin)
        for i, (risk, p, margin) in enumerate(designs)
    ]
    found = ranked(candidates)
    random.shuffle(candidates)
    assert list(ranked(candidates).items()) == list(found.items())
    assert list(found.values()) == sorted(found.values())


def candidate(name, rig):
    """A design judged on the speeds of its use, with a fit that scatters."""
    fit, support = 0.279e-3, 3745.0
    speed = np.linspace(2.0, 10.0, 9)
    runs = sweep(rig, speed, fit, support, seconds=0.3, settling=0.3, rate=15e3)
    bushing = rig.fit(fit)
    # The clamp swings at the slip frequency, and the beams' roots with it.
    swing = 2.0 * np.pi * np.nan_to_num(runs["slip_frequency"]) * runs["clamp_speed_rms"]
    grades = risk_grades(
        rig.beams.lever * np.sqrt(2.0) * swing,
        np.nan_to_num(runs["slip_frequency"]) / speed,
        bushing.critical_torque / bushing.kinetic_torque,
    )

    def noise_of(parts):
        found = sweep(rig, parts[:, 1], parts[:, 0], support, seconds=0.3, settling=0.3, rate=15e3)
        return np.where(found["stick_fraction"] > 0.02, "creak", "none")

    vary = {"interference": stats.norm(fit, 0.01e-3), "speed": stats.uniform(2.0, 8.0)}
    found = label_probabilities(noise_of, vary, np.random.default_rng(0), half_width=0.1)
    v_crit2 = critical_speeds(rig, fit, support).v_crit2
    return Candidate(name, design_risk(grades), found.any_but("none"), speed[0] - v_crit2)


def test_of_two_designs_the_one_that_is_quieter_by_construction_is_ranked_first():
    rig = load_material_rig("fluorocarbon-thesis")
    quiet = candidate("damped", with_damping(rig, 0.16))
    loud = candidate("undamped", with_damping(rig, 0.07))
    assert places(loud, quiet) == {"damped": 1, "undamped": 2}
    assert quiet.noise.high < loud.noise.low
    assert quiet.margin > loud.margin
    # All of static friction's excess gone, nothing sticks at all.
    fits = tuple(replace(fit, critical_torque=fit.kinetic_torque) for fit in rig.fits)
    smooth = candidate("smooth", replace(rig, fits=fits))
    assert smooth.noise.value == 0.0
    assert risk_band(smooth.risk) == "no risk"
    assert places(loud, quiet, smooth)["smooth"] == 1
