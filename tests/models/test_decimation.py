"""Recordings sampled far above all that is heard: the same sound, at a rate that is bounded."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st

from models.blocks import HIGHEST_WORKED, RecordingBlocks, decimated
from models.recording import Channel, Recording


@pytest.mark.parametrize("rate", [400_001.0, 1e6, 9_999_991.0, 1e7])
def test_a_tone_keeps_level_and_time_and_what_is_above_is_gone(rate):
    t = np.arange(round(0.02 * rate)) / rate
    tone = np.sin(2.0 * np.pi * 5000.0 * t)
    beyond = np.sin(2.0 * np.pi * 0.49 * rate * t) if rate > 8e5 else 0.0
    run = Recording((tone + beyond)[np.newaxis], rate, (Channel("pressure"),))
    blocks = RecordingBlocks.of(run)
    assert blocks.rate <= HIGHEST_WORKED
    found = blocks.read(0, blocks.n_samples)[0]
    at = np.arange(blocks.n_samples) / blocks.rate
    middle = slice(50, -50)
    np.testing.assert_allclose(found[middle], np.sin(2.0 * np.pi * 5000.0 * at)[middle], atol=2e-3)


@given(st.integers(0, 300), st.integers(1, 300), st.sampled_from([5e5, 3.3e6]))
def test_a_part_is_what_the_whole_has_there(first, length, rate):
    samples = np.random.default_rng(1).normal(size=(2, 4000))
    read, n, _ = decimated(lambda a, b: samples[:, a:b], 4000, rate)
    first = min(first, n - 1)
    last = min(n, first + length)
    np.testing.assert_array_equal(read(first, last), read(0, n)[:, first:last])
