"""The picture of one run: what it draws is the run."""

import warnings
from functools import cache

import numpy as np
import pytest
from matplotlib.figure import Figure

from features.kernels.spectra import autospectrum
from models.errors import ParameterError
from models.rig_file import load_material_rig
from noise.pictures.figure import check_picture_path, write_picture
from noise.pictures.run import plot_run, run_window
from sim.run import simulate
from sim.shaft import ConstantSpeed, Oscillation, SpeedRamp

LETTERS = {
    ".png": b"\x89PNG",
    ".svg": b"<?xml",
    ".pdf": b"%PDF",
}


@cache
def drawn(material="fluorocarbon-thesis", shaft=None, **about):
    run = simulate(load_material_rig(material), shaft or ConstantSpeed(1.0), **about)
    return run, plot_run(run)


def panel(figure, *, ylabel, xlabel=None, nth=0):
    found = [
        axes
        for axes in figure.axes
        if axes.get_ylabel().startswith(ylabel) and (xlabel is None or axes.get_xlabel() == xlabel)
    ]
    return found[nth]


def line(axes, colour_of):
    (found,) = [one for one in axes.lines if one.get_label() == colour_of]
    return found


def test_the_whole_run_is_drawn_with_its_extremes():
    run, figure = drawn()
    torque = line(panel(figure, ylabel="Torque [Nm]"), "elastomer").get_ydata()
    assert (torque.min(), torque.max()) == (run.motion.torque.min(), run.motion.torque.max())
    surface = line(panel(figure, ylabel="Displacement"), "elastomer's surface").get_ydata()
    assert surface.max() == 1e3 * run.motion.interface_angle.max()
    clamp = line(panel(figure, ylabel="Displacement"), "clamp").get_ydata()
    assert clamp.max() == 1e3 * run.motion.clamp_angle.max()
    speed = line(panel(figure, ylabel="Speed [rad/s]"), "sliding (shaft - surface)").get_ydata()
    assert speed.max() == run.motion.sliding_speed.max()


def test_a_few_cycles_are_drawn_sample_by_sample():
    run, figure = drawn()
    window = run_window(run)
    zoom = figure.axes[1]
    assert zoom.get_title("left") == "Part of it, 152.3 cycles a second"
    shown = line(zoom, "elastomer").get_ydata()
    # More samples than columns: each column keeps its extremes.
    part = run.motion.torque[window.first : window.last]
    assert (shown.min(), shown.max()) == (part.min(), part.max())
    slips = np.flatnonzero(run.motion.stuck[:-1] & ~run.motion.stuck[1:])
    inside = (slips >= window.first) & (slips < window.last)
    assert np.count_nonzero(inside) in (5, 6, 7)


@pytest.mark.parametrize(
    ("channel", "label", "reference"),
    [
        ("torque", "Torque\n[dB re (1 Nm)²/Hz]", 1.0),
        ("pressure", "Sound pressure\n[dB re (20 µPa)²/Hz]", 20e-6),
    ],
)
def test_autospectra_are_those_of_the_recording_up_to_half_its_rate(channel, label, reference):
    run, figure = drawn()
    axes = panel(figure, ylabel=label)
    curve = axes.lines[0]
    spectrum = autospectrum(run.recording[channel], run.recording.rate)
    at = np.searchsorted(spectrum.frequency, curve.get_xdata())
    np.testing.assert_array_equal(spectrum.frequency[at], curve.get_xdata())
    expected = 10.0 * np.log10(spectrum.density[at] / reference**2)
    np.testing.assert_allclose(curve.get_ydata(), expected, atol=1e-9)
    assert axes.get_xlim() == (20.0, 15e3)
    assert curve.get_ydata().max() == pytest.approx(
        10.0 * np.log10(spectrum.density[spectrum.frequency >= 20.0].max() / reference**2)
    )


@pytest.mark.parametrize(
    ("material", "shaft"),
    [
        ("fluorocarbon", ConstantSpeed(0.0)),
        ("fluorocarbon-thesis", ConstantSpeed(-5.0)),
        ("fluorocarbon-thesis", SpeedRamp(0.0, 10.0, 0.2)),
        ("fluorocarbon", Oscillation(0.26, 5)),
        ("PDMS", ConstantSpeed(5.0)),
    ],
)
def test_every_material_and_motion_is_drawn_without_a_warning(material, shaft):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = simulate(load_material_rig(material), shaft, seconds=0.2, support_stiffness=np.inf)
        figure = plot_run(run)
    labels = {one.get_label() for axes in figure.axes for one in axes.lines}
    assert "clamp" not in labels  # it is bolted down


def test_a_swing_is_enlarged_where_the_beam_shakes_most():
    shaft = Oscillation(np.radians(15.0), 2.0)
    run, figure = drawn("fluorocarbon", shaft, interference=0.381e-3, seconds=1.0)
    window = run_window(run)
    loudest = np.abs(run.recording["acceleration"]).argmax() / run.recording.rate
    assert window.first <= loudest * run.motion.rate <= window.last
    assert "-3.29 to 3.29 rad/s" in figure.get_suptitle()


@pytest.mark.parametrize("ending", sorted(LETTERS))
def test_the_ending_says_the_format_and_the_same_figure_is_the_same_file(ending, tmp_path):
    first, second = tmp_path / f"a{ending}", tmp_path / f"b{ending.upper()}"
    for path in (first, second):
        figure = Figure(figsize=(2, 2))
        figure.subplots().plot([0.0, 1.0], [2.0, 3.0])
        write_picture(path, figure)
    assert first.read_bytes().startswith(LETTERS[ending])
    assert first.read_bytes() == second.read_bytes()


def test_another_ending_is_refused(tmp_path):
    with pytest.raises(ParameterError, match=r"ends in \.png, \.svg or \.pdf"):
        check_picture_path(tmp_path / "a.gif")
