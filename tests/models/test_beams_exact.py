"""The exact model of clamp and beams, against closed forms, transfer matrices, finite elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.linalg import eigh

from models.bench import Beams
from models.structure.beams import (
    ACCELERATION,
    ANCHOR_FORCE,
    ANCHOR_MOMENT,
    PULSE,
    TORQUE,
    beam_length,
    beam_structure,
    bending_stiffness,
    mass_per_length,
    rigid_clamp_inertia,
    torsional_stiffness,
)
from noise.thesis.exact_beams import ClampOnBeams, RootMotion, natural_frequencies
from tests.helpers.exact_beams import forced_response

STEEL = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.005, 0.4)
LATERAL = 3500.0 * 4.4482216 / 0.0254
BENCH = ClampOnBeams(STEEL, 0.123, 0.96, 1 / 1050, LATERAL, 750.0)
SOFT = replace(STEEL, anchor_rotation=300.0, anchor_translation=5e6)
MOTIONS = (RootMotion.TURNING, RootMotion.SIDEWAYS)


def elements(structure, motion, n=40):
    """Stiffness and mass of the same structure by Hermite elements, and what maps them to nodes."""
    beams, size, h = structure.beams, 2 * (n + 1), structure.length / n
    k = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], float)
    m = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]])
    unit = np.array([1.0, h, 1.0, h])
    k = bending_stiffness(beams) / h**3 * k * np.outer(unit, unit)
    m = mass_per_length(beams) * h / 420 * m * np.outer(unit, unit)
    stiffness, mass = np.zeros((size, size)), np.zeros((size, size))
    for i in range(0, size - 2, 2):
        stiffness[i : i + 4, i : i + 4] += k
        mass[i : i + 4, i : i + 4] += m
    springs = (beams.anchor_translation, beams.anchor_rotation)
    kept = list(range(2, size - 2))
    for i, spring in enumerate(springs):
        if np.isfinite(spring):
            stiffness[size - 2 + i, size - 2 + i] += spring
            kept.append(size - 2 + i)
    if motion is RootMotion.LOOSE:
        nodes = np.eye(size)[:, [0, 1, *kept]]
        return nodes.T @ stiffness @ nodes, nodes.T @ mass @ nodes, nodes
    root = (beams.lever, 1.0) if motion is RootMotion.TURNING else (1.0, 0.0)
    nodes = np.eye(size)[:, [0, *kept]]
    nodes[:2, 0] = root
    stiffness, mass = 2 * nodes.T @ stiffness @ nodes, 2 * nodes.T @ mass @ nodes
    turning = motion is RootMotion.TURNING
    stiffness[0, 0] += structure.torsional_stiffness if turning else structure.lateral_stiffness
    mass[0, 0] += structure.clamp_inertia if turning else structure.clamp_mass
    return stiffness, mass, nodes


def test_a_beam_without_clamp_is_the_cantilever_of_the_textbook():
    waves = np.array([1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839])
    speed = np.sqrt(bending_stiffness(STEEL) / mass_per_length(STEEL))
    closed = (waves / 0.123) ** 2 * speed / (2 * np.pi)
    found = natural_frequencies(BENCH, 1.01 * closed[-1], RootMotion.LOOSE)
    assert found == pytest.approx(closed, rel=1e-8)


@pytest.mark.parametrize("beams", [STEEL, SOFT], ids=["rigid", "soft"])
@pytest.mark.parametrize("motion", [*MOTIONS, RootMotion.LOOSE])
@pytest.mark.parametrize("length", [0.123, 0.092])
def test_frequencies_are_those_of_many_finite_elements(beams, motion, length):
    structure = replace(BENCH, beams=beams, length=length)
    stiffness, mass, _ = elements(structure, motion)
    expected = np.sqrt(eigh(stiffness, mass, eigvals_only=True)[:6]) / (2 * np.pi)
    found = natural_frequencies(structure, 1.0001 * expected[-1], motion)
    assert found == pytest.approx(expected, rel=3e-5)


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


def test_very_stiff_anchors_are_rigid_ones():
    stiff = replace(STEEL, anchor_rotation=1e12, anchor_translation=1e16)
    assert torsional_stiffness(stiff, 0.123) == pytest.approx(torsional_stiffness(STEEL, 0.123))
    rigid = beam_structure(STEEL, 2214.0, 1 / 1200, 0.02, 20e3)
    almost = beam_structure(stiff, 2214.0, 1 / 1200, 0.02, 20e3)
    assert almost.frequencies == pytest.approx(rigid.frequencies, rel=1e-5)
    at = np.array([100.0, 1000.0, 5000.0])
    assert np.abs(almost.frequency_response(at) / rigid.frequency_response(at)) == pytest.approx(
        1.0, rel=2e-3
    )


def test_soft_anchors_still_balance_the_torque_at_rest_and_keep_the_lumped_mode():
    model = beam_structure(SOFT, 1500.0, 1 / 1200, 0.02, 20e3)
    _, force, moment = model.frequency_response([0.0])[:, TORQUE, 0].real
    arm = STEEL.lever + beam_length(SOFT, 1500.0)
    assert 2 * (force * arm + moment) == pytest.approx(1.0, rel=1e-6)
    assert model.frequencies[0] == pytest.approx(np.sqrt(1500.0 * 1200) / (2 * np.pi), rel=1e-6)
