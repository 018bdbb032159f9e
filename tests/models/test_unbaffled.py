from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED
from models.radiation.sound_power import radiated_power
from models.radiation.unbaffled import unbaffled_power
from models.rig import Plate
from models.structure.plate import plate_modes

BENCH = Plate(0.9, 0.6, 0.01, 2e11, 7850.0, 0.3, 0.03, (0.0, 0.12))
FORCES = np.array([(0.21, 0.13), (-0.3, 0.05), (0.05, -0.2), (0.37, -0.11)])


def test_a_small_rigid_plate_is_the_dipole_of_its_added_mass():
    square = Plate(0.6, 0.6, 0.01, 2e11, 7850.0, 0.3, 0.03, (0.0, 0.0), "free")
    modes = plate_modes(square, 600.0)
    corners = modes.shape([0.0, 0.3, 0.0], [0.0, 0.0, 0.3])[:, :3]
    rigid = np.zeros((modes.frequencies.size, 1), dtype=complex)
    rigid[:3, 0] = np.linalg.solve(corners, np.ones(3))  # 1 m/s everywhere
    frequency = 20.0
    omega = 2 * np.pi * frequency
    # air that a square plate carries along: 0.579 pi / 4 rho side^3 (Blevins 1979)
    force = omega * 0.579 * np.pi / 4 * AIR_DENSITY * 0.6**3
    both_sides = (omega / SOUND_SPEED * force) ** 2 / (12 * np.pi * AIR_DENSITY * SOUND_SPEED)
    assert unbaffled_power(modes, rigid, frequency) == pytest.approx(both_sides / 2, rel=0.02)


def test_without_a_baffle_a_simple_source_becomes_a_dipole():
    modes = plate_modes(BENCH, 200.0)
    first = np.eye(modes.frequencies.size, 1) + 0j
    low, high = (unbaffled_power(modes, first, f)[0] for f in (10.0, 20.0))
    assert np.log2(high / low) == pytest.approx(4, abs=0.1)


def test_at_high_frequency_the_baffle_makes_no_difference():
    modes = plate_modes(BENCH, 300.0)
    first = np.eye(modes.frequencies.size, 1) + 0j
    ratio = unbaffled_power(modes, first, 2e3) / radiated_power(modes, first[:, 0], 2e3)
    assert ratio == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize(
    ("edges", "decibels"),
    [
        ("simply_supported", {63: 17, 125: 10, 250: 7, 500: 6, 1000: 0}),
        ("free", {63: 10, 125: 12, 250: 2, 500: -1, 1000: 0}),
    ],
)
def test_the_baffle_costs_what_is_documented(edges, decibels):
    modes = plate_modes(dataclasses.replace(BENCH, edges=edges), 4e3)
    natural, ratios = 2 * np.pi * modes.frequencies, modes.damping_ratios
    for middle, expected in decibels.items():
        baffled = alone = 0.0
        for frequency in middle * 10 ** ((np.arange(8) + 0.5) / 80 - 0.05):
            omega = 2 * np.pi * frequency
            gain = 1j * omega / (natural**2 - omega**2 + 2j * ratios * natural * omega)
            velocity = (modes.shape(*FORCES.T) * gain / modes.mass).T
            baffled += sum(radiated_power(modes, v, frequency) for v in velocity.T)
            alone += unbaffled_power(modes, velocity, frequency).sum()
        assert 10 * np.log10(baffled / alone) == pytest.approx(expected, abs=0.8)
