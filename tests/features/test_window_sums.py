"""Features of windows: the same alone and among others, at any rate, silent or not."""

import numpy as np
import pytest

from features.windows.lines import Lines, segments_of
from features.windows.rhythm import envelope, rhythm_of
from features.windows.table import describe_windows

RATE = 16_000


def sound(seconds, seed=0):
    """Clicks at 40 a second and a tone with harmonics, in noise."""
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds * RATE)) / RATE
    clicks = np.where(np.mod(time, 0.025) < 2.0 / RATE, 1.0, 0.0)
    tone = sum(np.sin(2.0 * np.pi * 310.0 * n * time) / n for n in range(1, 6))
    return (clicks + tone + 0.01 * rng.normal(size=time.size)).astype(np.float32)


def test_a_window_alone_is_as_among_others():
    segments, at = segments_of(sound(3.0)), np.arange(10)[:, None] * 2 + np.arange(3)
    power = envelope(sound(3.0))[np.arange(10)[:, None] * 1000 + np.arange(2000)]
    rhythm, lines = rhythm_of(power), vars(Lines(segments, at, 7000.0))
    for i in range(10):
        for name, value in rhythm_of(power[i : i + 1]).items():
            np.testing.assert_array_equal(value[0], rhythm[name][i])
        for name, value in vars(Lines(segments, at[i : i + 1], 7000.0)).items():
            if np.shape(value) == (1,):
                np.testing.assert_array_equal(value[0], lines[name][i])


@pytest.mark.parametrize("limit", [25.0, 90.0, 180.0, 300.0, 1000.0, 7000.0])
@pytest.mark.parametrize("level", [0.0, 1e-9, 1.0])
def test_any_limit_and_level_gives_numbers(limit, level):
    x = np.float32(level) * sound(1.0)
    with np.errstate(all="raise", under="ignore"):
        found = describe_windows(x, x, scale=1.0, windows=3, limit=limit)
    assert not np.isinf(found.features).any()
