from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import freqz

from models.structure.modal import acceleration_section, displacement_section

RATE = 96e3


def _decibels(ratio):
    return 20 * np.log10(np.abs(ratio))


@pytest.mark.parametrize("natural", [50.0, 1000.0, 8000.0, 16000.0])
@pytest.mark.parametrize("damping", [0.002, 0.015, 0.1, 1.0, 30.0])
def test_sampled_mode_follows_the_continuous_one_up_to_a_sixth_of_the_rate(natural, damping):
    frequency = np.concatenate([np.geomspace(10, 16e3, 200), natural * np.linspace(0.9, 1.1, 21)])
    frequency = frequency[frequency <= 16e3]
    omega, omega_r = 2 * np.pi * frequency, 2 * np.pi * natural
    q = 1 / (omega_r**2 - omega**2 + 2j * damping * omega_r * omega)
    for section, continuous in ((acceleration_section, -(omega**2) * q), (displacement_section, q)):
        b, a = section(natural, damping, RATE)
        sampled = freqz(b, a, omega / RATE)[1]
        assert np.max(np.abs(_decibels(sampled / continuous))) < (0.2 if damping < 1 else 0.5)
