from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from models.bench import Microphone, Plate
from models.errors import ParameterError
from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED
from models.radiation.sound_power import (
    radiated_power,
    radiated_spectrum,
    third_octave_power,
)
from models.structure.plate import plate_modes, pressure_response

STEEL = Plate(0.9, 0.6, 8e-3, 2e11, 7850.0, 0.3, 0.03, (0.0, 0.12))
RATE = 96e3


def _one(modes, m, n):
    return int(
        np.flatnonzero((modes.products.along == m - 1) & (modes.products.across == n - 1))[0]
    )


def radiation_efficiency(modes, frequencies, mode=0):
    """Of a mode by itself: its power over that of a piston of equal mean square velocity."""
    alone = np.eye(modes.frequencies.size)[mode] + 0j
    piston = AIR_DENSITY * SOUND_SPEED * modes.plate.length * modes.plate.width / 4
    return np.array([radiated_power(modes, alone, f) / piston for f in frequencies])


def _wavenumber(frequency):
    return 2 * np.pi * frequency / SOUND_SPEED


@pytest.mark.parametrize("ratio", [0.01, 0.03, 0.1])
def test_first_mode_radiates_as_wallaces_limit_at_low_wavenumbers(ratio):
    # Wallace 1972, for odd m and n, with his term of second order
    a, b = STEEL.length, STEEL.width
    k = ratio * np.pi * np.hypot(1 / a, 1 / b)
    modes = plate_modes(STEEL, 500.0)
    found = radiation_efficiency(modes, [k * SOUND_SPEED / (2 * np.pi)], _one(modes, 1, 1))
    second = k**2 * a * b / 12 * ((1 - 8 / np.pi**2) * (a / b + b / a))
    assert found == pytest.approx(32 * k**2 * a * b / np.pi**5 * (1 - second), rel=1e-4)


@pytest.mark.parametrize(("m", "n", "power"), [(1, 1, 2), (2, 1, 4), (1, 2, 4), (2, 2, 6)])
def test_modes_are_mono_di_and_quadrupoles(m, n, power):
    modes = plate_modes(STEEL, 500.0)
    low, high = radiation_efficiency(modes, [5.0, 10.0], _one(modes, m, n))
    assert np.log2(high / low) == pytest.approx(power, abs=0.02)


@pytest.mark.parametrize("edges", ["simply_supported", "free", "clamped"])
def test_far_above_its_critical_frequency_every_mode_radiates_as_a_piston(edges):
    modes = plate_modes(dataclasses.replace(STEEL, edges=edges), 600.0)
    for mode in range(modes.frequencies.size):
        assert radiation_efficiency(modes, [12e3], mode) == pytest.approx(1, abs=0.03)


@pytest.mark.parametrize(
    "edges", ["simply_supported", "clamped", ("clamped", "free", "free", "free")]
)
@pytest.mark.parametrize("frequency", [150.0, 1100.0, 2500.0])
def test_power_is_the_intensity_of_rayleighs_integral_over_a_far_hemisphere(edges, frequency):
    modes = plate_modes(dataclasses.replace(STEEL, edges=edges), 1e3)
    rng = np.random.default_rng(3)
    velocity = rng.normal(size=modes.frequencies.size) + 1j * rng.normal(
        size=modes.frequencies.size
    )
    x, y = (side * ((np.arange(n) + 0.5) / n - 0.5) for side, n in ((0.9, 90), (0.6, 60)))
    field = modes.on_grid(x, y, slice(None)) @ velocity * 0.01**2
    cosine, weight = np.polynomial.legendre.leggauss(40)
    cosine, weight = (cosine + 1) / 2, weight / 2
    angle = np.arange(96) * 2 * np.pi / 96
    k = _wavenumber(frequency)
    total = 0.0
    for c, w in zip(cosine, weight, strict=True):
        k_x, k_y = (k * np.sqrt(1 - c**2) * turn(angle) for turn in (np.cos, np.sin))
        far = np.einsum(
            "xa,xy,ya->a", np.exp(1j * np.outer(x, k_x)), field, np.exp(1j * np.outer(y, k_y))
        )
        pressure = AIR_DENSITY * 2 * np.pi * frequency / (2 * np.pi) * far  # times distance
        total += w * 2 * np.pi * np.mean(np.abs(pressure) ** 2) / (AIR_DENSITY * SOUND_SPEED)
    assert radiated_power(modes, velocity, frequency) == pytest.approx(total, rel=0.01)


def test_power_of_a_mode_is_what_microphones_about_it_receive():
    modes = plate_modes(STEEL, 300.0)
    first = np.eye(modes.frequencies.size)[:, :1]
    frequency, distance = 200.0, 12.0
    total = 0.0
    nodes, weights = np.polynomial.legendre.leggauss(6)
    for node, weight in zip((nodes + 1) / 2, weights / 2, strict=True):
        radius = distance * np.sqrt(1 - node**2)
        for angle in np.arange(0.5, 4) * np.pi / 8:
            place = (radius * np.cos(angle), radius * np.sin(angle), distance * node)
            heard = pressure_response(modes, first, Microphone(place), 12e3, 12000)[0]
            gain = np.exp(-2j * np.pi * frequency / 12e3 * np.arange(heard.size)) @ heard
            total += weight * 2 * np.pi * distance**2 * abs(gain) ** 2 / 4
    (radiated,) = radiated_spectrum(modes, first, [1.0], [frequency])
    assert radiated == pytest.approx(total / (AIR_DENSITY * SOUND_SPEED), rel=0.02)


def test_spectra_of_drives_scale_and_combine():
    modes = plate_modes(STEEL, 2e3)
    drives = modes.shape([0.2, -0.2], [0.1, 0.1]).T
    apart = third_octave_power(
        modes, drives, lambda f: np.array([[3.0], [-3.0]]) * np.ones(f.size), low=200, high=500
    )
    couple = third_octave_power(modes, drives[:, :1] - drives[:, 1:], low=200, high=500)
    assert apart.level == pytest.approx(couple.level + 20 * np.log10(3), abs=1e-9)


def test_bands_beyond_the_modes_are_refused():
    modes = plate_modes(STEEL, 1e3)
    with pytest.raises(ParameterError, match="reach beyond the plate's modes"):
        third_octave_power(modes, modes.shape([0.1], [0.1]).T, high=4e3)
    with pytest.raises(ParameterError, match="low must not be above high"):
        third_octave_power(modes, modes.shape([0.1], [0.1]).T, low=900.0, high=400.0)
