"""How the shaft turns."""

import numpy as np
import pytest

from models.errors import ParameterError
from sim.shaft import ConstantSpeed, LoggedSpeed, Oscillation, SpeedRamp


def test_an_oscillation_swings_by_its_amplitude():
    time = np.linspace(0.0, 1.0, 100_001)
    angle = np.concatenate([[0.0], np.cumsum(Oscillation(0.26, 2.0).speed(time)[:-1] * 1e-5)])
    assert np.abs(angle).max() == pytest.approx(0.26, rel=1e-3)


@pytest.mark.parametrize(
    ("time", "speed", "message"),
    [
        ([0.0, 1.0], [1.0, np.nan], "speed in row 2 is no finite number"),
        ([0.0, 0.0], [1.0, 1.0], "time does not rise at row 2"),
        ([0.0], [1.0], "two or more samples"),
        ([0.0, 1.0], [1.0], "two or more samples"),
    ],
)
def test_a_log_that_cannot_be_used_is_refused_in_words(time, speed, message):
    with pytest.raises(ParameterError, match=message):
        LoggedSpeed(time, speed)


@pytest.mark.parametrize(
    ("motion", "seconds", "expected"),
    [
        (ConstantSpeed(-5.0), 1.0, 5.0),
        (SpeedRamp(2.0, -10.0, 600.0), np.inf, 10.0),  # long after the first minute
        (SpeedRamp(0.0, 10.0, 2.0), 1.0, 5.0),
        (Oscillation(-0.25, 2.0), 0.1, np.pi),
        (LoggedSpeed([0.0, 5.0, 5.0001, 5.0002, 10.0], [1.0, 1.0, -30.0, 1.0, 2.0]), 8.0, 30.0),
        (LoggedSpeed([0.0, 1.0], [0.0, 4.0]), 0.25, 1.0),
        (LoggedSpeed([-1.0, 1.0], [9.0, 1.0]), 5.0, 5.0),
    ],
)
def test_a_motion_tells_its_own_top_speed(motion, seconds, expected):
    assert motion.top_speed(seconds) == pytest.approx(expected)
