from __future__ import annotations

import itertools

import numpy as np
import pytest

from models.bench import Microphone, Plate
from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED, rayleigh_integral
from models.structure.plate import plate_modes, pressure_response
from sim.analysis.sound_power import radiated_power

RATE = 96e3


STEEL = Plate(0.9, 0.6, 8e-3, 2e11, 7850.0, 0.3, 0.03, (0.0, 0.12))


def test_pressure_is_rayleighs_integral_over_the_plates_acceleration():
    plate, position = STEEL, (0.15, -0.1, 0.8)
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


@pytest.mark.parametrize("frequency", [150.0, 1100.0, 2500.0])
def test_power_is_the_intensity_of_rayleighs_integral_over_a_far_hemisphere(frequency):
    modes = plate_modes(STEEL, 1e3)
    rng = np.random.default_rng(3)
    velocity = rng.normal(size=modes.frequencies.size) + 1j * rng.normal(
        size=modes.frequencies.size
    )
    x, y = (side * ((np.arange(n) + 0.5) / n - 0.5) for side, n in ((0.9, 90), (0.6, 60)))
    field = modes.on_grid(x, y, slice(None)) @ velocity * 0.01**2
    cosine, weight = np.polynomial.legendre.leggauss(40)
    cosine, weight = (cosine + 1) / 2, weight / 2
    angle = np.arange(96) * 2 * np.pi / 96
    k = 2 * np.pi * frequency / SOUND_SPEED
    total = 0.0
    for c, w in zip(cosine, weight, strict=True):
        k_x, k_y = (k * np.sqrt(1 - c**2) * turn(angle) for turn in (np.cos, np.sin))
        far = np.einsum(
            "xa,xy,ya->a", np.exp(1j * np.outer(x, k_x)), field, np.exp(1j * np.outer(y, k_y))
        )
        pressure = AIR_DENSITY * 2 * np.pi * frequency / (2 * np.pi) * far  # times distance
        total += w * 2 * np.pi * np.mean(np.abs(pressure) ** 2) / (AIR_DENSITY * SOUND_SPEED)
    assert radiated_power(modes, velocity, frequency) == pytest.approx(total, rel=0.01)


def _spectrum(integral, distribution, frequency):
    taps = integral.taps(distribution)
    n = integral.delay + np.arange(taps.size)
    return np.exp(-2j * np.pi * np.outer(frequency, n) / RATE) @ taps


def _disc(radius, n_rings=60):
    edges = radius * np.linspace(0, 1, n_rings + 1)
    x, area = [], []
    for inner, outer in itertools.pairwise(edges):
        # on the axis only the ring's radius counts: its root mean square, and its exact area
        x.append(np.sqrt((inner**2 + outer**2) / 2))
        area.append(np.pi * (outer**2 - inner**2))
    return np.array(x), np.zeros(n_rings), np.array(area)


@pytest.mark.parametrize("height", [0.1, 0.5, 2.0])
def test_circular_piston_sounds_on_its_axis_as_its_closed_form(height):
    radius = 0.05
    frequency = np.geomspace(100, 15e3, 60)
    integral = rayleigh_integral(*_disc(radius), (0.0, 0.0, height), RATE)
    k = 2 * np.pi * frequency / SOUND_SPEED
    path = np.hypot(radius, height)
    # per unit velocity: rho c (e^-ikz - e^-ikr); an acceleration of 1 is a velocity of 1/(i omega)
    exact = (
        AIR_DENSITY
        * SOUND_SPEED
        * (np.exp(-1j * k * height) - np.exp(-1j * k * path))
        / (2j * np.pi * frequency)
    )
    ratio = _spectrum(integral, np.ones(60), frequency) / exact
    audible = np.abs(exact) > 0.05 * np.abs(exact).max()
    assert np.count_nonzero(audible) > 30
    assert np.max(np.abs(20 * np.log10(np.abs(ratio[audible])))) < 0.2
    assert np.max(np.abs(np.angle(ratio[audible]))) < 0.05
