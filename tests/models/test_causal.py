"""Impulse responses of spectra that are known in a band only."""

import numpy as np
from hypothesis import given, settings, strategies as st
from scipy.signal import butter, sosfilt

from models.radiation.impulse_responses import convolve
from models.structure.modal import ModalModel
from models.transfer_functions.measured import measured_impulse_response
from models.transfer_functions.transfer_function import TransferFunction

RATE = 96e3
FREQUENCY = np.array([250.0, 900.0, 1800.0, 4500.0, 6000.0, 9000.0])
ONE = np.ones((6, 1))
STRUCTURE = ModalModel(
    FREQUENCY,
    np.full(6, 0.02),
    ONE,
    0 * ONE.T,
    np.array([[1, -1, 1, 1, -1, 1.0]]),
    np.zeros((1, 1)),
)


def lines(low=10.0, high=12800.0, spacing=2.0):
    return np.arange(low, high + 0.5 * spacing, spacing)


def spectrum(f):
    return STRUCTURE.frequency_response(f)[0, 0]


def difference(impulse_response):
    """Relative, of the outputs for a torque that fills the band to 4 kHz."""
    torque = sosfilt(
        butter(4, 4000.0, fs=RATE, output="sos"), np.random.default_rng(0).standard_normal(40000)
    )
    true = convolve(torque, STRUCTURE.impulse_response(RATE, 20000)[0, 0])
    return np.std(convolve(torque, impulse_response) - true) / np.std(true)


def test_lines_with_noise_reproduce_it_within_the_noise():
    f = lines()
    scatter = np.random.default_rng(1).standard_normal((2, f.size))
    noisy = spectrum(f) * (1 + 0.03 * (scatter[0] + 1j * scatter[1]))
    h = measured_impulse_response(TransferFunction(f, noisy), RATE, 20000)
    assert difference(h) < 0.04


@settings(max_examples=15)
@given(delay=st.integers(40, 300), gain=st.floats(0.1, 10))
def test_a_delay_stays_a_delay(delay, gain):
    f = lines(low=20.0, high=8000.0, spacing=20.0)
    pulse = gain * f**2 * np.exp(-((f / 2000) ** 2)) * np.exp(-2j * np.pi * f * delay / 32e3)
    h = measured_impulse_response(TransferFunction(f, pulse), 32e3, 1000)
    assert abs(int(np.argmax(np.abs(h))) - delay) <= 1
    # Nothing comes before its cause: the pulse itself is a few samples wide.
    assert np.abs(h[: max(delay - 30, 0)]).max(initial=0.0) < 0.02 * np.abs(h).max()
