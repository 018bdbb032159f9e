"""How a design stands with its parts: margins, advice, risk and ranking of real designs."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from noise.screening.design.design import Use, load_design
from noise.screening.design.tolerances import Tolerance
from noise.screening.parts.advice import increase_margin
from noise.screening.parts.design_variable import DesignVariable
from noise.screening.parts.population import outcomes
from noise.screening.parts.probability import label_probabilities
from noise.screening.parts.robustness import ASSUMED, factor_distributions, robustness
from noise.screening.parts.sampling import parts
from noise.screening.parts.variation import use_point, varied
from noise.screening.ranking.risk import Candidate, ranked, risk_band
from noise.screening.ranking.use_risk import use_grades, use_risk

FEW = (DesignVariable("damping", 0.7, 1.5), DesignVariable("critical_torque", 0.7, 1.2))
TOLERANCES = (
    Tolerance("damping", "relative", 0.1),
    Tolerance("critical_torque", "relative", 0.05),
    Tolerance("support_stiffness", "relative", 0.01),
)


def design(name="fluorocarbon", material="fluorocarbon", factors=None, **use):
    """A material on the shipped bench, some of its parameters times factors."""
    found = load_design(material)
    given = {"speed": (2.0, 12.0), "interference": (0.279e-3,), "support_stiffness": (3745.0,)}
    found = replace(found, name=name, use=Use(**(given | use)), tolerances=TOLERANCES)
    rig, _ = varied(found.rig, use_point(found), factors or {})
    return replace(found, rig=rig)


def stands(found, **options):
    given = {"half_width": 0.15, "samples": 64, "variables": FEW}
    return robustness(found, np.random.default_rng(0), **(given | options))


@pytest.fixture(scope="module")
def plain():
    return stands(design())


@pytest.fixture(scope="module")
def quieter():
    found = design("damped", factors={"damping": 2.0, "critical_torque": 0.8})
    return stands(found, variables=FEW[:1])


@pytest.mark.slow
def test_a_design_quieter_by_construction_is_ranked_first(plain, quieter):
    ranks = ranked(
        [
            Candidate(one.design, one.risk, one.noises.any_but(), one.margin)
            for one in (plain, quieter)
        ]
    )
    assert ranks == {"damped": 1, "fluorocarbon": 2}
    assert quieter.noises.any_but().high < plain.noises.any_but().low
    assert quieter.risk <= plain.risk
    assert quieter.margin > plain.margin


def test_probabilities_reach_the_precision_asked_for(plain):
    assert plain.noises.reached
    assert plain.noises.half_width <= 0.15
    assert sum(one.value for one in plain.noises.by_label.values()) == pytest.approx(1.0)


def test_what_scatters_more_matters_more(plain):
    assert {one.name for one in plain.sensitivities} == {one.name for one in TOLERANCES}
    assert plain.sensitivities[-1].name == "support_stiffness"


def test_tolerances_of_its_own_are_not_assumed_ones(plain):
    assert not plain.assumed
    bare = replace(design(), tolerances=())
    assert list(factor_distributions(bare, use_point(bare))) == [
        *(one.name for one in ASSUMED),
        "speed",
    ]


def test_advice_made_moves_the_simulated_boundary_as_predicted():
    found = design()
    variables = [*FEW, DesignVariable("kinetic_torque", 0.7, 1.4)]
    names = [variable.name for variable in variables]

    def by_stability(factors):
        return outcomes(found, factors, names=names, labels=False).margin

    advice = increase_margin(by_stability, variables, 2.0)
    made = np.ones((1 + len(variables), len(variables)))
    for row, one in zip(made[1:], advice, strict=True):
        row[names.index(one.name)] = one.value
    simulated = outcomes(found, made, names=names, labels=False, critical="simulation").margin
    assert all(one.enough and one.steady for one in advice)
    for one, moved in zip(advice, simulated[1:] - simulated[0], strict=True):
        assert moved == pytest.approx(one.gain, rel=0.2)


def test_the_change_advised_against_a_noise_ends_it_in_the_simulation(plain):
    names = [variable.name for variable in FEW]
    ends = [one for one in plain.noise_advice if one.enough]
    assert ends
    for one in ends:
        factors = [[one.value if one.name == name else 1.0 for name in names]]
        assert outcomes(design(), factors, names=names, critical="none").labels.tolist() == ["none"]


def test_a_silent_rubber_needs_no_advice():
    found = stands(design("PDMS", "PDMS"))
    assert found.noises.by_label["none"].value == 1.0
    assert found.clear.value == 1.0
    assert found.margin == math.inf
    assert (found.margin_advice, found.noise_advice) == ((), ())
    assert {one.total.value for one in found.sensitivities} == {0.0}
    assert risk_band(found.risk) == "no risk"


def test_factors_scatter_as_the_file_says():
    stated = (
        Tolerance("interference", "absolute", 0.0279),
        Tolerance("elastomer_stiffness", "limits", 532.0, 731.5),
        Tolerance("damping", "relative", 0.4),
        Tolerance("speed", "relative", 0.01),
    )
    found = replace(design(), tolerances=stated)
    factors = factor_distributions(found, use_point(found))
    assert list(factors) == [one.name for one in stated]
    middle = parts(factors, np.full((1, 4), 0.5))[0]
    low = parts(factors, np.full((1, 4), 1e-12))[0]
    assert middle == pytest.approx([1.0, 0.95, 1.0, 1.0])
    assert (low > 0.0).all()
    assert low[1] == pytest.approx(0.8)
    assert factors["interference"].std() == pytest.approx(0.1)


def test_speeds_of_use_are_alike_where_no_tolerance_says_otherwise():
    found = design()
    point = use_point(found)
    speed = factor_distributions(found, point)["speed"]
    assert point.speed * speed.ppf([0.0, 0.5, 1.0]) == pytest.approx([2.0, 7.0, 12.0])


def test_creaking_fits_are_a_greater_risk_than_sliding_ones():
    creaking = use_risk(design(interference=(0.381e-3,)))
    sliding = use_risk(design(interference=(0.178e-3,), speed=(9.0, 12.0)))
    assert risk_band(creaking) == "risk"
    assert risk_band(sliding) == "no risk"


def test_the_ends_of_all_conditions_are_graded():
    fits = (0.254e-3, 0.26e-3, 0.3e-3, 0.381e-3)
    one = use_grades(design("PDMS", "PDMS"))
    several = use_grades(design("PDMS", "PDMS", interference=fits, support_stiffness=(2e3, 4e3)))
    assert (one.size, several.size) == (12, 12 * 3 * 2)


def test_a_bolted_clamp_is_graded_as_well():
    assert use_grades(design(support_stiffness=(math.inf,), speed=(1.0, 2.0))).max() > 5.5


@pytest.mark.slow
def test_intervals_of_being_clear_hold_brute_force_as_often_as_they_state():
    found = design(speed=(11.0, 13.0))
    vary = factor_distributions(found, use_point(found))
    del vary["speed"]
    names = list(vary)

    def clear(factors):
        margin = outcomes(found, factors, names=names, labels=False).margin
        return np.where(margin > 0.0, "clear", "vibrates")

    points = np.random.default_rng(1).random((4000, len(vary)))
    truth = float(np.mean(clear(parts(vary, points)) == "clear"))
    assert 0.1 < truth < 0.9
    held = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        one = label_probabilities(clear, vary, rng, half_width=0.1).by_label["clear"]
        held += one.low <= truth <= one.high
    assert held >= stats.binom.ppf(0.001, 20, 0.95)
