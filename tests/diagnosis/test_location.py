"""Stage, channel, band and phase of a difference are those of the numbers that differ."""

from __future__ import annotations

import numpy as np
import pytest

from noise.diagnosis.causes.location import (
    STAGES,
    differences,
    learn_stage_nulls,
    locate,
    stage_findings,
    stage_of,
)
from noise.diagnosis.evidence.channel_summary import BAND_EDGES
from sim.effects import EFFECTS
from tests.helpers.made_posteriors import MOVES, NAMES, made_nulls, made_table
from tests.helpers.small_rigs import table_of


@pytest.fixture(scope="module")
def nulls():
    return made_nulls()


def _table(changes, speeds=(1.0, 2.0, 3.0, 4.0)):
    measured = np.random.default_rng(9).normal(size=(len(speeds), len(NAMES)))
    for name, size in changes.items():
        measured[:, NAMES.index(name)] += size
    return table_of(NAMES, measured, speeds=list(speeds))


@pytest.mark.parametrize(("cause", "names"), MOVES.items())
def test_the_stage_is_that_of_the_cause(nulls, cause, names):
    findings = stage_findings(_table(dict.fromkeys(names, 15.0)), nulls)
    assert tuple(findings) == STAGES
    worst = max(findings, key=lambda stage: findings[stage].gap)
    assert worst == EFFECTS[cause].stage.value
    assert findings[worst].share > 0.9
    assert findings[worst].p_value == min(f.p_value for f in findings.values())
    assert sum(f.share for f in findings.values()) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("name", "channels", "band", "phase"),
    [
        ("acceleration_gain_5", ("acceleration",), (BAND_EDGES[4], BAND_EDGES[5]), "all"),
        ("pressure_gain_9", ("pressure",), (BAND_EDGES[8], BAND_EDGES[9]), "all"),
        ("contact_creep_up_4", ("torque",), (0.0, 1800.0), "stick"),
        ("contact_law_down_3", ("torque",), (0.0, 1800.0), "slip"),
        ("contact_peak_spread", ("torque",), (0.0, 1800.0), "cycle"),
        ("angle_speed_spread", ("angle",), None, "all"),
    ],
)
def test_channel_band_and_phase_are_those_of_the_number(nulls, name, channels, band, phase):
    found = locate(_table({name: 20.0}), nulls)
    assert found.stage == stage_of(name)
    assert found.channels == channels
    assert band is None or found.band == pytest.approx(band)
    assert found.phase == phase
    assert found.conditions == "all"


def test_what_shows_at_speed_alone_is_said_to(nulls):
    measured = np.random.default_rng(3).normal(size=(4, len(NAMES)))
    column = NAMES.index("contact_law_down_3")
    measured[:, column] = [0.1, -0.1, 30.0, 34.0]
    fast = table_of(NAMES, measured, speeds=[1.0, 2.0, 4.0, 5.0])
    assert locate(fast, nulls).conditions == "speed_rad_s >= 3"
    slow = table_of(NAMES, measured, speeds=[5.0, 4.0, 2.0, 1.0])
    assert locate(slow, nulls).conditions == "speed_rad_s < 3"
    backwards = table_of(NAMES, measured, speeds=[-1.0, -2.0, -4.0, -5.0])
    assert locate(backwards, nulls).conditions == "speed_rad_s <= -3"


def test_a_number_with_a_long_tail_does_not_hide_the_others_of_its_stage():
    rng = np.random.default_rng(4)
    tables = [made_table(rng) for _ in range(200)]
    for i in rng.permutation(200)[:25]:
        tables[i].measured[:, NAMES.index("pressure_top")] += 300.0
    learned = learn_stage_nulls(tables, NAMES, np.ones(len(NAMES)))
    assert (
        stage_findings(_table({"acceleration_hum_50": 12.0}), learned)["measurement"].p_value < 0.05
    )


def test_a_gap_is_one_between_repeats_and_bounded_where_a_number_hardly_scatters(nulls):
    rng = np.random.default_rng(5)
    gaps = [f.gap for _ in range(40) for f in stage_findings(made_table(rng), nulls).values()]
    assert np.median([gap for gap in gaps if gap > 0.0]) == pytest.approx(1.0, abs=0.25)
    findings = stage_findings(_table({"pressure_gain_9": 1e6}), nulls)
    assert findings["radiation"].gap == 100.0


def test_the_map_has_the_guilty_place_first_and_every_place_once(nulls):
    places = differences(_table({"pressure_gain_9": 30.0}), nulls)
    keys = [(p.stage, p.channels, p.band, p.phase) for p in places]
    assert len(set(keys)) == len(keys)
    first = places[0]
    assert (first.stage, first.channels) == ("radiation", ("pressure",))
    assert first.band == pytest.approx((BAND_EDGES[8], BAND_EDGES[9]))
    p_values = [place.p_value for place in places]
    assert p_values == sorted(p_values)
    assert 0.0 < p_values[0] <= 1.0
