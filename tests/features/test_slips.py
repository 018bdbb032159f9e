from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from features.kernels.slips import in_intervals, slip_intervals, torque_slips


def noise(n, seed=0):
    return np.random.default_rng(seed).normal(size=n)


def stick_slip(frequency, rate=30e3, seconds=1.0, drop=2.7, kinetic=8.0, slip=0.1):
    """Torque that rises for 1 - slip of a period and falls for the rest."""
    phase = (frequency * np.arange(round(rate * seconds)) / rate) % 1.0
    up = np.minimum(phase / (1 - slip), 1.0) - np.maximum(phase - (1 - slip), 0.0) / slip
    return kinetic + drop * up


@settings(max_examples=60)
@given(
    frequency=st.floats(20.0, 200.0),
    drop=st.floats(0.5, 20.0),
    kinetic=st.floats(1.0, 40.0),
    sign=st.sampled_from([-1.0, 1.0]),
    rate=st.sampled_from([16e3, 30e3, 48e3]),
)
def test_stick_slip_is_described_by_its_rate_drop_and_slope(frequency, drop, kinetic, sign, rate):
    torque = sign * stick_slip(frequency, rate, drop=drop, kinetic=kinetic)
    found = torque_slips(torque, rate)
    assert found.rate == pytest.approx(frequency, abs=1.5)
    assert found.mean_interval == pytest.approx(1 / frequency, rel=0.01)
    assert found.interval_variation < 0.02
    assert found.mean_drop == pytest.approx(drop, rel=0.1)
    assert found.drop_variation < 0.05
    assert found.stick_slope == pytest.approx(drop * frequency / 0.9, rel=0.02)
    # The torque is smoothed to 2 kHz, which rounds up to a quarter of a millisecond at each slip.
    assert found.stick_fraction == pytest.approx(0.9, abs=0.02 + 0.25e-3 * frequency)
    assert found.stick_curvature == pytest.approx(1.0, abs=0.03)
    assert found.asymmetry < -1.0


@pytest.mark.parametrize("shape", ["harmonic", "triangular", "noise", "constant"])
def test_what_does_not_drop_suddenly_does_not_slip(shape):
    t = np.arange(30_000) / 30e3
    torque = {
        "harmonic": 8 + np.sin(2 * np.pi * 900 * t),
        "triangular": 8 + np.abs((300 * t) % 1.0 - 0.5),
        "noise": 8 + noise(t.size),
        "constant": np.full(t.size, 8.0),
    }[shape]
    found = torque_slips(torque, 30e3)
    assert found.rate == 0.0
    assert found.times.size == 0
    assert math.isnan(found.stick_slope)
    assert not abs(found.asymmetry) > 0.1


# --- slips of a sliding speed -----------------------------------------------------------------


@settings(max_examples=200)
@given(n=st.integers(0, 300), seed=st.integers(0, 2**16), apart=st.integers(0, 12))
def test_slips_of_a_speed_are_those_that_a_reader_marks_from_sample_to_sample(n, seed, apart):
    speed = 2.0 * np.cumsum(noise(n, seed))
    marked, begun = [], None
    for i, v in enumerate(speed.tolist()):
        if begun is None and v > 3.0:
            begun = i
        elif begun is not None and v < 1.2:
            if marked and begun - marked[-1][1] < apart:
                marked[-1][1] = i
            else:
                marked.append([begun, i])
            begun = None
    starts, ends = slip_intervals(speed, above=3.0, below=1.2, apart=apart)
    assert np.stack([starts, ends], axis=1).tolist() == marked
    slipping = in_intervals(starts, ends, n)
    assert slipping.sum() == (ends - starts).sum()
    assert np.all(in_intervals(starts, ends, n, margin=2) >= slipping)
