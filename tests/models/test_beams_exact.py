"""The exact model of clamp and beams, against closed forms, transfer matrices, finite elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.bench import Beams
from models.structure.beams import (
    ACCELERATION,
    ANCHOR_FORCE,
    ANCHOR_MOMENT,
    PULSE,
    TORQUE,
    beam_length,
    beam_structure,
    rigid_clamp_inertia,
    torsional_stiffness,
)
from noise.thesis.exact_beams import ClampOnBeams
from tests.helpers.exact_beams import forced_response

STEEL = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.005, 0.4)
SOFT = replace(STEEL, anchor_rotation=300.0, anchor_translation=5e6)


@pytest.mark.parametrize("beams", [STEEL, SOFT], ids=["rigid", "soft"])
@pytest.mark.parametrize("stiffness", [2214.0, 1500.0])
def test_the_modal_path_to_sensor_and_anchors_is_the_exact_one(beams, stiffness):
    """With the rigid clamp that the lumped model's inertia leaves, off and near resonance."""
    damped = replace(beams, damping_ratio=0.005)
    inertia = 1 / 1200
    modal = beam_structure(damped, stiffness, inertia, 0.005, 40e3)
    length = beam_length(beams, stiffness)
    level = stiffness / torsional_stiffness(beams, length)
    scaled = replace(
        beams,
        youngs_modulus=level * beams.youngs_modulus,
        density=level * beams.density,
        anchor_rotation=level * beams.anchor_rotation,
        anchor_translation=level * beams.anchor_translation,
    )
    clamp = rigid_clamp_inertia(beams, stiffness, inertia)
    frequency = np.geomspace(30.0, 15e3, 400)
    structure = ClampOnBeams(scaled, length, 1.0, clamp)
    exact = forced_response(structure, frequency, [beams.accelerometer], loss_factor=0.01)
    found = modal.frequency_response(frequency)[:, TORQUE]
    for output, expected in (
        (ACCELERATION, exact.acceleration[0]),
        (ANCHOR_FORCE, exact.anchor_force),
        (ANCHOR_MOMENT, exact.anchor_moment),
    ):
        typical = np.sqrt(np.abs(expected) * np.sqrt(np.mean(np.abs(expected) ** 2)))
        assert np.median(np.abs(found[output] - expected) / typical) < 0.01
        level = 20 * np.log10(np.abs(found[output]) / np.abs(expected))
        assert np.median(np.abs(level)) < 0.1
        assert np.percentile(np.abs(level), 95) < 0.6


# Anchors


@given(st.floats(0.05, 0.2), st.floats(20.0, 1e6), st.floats(2e6, 1e12))
@settings(max_examples=50)
def test_anchors_that_yield_leave_less_stiffness_and_no_anchor_any(length, rotation, translation):
    beams = replace(STEEL, anchor_rotation=rotation, anchor_translation=translation)
    stiffness = torsional_stiffness(beams, length)
    assert 0.0 < stiffness < torsional_stiffness(STEEL, length)
    softer = replace(beams, anchor_rotation=0.9 * rotation, anchor_translation=0.9 * translation)
    assert torsional_stiffness(softer, length) < stiffness
    assert beam_length(beams, 2214.0) == beam_length(STEEL, 2214.0)


@pytest.mark.parametrize("stiffness", [2214.0, 3745.0])
def test_the_clamp_moves_as_the_lumped_one_however_the_anchors_yield(stiffness):
    frequency = np.array([20.0, 100.0, 200.0, 240.0])
    omega = 2 * np.pi * frequency
    lumped = -(omega**2) * STEEL.lever / (stiffness - omega**2 / 1200)
    at_the_clamp = replace(SOFT, accelerometer=0.0)
    model = beam_structure(at_the_clamp, stiffness, 1 / 1200, 1e-4, 40e3)
    found = model.frequency_response(frequency)[ACCELERATION, TORQUE]
    assert np.abs(found / lumped) == pytest.approx(1, abs=0.05)


def test_a_blow_in_a_joint_that_yields_leaves_the_beams_a_couple():
    """Its arm is where it strikes: the anchor is not there to hold against a push."""
    found = []
    for strike in (0.001, 0.002):
        model = beam_structure(replace(SOFT, strike=strike), 2214.0, 1 / 1200, 0.01, 40e3)
        found.append(abs(model.frequency_response([3e3])[ACCELERATION, PULSE, 0]))
    assert found[1] / found[0] == pytest.approx(2.0, rel=0.05)


def test_soft_anchors_still_balance_the_torque_at_rest_and_keep_the_lumped_mode():
    model = beam_structure(SOFT, 1500.0, 1 / 1200, 0.02, 20e3)
    _, force, moment = model.frequency_response([0.0])[:, TORQUE, 0].real
    arm = STEEL.lever + beam_length(SOFT, 1500.0)
    assert 2 * (force * arm + moment) == pytest.approx(1.0, rel=1e-6)
    assert model.frequencies[0] == pytest.approx(np.sqrt(1500.0 * 1200) / (2 * np.pi), rel=1e-6)
