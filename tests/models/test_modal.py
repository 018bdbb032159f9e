from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import freqz

from models.structure.modal import (
    ModalModel,
    acceleration_section,
    displacement_section,
    ringing_samples,
)

RATE = 96e3


def _decibels(ratio):
    return 20 * np.log10(np.abs(ratio))


@pytest.mark.parametrize("natural", [50.0, 1000.0, 8000.0, 16000.0])
@pytest.mark.parametrize("damping", [0.002, 0.015, 0.1])
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
        assert np.max(np.abs(_decibels(sampled / continuous))) < 0.2


def test_sampled_mode_rings_at_its_frequency_with_its_damping():
    _, a = displacement_section(1000.0, 0.02, RATE)
    pole = np.roots(a)[0]
    s = np.log(pole) * RATE
    assert abs(s) / (2 * np.pi) == pytest.approx(1000.0, rel=1e-9)
    assert -s.real / abs(s) == pytest.approx(0.02, rel=1e-9)


def test_impulse_response_and_frequency_response_describe_the_same_structure():
    random = np.random.default_rng(3)
    n_modes = 6
    model = ModalModel(
        frequencies=random.uniform(200, 9e3, n_modes),
        damping_ratios=random.uniform(0.01, 0.05, n_modes),
        inputs=random.normal(size=(n_modes, 2)),
        displacements=random.normal(size=(3, n_modes)) * 1e6,
        accelerations=random.normal(size=(3, n_modes)),
        feedthrough=random.normal(size=(3, 2)),
    )
    n = 2**16
    frequency = np.fft.rfftfreq(n, 1 / RATE)
    band = frequency < 12e3
    sampled = np.fft.rfft(model.impulse_response(RATE, n))[:, :, band]
    continuous = model.frequency_response(frequency[band])
    scale = np.abs(continuous).max(axis=-1, keepdims=True)
    assert np.max(np.abs(sampled - continuous) / scale) < 0.03


def test_mode_is_followed_until_it_is_inaudible():
    n = ringing_samples(500.0, 0.01, RATE, 10**9)
    assert np.exp(-2 * np.pi * 500.0 * 0.01 * n / RATE) < 1e-6
    assert ringing_samples(500.0, 0.0, RATE, 4800) == 4800
