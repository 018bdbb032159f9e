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


def test_the_loudest_recording_makes_the_scale_of_all():
    loud, quiet = recording(pressure=TONE), recording(pressure=1e-3 * TONE)
    together = common_scales(t for r in (quiet, loud) for t in traces(r, segment(), 0.05))
    assert together == common_scales(traces(loud, segment(), 0.05))
