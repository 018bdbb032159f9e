"""The thesis's figures, drawn again: which there are, and that they show what they say."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from features.kernels.spectra import autospectrum
from models.condition import FIXED
from models.radiation.rig_response import impulse_responses
from models.rig_file import load_material_rig
from noise.cli import main
from noise.pictures import thesis, thesis_cases
from noise.pictures.channel_kinds import KINDS
from noise.pictures.model_traces import exact_trace, listing_trace, model_traces
from noise.pictures.panels import Curve, Panel, plot_panels
from noise.pictures.slips import plot_damping, plot_slip_histories
from noise.pictures.spectra import SpectraColumn, plot_spectra
from noise.pictures.thesis_bench import (
    acoustic_responses,
    mode_shapes,
    potentiometer_line,
    static_tests,
    temperature_distribution,
    torque_cell_line,
)
from noise.pictures.thesis_recordings import channels, torque_over_speed
from noise.thesis.heat import RUBBER, STEEL, contact_area, heat_shares, temperature_rise
from noise.thesis.modes import clamp_modes, rigidly_anchored
from noise.thesis.runs import CALIBRATED, LONG, RATE, SHORT, THESIS, Case, motion, rig_of
from noise.thesis.stiffness import MEASURED
from sim.run import simulate

NAMES = [
    "figure-3.3", "figure-5.1", "figure-5.2", "figure-5.3",
    "speeds-0.178mm", "speeds-0.279mm", "speeds-0.381mm",
    *(f"figure-5.{i}" for i in (*range(4, 10), *range(13, 27))),
    *(f"figure-6.{i}" for i in range(1, 11)),
    "figure-B1", "figure-C1", "figure-G3", "figure-H1",
]  # fmt: skip


def test_every_figure_with_data_is_there_in_order():
    assert [figure.name for figure in thesis.FIGURES] == NAMES


@pytest.mark.parametrize("figure", thesis.FIGURES, ids=lambda figure: figure.name)
def test_every_figure_draws_with_units_and_curves(figure, monkeypatch, recwarn):
    monkeypatch.setattr(thesis_cases, "_SWEPT", (1.0, 12.0))
    drawn = figure.picture()
    drawn.draw_without_rendering()
    assert not [str(one.message) for one in recwarn]
    assert drawn.get_suptitle().startswith(("Figure ", "Torque and frequency"))
    labels = [axes.get_xlabel() for axes in drawn.axes if axes.get_xlabel()]
    assert labels
    assert all("[" in label for label in labels)
    for axes in drawn.axes:
        assert any(len(np.atleast_1d(one.get_xdata())) > 1 for one in axes.lines)


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
        assert len(surface) == 20
        np.testing.assert_allclose(surface, surface[-1] * np.sqrt(0.05 * np.arange(1, 21)))


def test_nothing_warms_where_the_thesis_says_the_room_is():
    bushing = temperature_distribution()[1][1]
    depth, rise = bushing.curves[0][:2]
    assert np.interp(bushing.curves[2].x[0], depth, rise) < 1.0


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
    for fit, by_support in MEASURED.items():
        k_e = rig_of(THESIS).fit(1e-3 * fit).elastomer_stiffness
        panels = static_tests(fit)[0]
        for panel, k_b in zip(panels, [*by_support, FIXED], strict=True):
            curves = {curve.label: curve for curve in panel.curves}
            exact = curves["equations, exact"]
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
        assert curve.x[-1] > 14.99e3


def test_recorded_channels_are_those_that_simulate_records():
    case = Case(5.0, 0.279, LONG)
    grid = channels(CALIBRATED, case, ("torque", "pressure"))
    run = simulate(load_material_rig(CALIBRATED), 5.0, interference=0.279e-3)
    for (history, spectrum), name in zip(grid, ("torque", "pressure"), strict=True):
        shown = history.curves[0].y
        windows = np.lib.stride_tricks.sliding_window_view(run.recording[name], shown.size)
        assert (windows == shown).all(axis=1).any()  # a part of it
        found = autospectrum(run.recording[name], run.recording.rate)
        at = np.searchsorted(found.frequency, spectrum.curves[0].x)
        expected = 10.0 * np.log10(found.density[at] / KINDS[name].reference ** 2)
        np.testing.assert_allclose(spectrum.curves[0].y, expected)
        assert spectrum.marks == {"first torsional mode, 250 Hz": 250.0}


def test_a_creak_is_shown_where_it_slips():
    (_, (acceleration, _)) = channels(
        CALIBRATED, Case(1.0, 0.381, LONG), ("torque", "acceleration")
    )
    run = simulate(load_material_rig(CALIBRATED), 1.0, interference=0.381e-3)
    largest = np.abs(run.recording["acceleration"]).max()
    assert np.abs(acceleration.curves[0].y).max() == largest


def test_pdms_triples_its_torque_and_does_not_vibrate():
    row = torque_over_speed("PDMS", 0.381, {LONG: 17.0, FIXED: 17.0}, rise=3.0, slowest=0.25)[0]
    for panel in row:
        mean, low, high, published = panel.curves
        assert mean.y[-1] / mean.y[0] == pytest.approx(3.0, rel=0.1)
        np.testing.assert_allclose(low.y, high.y, rtol=1e-3)
        assert published.y[1] == pytest.approx(3.0 * mean.y[0])


def test_spectra_are_those_of_the_settled_torque():
    case = Case(1.0, 0.279, FIXED)
    (axes,) = plot_spectra([SpectraColumn("fixed", (case,), ("1 rad/s",))], title="").axes
    curves = {one.get_label(): one for one in axes.lines}
    torque = motion(THESIS, case).torque
    expected = autospectrum(torque[torque.size // 4 :], RATE)
    curve = curves["constant torque"]
    shown = expected.frequency <= 2000.0
    np.testing.assert_array_equal(curve.get_xdata(), expected.frequency[shown])
    np.testing.assert_allclose(curve.get_ydata(), 10.0 * np.log10(expected.density[shown]))
    assert list(curves["measured: lines"].get_xdata()) == [620.0, 930.0]


def test_steady_sliding_is_said_rather_than_drawn():
    column = SpectraColumn("", (Case(12.0),), ("",))
    (axes,) = plot_spectra([column], title="").axes
    assert [text.get_text() for text in axes.texts] == [
        "steady sliding: constant torque, calibrated"
    ]


def test_slips_are_laid_over_each_other():
    for trace in model_traces(Case(1.0), 0.3):
        start = trace.settled_slip()
        part = trace.during(start, start + 0.002)
        assert part.time[0] == pytest.approx(0.0, abs=2e-5)
        assert part.torque[0] - part.torque.min() > 2.0  # it drops within 2 ms


def test_histories_hold_the_traces():
    traces = [listing_trace(Case(1.0), 0.02), exact_trace(Case(1.0), 0.02)]
    figure = plot_slip_histories(traces, title="", time_label="Time [ms]", peak_speed=24.0)
    for i, trace in enumerate(traces):
        rows = figure.axes[i::2]
        np.testing.assert_array_equal(rows[0].lines[0].get_ydata(), trace.torque)
        np.testing.assert_array_equal(rows[1].lines[0].get_ydata(), 1e3 * trace.displacement)
        np.testing.assert_array_equal(rows[2].lines[0].get_ydata(), trace.sliding_speed)
        assert rows[2].lines[1].get_ydata() == [24.0, 24.0]


def test_the_models_agree_on_the_first_stick_of_the_equations():
    listing, exact = listing_trace(Case(1.0), 0.01), exact_trace(Case(1.0), 0.01)
    at = np.searchsorted(exact.time, listing.time[1:200])
    # The listing writes the torque of the row before.
    np.testing.assert_allclose(listing.torque[2:200], exact.torque[at[:-1]], atol=0.02)


def test_damping_that_ends_stick_slip_is_found_and_drawn():
    listing, exact = plot_damping(thesis_cases.damping(), title="").axes
    assert listing.get_title("left") == "listing: critical 0.0760 Nm s/rad"
    assert exact.get_title("left") == "equations, exact: critical 0.0781 Nm s/rad"
    sticking, critical, sliding = exact.lines[:3]
    ends = [one.get_ydata()[-20:].min() for one in (sticking, sliding)]
    assert ends[0] < 1e-9 < 1.0 < ends[1]
    after = critical.get_ydata()[critical.get_ydata().argmax() :]
    assert after.min() == pytest.approx(0.0, abs=0.01)


def test_the_fixed_clamp_has_no_listing():
    assert [trace.name for trace in model_traces(Case(5.0, 0.279, FIXED), 0.02)] == [
        "equations, exact",
        "calibrated",
    ]


def test_a_damping_is_that_of_the_thesiss_equations():
    sticks = exact_trace(Case(7.5, 0.279, SHORT, damping=0.05), 0.2).slips.size
    assert sticks > 10 > exact_trace(Case(7.5, 0.279, SHORT, damping=0.1), 0.2).slips.size


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
