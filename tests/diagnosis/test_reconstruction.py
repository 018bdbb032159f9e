"""The contact that no sensor sees is rebuilt from the torque that one does."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from models.condition import FIXED
from noise.diagnosis.evidence.contact_summary import slip_starts
from noise.diagnosis.evidence.reconstruction import reconstruct
from sim.acquisition import Acquisition
from sim.bushing import lumped_bushing
from sim.run import simulate
from tests.helpers.small_rigs import RIG

INTERFERENCE, SPEED = 0.279e-3, 1.0


def _rebuilt(support, *, bushing=None, rate=30e3, seconds=0.4):
    run = simulate(
        RIG, SPEED, interference=INTERFERENCE, support_stiffness=support, seconds=seconds,
        acquisition=Acquisition(rate=rate, noise={}),
    )  # fmt: skip
    torque = run.recording["torque"]
    bushing = bushing or lumped_bushing(RIG, INTERFERENCE, support)
    return reconstruct(torque, np.full(torque.size, SPEED), rate, bushing), run.recording


@pytest.mark.parametrize("support", [2214.0, 3745.0, FIXED])
@pytest.mark.parametrize("rate", [30e3, 48e3])
def test_the_contact_of_a_coulomb_run_slides_at_the_kinetic_torque(support, rate):
    found, _ = _rebuilt(support, rate=rate)
    sliding = found.sliding_speed > 8.0
    assert np.count_nonzero(sliding) > 300
    torque = found.friction_torque[sliding]
    assert np.median(torque) == pytest.approx(8.0, rel=0.01)
    assert np.percentile(np.abs(torque - 8.0), 90) < 0.4
    # what is measured is not that: the surface's inertia takes its share
    assert np.std(found.torque[sliding]) > 4 * np.std(torque)


@pytest.mark.parametrize("support", [2214.0, 3745.0, FIXED])
def test_in_stick_the_surface_moves_with_the_shaft(support):
    found, _ = _rebuilt(support)
    starts, ends = slip_starts(found, SPEED)
    assert starts.size >= 4
    stick = np.ones(found.torque.size, bool)
    for a, b in zip(starts, ends, strict=True):
        stick[max(a - 24, 0) : b + 24] = False
    assert stick.mean() > 0.6
    # the clamp rings down from before the recording, which no one has measured
    settled = stick & (np.arange(stick.size) > 0.1 * found.rate)
    assert np.percentile(np.abs(found.sliding_speed[settled]), 95) < 0.05 * SPEED
    assert found.friction_torque[stick].max() < 1.01 * 10.7


@pytest.mark.parametrize("support", [2214.0, FIXED])
@pytest.mark.parametrize(
    ("sensitivity", "parts"),
    [
        ("by_stiffness", ("elastomer_stiffness",)),
        ("by_damping", ("elastomer_damping", "support_damping")),
        ("by_clamp", ("clamp_inertia",)),
    ],
)
def test_sensitivities_are_what_a_slightly_different_bushing_gives(support, sensitivity, parts):
    bushing, h = lumped_bushing(RIG, INTERFERENCE, support), 1e-4
    found, recording = _rebuilt(support)
    speed = np.full(recording.samples.shape[1], SPEED)

    def slid(factor):
        other = replace(bushing, **{part: factor * getattr(bushing, part) for part in parts})
        return reconstruct(recording["torque"], speed, 30e3, other).sliding_speed

    # a stiffer elastomer twists less for the torque that was measured, so the surface slides more
    slope = (slid(1 + h) - slid(1 - h)) / (2 * h)
    given = getattr(found, sensitivity)
    expected = max(np.abs(slope).max(), 1e-12)
    assert np.abs(slope - given).max() < 1e-3 * expected
    assert given.any() == (sensitivity != "by_clamp" or not math.isinf(support))
