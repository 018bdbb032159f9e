"""The published numbers beside the computed ones: the table, its verdicts, and its page.

The page is written by ``bushing-noise thesis --out tests/thesis.md``. Where a test says that it is
stale, look at what changed, and write it again.
"""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.rig_file import load_material_rig
from noise.cli import main
from noise.thesis import table
from noise.thesis.table import reasons
from sim.analysis.critical_speeds import critical_damping, motion_from_rest
from sim.analysis.regime import Regime, friction_regime

PAGE = Path(__file__).parents[1] / "thesis.md"
STALE = "tests/thesis.md is stale; run: bushing-noise thesis --out tests/thesis.md"
THESIS = load_material_rig("fluorocarbon-thesis")
PDMS = load_material_rig("PDMS")


def published_rows():
    lines = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("|")]
    cells = [tuple(cell.strip() for cell in line.strip("|").split("|")) for line in lines]
    return [dict(zip(cells[0], line, strict=True)) for line in cells[2:]]


@pytest.fixture(scope="module")
def computed_rows():
    return table.thesis_rows(table.group_names())


# The page


@pytest.mark.ci
@pytest.mark.slow
def test_the_page_is_what_the_program_writes(computed_rows):
    assert PAGE.read_text(encoding="utf-8") == table.thesis_page(computed_rows), STALE


@pytest.mark.ci
@pytest.mark.slow
def test_what_was_measured_and_missed_says_why_and_nothing_else_does(computed_rows):
    missed = {(r.item, r.condition) for r in computed_rows if r.misses}
    assert missed == {(r.item, r.condition) for r in computed_rows if r.why}
    assert missed == set(reasons())


@pytest.mark.ci
@pytest.mark.slow
def test_a_measured_fact_is_counted_by_what_ships(computed_rows):
    for found in computed_rows:
        if found.measured and found.counted and np.isnan(found.calibrated):
            # The shipped material does not slip there, nor did the rig, beyond its V_crit1.
            assert found.item in {"slip_frequency", "strongest_share"}
    modes = [r for r in computed_rows if r.item == "beam_mode" and r.measured and r.counted]
    assert sorted(r.published.low for r in modes) == [250.0, 310.0, 900.0, 1375.0, 4500.0, 6000.0]


def test_the_page_has_a_row_for_every_checkable_number():
    found = published_rows()
    assert len(found) >= 60
    assert len({(r["item"], r["condition"]) for r in found}) == len(found)
    assert all(r["item"] == r["item"].lower() and " " not in r["item"] for r in found)
    assert all(r["published"] and r["unit"] and r["verdict"] for r in found)


@pytest.mark.parametrize(
    ("item", "condition", "column", "value", "tolerance"),
    [
        ("critical_damping", "0.279 mm, 3745 Nm/rad, 7.5 rad/s", "listing", 0.0760, 5e-5),
        ("critical_damping", "0.279 mm, 3745 Nm/rad, 7.5 rad/s", "exact", 0.0781, 5e-5),
        ("v_crit1", "0.279 mm, 2214 Nm/rad", "listing", 5.5, 0.0),
        ("v_crit1", "0.279 mm, 2214 Nm/rad", "exact", 5.5, 0.0),
        ("v_crit1", "0.279 mm, 3745 Nm/rad", "exact", 7.0, 0.0),
        ("simulated_stick_slip", "0.279 mm, 2214 Nm/rad", "exact", 5.5, 0.0),
        ("simulated_stick_slip", "0.279 mm, 3745 Nm/rad", "exact", 7.0, 0.0),
        ("slip_frequency", "0.279 mm, fixed clamp, 1 rad/s", "exact", 153.1, 0.5),
        ("slip_frequency", "0.279 mm, 2214 Nm/rad, 1 rad/s", "exact", 152.0, 0.5),
        ("slip_frequency", "0.279 mm, 3745 Nm/rad, 1 rad/s", "exact", 149.75, 0.5),
        *(
            (
                "slip_frequency",
                f"0.381 mm, 2214 Nm/rad, c_E 0.08, {v:g} rad/s",
                "exact",
                f,
                0.015 * f,
            )
            for v, f in ((1.0, 82.0), (2.5, 185.0), (5.0, 368.0), (7.5, 482.0), (10.0, 708.0))
        ),
        ("peak_sliding_speed", "0.279 mm, 2214 Nm/rad, 10 rad/s", "exact", 24.2, 0.05),
        ("peak_sliding_speed", "0.279 mm, 3745 Nm/rad, 10 rad/s", "exact", 27.2, 0.05),
        ("support_stiffness", "(4.11), 12.3 cm", "exact", 2198.6, 0.05),
        ("first_torsional_mode", "0.279 mm, 2214 Nm/rad, stuck", "exact", 295.8, 0.05),
        ("first_torsional_mode", "0.279 mm, 3745 Nm/rad, sliding", "exact", 334.0, 0.05),
    ],
)
def test_computed_values_are_those_of_an_independent_check(
    item, condition, column, value, tolerance
):
    (found,) = [r for r in published_rows() if (r["item"], r["condition"]) == (item, condition)]
    assert float(found[column]) == pytest.approx(value, abs=tolerance + 1e-9)


@pytest.mark.parametrize(
    ("item", "start", "verdict"),
    [
        ("critical_damping", "0.279 mm, 3745", "misprint"),
        ("simulated_stick_slip", "0.279 mm, 2214", "fails"),
        ("simulated_stick_slip", "0.279 mm, 3745", "holds"),
        ("simulated_stick_slip", "0.381 mm, 3745", "holds"),
        ("simulated_stick_slip", "0.381 mm, 2214 Nm/rad, c_E 0.08", "holds"),
        ("simulated_stick_slip_ratio", "", "fails"),
        ("sudden_share", "0.279 mm, 3745 Nm/rad, c_E", "holds"),
        ("effective_stiffness_error", "", "holds"),
        ("slip_frequency_rise", "", "refuted"),
        ("quasi_harmonic_range", "", "refuted"),
        ("squeal_frequency", "", "misprint"),
        ("shaft_torsion", "", "holds"),
        ("wlf_constant", "", "misprint"),
        ("time_step", "", "misprint"),
    ],
)
def test_verdicts_are_those_of_the_check_of_the_thesis(item, start, verdict):
    found = [
        r["verdict"]
        for r in published_rows()
        if r["item"] == item and r["condition"].startswith(start)
    ]
    assert found
    assert {v.removesuffix(" (in sample)").split("; ")[0] for v in found} == {verdict}


def test_what_misses_a_measurement_says_so():
    for found in published_rows():
        if found["item"].startswith("v_crit") and found["published"][0].isdigit():
            measured = float(found["published"])
            off = abs(float(found["calibrated"].strip("> ")) - measured)
            assert found["verdict"].startswith("holds") == (off <= 0.25 + 1e-9)


def test_what_was_measured_and_missed_is_counted():
    ten = table.number(10.0)
    missed = table.Row("x", "y", "Hz", ten, exact=10.0, calibrated=20.0, measured=True)
    assert missed.misses
    assert not replace(missed, measured=False).misses
    assert not replace(missed, calibrated=11.0).misses
    formula = replace(missed, exact=20.0, calibrated=np.nan, counted=False)
    assert formula.misses
    nothing = replace(missed, exact=20.0, calibrated=np.nan)
    assert not nothing.misses
    rows = [missed, replace(missed, in_sample=True), formula, nothing]
    assert table.measured_counts(rows) == (
        "Measured: 2 facts, of which 1 out of sample; more than 25 % off 2, of which 1 out of "
        "sample; not checkable 1."
    )


# Verdicts


def given(published, exact, **about):
    return table.Row("x", "y", "1", published, exact=exact, **about).verdict


def test_a_verdict_follows_from_the_distance_alone():
    ten = table.number(10.0)
    assert [given(ten, v) for v in (10.05, 10.3, 12.4, 13.0, np.nan)] == [
        "holds", "off by 3.0 %", "off by 24 %", "fails", "not checkable",
    ]  # fmt: skip
    assert given(table.Published("> 13", 13.0, np.inf), np.inf, limit=13.0) == "holds"
    assert given(table.Published("< 250", -np.inf, 250.0), 368.0, measured=True) == "refuted"


def test_a_calibrated_rig_that_misses_a_measurement_is_told_even_if_the_equations_meet_it():
    missed = replace(
        table.Row("x", "y", "Hz", table.number(155.0), exact=153.1, tolerance=0.02, measured=True),
        calibrated=85.0,
    )
    assert missed.verdict == "holds; calibrated fails"
    assert replace(missed, calibrated=150.0).verdict == "holds; calibrated off by 3.2 %"
    assert replace(missed, measured=False).verdict == "holds"


def test_a_misprint_needs_the_corrected_number_to_hold():
    assert given(table.number(0.7599), 0.07598, meant=table.number(0.07599)) == "misprint"
    assert given(table.number(0.7599), 0.0781, meant=table.number(0.07599)) == "fails"


# The command


@pytest.fixture
def short(monkeypatch):
    monkeypatch.setattr(table, "group_names", lambda: ["potentiometer", "torque_cell"])


def test_the_command_writes_the_contracts_columns(short, tmp_path, capsys):
    assert main(["thesis", "--out", str(tmp_path / "new" / "t.csv")]) == 0
    with (tmp_path / "new" / "t.csv").open(encoding="utf-8", newline="") as file:
        found = list(csv.DictReader(file))
    assert list(found[0]) == [
        "item", "condition", "unit", "published", "listing", "exact", "calibrated", "verdict",
    ]  # fmt: skip
    assert found[1]["item"] == "potentiometer_slope"
    out, err = capsys.readouterr()
    assert out == f"{tmp_path / 'new' / 't.csv'}\n"
    assert "rows: " in err


def test_what_can_be_no_table_is_refused_before_the_work(tmp_path, capsys):
    (tmp_path / "folder.md").mkdir()
    for name, reason in (("t.docx", ".md"), ("t", ".md"), ("folder.md", "is a folder")):
        assert main(["thesis", "--out", str(tmp_path / name)]) == 2
        error = capsys.readouterr().err
        assert reason in error
        assert "preparing" not in error


# Critical speeds and damping


def test_beyond_the_end_of_stick_slip_there_is_an_island_of_it():
    speeds = np.arange(3.0, 6.1, 0.25).tolist()
    motions = {v: motion_from_rest(THESIS, v, 0.279e-3, 2214.0) for v in speeds}
    sticks = [v for v in speeds if friction_regime(motions[v]) is Regime.STICK_SLIP]
    assert sticks == [3.0, 3.25, 3.5, 4.75, 5.0, 5.25, 5.5]


def test_critical_damping_of_the_equations_is_0_0781():
    found = critical_damping(THESIS, 7.5, interference=0.279e-3, support_stiffness=3745.0)
    assert found == pytest.approx(0.07810, abs=2e-5)
