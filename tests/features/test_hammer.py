"""Hammer hits: what is refused, and the response function of what is not."""

import numpy as np
import pytest
from scipy.signal import coherence, csd, welch

from features.modal.hammer import Hit, check_hit, estimate_transfer_function
from models.errors import RecordingError

RATE = 20e3
PULSE = np.sin(np.pi * np.arange(0.3, 9) / 9)


def pulse(n=2000, at=20, peak=80.0):
    force = np.zeros(n)
    force[at : at + PULSE.size] = peak * PULSE
    return force


def ringing(n=2000, frequency=700.0):
    t = np.arange(n) / RATE
    return 30 * np.exp(-60 * t) * np.sin(2 * np.pi * frequency * t)


def hits(rng, n_hits=6, noise=0.02):
    answer = ringing()
    made = []
    for i in range(n_hits):
        force = pulse(at=15 + i, peak=rng.uniform(50, 90))
        response = np.convolve(force, answer)[: force.size]
        made.append(
            Hit(
                force + noise * rng.standard_normal(force.size),
                response + noise * rng.standard_normal(force.size) * np.abs(response).max(),
                RATE,
                f"hit_{i}",
            )
        )
    return made


@pytest.mark.parametrize(("after", "share"), [(12, 0.3), (60, 0.08), (900, 0.6), (400, 1.4)])
def test_a_second_contact_is_a_double_hit(after, share):
    with pytest.raises(RecordingError, match="double hit; the force rises again"):
        check_hit(Hit(pulse() + pulse(at=20 + after, peak=80 * share), ringing(), RATE))


@pytest.mark.parametrize("limit", [0.3, 0.5, 0.8])
def test_a_force_that_is_cut_off_is_clipped(limit):
    with pytest.raises(RecordingError, match="force is clipped"):
        check_hit(Hit(np.minimum(pulse(), 80 * limit), ringing(), RATE))


@pytest.mark.parametrize("curve", ["straight", "slow wave", "step"])
@pytest.mark.parametrize("size", [0.03, 0.3, 2.0])
def test_a_force_that_drifts_is_named_so(curve, size):
    t = np.linspace(0.0, 1.0, 2000)
    drift = {"straight": t, "slow wave": np.sin(5 * t), "step": (t > 0.4).astype(float)}[curve]
    noise = 0.05 * np.random.default_rng(0).standard_normal(2000)
    with pytest.raises(RecordingError, match="the force drifts beside the blow"):
        check_hit(Hit(pulse() + 80 * size * drift + noise, ringing(), RATE))


@pytest.mark.parametrize("sign", [1, -1])
def test_swapped_channels_are_named_so(sign):
    with pytest.raises(RecordingError, match="force and response are swapped"):
        check_hit(Hit(sign * ringing(), pulse(), RATE))


def test_h1_and_coherence_are_those_of_scipy():
    some = hits(np.random.default_rng(1))
    force = np.concatenate([hit.force for hit in some])
    response = np.concatenate([hit.response for hit in some])
    arguments = (RATE, "boxcar", 2000, 0)
    f, cross = csd(force, response, *arguments)
    estimate = estimate_transfer_function(some)
    assert np.array_equal(estimate.frequencies, f)
    np.testing.assert_allclose(estimate.response[1:], (cross / welch(force, *arguments)[1])[1:])
    expected = coherence(force, response, *arguments)[1]
    np.testing.assert_allclose(estimate.coherence[1:], expected[1:], rtol=1e-9)
