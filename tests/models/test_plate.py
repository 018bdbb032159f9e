from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from models.bench import Microphone, Plate
from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED
from models.structure.plate import plate_modes, pressure_response

RATE = 96e3


def _plate(length=0.9, width=0.6, thickness=8e-3, loss_factor=0.03):
    return Plate(length, width, thickness, 2e11, 7850.0, 0.3, loss_factor, (-0.07, 0.04))


def _bending_stiffness(plate):
    return plate.youngs_modulus * plate.thickness**3 / (12 * (1 - plate.poisson_ratio**2))


@given(st.floats(0.2, 2.0), st.floats(0.2, 2.0), st.floats(2e-3, 2e-2))
@settings(max_examples=40)
def test_frequencies_are_those_of_the_closed_form(length, width, thickness):
    plate = _plate(length, width, thickness)
    modes = plate_modes(plate, 6e3)
    scale = math.pi / 2 * math.sqrt(_bending_stiffness(plate) / (plate.density * thickness))
    expected = sorted(
        scale * ((m / length) ** 2 + (n / width) ** 2) for m in range(1, 100) for n in range(1, 100)
    )
    expected = [frequency for frequency in expected if frequency <= 6e3]
    assert modes.frequencies == pytest.approx(expected, rel=1e-9)


def test_pressure_is_rayleighs_integral_over_the_plates_acceleration():
    plate, position = _plate(), (0.15, -0.1, 0.8)
    modes = plate_modes(plate, 16e3)
    force = modes.shape([-0.2], [0.1]).T
    frequency = np.array([120.0, 777.0, 2500.0, 6000.0, 11000.0, 14500.0])
    step = 5e-3
    x = np.arange(-plate.length / 2 + step / 2, plate.length / 2, step)
    y = np.arange(-plate.width / 2 + step / 2, plate.width / 2, step)
    x, y = (a.ravel() for a in np.meshgrid(x, y))
    q_tt = (
        force[:, 0, None]
        / modes.mass
        * -(frequency**2)
        / (
            modes.frequencies[:, None] ** 2
            - frequency**2
            + 1j * plate.loss_factor * modes.frequencies[:, None] * frequency
        )
    )
    acceleration = modes.shape(x, y) @ q_tt
    r = np.sqrt((x - position[0]) ** 2 + (y - position[1]) ** 2 + position[2] ** 2)[:, None]
    green = np.exp(-2j * np.pi * frequency / SOUND_SPEED * r) / r
    expected = AIR_DENSITY / (2 * np.pi) * step**2 * np.sum(acceleration * green, axis=0)
    response = pressure_response(modes, force, Microphone(position), RATE, 2**17)[0]
    samples = np.arange(response.size)
    found = np.exp(-2j * np.pi / RATE * np.outer(frequency, samples)) @ response
    assert np.abs(found / expected) == pytest.approx(1, abs=0.05)
    assert np.angle(found / expected) == pytest.approx(0, abs=0.05)
