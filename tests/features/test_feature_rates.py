"""The same sound has the same features at any sampling rate, as closely as the registry says.

Resampled by polyphase filters, which have nothing in common with how features are brought to their
working rate.
"""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest
from scipy import fft, signal

from features.table import feature_vector, features_of
from tests.features.test_feature_sounds import SOUNDS

MASTER_RATE = 192_000
RATES = (16_000, 22_050, 30_000, 44_100, 51_200, 96_000)
COMMON = 7_000.0

REACHED_FROM = {
    "band_7000_13000": 29_800,
    "top_kurtosis": 29_800,
    "band_5000_15000": 34_300,
    "band_13000_19000": 43_500,
    "third_octave_8000": 19_900,
    "third_octave_10000": 25_000,
    "third_octave_12500": 31_400,
    "third_octave_16000": 39_600,
    "third_octave_20000": 49_800,
}
"""Features of what lies above 7 kHz, and the rate [Hz] that they need."""

RHYTHM = {"pulse_rate", "pulse_irregularity", "pulse_glide"}
"""Of sounds without pulses these describe the few maxima that noise has by chance."""


def below(x, limit):
    bins = fft.rfft(x)
    bins[round(limit * x.size / MASTER_RATE) :] = 0.0
    return fft.irfft(bins, x.size)


def sawtooth(seconds):
    """A torque that rises in stick and drops in slip, 35 times a second."""
    phase = 35.0 * np.arange(round(MASTER_RATE * seconds)) / MASTER_RATE % 1.0
    torque = 8.0 + np.interp(phase, [0.0, 0.95, 1.0], [-3.0, 3.0, -3.0])
    return torque + 0.05 * np.random.default_rng(3).normal(size=torque.size)


@functools.cache
def master(name, seconds, limit):
    if name == "sawtooth":
        return below(sawtooth(seconds), limit)
    return below(signal.resample_poly(SOUNDS[name](seconds), 2, 1), limit)


@functools.cache
def vector(name, seconds, rate, limit=COMMON):
    x = master(name, seconds, limit)
    if rate != MASTER_RATE:
        shared = math.gcd(rate, MASTER_RATE)
        up, down = rate // shared, MASTER_RATE // shared
        # 80 dB down from half the rate on, nothing lost up to 0.9 of it
        taps = signal.firwin(
            2 * 50 * max(up, down) + 1, 0.95 / max(up, down), window=("kaiser", 8.0)
        )
        x = signal.resample_poly(x, up, down, window=taps)
    return feature_vector(x, rate, "torque" if name == "sawtooth" else "pressure")


def check_agreement(name, seconds, rate, limit, but):
    kind = "torque" if name == "sawtooth" else "pressure"
    found, expected = vector(name, seconds, rate, limit), vector(name, seconds, MASTER_RATE, limit)
    for feature in features_of(kind):
        value, right = found[feature.name], expected[feature.name]
        if rate < REACHED_FROM.get(feature.name, 0):
            assert math.isnan(value), feature.name
        elif feature.name not in but and not right < -50.0:  # dB: nothing but leakage
            share, much = feature.tolerance
            close = pytest.approx(right, rel=share, abs=much, nan_ok=True)
            assert value == close, feature.name


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("name", [*SOUNDS, "sawtooth"])
def test_what_lies_below_7_khz_is_the_same_at_any_rate(name, rate):
    check_agreement(name, 1.0, rate, COMMON, set() if name == "creak" else RHYTHM)
