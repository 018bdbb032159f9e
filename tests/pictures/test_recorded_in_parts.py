"""A recording that is read in parts is drawn as one in memory."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest

from models.blocks import RecordingBlocks
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.pictures import recording as recorded
from noise.pictures.recording import (
    plot_recording,
    recorded_levels,
    recorded_orders,
    recorded_speed,
)

RATE = 30_000.0


@pytest.fixture(scope="module")
def run_up():
    """A shaft that goes faster, and a line of a constant order in what is heard of it."""
    time = np.arange(round(6.0 * RATE)) / RATE
    speed = 2.0 + 1.5 * time
    angle = np.cumsum(speed) / RATE
    hiss = np.random.default_rng(1).normal(size=time.size)
    sound = (1.0 + (time > 3.0)) * np.sin(400.0 * angle) + 0.01 * hiss
    channels = (Channel("torque"), Channel("pressure"), Channel("angle"))
    return Recording(np.stack([hiss, sound, angle]), RATE, channels, name="run-up")


@pytest.fixture
def long(monkeypatch):
    monkeypatch.setattr(recorded, "_MOST", 20_000)


def test_levels_keep_their_maximum_and_where_it_is(run_up, monkeypatch):
    time, level = recorded_levels(run_up)
    monkeypatch.setattr(recorded, "_MOST", 20_000)
    times, levels = recorded_levels(RecordingBlocks.of(run_up))
    assert levels.max() == level.max()
    assert times[levels.argmax()] == time[level.argmax()]
    assert np.interp(time, times, levels)[10:-10] == pytest.approx(level[10:-10], abs=0.3)


@pytest.mark.usefixtures("long")
def test_the_speed_is_that_of_the_shaft_at_a_rate_of_its_own(run_up):
    speed, rate = recorded_speed(RecordingBlocks.of(run_up))
    assert speed.size <= 20_000
    at = np.arange(speed.size) / rate
    assert speed[50:-50] == pytest.approx((2.0 + 1.5 * at)[50:-50], abs=0.05)


def test_orders_are_those_of_the_recording_in_memory(run_up, monkeypatch):
    whole = recorded_orders(run_up)
    monkeypatch.setattr(recorded, "_MOST", 20_000)
    parts = recorded_orders(RecordingBlocks.of(run_up))
    strongest = [of.order_edges[np.nanargmax(of.level, axis=0)] for of in (whole, parts)]
    assert np.median(strongest[1]) == pytest.approx(np.median(strongest[0]), rel=0.05)
    assert np.nanmax(parts.level) == pytest.approx(np.nanmax(whole.level), abs=0.5)


def slow(*kinds):
    samples = np.random.default_rng(1).normal(size=(len(kinds), 1000))
    return Recording(samples, 100.0, tuple(map(Channel, kinds)), name="slow")


def test_sound_sampled_too_slowly_for_a_line_of_its_spectrogram_is_not_drawn():
    with pytest.raises(ParameterError, match="sampling rate of 100 Hz shows no sound"):
        plot_recording(slow("pressure"))
    (axes,) = plot_recording(slow("pressure", "torque")).axes
    assert axes.get_ylabel() == "Torque\n[Nm]"


@pytest.mark.parametrize("name", ["caf\udce9\x1b[2J\a\n", r"$\frac$ a_{$"])
def test_a_recording_of_any_name_is_drawn(run_up, name):
    figure = plot_recording(replace(run_up, name=name))
    figure.savefig(BytesIO())
