"""The rig's data acquisition."""

import numpy as np
import pytest

from sim.acquisition import CONVERTER_GAIN, Acquisition, sample

QUIET = Acquisition(noise={})


def rng():
    return np.random.default_rng(0)


@pytest.mark.parametrize(
    ("kind", "bit"), [("torque", 0.05), ("acceleration", 0.477), ("angle", 6.04e-3)]
)
def test_one_bit_of_the_converter_is_what_the_thesis_says(kind, bit):
    ramp = np.linspace(0.0, 20 * bit, 5000)
    taken = sample({kind: ramp}, 1, Acquisition(noise={}, converter=True), rng())[kind]
    assert np.diff(np.unique(taken)) == pytest.approx(np.full(20, bit), rel=0.01)


def test_the_converter_clips_at_its_range():
    loud = np.array([-1e3, 1e3])
    taken = sample({"torque": loud}, 1, Acquisition(noise={}, converter=True), rng())["torque"]
    assert taken == pytest.approx([-1.25 * 82.0, 1.25 * 82.0], rel=1e-3)


def test_what_lies_above_half_the_sampling_rate_is_filtered_out():
    time = np.arange(96_000) / 96e3
    tone = np.sin(2 * np.pi * 20e3 * time)
    taken = sample({"pressure": tone}, 4, QUIET, rng())["pressure"]
    assert np.sqrt(np.mean(taken[100:-100] ** 2)) < 1e-2


def test_what_lies_below_passes():
    time = np.arange(96_000) / 96e3
    tone = np.sin(2 * np.pi * 5e3 * time)
    taken = sample({"pressure": tone}, 4, QUIET, rng())["pressure"]
    assert np.sqrt(2.0 * np.mean(taken[100:-100] ** 2)) == pytest.approx(1.0, abs=0.01)


def test_the_same_seed_gives_the_same_noise_and_another_another():
    silence = {"pressure": np.zeros(100)}
    first, again = (sample(silence, 1, Acquisition(), rng())["pressure"] for _ in range(2))
    other = sample(silence, 1, Acquisition(), np.random.default_rng(1))["pressure"]
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_every_kind_of_channel_has_a_gain():
    assert set(CONVERTER_GAIN) >= set(Acquisition().noise)
