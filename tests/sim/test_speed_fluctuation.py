"""The shaft that does not turn evenly."""

import numpy as np
import pytest

from sim.effects import EFFECTS

EFFECT = EFFECTS["speed_fluctuation"]
RATE = 10e3


def driven(speed, seed=0, **parameters):
    active = EFFECT.active(parameters)
    return active.apply_drive(speed, RATE, np.random.default_rng(seed))


def even(speed=5.0, seconds=10.0):
    return np.full(round(seconds * RATE), speed)


def frequency_of(speed):
    spectrum = np.abs(np.fft.rfft(speed - speed.mean()))
    return np.fft.rfftfreq(speed.size, 1.0 / RATE)[np.argmax(spectrum)]


@pytest.mark.parametrize("form", EFFECT.forms)
def test_a_depth_gives_the_same_rms_in_every_form(form):
    speed = driven(even(5.0, 40.0), depth=0.1, form=form, frequency=10.0, bandwidth=20.0)
    assert speed.mean() == pytest.approx(5.0, rel=0.01)
    assert speed.std() == pytest.approx(5.0 * 0.1 / 2**0.5, rel=0.05)


@pytest.mark.parametrize(("speed", "order"), [(2.0 * np.pi, 1.0), (2.0 * np.pi, 3.0), (-5.0, 12.0)])
def test_the_sine_has_so_many_periods_a_turn(speed, order):
    found = frequency_of(driven(even(speed), order=order))
    assert found == pytest.approx(order * abs(speed) / (2.0 * np.pi), abs=0.06)


def test_the_random_form_loses_half_its_power_at_the_bandwidth():
    speeds = [driven(even(), seed, depth=0.1, form="random", bandwidth=20.0) for seed in range(20)]
    power = np.mean([np.abs(np.fft.rfft(speed - 5.0)) ** 2 for speed in speeds], axis=0)
    low, corner = power[2:50].mean(), power[150:251].mean()  # around 20 Hz
    assert corner / low == pytest.approx(0.5, rel=0.15)
