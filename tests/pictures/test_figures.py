from __future__ import annotations

import warnings
from xml.etree import ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.drawing import styled, thinned
from models.recording import Channel, Recording
from noise.labels.segments import Segment
from noise.pages import figures
from noise.pages.figures import COLUMNS, recording_panels

RATE = 30_000
TIME = np.arange(RATE) / RATE
TONE = np.sin(2.0 * np.pi * 1000.0 * TIME)
SEGMENT = Segment("all", 0.0, 1.0, "squeal", {"squeal": 1.0}, 1000.0, 91.0, -3.0)


def recording(*, calibrated=True, **channels):
    names = tuple(Channel(name) for name in channels)
    samples = np.stack([np.broadcast_to(signal, RATE) for signal in channels.values()])
    return Recording(samples, RATE, names, calibrated=calibrated)


SOUND = recording(pressure=TONE)


def test_panels_are_svg_files_and_say_what_they_show():
    (found,) = recording_panels([(SOUND, SEGMENT)])
    time, spectrum = found.pictures
    for panel in (time, spectrum):
        assert ET.fromstring(panel.svg).tag == "{http://www.w3.org/2000/svg}svg"
    # 30 samples a cycle miss the peak
    over = "Sound pressure over 50 ms from 0.475 s: between -0.995 and 0.995 Pa."
    assert time.alt == over
    # 1 Pa at a bin of 4 Hz: 91 dB spread over 1.5 bins
    assert "highest at 1000 Hz with 83 dB re (20 µPa)²/Hz" in spectrum.alt
    plain = recording(pressure=TONE, calibrated=False)
    (found,) = recording_panels([(plain, SEGMENT)])
    assert "highest at 1000 Hz with -11 dB re FS²/Hz" in found.pictures[1].alt


def test_constant_and_silent_recordings_are_drawn_without_a_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        silent, constant = recording_panels(
            [
                (recording(pressure=0.0), SEGMENT),
                (recording(torque=8.1, acceleration=-3.0), SEGMENT),
            ]
        )
    for found in (silent, constant):
        assert all("all below" in picture.alt for picture in found.pictures[1::2])


@pytest.mark.parametrize(("amplitude", "calibrated"), [(1e-7, True), (30_000.0, False)])
def test_no_writing_on_a_panel_overlaps_or_is_cut_off(monkeypatch, amplitude, calibrated):
    drawn = []
    monkeypatch.setattr(figures, "as_svg", lambda figure: drawn.append(figure) or b"")
    loud = recording(
        torque=amplitude * TONE - 36.9, acceleration=amplitude * TONE, calibrated=calibrated
    )
    quiet = recording(torque=8.0, acceleration=0.0, calibrated=calibrated)
    recording_panels([(loud, SEGMENT), (quiet, SEGMENT)])
    assert len(drawn) == 8
    with styled():
        for figure in drawn:
            figure.draw_without_rendering()
            (axes,) = figure.axes
            low, high = axes.get_ylim()
            numbers = [
                tick.label1.get_window_extent()
                for tick in axes.yaxis.get_major_ticks()
                if low <= tick.get_loc() <= high
            ]
            assert len(numbers) >= 2
            assert min(number.x0 for number in numbers) > axes.yaxis.label.get_window_extent().x1
            extent = axes.get_tightbbox()
            assert extent.x0 >= 0.0
            assert extent.y0 >= 0.0
            assert extent.x1 <= figure.bbox.x1
            assert extent.y1 <= figure.bbox.y1


@given(st.integers(1, 4000), st.integers(0, 2**32 - 1))
def test_thinning_keeps_ends_order_and_extremes(size, seed):
    x, y = np.arange(float(size)), np.random.default_rng(seed).normal(size=size)
    kept_x, kept_y = thinned(x, y, columns=COLUMNS)
    assert np.all(np.diff(kept_x) > 0)
    assert (kept_x[0], kept_x[-1]) == (x[0], x[-1])
    assert (kept_y.min(), kept_y.max()) == (y.min(), y.max())


def test_drawing_leaves_the_callers_settings_alone_and_does_not_depend_on_them():
    with mpl.rc_context({"font.size": 31.0, "axes.grid": False, "svg.hashsalt": "theirs"}):
        before = dict(mpl.rcParams)
        theirs = recording_panels([(SOUND, SEGMENT)])
        assert dict(mpl.rcParams) == before
    assert recording_panels([(SOUND, SEGMENT)]) == theirs
