"""Benches that the diagnosis learns from: of all kinds, and still rigs that do what rigs do."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from noise.training.causes.cases.draw import Truth, visible_through
from noise.training.causes.cases.rigs import (
    DEPARTURES,
    OWN_LAWS,
    STARTS,
    draw_bench,
    draw_start,
)


@pytest.fixture(scope="module")
def benches():
    return [draw_bench(np.random.default_rng(seed)) for seed in range(600)]


def test_a_third_is_quiet_half_have_the_constant_law_and_all_departures_are_met(benches):
    quiet = [bench for bench in benches if not bench.departures]
    assert len(quiet) / len(benches) == pytest.approx(0.3, abs=0.05)
    assert all(bench.law == "" and bench.repeats and not bench.bits for bench in quiet)
    constant = sum(not bench.law for bench in benches)
    assert constant / len(benches) == pytest.approx(0.5, abs=0.06)
    met = Counter(name for bench in benches for name in bench.departures)
    assert set(met) == {"laws", *DEPARTURES}
    assert min(met.values()) > 0.05 * len(benches)
    assert {bench.law for bench in benches} == {"", *OWN_LAWS}
    assert {bench.start for bench in benches} == {"", *STARTS}


@pytest.mark.parametrize("name", STARTS)
def test_a_start_ends_at_the_speed_that_is_stated(name):
    for seed in range(10):
        rng = np.random.default_rng(seed)
        shaft, before = draw_start(name, 3.0, 0.8, 0.25, rng)
        speed = shaft.speed(before + np.linspace(0.0, 0.8, 200))
        assert speed[-1] == pytest.approx(3.0, rel=2e-3)
        assert np.ptp(speed) > 0.05
        assert (before == 0.0) == (name == "rest") == (speed[0] == 0.0)


def test_what_acts_in_no_channel_that_was_recorded_is_no_cause():
    pair = Truth("pair", ("clipping", "plate_modes"), ("plain", "modes"), (0.2, 0.3))
    acting = [{"torque", "pressure"}, {"pressure"}]
    assert visible_through(pair, acting, ("pressure",)).effects == pair.effects
    one = visible_through(pair, acting, ("torque", "angle"))
    assert (one.kind, one.effects, one.strengths) == ("one", ("clipping",), (0.2,))
    assert visible_through(pair, acting, ("angle",)).kind == "none"
    offset = Truth("parameters", offsets=(("damping", 1.1),))
    assert visible_through(offset, (), ("torque",)) == offset
