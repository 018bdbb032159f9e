"""A bench whose sensors are noisy: their noise is no cause, and a cause is seen all the same."""

from dataclasses import replace

import numpy as np
import pytest

from noise.diagnosis.diagnose import diagnose
from noise.diagnosis.floor import reference
from noise.diagnosis.gap import gap_of
from noise.diagnosis.sentences import headline
from noise.diagnosis.signature import NAMES
from sim.acquisition import Acquisition
from tests.helpers.small_rigs import RIG_FILE, at, run, write_case

TIMES = {"torque": 12.0, "acceleration": 20.0, "pressure": 5.0, "angle": 20.0}
CREEPING = ("partial_slip", {"form": "mindlin", "share": 0.8})


def noisy(recording, seed):
    rng, samples = np.random.default_rng(seed), recording.samples.copy()
    for row, channel in zip(samples, recording.channels, strict=True):
        level = TIMES[channel.kind] * Acquisition().noise[channel.kind]
        row += level * np.exp(0.1 * rng.standard_normal()) * rng.standard_normal(row.size)
    return replace(recording, samples=samples)


def test_noise_of_sensors_that_nobody_states_is_no_cause(tmp_path):
    runs = [noisy(run(at(v), seed=30 + i), i) for i, v in enumerate((1.0, 1.6, 1.6, 2.5))]
    found = diagnose(*write_case(tmp_path, runs), quick=True)
    assert found.verdict == ()
    assert found.probabilities["background_noise"] == 0.0
    assert headline(found) == "No gap"


def test_one_recording_through_noisy_sensors_can_have_a_cause(tmp_path):
    loud = noisy(run(at(1.0), CREEPING, seed=3, seconds=0.6), 5)
    stated = "\n[sensors]\nnoise = { torque = 0.06, acceleration = 0.4, pressure = 4e-3 }\n"
    found = diagnose(*write_case(tmp_path, [loud], RIG_FILE + stated), quick=True)
    assert found.p_value < 0.05  # with twelve repeats their exchange alone gives 0.08 at least
    assert found.verdict != ()


@pytest.mark.parametrize("n", [1, 2])
def test_p_values_of_repeats_are_even_and_those_of_others_fall_below_any_threshold(n):
    rng, p = np.random.default_rng(0), []
    for _ in range(50):
        known = reference(list(rng.normal(size=(12, len(NAMES)))))
        p.append(gap_of(list(rng.normal(size=(n, len(NAMES)))), [known] * n).p_value)
    assert np.mean(np.array(p) < 0.05) <= 0.12
    assert 0.25 < np.median(p) < 0.75
    far = gap_of(list(rng.normal(6.0, 1.0, (n, len(NAMES)))), [known] * n)
    assert far.p_value < 0.002
