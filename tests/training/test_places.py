"""Cabins and halls sound as they do, and a sound lies above them by what is stated."""

import numpy as np
import pytest

from noise.training.classifier.augmentation.places import (
    CABINS,
    LEARNED,
    LEFT_OUT,
    PLACES,
    a_weighted,
    in_a_place,
    orders,
    place,
    shaped_noise,
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


def test_in_a_moving_car_most_power_lies_where_nobody_listens():
    for name in set(CABINS) - {"standing_car"}:
        over = [
            decibel(
                1.0 / a_weighted(place(RATE, RATE, rng, among=(name,), peopled=False), RATE).std()
            )
            for rng in map(np.random.default_rng, range(6))
        ]
        assert np.median(over) > 10.0, name


def test_some_kinds_of_cabin_and_hall_are_left_out_of_training():
    assert set(LEARNED) | set(LEFT_OUT) == set(PLACES)
    assert not set(LEARNED) & set(LEFT_OUT)
    assert set(LEFT_OUT) & set(CABINS)
    assert set(LEFT_OUT) - set(CABINS)


def test_the_same_place_twice_is_the_same_for_one_seed_and_another_for_two():
    one, same, other = (place(4800, RATE, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert np.array_equal(one, same)
    assert not np.allclose(one, other)


@pytest.mark.parametrize("snr", [-5.0, 0.0, 12.0])
def test_a_sound_lies_above_its_place_by_the_stated_level(snr):
    sound, around = tone(1500.0), place(RATE, RATE, np.random.default_rng(3))
    mixed, _ = in_a_place(sound, around, RATE, snr)
    weighted, rest = a_weighted(sound, RATE), a_weighted(mixed - sound, RATE)
    assert decibel(weighted.std() / rest.std()) == pytest.approx(snr, abs=0.01)


def test_a_sound_that_nobody_would_hear_is_lifted():
    hiss = np.random.default_rng(0).normal(size=RATE)
    mixed, _ = in_a_place(hiss, np.random.default_rng(1).normal(size=RATE), RATE, -30.0)
    assert decibel(hiss.std() / (mixed - hiss).std()) > -5.0


def test_a_pause_is_not_of_the_sound_that_a_place_drowns():
    sound = tone(1500.0, 3.0)
    sound[: RATE // 2] = sound[2 * RATE :] = 0.0
    _, (start, end) = in_a_place(sound, place(sound.size, RATE, np.random.default_rng(3)), RATE, 0)
    assert start == pytest.approx(0.5, abs=0.2)
    assert end == pytest.approx(2.0, abs=0.2)


def test_silence_in_a_place_is_the_place():
    around = place(4800, RATE, np.random.default_rng(3))
    mixed, span = in_a_place(np.zeros(4800), around, RATE, 0.0)
    assert np.array_equal(mixed, around)
    assert span == (0.0, 0.1)


def test_a_weighting_is_that_of_the_standard():
    for frequency, gain in {100.0: -19.1, 250.0: -8.6, 1000.0: 0.0, 4000.0: 1.0}.items():
        heard = a_weighted(tone(frequency), RATE).std() / tone(frequency).std()
        assert decibel(heard) == pytest.approx(gain, abs=0.2)


def test_noise_follows_its_shape():
    noise = shaped_noise(2**18, RATE, ((20, 0), (100, 0), (10_000, -60)), np.random.default_rng(2))
    power = np.abs(np.fft.rfft(noise)) ** 2
    hertz = np.fft.rfftfreq(noise.size, 1.0 / RATE)
    low, high = (power[(hertz > f / 1.2) & (hertz < 1.2 * f)].mean() for f in (100.0, 10_000.0))
    assert 5.0 * np.log10(low / high) == pytest.approx(30.0, abs=12.0)


def test_orders_stand_at_multiples_of_the_shaft():
    sound = orders(np.full(RATE, 24.0), RATE, 0.5, 2.0, 1.0, np.random.default_rng(0))
    spectrum = np.abs(np.fft.rfft(sound))
    strong = np.flatnonzero(spectrum > 0.01 * spectrum.max())
    assert not (strong % 12).any()
    assert strong.size > 5
