"""The thesis's figures, drawn again: which there are, and that they show what they say."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from features.kernels.spectra import autospectrum
from models.condition import FIXED
from models.radiation.rig_response import impulse_responses
from noise.cli import main
from noise.pictures import thesis, thesis_panels
from noise.pictures.panels import Curve, Panel, plot_panels
from noise.pictures.thesis_bench import (
    acoustic_responses,
    mode_shapes,
    potentiometer_line,
    temperature_distribution,
    torque_cell_line,
)
from noise.pictures.thesis_panels import by_damping, channels, spectra, static_tests
from noise.pictures.thesis_runs import exact_trace, listing_trace, recorded_trace, traces
from noise.thesis.heat import RUBBER, STEEL, contact_area, heat_shares, temperature_rise
from noise.thesis.modes import clamp_modes, rigidly_anchored
from noise.thesis.runs import CALIBRATED, LONG, RATE, SHORT, THESIS, Case, motion, rig_of
from noise.thesis.stiffness import MEASURED

NAMES = [
    "figure-3.3", "figure-5.1", "figure-5.2", "figure-5.3",
    "speeds-0.178mm", "speeds-0.279mm", "speeds-0.381mm",
    *(f"figure-5.{i}" for i in (*range(4, 10), *range(13, 27))),
    *(f"figure-6.{i}" for i in range(1, 11)),
    "figure-B1", "figure-C1", "figure-G3", "figure-H1",
]  # fmt: skip
DEAR = ("5.3", "speeds", "5.5", "5.6", "5.13", "6.10")


def test_every_figure_with_data_is_there_in_order():
    assert [figure.name for figure in thesis.FIGURES] == NAMES


@pytest.mark.parametrize(
    "figure",
    [
        pytest.param(one, id=one.name, marks=[pytest.mark.slow] * any(n in one.name for n in DEAR))
        for one in thesis.FIGURES
    ],
)
def test_every_figure_draws_with_units_and_curves(figure, recwarn):
    drawn = figure.picture()
    drawn.draw_without_rendering()
    assert not [str(one.message) for one in recwarn]
    assert drawn.get_suptitle().startswith(("Figure ", "Torque and frequency"))
    labels = [axes.get_xlabel() for axes in drawn.axes if axes.get_xlabel()]
    assert labels
    assert all("[" in label for label in labels)
    for axes in drawn.axes:
        assert axes.lines
        assert axes._left_title.get_window_extent().x1 <= drawn.bbox.x1


def test_panels_show_their_curves_and_what_the_thesis_names():
    curves = [Curve(np.arange(3.0), np.ones(3)), Curve.published([1.0], [2.0], "measured")]
    panel = Panel("one", "Time [s]", "Torque [Nm]", curves, {"250 Hz": 1.5}, span=(0.0, 2.0))
    ours, points, mark = plot_panels([[panel]], title="").axes[0].lines
    np.testing.assert_array_equal(ours.get_ydata(), np.ones(3))
    assert (points.get_label(), points.get_color()) == ("thesis: measured", "black")
    assert (mark.get_label(), list(mark.get_xdata())) == ("thesis: 250 Hz", [1.5, 1.5])


def test_temperatures_are_those_of_appendix_g():
    growing, at_run = temperature_distribution()
    for panel, body, share in zip(at_run, (STEEL, RUBBER), heat_shares(STEEL, RUBBER), strict=True):
        depth, rise = panel.curves[0][:2]
        flux = share * 300.0 / contact_area(300.0, 26.0, 0.23)
        deep = depth.size // 3
        expected = temperature_rise(body, flux, 0.23, 1e-3 * depth[deep])
        assert rise[deep] == pytest.approx(expected, rel=1e-12)
        assert rise[0] == pytest.approx(panel.curves[1].y[0])  # 26 K
    for panel in growing:  # a line each 0.05 s, each above the one before
        surface = [curve.y[0] for curve in panel.curves]
        np.testing.assert_allclose(surface, surface[-1] * np.sqrt(0.05 * np.arange(1, 21)))
    depth, rise = at_run[1].curves[0][:2]  # nothing warms where the thesis says the room is
    assert np.interp(at_run[1].curves[2].x[0], depth, rise) < 1.0


def test_mode_shapes_meet_anchors_clamp_and_frequencies():
    rows = mode_shapes()
    for column, length in enumerate((0.123, 0.092)):
        found = [float(row[column].title.split(": ")[1].split(" Hz")[0]) for row in rows]
        np.testing.assert_allclose(found, clamp_modes(rigidly_anchored(), length)[:4], atol=0.5)
    for panel in (panel for row in rows for panel in row):
        _, (place, shape, *_), (_, clamp, *_) = panel.curves
        np.testing.assert_allclose(shape[[0, -1]], 0.0, atol=1e-6)
        np.testing.assert_allclose(np.diff(shape)[[0, -1]], 0.0, atol=2e-3)  # held against turning
        turning = "turning" in panel.title
        np.testing.assert_allclose(shape, (-1 if turning else 1) * shape[::-1], atol=1e-9)
        middle = np.diff(clamp) / np.diff(place[np.isin(shape, clamp)]) if turning else clamp
        assert np.ptp(middle) < 1e-6


def test_static_tests_have_the_stiffness_of_elastomer_and_beams():
    by_support = MEASURED[0.279]
    k_e = rig_of(THESIS).fit(0.279e-3).elastomer_stiffness
    for panel, k_b in zip(static_tests(0.279)[0], [*by_support, FIXED], strict=True):
        exact = next(curve for curve in panel.curves if curve.label == "equations, exact")
        slope = 1e3 * np.polyfit(exact.x, exact.y, 1)[0]
        assert slope == pytest.approx(1.0 / (1.0 / k_b + 1.0 / k_e), rel=0.01)
        measured = panel.curves[-1]
        k_eff = 1e3 * measured.y[-1] / measured.x[-1]
        assert k_eff == pytest.approx(by_support[k_b][0] if k_b in by_support else k_e)


@pytest.mark.parametrize(
    ("panels", "rounding"), [(potentiometer_line, 0.0005), (torque_cell_line, 0.005)]
)
def test_a_calibration_fits_its_points_no_worse_than_the_printed_line_of_the_same_slope(
    panels, rounding
):
    *lines, points = panels()[0][0].curves
    fitted, printed = lines[len(lines) // 2 - 1 :: len(lines) // 2]  # at positive torque

    def misfit(line):
        side = (points.x >= fitted.x[0]) & (points.x <= fitted.x[-1])
        off = np.interp(points.x, line.x, line.y) - points.y
        return np.sum(off[side] ** 2)

    assert misfit(fitted) <= misfit(printed)
    slopes = [np.ptp(line.y[-2:]) / np.ptp(line.x[-2:]) for line in (fitted, printed)]
    assert slopes[0] == pytest.approx(slopes[1], abs=rounding)


def test_acoustic_responses_are_those_of_the_rig():
    rig = rig_of(CALIBRATED)
    for row, support in zip(acoustic_responses(), (LONG, SHORT, FIXED), strict=True):
        curve = row[0].curves[0]
        paths = impulse_responses(rig, 0.279e-3, support, 96e3)
        i = curve.x.size // 5
        t = np.arange(paths.torque_to_pressure.size) / 96e3
        line = paths.torque_to_pressure @ np.exp(-2j * np.pi * curve.x[i] * t)
        expected = 20.0 * np.log10(rig.beams.lever * abs(line))
        assert curve.y[i] == pytest.approx(expected, abs=1e-6)


def test_a_creak_is_shown_where_it_slips_with_the_lines_that_the_thesis_names():
    case = Case(1.0, 0.381, LONG)
    grid = channels(CALIBRATED, case, ("torque", "acceleration"))
    shown = grid[1][0].curves[0].y
    assert (
        np.abs(shown).max() == np.abs(recorded_trace(CALIBRATED, case).values["acceleration"]).max()
    )
    assert grid[0][1].marks == {"first torsional mode, 250 Hz": 250.0}


def test_spectra_are_those_of_the_settled_torque():
    case = Case(1.0, 0.279, FIXED)
    ((panel,),) = spectra(("fixed", [("1 rad/s", case)]))
    torque = motion(THESIS, case).torque
    expected = autospectrum(torque[torque.size // 4 :], RATE)
    shown = expected.frequency <= 2000.0
    np.testing.assert_array_equal(panel.curves[0].x, expected.frequency[shown])
    np.testing.assert_allclose(panel.curves[0].y, 10.0 * np.log10(expected.density[shown]))
    assert list(panel.marks.values()) == [620.0, 930.0]


def test_slips_are_laid_over_each_other_and_a_fixed_clamp_has_no_listing():
    for trace in traces(Case(1.0), 0.3):
        part = trace.about_a_slip(0.02)
        before, after = part.during(0.001, 0.002), part.during(0.002, 0.004)
        torque = thesis_panels.TORQUE
        assert before.values[torque].max() - after.values[torque].min() > 2.0
    assert len(traces(Case(5.0, 0.279, FIXED), 0.02)) == 2


def test_the_models_agree_on_the_first_stick_of_the_equations():
    torque = thesis_panels.TORQUE
    listing, exact = listing_trace(Case(1.0), 0.01), exact_trace(Case(1.0), 0.01)
    at = np.searchsorted(exact.time, listing.time[1:200])
    # The listing writes the torque of the row before.
    np.testing.assert_allclose(
        listing.values[torque][2:200], exact.values[torque][at[:-1]], atol=0.02
    )


@pytest.mark.slow
def test_damping_that_ends_stick_slip_is_found_and_drawn():
    ((listing, exact),) = by_damping(Case(7.5, 0.279, SHORT))
    assert listing.title == "listing: critical 0.0760 Nm s/rad"
    assert exact.title == "equations, exact: critical 0.0781 Nm s/rad"
    sticking, critical, sliding = (curve.y for curve in exact.curves)
    assert sticking[-20:].min() < 1e-9 < 1.0 < sliding[-20:].min()
    assert critical[critical.argmax() :].min() == pytest.approx(0.0, abs=0.01)


def test_the_command_writes_the_pictures_and_no_table(tmp_path, capsys, monkeypatch):
    few = {name: Figure(figsize=(2, 2)) for name in ("figure-5.3", "figure-6.2")}
    monkeypatch.setattr(thesis, "thesis_pictures", lambda: iter(few.items()))
    assert main(["thesis", "--plots", str(tmp_path / "new")]) == 0
    expected = [tmp_path / "new" / f"{name}.png" for name in few]
    assert capsys.readouterr().out.splitlines() == [str(path) for path in expected]
    assert sorted((tmp_path / "new").iterdir()) == sorted(expected)


def test_a_file_for_a_folder_is_refused_before_the_work(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(thesis, "thesis_pictures", None)
    (tmp_path / "file").write_text("", encoding="utf-8")
    for place in (tmp_path / "file", tmp_path / "file" / "folder"):
        assert main(["thesis", "--plots", str(place)]) == 2
        (told,) = capsys.readouterr().err.splitlines()
        assert f"error: --plots {place}" in told or "is a file, not a folder" in told
