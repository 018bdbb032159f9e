"""The exact model of clamp and beams, against closed forms, transfer matrices, finite elements."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.special import mathieu_modsem1, mathieu_modsem2, mathieu_sem

from models.bench import Beams, Microphone
from models.errors import ParameterError
from models.radiation.rayleigh import SOUND_SPEED
from models.radiation.rig_response import strip_section
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
from tests.helpers.exact_beams import (
    ClampOnBeams,
    RootMotion,
    boundary_conditions,
    wavenumber,
    waves_at,
)

STEEL = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.005, 0.4)
J_C = 1 / 1200

stiffnesses = st.floats(1500.0, 20e3)


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


def test_beams_heavier_than_the_clamp_are_refused():
    with pytest.raises(ParameterError, match="larger support stiffness"):
        beam_structure(STEEL, 500.0, J_C, 0.02, 40e3)


def turned_by_a_unit_torque(structure, frequency, loss_factor):
    """Acceleration at the sensor, force and moment of the right anchor, exactly."""
    beams, length = structure.beams, structure.length
    boundary = boundary_conditions(
        structure, frequency, RootMotion.TURNING, loss_factor, scaled=False
    )
    load = np.zeros((frequency.size, 4, 1))
    load[:, 1] = 1.0
    waves = np.linalg.solve(boundary, load)[..., 0]
    wave = wavenumber(structure, frequency, loss_factor) * length
    deflection, moment, shear = (
        np.einsum("fw,fw->f", waves_at(wave, at, n), waves)
        for at, n in ((beams.accelerometer, 0), (1.0, 2), (1.0, 3))
    )
    stiffness = beams.bending_stiffness * (1.0 + 1j * loss_factor)
    acceleration = -((2.0 * np.pi * frequency) ** 2) * deflection
    return acceleration, stiffness / length**3 * shear, -stiffness / length**2 * moment


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
    exact = turned_by_a_unit_torque(structure, frequency, 0.01)
    found = modal.frequency_response(frequency)[:, TORQUE]
    for output, expected in (
        (ACCELERATION, exact[0]),
        (ANCHOR_FORCE, exact[1]),
        (ANCHOR_MOMENT, exact[2]),
    ):
        typical = np.sqrt(np.abs(expected) * np.sqrt(np.mean(np.abs(expected) ** 2)))
        assert np.median(np.abs(found[output] - expected) / typical) < 0.01
        level = 20 * np.log10(np.abs(found[output]) / np.abs(expected))
        assert np.median(np.abs(level)) < 0.1
        assert np.percentile(np.abs(level), 95) < 0.6


# Anchors


RATE = 96e3
CLAMP, MICROPHONE = (0.0, 0.12), Microphone((-0.2, 0.15, 0.5))


def gain(width, height, frequency):
    far, _, poles = strip_section(width, height, RATE)
    turn = np.exp(2j * np.pi * np.asarray(frequency) / RATE)
    return np.polyval(far, turn) / np.polyval(poles, turn)


def exact_strip(ka, modes=7):
    """Far field of a thin strip without a baffle over that with one, straight in front.

    Pressure odd about the strip, as a sum of Mathieu functions of the elliptic cylinder that the
    strip is the limit of; normal acceleration given on it.
    """
    q, angle = ka**2 / 4, np.linspace(0.0, np.pi, 2001)
    total = 0.0
    for m in range(1, 2 * modes, 2):
        along = mathieu_sem(m, q, np.degrees(angle))[0]
        share = 2 / np.pi * np.sum(np.sin(angle) * along) * (angle[1] - angle[0])
        outwards = mathieu_modsem1(m, q, 0.0)[1] - 1j * mathieu_modsem2(m, q, 0.0)[1]
        total += -share / outwards * mathieu_sem(m, q, 90.0)[0] * np.exp(0.5j * np.pi * m)
    return total / -1j


def test_a_thin_strip_sounds_as_the_exact_solution_says():
    ka = np.array([0.05, 0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0])
    # Wide, to stay clear of the bend of the bilinear transform.
    width = 0.1
    frequency = ka * SOUND_SPEED / (np.pi * width)
    found = gain(width, 0.0, frequency)
    exact = np.array([exact_strip(each) for each in ka])
    assert np.abs(20 * np.log10(np.abs(found / exact))).max() < 1.2
    assert np.abs(np.angle(found / exact, deg=True)).max() < 12.0


# In the rig
