"""Synthetic creak, squawk, squeal and noise: what features tell apart, and what must not matter."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest
from scipy import fft
from scipy.signal import lfilter

from features.table import KINDS, feature_vector, features_of

MASTER_RATE = 96_000


def noise(n, seed=0):
    return np.random.default_rng(seed).normal(size=n)


def creak(seconds=1.0):
    rng = np.random.default_rng(5)
    pulses, t = np.zeros(round(MASTER_RATE * seconds)), 0.01
    while t < seconds - 0.01:
        pulses[int(t * MASTER_RATE)] = 1 + 0.2 * rng.normal()
        t += (1 + 0.03 * rng.normal()) / 90
    total = np.zeros(pulses.size)
    for frequency, quality, gain in (
        *((310, 15, 0.4), (940, 20, 1.0), (2300, 30, 1.0)),
        *((4800, 40, 1.5), (9000, 40, 1.0), (15000, 40, 0.5)),
    ):
        radius = math.exp(-math.pi * frequency / quality / MASTER_RATE)
        turn = -2 * radius * math.cos(2 * math.pi * frequency / MASTER_RATE)
        total += gain * (1 - radius) * lfilter([1.0], [1.0, turn, radius**2], pulses)
    return total + 0.01 * total.std() * rng.normal(size=total.size)


def squawk(seconds=1.0):
    t = np.arange(round(MASTER_RATE * seconds)) / MASTER_RATE
    levels = {1: 0.3, 2: 0.5, 3: 0.4, 4: 1.0, 6: 0.6, 7: 0.2}
    tones = sum(a * np.sin(2 * np.pi * 155 * k * t + k * k) for k, a in levels.items())
    return tones + 0.05 * noise(t.size, 6)


def squeal(seconds=1.0):
    t = np.arange(round(MASTER_RATE * seconds)) / MASTER_RATE
    phase = 2 * np.pi * (1046 * t + 0.4 * np.sin(2 * np.pi * 3 * t))
    return np.sin(phase) + 0.05 * np.sin(2 * phase) + 0.03 * noise(t.size, 7)


def none(seconds=1.0):
    return noise(round(MASTER_RATE * seconds), 8)


SOUNDS = {"creak": creak, "squawk": squawk, "squeal": squeal, "none": none}


@functools.cache
def at(name, rate, seconds=1.0):
    """One of the sounds, recorded at a rate: everything above half of it is gone."""
    x = SOUNDS[name](seconds)
    n = round(seconds * rate)
    return fft.irfft(fft.rfft(x)[: n // 2 + 1], n) * (n / x.size)


@functools.cache
def vector(name, rate=48_000, seconds=1.0):
    return feature_vector(at(name, rate, seconds), rate, "pressure")


# --- what the features must not depend on ----------------------------------------------------


@pytest.mark.parametrize("name", SOUNDS)
@pytest.mark.parametrize("kind", KINDS)
def test_only_levels_depend_on_the_gain(name, kind):
    x = at(name, 48_000, 0.5)
    quiet, loud = feature_vector(x, 48e3, kind), feature_vector(1e3 * x, 48e3, kind)
    for feature in features_of(kind):
        if not feature.calibrated:
            assert loud[feature.name] == pytest.approx(quiet[feature.name], rel=1e-6, nan_ok=True)


# --- what the features must tell apart --------------------------------------------------------


def test_creak_is_broadband_impulsive_and_regular():
    found = vector("creak")
    assert found["band_7000_13000"] > -20
    assert found["high_kurtosis"] > 6
    assert found["top_kurtosis"] > 6
    assert found["pulse_rate"] == pytest.approx(90, rel=0.05)
    assert found["pulse_irregularity"] < 0.1
    assert found["modulation_rate"] == pytest.approx(90, rel=0.02)
    assert found["line_share"] < 0.3


def test_squawk_has_several_lines_of_one_fundamental():
    found = vector("squawk")
    assert found["line_count"] == 6
    assert found["fundamental"] == pytest.approx(155, rel=0.005)
    assert found["line_order"] == pytest.approx(4, rel=0.005)
    assert found["harmonicity"] > 0.95
    assert found["lines_share"] > 0.95
    assert found["line_share"] < 0.7
    assert found["second_line"] == pytest.approx(20 * math.log10(0.6), abs=0.2)


def test_squeal_is_one_line_that_stays():
    found = vector("squeal")
    assert found["line_share"] > 0.85
    assert found["tone_share"] > 0.95
    assert found["tone_continuity"] > 0.95
    assert found["second_line"] < -20
    assert found["fundamental_wander"] < 0.02


def test_noise_has_no_tone_no_rhythm_and_no_change():
    found = vector("none")
    assert found["line_count"] == 0
    assert math.isnan(found["fundamental"])
    assert found["harmonicity"] < 0.05
    assert found["tone_share"] < 0.1
    assert found["kurtosis"] == pytest.approx(3.0, abs=0.2)
    assert found["flatness"] > 0.8
    assert found["level_variation"] < 0.5
    assert found["modulation_strength"] < 0.2


def test_torque_features_tell_stick_slip_from_quasi_harmonic():
    t = np.arange(30_000) / 30e3
    sticks = feature_vector(8 + 2.7 * ((155 * t) % 1.0), 30e3, "torque")
    glides = feature_vector(8 + 0.3 * np.sin(2 * np.pi * 900 * t), 30e3, "torque")
    assert sticks["slip_rate"] == pytest.approx(155, abs=2)
    assert sticks["harmonic_count"] > 10
    assert sticks["stick_slope"] == pytest.approx(2.7 * 155, rel=0.02)
    assert sticks["mean"] == pytest.approx(9.35, rel=0.01)
    assert glides["slip_rate"] == 0.0
    assert glides["harmonic_count"] == 1
    assert glides["line_share"] > 0.95
    assert glides["fundamental"] == pytest.approx(900, abs=1)
    assert glides["oscillation"] == pytest.approx(0.3 / math.sqrt(2), rel=0.01)
    assert abs(glides["asymmetry"]) < 0.1 < 1 < -sticks["asymmetry"]
