"""The thesis's figures, drawn again: which there are, and that they show what they say."""

from functools import cache

import numpy as np
import pytest
from matplotlib.figure import Figure

from features.kernels.spectra import autospectrum
from models.condition import FIXED
from noise.cli import main
from noise.pictures import thesis
from noise.pictures.model_traces import exact_trace, listing_trace, model_traces
from noise.pictures.slips import plot_damping, plot_slip_histories
from noise.pictures.spectra import SpectraColumn, plot_spectra
from noise.thesis.runs import RATE, SHORT, THESIS, Case, motion

NAMES = [
    "figure-5.3", "speeds-0.178mm", "speeds-0.279mm", "speeds-0.381mm",
    *(f"figure-5.{i}" for i in range(14, 19)), *(f"figure-6.{i}" for i in range(1, 11)),
]  # fmt: skip


@cache
def pictures():
    """All but the long sweeps; their speeds are a few."""
    speeds = thesis._SWEPT
    thesis._SWEPT = np.array([1.0, 12.0])
    try:
        return dict(thesis.thesis_pictures())
    finally:
        thesis._SWEPT = speeds


@pytest.mark.slow
def test_every_figure_is_there_in_order():
    assert list(pictures()) == NAMES
    assert len(NAMES) == thesis.N_PICTURES


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_every_axis_has_a_unit_and_every_panel_a_curve(name):
    figure = pictures()[name]
    assert figure.get_suptitle()
    labels = [axes.get_xlabel() for axes in figure.axes if axes.get_xlabel()]
    assert labels
    assert all("[" in label for label in labels)
    for axes in figure.axes:
        assert any(len(np.atleast_1d(one.get_xdata())) > 1 for one in axes.lines)


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
    listing, exact = plot_damping(thesis._damping(), title="").axes
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
