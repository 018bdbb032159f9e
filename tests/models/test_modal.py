from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp
from scipy.signal import freqz, lfilter

from models.structure.modal import (
    acceleration_section,
    displacement_section,
)

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
    for section, continuous in (
        (acceleration_section, -(omega**2) * q),
        (displacement_section, q),
    ):
        b, a = section(natural, damping, RATE)
        sampled = freqz(b, a, omega / RATE)[1]
        assert np.max(np.abs(_decibels(sampled / continuous))) < (0.2 if damping < 1 else 0.5)


@settings(max_examples=15)
@given(natural=st.floats(50.0, 1000.0), damping=st.floats(0.6, 8.0))
def test_a_mode_moves_as_integrated_in_time_whether_it_rings_or_not(natural, damping):
    omega, seconds = 2 * np.pi * natural, 0.02
    t = np.arange(int(seconds * RATE)) / RATE

    def force(t):
        return np.sin(2 * np.pi * 150.0 * t) ** 2

    moved = solve_ivp(
        lambda t, y: [y[1], force(t) - 2 * damping * omega * y[1] - omega**2 * y[0]],
        (0.0, t[-1]), [0.0, 0.0], method="LSODA", t_eval=t, rtol=1e-9, atol=1e-18,
    ).y  # fmt: skip
    q, speed = moved
    q_tt = force(t) - 2 * damping * omega * speed - omega**2 * q
    for section, exact in ((displacement_section, q), (acceleration_section, q_tt)):
        sampled = lfilter(*section(natural, damping, RATE), force(t))
        assert np.abs(sampled - exact).max() < 0.02 * np.abs(exact).max()
