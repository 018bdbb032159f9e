from __future__ import annotations

import itertools

import numpy as np
import pytest

from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED, rayleigh_integral

RATE = 96e3


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
