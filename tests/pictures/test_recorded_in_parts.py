"""A recording that is read in parts is drawn as one in memory."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest

from models.blocks import RecordingBlocks
from models.errors import ParameterError
from models.recording import Channel, Recording
from noise.pictures.recording import plot_recording, recorded_orders, recorded_speed

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


def test_speed_and_orders_in_parts_are_those_of_the_recording_in_memory(run_up):
    blocks = RecordingBlocks.of(run_up)
    time = np.arange(run_up.samples.shape[1]) / RATE
    speed = recorded_speed(blocks)
    assert speed[3000:-3000] == pytest.approx((2.0 + 1.5 * time)[3000:-3000], abs=0.05)
    whole, parts = recorded_orders(run_up), recorded_orders(blocks)
    np.testing.assert_array_equal(whole.level, parts.level)


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
