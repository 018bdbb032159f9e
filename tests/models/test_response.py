from __future__ import annotations

import numpy as np
import pytest

from models.radiation.impulse_responses import ImpulseResponses, radiate

random = np.random.default_rng(11)
CHAIN = ImpulseResponses(48e3, *random.normal(size=(4, 300)))


@pytest.mark.parametrize("torque", [0.0, 8.0, -30.0])
def test_a_steady_torque_is_silent(torque):
    acceleration, pressure = radiate(CHAIN, np.full(1000, torque))
    assert not np.any(acceleration)
    assert not np.any(pressure)


def test_torque_and_pulses_add_up():
    torque, pulse = np.random.default_rng(6).normal(size=(2, 700))
    both = radiate(CHAIN, torque, pulse)
    torque_alone = radiate(CHAIN, torque, np.zeros(700))
    pulse_alone = radiate(CHAIN, np.zeros(700), pulse)
    for together, first, second in zip(both, torque_alone, pulse_alone, strict=True):
        assert np.any(first)
        assert np.any(second)
        assert together == pytest.approx(first + second, abs=1e-9)


def test_what_is_kept_between_signals_of_any_length_changes_nothing():
    for n in (700, 1, 40, 3000, 700):
        torque = np.random.default_rng(n).normal(size=n)
        _, pressure = radiate(CHAIN, torque)
        expected = np.convolve(torque - torque[0], CHAIN.torque_to_pressure)[:n]
        assert pressure == pytest.approx(expected, abs=1e-9)
