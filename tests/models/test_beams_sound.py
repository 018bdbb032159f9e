"""Beams and clamp as radiators without a baffle."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import mathieu_modsem1, mathieu_modsem2, mathieu_sem

from models.bench import Beams, Microphone
from models.errors import ParameterError
from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED
from models.structure.beams import (
    TORQUE,
    beam_length,
    beam_structure,
    beams_pressure,
    strip_section,
)

RATE = 96e3
STEEL = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.005, 0.4)
CLAMP, MICROPHONE = (0.0, 0.12), Microphone((-0.2, 0.15, 0.5))


def pressure(beams=STEEL, microphone=MICROPHONE, damping=0.02, n=2**15):
    return beams_pressure(beams, 2214.0, 1 / 1200, damping, CLAMP, microphone, RATE, n, 40e3)


def spectrum(signal, frequency):
    turn = np.exp(-2j * np.pi / RATE * np.outer(np.arange(signal.size), frequency))
    return signal @ turn


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


def test_far_below_the_corner_it_is_a_row_of_dipoles_with_their_near_field():
    frequency = np.array([50.0, 120.0, 230.0])
    heard = spectrum(pressure()[TORQUE], frequency)
    length = beam_length(STEEL, 2214.0)
    x = np.linspace(0.0, STEEL.lever + length, 4001)
    x = 0.5 * (x[1:] + x[:-1])
    moved = beam_structure(STEEL, 2214.0, 1 / 1200, 0.02, 40e3, x).frequency_response(frequency)
    moved = moved[3:, TORQUE]
    step, wave = x[1] - x[0], 2 * np.pi * frequency / SOUND_SPEED
    clamp = np.where(x < STEEL.lever, STEEL.clamp_width, STEEL.width)
    height = np.where(x < STEEL.lever, STEEL.clamp_width, STEEL.thickness)
    carried = AIR_DENSITY * (np.pi * clamp**2 / 4 + clamp * height)
    expected = 0.0
    for side in (1, -1):
        lift = MICROPHONE.position[2] - STEEL.height
        r = np.sqrt((side * x + 0.2) ** 2 + 0.03**2 + lift**2)[:, None]
        dipole = lift / r * (1j * wave + 1 / r) * np.exp(-1j * wave * r) / (4 * np.pi * r)
        expected = expected + side * np.sum(carried[:, None] * step * moved * dipole, axis=0)
    assert np.abs(heard / expected) == pytest.approx(1.0, abs=0.04)


def test_a_microphone_on_the_clamp_is_refused():
    with pytest.raises(ParameterError, match="from the beams or the clamp; it must be at least"):
        pressure(microphone=Microphone((0.01, 0.12, 0.07)))


# In the rig
