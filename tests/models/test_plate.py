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


def _single(plate, microphone, m, n, frequency=None):
    """Pressure of one mode, at its own frequency unless told, per newton of modal force."""
    modes = plate_modes(plate, 3e3)
    one = ((modes.products.along == m - 1) & (modes.products.across == n - 1)).astype(float)[
        :, None
    ]
    response = pressure_response(modes, one, Microphone(microphone), RATE, 2**18)[0]
    frequency = frequency or modes.frequencies[np.flatnonzero(one)[0]]
    return np.exp(-2j * np.pi * frequency * np.arange(response.size) / RATE) @ response


def test_far_away_the_first_mode_loses_six_decibels_a_doubling():
    levels = [
        20 * np.log10(abs(_single(_plate(), (0.0, 0.0, height), 1, 1)))
        for height in (10.0, 20.0, 40.0)
    ]
    assert -np.diff(levels) == pytest.approx([6.02, 6.02], abs=0.05)


def test_the_first_mode_is_a_point_source_at_low_frequency():
    plate = _plate()
    modes = plate_modes(plate, 3e3)
    # volume acceleration of the mode far below its resonance, where it is omega^2 / omega_r^2
    frequency = 20.0
    omega, omega_r = 2 * np.pi * frequency, 2 * np.pi * modes.frequencies[0]
    q_tt = -(omega**2) / (omega_r**2 - omega**2 + 1j * plate.loss_factor * omega_r * omega)
    volume = plate.length * plate.width * (2 / np.pi) ** 2 * q_tt / modes.mass
    expected = AIR_DENSITY * volume / (2 * np.pi * 8.0)
    found = _single(plate, (0.0, 0.0, 8.0), 1, 1, frequency) * np.exp(1j * omega * 8 / SOUND_SPEED)
    assert found == pytest.approx(expected, rel=0.02)


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
