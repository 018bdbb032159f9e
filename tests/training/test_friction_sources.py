"""Bodies creak, squawk and squeal as their mechanisms say."""

import numpy as np
import pytest

from features.kernels.lines import find_lines
from features.kernels.spectra import autospectrum
from noise.training.classifier.described_samples import (
    CREAKS,
    SQUAWKS,
    creak,
    pulses,
    random_slips,
    squawk,
)
from noise.training.classifier.friction_sources.limit_cycle import ENVELOPE_RATE, amplitudes
from noise.training.classifier.friction_sources.modal_body import ModalBody, random_body
from noise.training.classifier.friction_sources.slider import Slips, random_drive, slide
from noise.training.classifier.friction_sources.squeals import SQUEALS, squeal

RATE = 48e3


def slips_of(drive, **changed):
    given = {"ageing_time": 1e-4, "scatter": 0.0, "rng": np.random.default_rng(0)} | changed
    return slide(drive, RATE, **given)


def test_a_steady_drive_slips_at_its_speed_over_the_distance_of_a_stick():
    gaps = np.diff(slips_of(np.full(48_000, 40.0)).time)
    assert gaps == pytest.approx(np.full(gaps.size, 1 / 40.0), rel=0.01)


def test_a_drive_that_stands_still_makes_no_slip():
    assert slips_of(np.zeros(48_000)).time.size == 0


def test_longer_sticks_make_larger_slips():
    drive = np.repeat([200.0, 5.0], 96_000)
    slips = slips_of(drive, ageing_time=0.01)
    assert slips.size[slips.time > 2.5].mean() > 1.2 * slips.size[slips.time < 1.9].mean()


def test_scatter_makes_the_rate_irregular():
    steady, scattered = (
        np.diff(slips_of(np.full(96_000, 50.0), scatter=s).time) for s in (0.0, 0.3)
    )
    assert scattered.std() > 0.2 * scattered.mean() > 10 * steady.std()


def test_the_rate_of_a_creaks_slips_glides_by_half_an_octave_or_more_in_most():
    glides = []
    for seed in range(40):
        slips = random_slips("door", 96_000, RATE, np.random.default_rng(seed))
        rate = 1.0 / np.diff(slips.time)
        slow, fast = np.percentile(rate, [10, 90])
        glides.append(fast / slow)
    assert np.mean(np.array(glides) > 1.41) > 0.8


def test_a_drive_wanders_within_its_range_or_rests():
    drive = random_drive(96_000, RATE, 5.0, 250.0, np.random.default_rng(4))
    moving = drive[drive > 0.0]
    assert 3.0 < moving.min() < moving.max() < 400.0


def test_a_mode_rings_at_its_frequency_and_dies_as_its_damping_says():
    body = ModalBody(np.array([700.0]), np.array([0.01]), np.array([1.0]))
    sound = body.impulse_response(RATE)
    assert np.abs(np.fft.rfft(sound, 48_000)).argmax() == pytest.approx(700, abs=2)
    level = [np.abs(sound[a : a + 480]).max() for a in (0, 4800)]
    assert level[1] / level[0] == pytest.approx(np.exp(-0.01 * 2 * np.pi * 700 * 0.1), rel=0.05)


def test_a_body_is_stable():
    for seed in range(10):
        sound = random_body("hinge", np.random.default_rng(seed)).impulse_response(RATE)
        assert np.abs(sound[-480:]).max() < np.abs(sound[:480]).max()


def test_a_pulse_comes_when_its_slip_does():
    force = pulses(Slips(np.array([0.02]), np.array([1.0])), 2400, RATE, np.random.default_rng(1))
    assert not np.abs(force[:950]).max() > 1e-9
    assert force[955:1010].max() > 0.1


def test_growth_balances_loss_at_an_amplitude_of_one():
    one = np.ones((1, 6000))
    grown = amplitudes(
        200.0 * one, 0.0 * one, np.array([[200.0]]), np.zeros(1), np.random.default_rng(0)
    )
    assert np.abs(grown[0, -1]) == pytest.approx(1.0, abs=0.01)


def test_without_growth_a_mode_dies():
    one = np.ones((1, 6000))
    gone = amplitudes(
        -50.0 * one, 0.0 * one, np.array([[50.0]]), np.zeros(1), np.random.default_rng(0)
    )
    assert np.abs(gone[0, -1]) < 1e-6


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


@pytest.mark.parametrize("kind", SQUEALS)
def test_a_squeal_is_loudest_within_the_range_of_its_kind(kind):
    low, high = SQUEALS[kind].frequency
    inside = 0
    for seed in range(8):
        sound = squeal(kind, 48_000, RATE, np.random.default_rng(seed))
        spectrum = np.abs(np.fft.rfft(sound)) ** 2
        smooth = np.convolve(spectrum, np.ones(20), mode="same")
        inside += 0.6 * low < smooth.argmax() < 1.4 * high
    assert inside >= 7


def test_a_chalks_squeal_is_never_as_steady_as_a_tone():
    for seed in range(6):
        sound = squeal("chalk", 48_000, RATE, np.random.default_rng(seed))
        power = np.abs(np.fft.rfft(sound)) ** 2
        at = power[300:].argmax() + 300
        assert power[at - 1 : at + 2].sum() < 0.9 * power.sum()


def test_modes_that_none_wins_sound_at_several_frequencies():
    several = 0
    for seed in range(10):
        sound = squawk("modes", 96_000, RATE, np.random.default_rng(seed))
        lines = find_lines(autospectrum(sound, RATE), low=60.0, high=5e3)
        several += np.count_nonzero(lines.power > lines.power[:1] * 10**-1.8) > 1
    assert several >= 8


def test_a_chatter_has_harmonics_of_its_slips():
    found = 0
    for seed in range(10):
        sound = squawk("chatter", 96_000, RATE, np.random.default_rng(seed))
        lines = find_lines(autospectrum(sound, RATE), low=40.0, high=5e3)
        found += lines.frequency.size >= 3
    assert found >= 7


@pytest.mark.parametrize(
    ("make", "kind"),
    [(creak, k) for k in CREAKS] + [(squeal, k) for k in SQUEALS] + [(squawk, k) for k in SQUAWKS],
)
def test_every_body_sounds_the_same_again_and_differently_with_another_seed(make, kind):
    first, again, other = (make(kind, 24_000, RATE, np.random.default_rng(s)) for s in (1, 1, 2))
    assert np.isfinite(first).all()
    assert np.abs(first).max() == pytest.approx(1.0)
    assert first.tobytes() == again.tobytes()
    assert first.tobytes() != other.tobytes()
