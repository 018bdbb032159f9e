"""Motions of the shaft that go on for as long as somebody listens."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.shaft import ConstantSpeed, Oscillation, SpeedRamp

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from sim.shaft import ShaftMotion

__all__ = ["RunUp", "motion_of", "motion_options", "once"]


@dataclass(frozen=True)
class RunUp:
    """Up from one speed to another and down again, over and over.

    Parameters
    ----------
    start, end : float
        [rad/s]
    seconds : float
        From one to the other [s].

    Examples
    --------
    >>> RunUp(0.0, 10.0, 2.0).speed(np.array([0.0, 1.0, 3.0, 5.0]))
    array([0., 5., 5., 5.])
    """

    start: float
    end: float
    seconds: float

    def speed(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Angular speed [rad/s] at `time` [s], both of one shape."""
        share = np.abs((time / self.seconds + 1.0) % 2.0 - 1.0)
        return np.asarray(self.start + (self.end - self.start) * share)


def motion_of(values: Mapping[str, float | bool | str]) -> ShaftMotion:
    """Return the motion that values of controls describe.

    Examples
    --------
    >>> motion_of({"motion": "swing", "swing.degrees": 180.0, "swing.hz": 2.0})
    Oscillation(amplitude=3.141592653589793, frequency=2.0)
    """
    if values["motion"] == "run_up":
        of = [float(values[f"run_up.{name}"]) for name in ("start", "end", "seconds")]
        return RunUp(*of)
    if values["motion"] == "swing":
        return Oscillation(math.radians(float(values["swing.degrees"])), float(values["swing.hz"]))
    return ConstantSpeed(float(values["speed"]))


def once(shaft: ShaftMotion) -> tuple[ShaftMotion, float]:
    """Return the motion of a recording of it, and how long that has to be at least [s].

    Examples
    --------
    >>> once(RunUp(0.0, 10.0, 6.0))
    (SpeedRamp(start=0.0, end=10.0, duration=6.0), 6.0)
    """
    if isinstance(shaft, RunUp):
        return SpeedRamp(shaft.start, shaft.end, shaft.seconds), shaft.seconds
    return shaft, 0.0


def motion_options(values: Mapping[str, float | bool | str]) -> str:
    """Return the motion as options of a command.

    Examples
    --------
    >>> motion_options({"motion": "constant", "speed": 5.0})
    '--speed 5'
    """
    if values["motion"] == "run_up":
        start, end, seconds = (values[f"run_up.{name}"] for name in ("start", "end", "seconds"))
        return f"--speed {start:g}..{end:g} --seconds {seconds:g}"
    if values["motion"] == "swing":
        return f"--oscillate {values['swing.degrees']:g},{values['swing.hz']:g}"
    return f"--speed {values['speed']:g}"
