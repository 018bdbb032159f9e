"""Benches that the diagnosis learns from: of all kinds, and still rigs that do what rigs do."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from models.rig import LawSpec
from noise.training.causes.cases.draw import Truth, visible_through
from noise.training.causes.cases.rigs import (
    DEPARTURES,
    MATERIALS,
    OWN_LAWS,
    STARTS,
    draw_bench,
    draw_law,
    draw_start,
    scaled_law,
)
from sim.acquisition import Acquisition
from sim.friction import LAWS, friction_law
from sim.parameters import resolve


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


def test_a_departure_changes_what_it_names_and_nothing_else(benches):
    usual = Acquisition().noise
    for bench in benches:
        met = bench.departures
        assert bool(bench.law) == ("laws" in met)
        assert (set(bench.sizes.values()) != {1.0}) == ("sizes" in met)
        assert bool(bench.listed) == ("listed" in met)
        assert bench.repeats != ("single" in met)
        assert bool(bench.wrong_speed) == bool(bench.warmer) == ("conditions" in met)
        assert (bench.responses != "good") == ("responses" in met)
        assert bool(bench.start) == ("starts" in met)
        rough = any(not 0.7 <= bench.noise[kind] / usual[kind] <= 1.6 for kind in usual)
        assert not (rough or bench.bits) or "sensors" in met


def test_every_law_of_the_simulator_is_met_within_its_range():
    own = set(OWN_LAWS) - set(MATERIALS)
    assert own == set(LAWS) - {"coulomb"}
    for name in own:
        for seed in range(5):
            law = draw_law(name, np.random.default_rng(seed))
            resolve(name, friction_law(name).parameters, law.parameters)
            far = scaled_law(law, angle=9.0, time=0.3, torque=3.0)
            resolve(name, friction_law(name).parameters, far.parameters)


def test_a_law_on_a_rig_of_another_size_is_scaled_by_the_units_of_its_numbers():
    law = LawSpec("contact_with_memory", {"ageing_time": 1e-3, "weakening_share": 0.1})
    other = scaled_law(law, angle=2.0, time=0.5, torque=4.0).parameters
    plain = scaled_law(law, angle=1.0, time=1.0, torque=1.0).parameters
    assert other["ageing_time"] == pytest.approx(0.5e-3)
    assert other["weakening_share"] == 0.1
    assert other["contact_stiffness_per_torque"] == plain["contact_stiffness_per_torque"] / 2.0
    assert other["weakening_speed"] == plain["weakening_speed"] * 4.0


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
