"""Bodies creak, squawk and squeal as their mechanisms say."""

import numpy as np
import pytest

from features.kernels.lines import find_lines
from features.kernels.spectra import autospectrum
from noise.training.classifier.friction_mechanisms import (
    ENVELOPE_RATE,
    ModalBody,
    amplitudes,
    slide,
)
from noise.training.classifier.friction_sounds import (
    FRICTION_SOUNDS,
    contact_load,
    friction_sound,
)

RATE = 48e3


def slips_of(drive, **changed):
    given = {"ageing_time": 1e-4, "scatter": 0.0, "rng": np.random.default_rng(0)} | changed
    return slide(drive, RATE, **given)


def test_a_steady_drive_slips_at_its_speed_over_the_distance_of_a_stick():
    gaps = np.diff(slips_of(np.full(48_000, 40.0)).time)
    assert gaps == pytest.approx(np.full(gaps.size, 1 / 40.0), rel=0.01)


def test_longer_sticks_make_larger_slips():
    drive = np.repeat([200.0, 5.0], 96_000)
    slips = slips_of(drive, ageing_time=0.01)
    assert slips.size[slips.time > 2.5].mean() > 1.2 * slips.size[slips.time < 1.9].mean()


def test_a_mode_rings_at_its_frequency_and_dies_as_its_damping_says():
    body = ModalBody(np.array([700.0]), np.array([0.01]), np.array([1.0]))
    sound = body.impulse_response(RATE)
    assert np.abs(np.fft.rfft(sound, 48_000)).argmax() == pytest.approx(700, abs=2)
    level = [np.abs(sound[a : a + 480]).max() for a in (0, 4800)]
    assert level[1] / level[0] == pytest.approx(np.exp(-0.01 * 2 * np.pi * 700 * 0.1), rel=0.05)


def test_of_two_modes_that_share_their_losses_the_faster_wins_and_the_winner_may_change():
    m = int(4 * ENVELOPE_RATE)
    growth = np.array([np.linspace(300.0, 100.0, m), np.linspace(100.0, 300.0, m)])
    solved = np.abs(
        amplitudes(
            growth, 0.0 * growth, np.array([[200.0, 300.0], [300.0, 200.0]]), np.full(2, 0.3),
            np.random.default_rng(0),
        )
    )  # fmt: skip
    quarter = m // 8
    assert solved[0, quarter : 2 * quarter].mean() > 5 * solved[1, quarter : 2 * quarter].mean()
    assert solved[1, -quarter:].mean() > 5 * solved[0, -quarter:].mean()


SQUEALS = [name for name, row in FRICTION_SOUNDS.items() if row["label"] == "squeal"]


def drawn(name, seed, n=48_000):
    return friction_sound(name, n, RATE, np.random.default_rng(seed))[0]


@pytest.mark.parametrize("name", SQUEALS)
def test_a_squeal_is_loudest_within_the_range_of_its_kind(name):
    low, high = FRICTION_SOUNDS[name]["frequency_hz"]
    high *= FRICTION_SOUNDS[name].get("ratio", (1.0, 1.0))[1]
    inside = 0
    for seed in range(8):
        spectrum = np.abs(np.fft.rfft(drawn(name, seed))) ** 2
        inside += 0.6 * low < np.convolve(spectrum, np.ones(20), mode="same").argmax() < 1.4 * high
    assert inside >= 7


def test_a_short_squeal_alone_is_silent_before_and_after():
    row = {**FRICTION_SOUNDS["brake_squeal"], "chirps": 1.0}
    loads = [contact_load(row, 12_000, np.random.default_rng(seed)) for seed in range(20)]
    lengths = [np.ptp(np.flatnonzero(load)) / ENVELOPE_RATE for load in loads]
    assert min(lengths) < 0.5 < max(lengths)  # alone, and in sequence
    for seed in range(12):
        rng = np.random.default_rng(seed)
        sound, span, _ = friction_sound("brake_squeal", 96_000, RATE, rng)
        first, last = (round(at * RATE) for at in span)
        inside = sound[first:last].std()
        for outside in (sound[: max(0, first - 480)], sound[last + 9600 :]):
            assert not outside.size or outside.std() < 0.1 * inside


def test_modes_that_none_wins_sound_at_several_frequencies():
    several = 0
    for seed in range(10):
        sound = drawn("modes_squawk", seed, 96_000)
        lines = find_lines(autospectrum(sound, RATE), low=60.0, high=5e3)
        several += np.count_nonzero(lines.power > lines.power[:1] * 10**-1.8) > 1
    assert several >= 8


@pytest.mark.parametrize("name", ["chatter_squawk", "bowed_string_squawk", "singing_hinge"])
def test_regular_slips_have_harmonics(name):
    found = 0
    for seed in range(10):
        sound = drawn(name, seed, 96_000)[:24_000]
        found += find_lines(autospectrum(sound, RATE), low=40.0, high=8e3).frequency.size >= 3
    assert found >= 6
