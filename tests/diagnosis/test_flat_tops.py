"""Flat peaks are an overload's: no vibration, no noise and no coarse converter has them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from noise.diagnosis.causes.location import locate, stage_findings
from noise.diagnosis.first_answer import flat_channels, pile_ups
from sim.acquisition import decimate
from tests.helpers.made_posteriors import NAMES, made_nulls
from tests.helpers.small_rigs import at, run, table_of

SPEEDS = (1.0, 1.6, 2.5)


@pytest.fixture(scope="module")
def plain():
    return [run(at(speed), seed=i) for i, speed in enumerate(SPEEDS)]


def _cut(recording, kind, share):
    """Overload a channel at a share of its peak, before a filter that rounds the corners."""
    samples = np.array(recording.samples)
    row = recording.first(kind)
    x = samples[row] - samples[row].mean()
    fine = np.interp(np.arange(4 * x.size) / 4.0, np.arange(x.size), x)
    limit = share * np.abs(x).max()
    samples[row] = samples[row].mean() + decimate(np.clip(fine, -limit, limit), 4)
    return replace(recording, samples=samples)


@pytest.mark.parametrize(("kind", "share"), [("pressure", 0.3), ("torque", 0.6)])
def test_an_overloaded_channel_is_told_through_its_filter(plain, kind, share):
    cut = [_cut(one, kind, share) for one in plain]
    assert flat_channels(cut, lambda one: plain[cut.index(one)]) == (kind,)
    assert flat_channels(plain, lambda one: one) == ()


def test_what_the_simulation_has_as_well_is_no_overload(plain):
    cut = [_cut(one, "pressure", 0.3) for one in plain]
    assert flat_channels(cut, lambda one: one) == ()


@settings(max_examples=30)
@given(st.floats(20.0, 3000.0), st.floats(0.0, 1.0), st.integers(0, 99))
def test_no_tone_in_noise_passes_its_peak_slower_than_a_parabola(frequency, noise, seed):
    rng = np.random.default_rng(seed)
    time = np.arange(12_000) / 30e3
    tone = np.sin(2 * np.pi * frequency * time + rng.uniform(0.0, 6.0))
    ratios = pile_ups(tone + noise * rng.standard_normal(time.size))
    assert ratios.min(axis=0).max() < 3.0


def test_what_differs_in_an_overloaded_channel_is_the_sensors():
    z = np.zeros((4, len(NAMES)))
    z[:, NAMES.index("pressure_gain_9")] = 15.0
    table, nulls = table_of(NAMES, z), made_nulls()
    plain, flat = (stage_findings(table, nulls, kinds) for kinds in ((), ("pressure",)))
    assert plain["radiation"].gap == max(one.gap for one in plain.values())
    assert flat["radiation"].gap < flat["measurement"].gap
    assert flat["measurement"].p_value <= 0.05
    assert locate(table, nulls, flat=("pressure",)).stage == "measurement"
