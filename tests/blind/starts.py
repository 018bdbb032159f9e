"""How the shaft comes to its speed: before the recording, or in it.

A start is a factor of the speed over the time since the recording began; before it the factor is
that of its first instant. The rig settles beforehand unless it starts from rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    _Course = Callable[[NDArray[np.float64]], NDArray[np.float64]]

__all__ = ["SETTLING", "STARTS", "settled"]

SETTLING = 0.35
"""Of a rig before its recording, unless this starts from rest [s]."""


def settled(rng: np.random.Generator, seconds: float) -> _Course:
    """Turn evenly throughout."""
    return np.ones_like


def _rest(rng, seconds):
    ramp = rng.uniform(0.005, 0.06)
    return lambda t: np.minimum(t / ramp, 1.0)


def _run_up(rng, seconds):
    low, ramp = rng.uniform(0.3, 0.7), rng.uniform(0.2, 0.5) * seconds

    def course(t):
        x = np.minimum(t / ramp, 1.0)
        return low + (1.0 - low) * x * x * (3.0 - 2.0 * x)

    return course


def _swing(rng, seconds):
    depth, frequency = rng.uniform(0.15, 0.4), rng.uniform(4.0, 15.0)
    decay = rng.uniform(0.03, 0.12) * seconds
    return lambda t: 1.0 + depth * np.exp(-t / decay) * np.sin(2.0 * np.pi * frequency * t)


STARTS: dict[str, Callable[[np.random.Generator, float], _Course]] = {
    "settled": settled, "rest": _rest, "run_up": _run_up, "swing": _swing,
}  # fmt: skip
"""By name: a drive that is switched on, one that is run up, one whose controller swings in."""
