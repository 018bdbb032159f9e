from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.bench import Beams
from models.errors import ParameterError
from models.structure.beams import (
    ANCHOR_FORCE,
    PULSE,
    beam_length,
    beam_structure,
    torsional_stiffness,
)

STEEL = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.005, 0.4)
J_C = 1 / 1200

stiffnesses = st.floats(1500.0, 20e3)


@given(st.floats(1.0, 1e7))
def test_every_stiffness_has_its_beam_length(stiffness):
    length = beam_length(STEEL, stiffness)
    assert torsional_stiffness(STEEL, length) == pytest.approx(stiffness, rel=1e-9)


@pytest.mark.parametrize("stiffness", [0.0, -2214.0, 1e-300, 1e300, math.inf, math.nan])
def test_a_stiffness_that_no_beam_has_is_refused(stiffness):
    with pytest.raises(ParameterError, match="belongs to no beam"):
        beam_length(STEEL, stiffness)


@given(stiffnesses, st.floats(1 / 1300, 1 / 800))
@settings(max_examples=30)
def test_first_torsional_mode_is_the_lumped_models(stiffness, inertia):
    model = beam_structure(STEEL, stiffness, inertia, 0.02, 40e3)
    lumped = math.sqrt(stiffness / inertia) / (2 * math.pi)
    assert model.frequencies[0] == pytest.approx(lumped, rel=1e-7)
    assert model.damping_ratios[0] == 0.02
    assert np.all(model.damping_ratios[1:] == STEEL.damping_ratio)


def test_a_pulse_on_the_beam_is_held_by_the_anchor_beside_it():
    static = beam_structure(STEEL, 2214.0, J_C, 0.02, 40e3).frequency_response([0.0])
    assert -1.01 < static[ANCHOR_FORCE, PULSE, 0].real < -0.98


def test_modes_left_out_still_act_on_the_anchors_at_low_frequency():
    few = beam_structure(STEEL, 2214.0, J_C, 0.02, 5e3).frequency_response([50.0, 500.0])
    many = beam_structure(STEEL, 2214.0, J_C, 0.02, 40e3).frequency_response([50.0, 500.0])
    assert few[ANCHOR_FORCE:] == pytest.approx(many[ANCHOR_FORCE:], rel=0.02, abs=1e-4)


def test_beams_heavier_than_the_clamp_are_refused():
    with pytest.raises(ParameterError, match="larger support stiffness"):
        beam_structure(STEEL, 500.0, J_C, 0.02, 40e3)
