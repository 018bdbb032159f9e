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
from noise.thesis import page, row, table
from noise.thesis.formulas import fixed_free_frequencies, free_free_frequencies
from noise.thesis.heat import RUBBER, temperature_rise
from noise.thesis.repetition import repetition_rate
from noise.thesis.table import reasons
from sim.analysis.critical_damping import critical_damping
from sim.analysis.critical_speeds import motion_from_rest
from sim.analysis.regime import Regime, friction_regime
from sim.analysis.slips import find_slips

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
    assert PAGE.read_text(encoding="utf-8") == page.thesis_page(computed_rows), STALE


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


def test_verdicts_are_of_the_small_set():
    words = {"holds", "misprint", "fails", "refuted", "not checkable"}
    for found in published_rows():
        for part in found["verdict"].removesuffix(" (in sample)").split("; "):
            plain = part.removeprefix("calibrated ")
            assert plain in words or plain.startswith("off by "), part


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


def test_what_parameters_were_chosen_for_says_so_and_is_counted_apart():
    found = published_rows()
    of_fit = [r for r in found if r["item"] == "v_crit1" and r["condition"].startswith("0.279")]
    assert len(of_fit) == 3
    assert all(r["verdict"].endswith(" (in sample)") for r in of_fit)
    predicted = [r for r in found if r["item"] == "v_crit1" and r["condition"].startswith("0.178")]
    assert not any(r["verdict"].endswith(" (in sample)") for r in predicted)
    holding = sum(r["verdict"] == "holds (in sample)" for r in found)
    assert f"holds (in sample) {holding}," in PAGE.read_text(encoding="utf-8")


def test_what_was_measured_and_missed_is_counted():
    ten = row.number(10.0)
    missed = row.Row("x", "y", "Hz", ten, exact=10.0, calibrated=20.0, measured=True)
    assert missed.misses
    assert not replace(missed, measured=False).misses
    assert not replace(missed, calibrated=11.0).misses
    formula = replace(missed, exact=20.0, calibrated=np.nan, counted=False)
    assert formula.misses
    nothing = replace(missed, exact=20.0, calibrated=np.nan)
    assert not nothing.misses
    rows = [missed, replace(missed, in_sample=True), formula, nothing]
    assert page.measured_counts(rows) == (
        "Measured: 2 facts, of which 1 out of sample; more than 25 % off 2, of which 1 out of "
        "sample; not checkable 1."
    )


# Verdicts


def given(published, exact, **about):
    return row.Row("x", "y", "1", published, exact=exact, **about).verdict


def test_a_verdict_follows_from_the_distance_alone():
    ten = row.number(10.0)
    assert [given(ten, v) for v in (10.05, 10.3, 12.4, 13.0, np.nan)] == [
        "holds", "off by 3.0 %", "off by 24 %", "fails", "not checkable",
    ]  # fmt: skip
    assert given(row.Published("> 13", 13.0, np.inf), np.inf, limit=13.0) == "holds"
    assert given(row.Published("< 250", -np.inf, 250.0), 368.0, measured=True) == "refuted"


def test_a_calibrated_rig_that_misses_a_measurement_is_told_even_if_the_equations_meet_it():
    missed = replace(
        row.Row("x", "y", "Hz", row.number(155.0), exact=153.1, tolerance=0.02, measured=True),
        calibrated=85.0,
    )
    assert missed.verdict == "holds; calibrated fails"
    assert replace(missed, calibrated=150.0).verdict == "holds; calibrated off by 3.2 %"
    assert replace(missed, measured=False).verdict == "holds"


def test_a_misprint_needs_the_corrected_number_to_hold():
    assert given(row.number(0.7599), 0.07598, meant=row.number(0.07599)) == "misprint"
    assert given(row.number(0.7599), 0.0781, meant=row.number(0.07599)) == "fails"


# Repetition


def test_a_torque_repeats_at_its_slips_or_its_period_or_not_at_all():
    t = np.arange(30_000) / 30e3
    for torque, wanted in (
        (8.0 + 3.0 * ((150.0 * t) % 1.0), 150.0),
        (8.0 + np.sin(2 * np.pi * 90.0 * t), 90.0),
        (np.full(30_000, 8.0), np.nan),
    ):
        slips = find_slips(torque / 665.0, 2.0, 30e3, own_period=1e-3)
        found = repetition_rate(slips, torque, 30e3)
        assert found == pytest.approx(wanted, rel=0.01, nan_ok=True)


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


def test_the_command_writes_the_page(short, tmp_path):
    assert main(["thesis", "--out", str(tmp_path / "t.md")]) == 0
    assert "| potentiometer_slope |" in (tmp_path / "t.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["t.docx", "t"])
def test_an_ending_that_no_table_has_is_refused_before_the_work(name, tmp_path, capsys):
    assert main(["thesis", "--out", str(tmp_path / name)]) == 2
    assert ".md" in capsys.readouterr().err


def test_a_folder_in_the_place_of_the_page_is_refused_before_the_work(tmp_path, capsys):
    (tmp_path / "t.md").mkdir()
    assert main(["thesis", "--out", str(tmp_path / "t.md")]) == 2
    said = capsys.readouterr().err
    assert "is a folder" in said
    assert "preparing" not in said


# Critical speeds and damping


def test_beyond_the_end_of_stick_slip_there_is_an_island_of_it():
    speeds = np.arange(3.0, 6.1, 0.25).tolist()
    motions = {v: motion_from_rest(THESIS, v, 0.279e-3, 2214.0) for v in speeds}
    sticks = [v for v in speeds if friction_regime(motions[v]) is Regime.STICK_SLIP]
    assert sticks == [3.0, 3.25, 3.5, 4.75, 5.0, 5.25, 5.5]


def test_critical_damping_of_the_equations_is_0_0781():
    found = critical_damping(THESIS, 7.5, interference=0.279e-3, support_stiffness=3745.0)
    assert found == pytest.approx(0.07810, abs=2e-5)


# Heat and shaft


def test_a_half_space_obeys_the_heat_equation():
    x, t, h, dt = 2e-4, 0.2, 2e-6, 1e-4
    at = [temperature_rise(RUBBER, 1e4, t, x + i * h) for i in (-1, 0, 1)]
    in_time = [temperature_rise(RUBBER, 1e4, t + s * dt, x) for s in (-1, 1)]
    rate = (in_time[1] - in_time[0]) / (2 * dt)
    assert rate == pytest.approx(RUBBER.diffusivity * (at[0] - 2 * at[1] + at[2]) / h**2, rel=1e-3)


def test_a_shaft_with_a_small_end_inertia_is_a_quarter_wave_and_with_a_large_one_a_pendulum():
    transit = 1 / 16262
    assert fixed_free_frequencies(transit, 1e9)[0] == pytest.approx(0.25 / transit, rel=1e-6)
    slow = fixed_free_frequencies(transit, 1e-6)
    assert slow[0] == pytest.approx(1e-3 / (2 * np.pi * transit), rel=1e-3)
    assert slow[1] == pytest.approx(free_free_frequencies(transit)[0], rel=1e-5)
