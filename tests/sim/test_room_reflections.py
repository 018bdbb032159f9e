"""Sound that comes by way of the room."""

from __future__ import annotations

import numpy as np
import pytest

from models.radiation.impulse_responses import ImpulseResponses
from models.radiation.rayleigh import SOUND_SPEED
from sim.chain import apply_chain_effects
from sim.effects import EFFECTS

RATE = 96e3


def room(form, seed=0, **given):
    one = np.ones(1)
    active = EFFECTS["room_reflections"].active({"form": form, **given})
    plain = ImpulseResponses(RATE, one, one, one, one)
    return apply_chain_effects(plain, [active], np.random.default_rng(seed)).torque_to_pressure


def test_the_floor_makes_a_comb():
    taps = room("floor", reverberation_time=3.0)
    delay = 1.8 / SOUND_SPEED
    frequency = np.arange(1, 9) / (2 * delay)
    turn = np.exp(-2j * np.pi / RATE * np.outer(np.arange(taps.size), frequency))
    gains = np.abs(taps @ turn)
    assert np.all(gains[0::2] < 0.8)
    assert np.all(gains[1::2] > 1.2)


def test_the_first_wall_of_a_shoebox_is_heard_when_its_image_is():
    taps = room("shoebox", distance=0.5, reverberation_time=3.0)
    first = np.flatnonzero(np.abs(taps[1:]) > 0.05)[0] + 1
    nearest = min(2 * 0.9 + 0.5, np.hypot(2 * 0.37 * 5.0, 0.5), 2 * (3.0 - 0.9) - 0.5)
    assert first / RATE * SOUND_SPEED == pytest.approx(nearest - 0.5, abs=0.01)


@pytest.mark.parametrize("lasting", [0.2, 1.0])
def test_the_tail_decays_by_60_db_in_the_reverberation_time(lasting):
    taps = room("diffuse", reverberation_time=lasting)[1:]
    remaining = np.cumsum(taps[::-1] ** 2)[::-1]
    level = 10 * np.log10(remaining / remaining[0])
    time = np.arange(taps.size) / RATE
    fitted = (level < -5) & (level > -35)
    assert -60.0 / np.polyfit(time[fitted], level[fitted], 1)[0] == pytest.approx(lasting, rel=0.05)
