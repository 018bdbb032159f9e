"""Cabins and halls sound as they do, and a sound lies above them by what is stated."""

import numpy as np
import pytest

from noise.training.classifier.places import (
    PLACES,
    a_weighted,
    in_a_place,
    orders,
    place,
)

RATE = 48_000


def decibel(share):
    return 20.0 * np.log10(share)


def tone(frequency, seconds=1.0):
    return np.sin(2.0 * np.pi * frequency * np.arange(round(seconds * RATE)) / RATE)


@pytest.mark.parametrize("name", PLACES)
@pytest.mark.parametrize("rate", [16_000.0, 96_000.0])
def test_every_place_sounds_at_any_rate(name, rate):
    sound = place(24_000, rate, np.random.default_rng(1), among=(name,))
    assert sound.shape == (24_000,)
    assert sound.std() == pytest.approx(1.0)


@pytest.mark.parametrize("snr", [-5.0, 0.0, 12.0])
def test_a_sound_lies_above_its_place_by_the_stated_level(snr):
    sound, around = tone(1500.0), place(RATE, RATE, np.random.default_rng(3))
    mixed, _ = in_a_place(sound, around, RATE, snr)
    weighted, rest = a_weighted(sound, RATE), a_weighted(mixed - sound, RATE)
    assert decibel(weighted.std() / rest.std()) == pytest.approx(snr, abs=0.01)


def test_a_pause_is_not_of_the_sound_that_a_place_drowns():
    sound = tone(1500.0, 3.0)
    sound[: RATE // 2] = sound[2 * RATE :] = 0.0
    _, (start, end) = in_a_place(sound, place(sound.size, RATE, np.random.default_rng(3)), RATE, 0)
    assert start == pytest.approx(0.5, abs=0.2)
    assert end == pytest.approx(2.0, abs=0.2)


def test_orders_stand_at_multiples_of_the_shaft():
    sound = orders(np.full(RATE, 24.0), RATE, 0.5, 2.0, 1.0, np.random.default_rng(0))
    spectrum = np.abs(np.fft.rfft(sound))
    strong = np.flatnonzero(spectrum > 0.01 * spectrum.max())
    assert not (strong % 12).any()
    assert strong.size > 5
