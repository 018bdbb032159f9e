"""Pictures of sweeps: torque and frequency against speed, beside what was measured."""

import math
from functools import cache

import numpy as np
import pytest

from features.kernels.harmonics import analyse_harmonics
from models.condition import FIXED
from models.errors import ParameterError
from models.rig_file import load_material_rig
from noise.pictures.measured import FIRST_MODE, FITS, LINES, V_CRIT1, V_CRIT2, lines_at
from noise.pictures.speeds import plot_sweep, plot_torque_of_fits
from noise.pictures.sweep import sweep_torque
from noise.thesis.runs import LONG, SHORT
from sim.analysis.sweep import Sweep
from sim.constant_version import constant_version
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

SPEEDS = (1.0, 5.0, 12.0)
SUPPORTS = (LONG, SHORT, FIXED)


@cache
def swept(material="fluorocarbon-thesis", interference=0.279e-3):
    rig = constant_version(load_material_rig(material))
    return sweep_torque(rig, SPEEDS, interference=interference, support_stiffness=SUPPORTS)


def curves(axes):
    return {one.get_label(): one for one in axes.lines}


def test_a_swept_torque_is_that_of_the_sweep():
    features = Sweep(
        load_material_rig("fluorocarbon-thesis"),
        [SPEEDS],
        support_stiffness=[[support] for support in SUPPORTS],
        settling=0.5,
    ).features()
    sweep = swept()
    np.testing.assert_allclose(sweep.mean, features["torque_mean"], rtol=1e-3)
    # Slips that the torque shows are the solver's.
    np.testing.assert_allclose(sweep.slip_frequency, features["slip_frequency"], rtol=0.02)
    # The extremes of a slip pass through an anti-alias filter.
    np.testing.assert_allclose(sweep.high, features["torque_max"], rtol=0.02)
    np.testing.assert_allclose(sweep.low, features["torque_min"], rtol=0.02)


def test_steady_sliding_has_no_frequency():
    sweep = swept()
    assert np.isnan(sweep.slip_frequency[:2, 2]).all()
    assert np.isnan(sweep.strongest_line[:2, 2]).all()
    np.testing.assert_allclose(sweep.mean[:2, 2], 8.0, rtol=1e-6)


def test_the_strongest_line_of_plain_stick_slip_is_its_rate():
    sweep = swept()
    assert sweep.strongest_line[2, 0] == pytest.approx(sweep.slip_frequency[2, 0], abs=2.0)


def test_a_contact_that_creeps_is_counted_by_its_torque():
    motion = simulate_motion(
        constant_version(load_material_rig("fluorocarbon")), ConstantSpeed(5.0),
        interference=0.279e-3, support_stiffness=SHORT, seconds=1.5, rate=30e3,
    )  # fmt: skip
    fundamental = analyse_harmonics(motion.since(15000).torque, motion.rate).fundamental
    assert swept("fluorocarbon").slip_frequency[1, 1] == pytest.approx(fundamental, rel=0.05)


def test_each_support_has_its_torque_above_its_frequencies():
    sweep = swept()
    figure = plot_sweep({"constant torque": sweep}, title="0.279 mm", interference_mm=0.279)
    titles = [axes.get_title("left") for axes in figure.axes[:3]]
    assert titles == ["2214 Nm/rad", "3745 Nm/rad", "clamp fixed"]
    assert figure.get_suptitle() == "0.279 mm"
    for i in range(3):
        torque, frequency = curves(figure.axes[i]), curves(figure.axes[3 + i])
        mean = torque["constant torque: mean torque"]
        np.testing.assert_array_equal(mean.get_xdata(), SPEEDS)
        np.testing.assert_array_equal(mean.get_ydata(), sweep.mean[i])
        slips = frequency["constant torque: cycles a second"].get_ydata()
        np.testing.assert_array_equal(slips, sweep.slip_frequency[i])
        lines = frequency["constant torque: strongest line"].get_ydata()
        np.testing.assert_array_equal(lines, sweep.strongest_line[i])
        (band,) = figure.axes[i].collections
        heights = band.get_paths()[0].vertices[:, 1]
        assert (heights.min(), heights.max()) == (sweep.low[i].min(), sweep.high[i].max())


def test_measurements_stand_where_the_tables_have_them():
    figure = plot_sweep({"a": swept()}, title="", interference_mm=0.279)
    for i, support in enumerate(SUPPORTS):
        torque, frequency = curves(figure.axes[i]), curves(figure.axes[3 + i])
        for axes in (torque, frequency):
            assert axes["measured: end of stick"].get_xdata()[0] == V_CRIT1[0.279, support]
            assert axes["measured: end of oscillation"].get_xdata()[0] == V_CRIT2[0.279, support]
        if support in FIRST_MODE:
            drawn = frequency["measured: first torsional mode"].get_ydata()[0]
            assert drawn == FIRST_MODE[support]
        assert list(torque["thesis: mean torque"].get_ydata()) == [8.0, 8.0]
    points = [
        float(one.get_ydata()[0])
        for one in figure.axes[5].lines
        if one.get_label() == "measured: lines"
    ]
    assert points == [620.0, 930.0]


def test_what_was_not_measured_is_not_in_the_legend():
    for fit, there in ((0.178, False), (0.279, True)):
        figure = plot_sweep({"a": swept()}, title="", interference_mm=fit)
        names = [text.get_text() for text in figure.legends[0].get_texts()]
        assert ("measured: end of stick" in names) is there
        assert len(names) == len(set(names))
    alone = plot_sweep({"a": swept()}, title="")
    names = [text.get_text() for text in alone.legends[0].get_texts()]
    assert not any("measured" in name or "thesis" in name for name in names)


def test_torque_against_speed_has_a_panel_a_fit():
    sweeps = [swept(interference=1e-3 * fit) for fit in FITS]
    figure = plot_torque_of_fits({"constant torque": sweeps}, title="", support_stiffness=SHORT)
    for axes, sweep in zip(figure.axes, sweeps, strict=True):
        mean = curves(axes)["constant torque: mean torque"].get_ydata()
        np.testing.assert_array_equal(mean, sweep.mean[1])
    with pytest.raises(ParameterError, match="1000 Nm/rad was not swept"):
        plot_torque_of_fits({"a": sweeps}, title="", support_stiffness=1000.0)


def test_a_squeal_printed_in_hertz_is_taken_for_radians_a_second():
    (squeal,) = lines_at(0.279, SHORT, 10.0)
    assert squeal == pytest.approx(6570.0 / math.tau)
    assert [line.note for line in LINES if line.frequency == squeal] == ["6570 rad/s"]
