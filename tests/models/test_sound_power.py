from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from models.bench import Plate
from models.errors import ParameterError
from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED
from models.radiation.sound_power import (
    radiated_power,
    third_octave_power,
)
from models.structure.plate import plate_modes

STEEL = Plate(0.9, 0.6, 8e-3, 2e11, 7850.0, 0.3, 0.03, (0.0, 0.12))


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
