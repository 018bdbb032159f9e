"""Effects that a rig file lists already: the documented forms, so that they are no gap.

Each draws its numbers and gives them with what it does to a setup; a recording's chance is its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .. import kernel

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ..rig import Setup

__all__ = ["LISTED", "Listed", "draw_listed"]

_SLIDING = np.linspace(0.0, kernel.LARGEST_SLIDING, kernel.POINTS)
_RATIO = np.linspace(0.0, 1.0, kernel.POINTS)
_AGE = kernel.LOWEST_AGE * 10.0 ** (kernel.AGE_DECADES * _RATIO)


def _weakens(s, v, run):
    s.weakening *= 1.0 - v["share"] * (1.0 - np.exp(-_SLIDING / v["speed"]))


def _ages(s, v, run):
    s.ageing *= 1.0 - v["share"] * np.exp(-_AGE / v["ageing_time"])


def _creeps(s, v, run):
    s.creep += v["share"] * _RATIO ** v["exponent"]


def _scatters(s, v, run):
    z = run.uniform(-np.sqrt(3.0), np.sqrt(3.0), 4096)
    s.scatter = s.scatter * np.maximum(1.0 + v["scatter"] * z, 0.0)


def _fluctuates(s, v, run):
    turns = v["frequency"] * s.time + run.random()
    s.omega *= 1.0 + v["depth"] * np.sin(2.0 * np.pi * turns)


_Ranges = dict[str, tuple[float, float]]
LISTED: dict[str, tuple[str, _Ranges, Callable]] = {
    "velocity_weakening": ("exponential", {"share": (0.03, 0.15), "speed": (4.0, 20.0)}, _weakens),
    "static_ageing": ("exponential", {"share": (0.2, 0.8), "ageing_time": (3e-4, 3e-3)}, _ages),
    "partial_slip": ("power", {"share": (0.2, 0.7), "exponent": (2.0, 6.0)}, _creeps),
    "critical_torque_scatter": ("uniform", {"scatter": (0.05, 0.3)}, _scatters),
    "speed_fluctuation": ("sine", {"depth": (0.02, 0.1), "frequency": (8.0, 40.0)}, _fluctuates),
}
"""Form, ranges of the numbers, and what they do, by effect."""


@dataclass(frozen=True)
class Listed:
    """One effect of a rig file, with its numbers."""

    effect: str
    values: Mapping[str, float]

    @property
    def text(self) -> str:
        """As a rig file has it."""
        numbers = ",".join(f"{key}={value:g}" for key, value in self.values.items())
        return f"{self.effect}:form={LISTED[self.effect][0]},{numbers}"

    def apply(self, setup: Setup, run: np.random.Generator) -> None:
        """Change the setup."""
        LISTED[self.effect][2](setup, self.values, run)


def draw_listed(count: int, rng: np.random.Generator) -> tuple[Listed, ...]:
    """Draw so many effects."""
    names = rng.choice(sorted(LISTED), count, replace=False)
    return tuple(
        Listed(str(name), {
            key: float(f"{np.exp(rng.uniform(np.log(low), np.log(high))):.4g}")
            for key, (low, high) in LISTED[str(name)][1].items()
        })
        for name in names
    )  # fmt: skip
