from __future__ import annotations

import numpy as np
import pytest

from models.recording import Channel, Recording
from noise.labels.segments import Segment
from noise.pages.figures import common_scales, traces

RATE = 30_000
TIME = np.arange(RATE) / RATE
TONE = np.sin(2.0 * np.pi * 1046.0 * TIME)


def recording(*, calibrated=True, **channels):
    names = tuple(Channel(name) for name in channels)
    samples = np.stack([np.broadcast_to(signal, RATE) for signal in channels.values()])
    return Recording(samples, RATE, names, calibrated=calibrated)


def segment(start=0.0, end=1.0, *, channel="all"):
    return Segment(channel, start, end, "squeal", {"squeal": 1.0}, 1046.0, 91.0, -3.0)


@pytest.mark.parametrize(
    ("channels", "kinds"),
    [
        (["pressure"], ["pressure"]),
        (["angle", "pressure", "acceleration", "torque"], ["torque", "acceleration", "pressure"]),
        (["angle"], []),
    ],
)
def test_torque_comes_before_acceleration_before_pressure(channels, kinds):
    found = traces(recording(**dict.fromkeys(channels, TONE)), segment(), 0.05)
    assert [trace.kind for trace in found] == kinds


def test_the_time_history_is_from_the_middle_of_the_segment():
    (trace,) = traces(recording(pressure=TIME), segment(0.6, 1.0), 0.05)
    assert trace.samples[[0, -1]] == pytest.approx([0.775, 0.825], abs=1e-4)
    assert trace.analysed == pytest.approx((0.6, 1.0))


@pytest.mark.parametrize(("start", "end"), [(0.0, 0.02), (0.99, 1.0), (-1.0, 0.01), (0.5, 0.5)])
def test_the_time_history_lies_within_the_recording(start, end):
    (trace,) = traces(recording(pressure=TIME), segment(start, end), 0.05)
    assert trace.samples.size == 1500
    assert trace.samples[0] == pytest.approx(trace.start, abs=1e-9)


def test_a_recording_shorter_than_the_window_is_shown_whole():
    short = Recording(TONE[None, :600], RATE, (Channel("pressure"),))
    (trace,) = traces(short, segment(), 0.05)
    assert (trace.start, trace.samples.size) == (0.0, 600)


def test_a_segment_of_one_track_shows_that_track():
    both = recording(pressure=TONE, pressure_2=2.0 * TONE)
    (trace,) = traces(both, segment(channel="2"), 0.05)
    assert np.abs(trace.samples).max() == pytest.approx(2.0, rel=1e-3)


def test_levels_are_those_of_the_density_that_the_axis_names():
    noise = np.random.default_rng(3).normal(size=RATE)
    (trace,) = traces(recording(pressure=noise), segment(), 0.05)
    frequency, levels = trace.levels
    expected = 10.0 * np.log10(1.0 / (RATE / 2.0) / 20e-6**2)
    assert 10.0 * np.log10(np.mean(10.0 ** (levels / 10.0))) == pytest.approx(expected, abs=0.2)
    assert frequency[0] >= 20.0
    assert frequency[-1] <= 15e3


def test_samples_that_are_not_calibrated_refer_to_full_scale():
    found = [traces(recording(pressure=TONE, calibrated=c), segment(), 0.05) for c in (True, False)]
    ((calibrated,), (plain,)) = found
    difference = calibrated.levels[1].max() - plain.levels[1].max()
    assert difference == pytest.approx(-20.0 * np.log10(20e-6))


def test_a_torque_swings_about_its_middle_and_a_pressure_about_zero():
    torque, pressure = traces(recording(torque=8.0 + TONE, pressure=8.0 + TONE), segment(), 0.05)
    assert torque.swing == pytest.approx((8.0, 1.0), abs=1e-3)
    assert pressure.swing == pytest.approx((0.0, 9.0), abs=1e-3)


def test_the_loudest_recording_makes_the_scale_of_all():
    loud, quiet = recording(pressure=TONE), recording(pressure=1e-3 * TONE)
    together = common_scales(t for r in (quiet, loud) for t in traces(r, segment(), 0.05))
    assert together == common_scales(traces(loud, segment(), 0.05))


def test_recordings_that_are_not_calibrated_have_scales_of_their_own():
    both = (recording(pressure=TONE), recording(pressure=TONE, calibrated=False))
    scales = common_scales(t for r in both for t in traces(r, segment(), 0.05))
    assert scales["pressure", True].top == 90.0
    assert scales["pressure", False].top == 0.0


def test_the_highest_line_stands_below_the_end_of_the_axis():
    for amplitude in np.geomspace(0.1, 10.0, 9):
        (trace,) = traces(recording(pressure=amplitude * TONE), segment(), 0.05)
        (scale,) = common_scales([trace]).values()
        assert 3.0 <= scale.top - trace.levels[1].max() <= 13.0
