"""Levels of lines over time and frequency."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from noise.audio.spectrogram import Grid, spectrogram

RATE = 48000.0


def reader(samples):
    return lambda first, last: samples[first:last]


def tone(frequency, n=24000):
    return np.sqrt(2.0) * np.sin(2 * np.pi * frequency * np.arange(n) / RATE)


def levels_of(samples, grid):
    return spectrogram(reader(samples), samples.size, RATE, 1.0, grid)


@settings(max_examples=25)
@given(st.floats(200.0, 15e3))
def test_a_steady_tone_has_its_own_level_in_its_own_row(frequency):
    grid = Grid(4000, 20000, 20, 200, 50.0, 20e3, 2048, padding=2)
    column = levels_of(tone(frequency), grid)[:, 10]
    assert column.max() == pytest.approx(0.0, abs=0.4)
    row = np.searchsorted(grid.edges, frequency) - 1
    strongest = grid.height - 1 - int(column.argmax())
    wide = RATE / 2 / 2048 / frequency  # half a line of the padded frame, as a ratio
    per_row = np.log(400.0) / 200
    assert abs(strongest - row) <= 1 + wide / per_row


def test_no_click_falls_between_two_columns():
    rng = np.random.default_rng(5)
    grid = Grid(0, 96000, 30, 40, 50.0, 20e3, 1024)
    for at in rng.integers(1000, 95000, 20):
        samples = np.zeros(96000)
        samples[at] = 1.0
        found = levels_of(samples, grid).max(axis=0)
        assert found.max() > -62.0  # where its frame is nearest, at least half of the window counts
        assert abs(int(found.argmax()) - at * 30 // 96000) <= 1


def test_a_part_is_as_it_is_in_the_whole():
    samples = np.random.default_rng(3).standard_normal(48000)
    whole = levels_of(samples, Grid(0, 48000, 96, 40, 50.0, 20e3, 1024))
    part = levels_of(samples, Grid(24000, 36000, 24, 40, 50.0, 20e3, 1024))
    np.testing.assert_allclose(part, whole[:, 48:72], atol=1e-3)


def test_a_tone_is_nothing_at_low_frequencies_however_the_frames_cut_it():
    tone = np.sin(2 * np.pi * 1003.0 * np.arange(48000) / RATE) + 0.5
    grid = Grid(4800, 43200, 20, 40, 50.0, 20e3, 2048)
    levels = spectrogram(reader(tone), tone.size, RATE, 1.0, grid)
    assert levels[-10:].max() < -95.0  # below 220 Hz
