"""Populations: the same bushing many times, each with its own deviations."""

import math

import numpy as np
import pytest

from models.errors import ParameterError
from noise.screening.design.design import load_design
from noise.screening.map.point import evaluate_point
from noise.screening.parts.population import outcomes
from noise.screening.parts.variation import UsePoint, use_point, varied
from noise.screening.ranking.margins import margin_of, range_of

FLUOROCARBON = load_design("fluorocarbon")
POINT = UsePoint(10.0, 0.279e-3, 3745.0, 23.0, (2.0, 13.0))


def test_the_nominal_bushing_is_the_design_itself():
    found = outcomes(FLUOROCARBON, [[1.0, 1.0]], names=["damping", "interference"], point=POINT)
    alone = evaluate_point(FLUOROCARBON.rig, 10.0, interference=0.279e-3, support_stiffness=3745.0)
    assert found.labels.tolist() == [alone.label] == ["squeal"]
    assert found.v_crit2[0] == pytest.approx(12.07, abs=0.05)
    assert found.margin[0] == pytest.approx(2.0 - found.v_crit2[0])
    assert math.isnan(found.v_crit1[0])


def test_each_row_is_its_own_bushing_whatever_the_order_and_the_workers():
    factors = 1.0 + 0.1 * np.random.default_rng(2).standard_normal((8, 3))
    names = ["elastomer_stiffness", "damping", "support_stiffness"]
    found = outcomes(FLUOROCARBON, factors, names=names, point=POINT)
    turned = outcomes(FLUOROCARBON, factors[::-1], names=names, point=POINT, workers=1)
    assert found.labels.tolist() == turned.labels[::-1].tolist()
    assert found.margin.tolist() == turned.margin[::-1].tolist()
    for i in (0, 5):
        rig, moved = varied(FLUOROCARBON.rig, POINT, dict(zip(names, factors[i], strict=True)))
        own = evaluate_point(
            rig, moved.speed,
            interference=moved.interference, support_stiffness=moved.support_stiffness,
        )  # fmt: skip
        assert found.labels[i] == own.label


def test_damping_buys_margin():
    found = outcomes(
        FLUOROCARBON, [[0.8], [1.0], [1.2], [1.4]], names=["damping"], point=POINT, labels=False
    )
    assert np.all(np.diff(found.margin) > 0.0)


def test_critical_speeds_by_simulation_stand_beside_those_by_stability():
    by_stability, by_simulation = (
        outcomes(
            FLUOROCARBON, [[1.0]], names=["damping"], point=POINT, labels=False, critical=critical
        )
        for critical in ("stability", "simulation")
    )
    assert by_simulation.v_crit2[0] == pytest.approx(by_stability.v_crit2[0], abs=0.3)
    assert by_simulation.v_crit1[0] == pytest.approx(3.25, abs=0.3)


def test_a_constant_torque_is_simulated_since_stability_tells_nothing():
    design = load_design("fluorocarbon-thesis")
    found = outcomes(design, [[1.0], [2.0]], names=["damping"], point=POINT, labels=False)
    assert found.v_crit2[0] == pytest.approx(7.0, abs=0.3)
    assert found.margin[1] > found.margin[0]


def test_pdms_has_all_the_margin_there_is():
    found = outcomes(load_design("PDMS"), [[0.8], [1.2]], names=["kinetic_torque"])
    assert found.margin.tolist() == [math.inf, math.inf]
    assert found.labels.tolist() == ["none", "none"]


def test_factors_that_do_not_fit_their_names_are_refused():
    with pytest.raises(ParameterError, match="do not fit 1 names"):
        outcomes(FLUOROCARBON, [[1.0, 1.0]], names=["damping"])


def test_a_use_below_the_slowest_vibration_has_margin_as_well():
    speed = np.arange(1.0, 11.0)
    span = range_of(speed, (speed >= 4.0) & (speed <= 7.0))
    assert span == (4.0, 7.0)
    assert margin_of(span, (1.0, 3.0)) == 1.0
    assert margin_of(span, (8.0, 10.0)) == 1.0
    assert margin_of(span, (1.0, 10.0)) == -6.0


def test_the_middle_of_the_use_is_where_a_population_is_heard():
    assert use_point(FLUOROCARBON).speed == pytest.approx(6.625)
