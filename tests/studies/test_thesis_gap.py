"""The thesis's own gap: cells, candidates, fits that know no left-out cell, and the page.

The page is written by ``python -m tests.studies.thesis_gap --out tests/studies/thesis_gap.md``.
Where a test says that it is stale, look at what changed, and write it again.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from noise.training.calibrate.thesis_table import CELLS
from sim.analysis.critical_speeds import critical_speeds
from sim.effects import EFFECTS
from sim.effects.effect import Stage, activated
from tests.studies.thesis_gap import fit
from tests.studies.thesis_gap.__main__ import candidates, main, rows_of
from tests.studies.thesis_gap.candidates import KNOBS, PAIRS, Candidate, nominal_rig, singles
from tests.studies.thesis_gap.fit import Effort, Trials, fitted_point, rms
from tests.studies.thesis_gap.holdout import closed, errors_of, examine
from tests.studies.thesis_gap.page import CONSTANT, gap_page, gap_rows, least_without_a_regime
from tests.studies.thesis_gap.slips import SLIP_CELLS, slip_errors
from tests.studies.thesis_gap.speeds import coarse_errors, errors, reading_error

PAGE = Path(__file__).with_name("thesis_gap.md")
STALE = "stale; run: python -m tests.studies.thesis_gap --out tests/studies/thesis_gap.md"
ALL = [*singles(), *map(Candidate, PAIRS)]


def page_lines():
    return PAGE.read_text(encoding="utf-8").splitlines()


# Candidates


def test_every_effect_of_drive_and_friction_is_a_candidate():
    acting = {e.name for e in EFFECTS.values() if e.stage in (Stage.DRIVE, Stage.FRICTION)}
    assert set(KNOBS) == acting


def test_a_candidate_has_its_strength_and_at_most_two_further_parameters():
    for name, knobs in KNOBS.items():
        assert knobs[0].name == EFFECTS[name].strength
        assert len(knobs) <= 3


@pytest.mark.parametrize("candidate", ALL, ids=lambda c: c.name)
@settings(max_examples=20)
@given(data=st.data())
def test_every_point_of_the_cube_is_a_rig(candidate, data):
    place = st.floats(0.0, 1.0)
    n = candidate.dimensions
    point = data.draw(st.lists(place, min_size=n, max_size=n))
    rig = candidate.rig(point)
    assert [a.effect.name for a in activated(rig.effects, EFFECTS)] == list(candidate.effects)
    assert all(fit.critical_torque >= fit.kinetic_torque for fit in rig.fits)


def test_each_form_is_within_reach():
    for name in KNOBS:
        candidate = Candidate((name,))
        rest = [0.5] * (candidate.dimensions - 1)
        forms = {
            candidate.specs([place, *rest])[0].parameters["form"] for place in np.linspace(0, 1, 24)
        }
        assert forms == set(EFFECTS[name].forms)


# Errors


def test_constant_torques_end_stick_and_vibration_together():
    found = errors(nominal_rig())
    speeds = [cell.value * np.exp(e) for cell, e in zip(CELLS, found, strict=True)]
    assert speeds[:3] == pytest.approx(speeds[3:])
    assert rms(found) >= least_without_a_regime()


def test_reported_errors_are_those_of_the_defined_critical_speeds():
    rig = nominal_rig()
    speeds = tuple(0.25 * i for i in range(1, 65))
    for cell, error in zip(CELLS, errors(rig), strict=True):
        found = critical_speeds(rig, cell.interference, cell.support_stiffness, speeds)
        assert np.log(getattr(found, cell.item) / cell.value) == pytest.approx(error)


def test_the_search_sees_nearly_what_is_reported():
    rig = nominal_rig()
    assert np.abs(coarse_errors(rig) - errors(rig)).max() < np.log(1.2)


def test_a_rig_that_never_vibrates_counts_as_half_a_radian_a_second():
    rig = nominal_rig()
    smooth = replace(
        rig, fits=tuple(replace(f, critical_torque=f.kinetic_torque) for f in rig.fits)
    )
    expected = np.log([0.5 / cell.value for cell in CELLS])
    assert errors(smooth) == pytest.approx(expected)
    assert coarse_errors(smooth) == pytest.approx(expected)
    assert slip_errors(smooth)[: len(SLIP_CELLS) - 8] == pytest.approx(np.log(2.0))


def test_constant_torques_slip_faster_than_the_mode_and_right_on_a_fixed_clamp():
    found = dict(zip(SLIP_CELLS, slip_errors(nominal_rig()), strict=True))
    assert found["0.279 mm, fixed, 1 rad/s: 155 Hz"] == pytest.approx(np.log(153.1 / 155), abs=0.01)
    assert found["0.381 mm, 2214 Nm/rad, 1 rad/s: at most 250 Hz"] == 0.0
    assert found["0.381 mm, 2214 Nm/rad, 10 rad/s: at most 250 Hz"] > 0.5


# Fits


@pytest.fixture
def bowl(monkeypatch):
    """Errors that are the distance from one point a cell, without any simulation."""
    seen = {"lies": 0.0}
    centres = np.linspace(0.1, 0.7, len(CELLS))

    def errors_at(point):
        found = np.array([np.linalg.norm(np.asarray(point) - c) for c in centres])
        found[0] += seen["lies"]
        return found

    monkeypatch.setattr(fit, "coarse_errors", errors_at)
    monkeypatch.setattr(Candidate, "rig", lambda _, point: point)
    return seen


def test_a_left_out_cell_does_not_steer_its_fit(bowl):
    training = range(1, len(CELLS))
    first = fitted_point(Trials(Candidate(())), training, Effort(4, 20))
    bowl["lies"] = 7.0
    assert fitted_point(Trials(Candidate(())), training, Effort(4, 20)) == first


def test_the_local_search_betters_the_design(bowl):
    trials = Trials(Candidate(()))
    cells = range(len(CELLS))
    rough, fine = (fitted_point(trials, cells, Effort(3, steps)) for steps in (0, 40))
    assert rms(trials.errors(fine)) < rms(trials.errors(rough))
    assert all(0.0 <= place <= 1.0 for place in fine)


def test_fits_can_be_repeated(bowl):
    one, other = (fitted_point(Trials(Candidate(())), (1, 3), Effort(3, 9)) for _ in range(2))
    assert one == other


# Closed


errors_strategy = st.lists(st.floats(0.2, 2.0), min_size=6, max_size=6).map(np.array)


@settings(max_examples=10)
@given(before=errors_strategy)
def test_no_change_closes_nothing_and_the_floor_closes_all(before):
    floor = reading_error()
    same, whole = closed(before, -before, floor), closed(before, floor, floor)
    assert (same.share, same.low, same.high) == pytest.approx((0.0, 0.0, 0.0))
    assert (whole.share, whole.low, whole.high) == pytest.approx((1.0, 1.0, 1.0))


@settings(max_examples=10)
@given(before=errors_strategy, factor=st.floats(0.1, 3.0))
def test_closed_falls_as_the_error_left_grows(before, factor):
    floor = reading_error()
    assert (
        closed(before, factor * before, floor).share
        > closed(before, 1.1 * factor * before, floor).share
    )


# The page


def test_the_page_holds_for_what_is_cheap_to_check():
    before = errors_of(nominal_rig())
    finding = examine(Candidate(()), Effort())
    page = gap_page(gap_rows(before, before, [finding])).splitlines()
    cheap = [line for line in page if line.startswith((f"| {CONSTANT}", "| parameters"))]
    assert len(cheap) == 4
    assert set(cheap) <= set(page_lines()), STALE


@pytest.mark.slow
def test_the_page_is_what_the_program_writes():
    assert page_lines() == gap_page(rows_of(candidates())).splitlines(), STALE


def test_an_unknown_candidate_is_refused_by_name(capsys):
    assert main(["--only", "magic"]) == 2
    assert "'magic' is unknown" in capsys.readouterr().err
