"""How the shaft comes to its speed within a recording: from rest, run up, or swinging in."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.diagnosis.cases.variants.common import log_uniform
from sim.shaft import LoggedSpeed

if TYPE_CHECKING:
    Course = Callable[[NDArray[np.float64]], NDArray[np.float64]]


_STEP = 5e-4
"""Of the times at which a course of speed is given [s]."""

_LATEST = 0.55
"""Share of a recording after which the shaft turns evenly, to a per mille of its speed."""


def draw_start(
    name: str, speed: float, seconds: float, settling: float, rng: np.random.Generator
) -> tuple[LoggedSpeed, float]:
    """Draw a course of speed.

    Parameters
    ----------
    name : str
        Of `STARTS`.
    speed : float
        In the end [rad/s].
    seconds, settling : float
        Of the recording, and how long a shaft that does not start in it turns before [s].
    rng : numpy.random.Generator

    Returns
    -------
    shaft : LoggedSpeed
    before : float
        How long it turns before the recording begins [s].

    Examples
    --------
    >>> shaft, before = draw_start("rest", 2.0, 0.5, 0.35, np.random.default_rng(0))
    >>> shaft.speed(np.array([0.0, 0.5])), before
    (array([0., 2.]), 0.0)
    """
    course = STARTS[name](seconds, rng)
    time = np.arange(0.0, seconds + 2.0 * _STEP, _STEP)
    factor = course(time)
    before = 0.0 if factor[0] == 0.0 else settling
    return LoggedSpeed(time + before, speed * factor), before


def _rest(seconds: float, rng: np.random.Generator) -> Course:
    ramp = log_uniform(rng, 3e-3, 0.25 * seconds)
    power = float(rng.uniform(0.6, 1.6))
    return lambda t: np.minimum(t / ramp, 1.0) ** power


def _run_up(seconds: float, rng: np.random.Generator) -> Course:
    low, ramp = float(rng.uniform(0.2, 0.85)), float(rng.uniform(0.1, _LATEST)) * seconds
    smooth = bool(rng.random() < 0.5)

    def course(t: NDArray[np.float64]) -> NDArray[np.float64]:
        x = np.minimum(t / ramp, 1.0)
        return low + (1.0 - low) * (x * x * (3.0 - 2.0 * x) if smooth else x)

    return course


def _swing(seconds: float, rng: np.random.Generator) -> Course:
    depth, frequency = float(rng.uniform(0.08, 0.5)), log_uniform(rng, 3.0, 25.0)
    decay = float(rng.uniform(0.02, _LATEST / math.log(1e3))) * seconds
    phase = float(rng.uniform(0.0, 2.0 * math.pi))
    return lambda t: 1.0 + depth * np.exp(-t / decay) * np.sin(2 * np.pi * frequency * t + phase)


STARTS: Mapping[str, Callable[[float, np.random.Generator], Course]] = {
    "rest": _rest,
    "run_up": _run_up,
    "swing": _swing,
}
"""Each takes the length of the recording [s] and a generator, and gives the speed over that in the
end as a function of time."""
