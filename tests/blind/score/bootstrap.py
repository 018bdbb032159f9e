"""Intervals by drawing cases again, and whether an aim lies inside or beyond them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

__all__ = ["Aim", "Figure", "Quantity", "at_least", "at_most", "between", "figure", "mean"]

DRAWS = 1000
LEVEL = 0.95
_NORMAL = 1.959964


@dataclass(frozen=True)
class Aim:
    """The values that were hoped for, ends included."""

    low: float = -np.inf
    high: float = np.inf

    def __str__(self) -> str:
        if np.isinf(self.low):
            return f"<= {self.high:g}"
        return f">= {self.low:g}" if np.isinf(self.high) else f"{self.low:g} to {self.high:g}"

    def met(self, low: float, high: float) -> bool:
        """Whether an interval has a point among them."""
        return bool(high >= self.low and low <= self.high)


def at_least(value: float) -> Aim:
    """Aim at this or more."""
    return Aim(low=value)


def at_most(value: float) -> Aim:
    """Aim at this or less."""
    return Aim(high=value)


def between(low: float, high: float) -> Aim:
    """Aim at a range."""
    return Aim(low, high)


def mean(rows: NDArray[np.float64]) -> float:
    """Mean of the first column."""
    return float(rows[:, 0].mean())


@dataclass(frozen=True, eq=False)
class Quantity:
    """Something to score: a row a case that it is asked of, and a statistic of the rows."""

    name: str
    rows: NDArray[np.float64]
    statistic: Callable[[NDArray[np.float64]], float] = mean
    aim: Aim | None = None

    @classmethod
    def of(cls, name, rows, statistic=mean, aim=None):
        """Make a quantity of a list of numbers or of rows."""
        table = np.array(rows, dtype=float)
        return cls(name, table.reshape(len(table), -1 if table.size else 1), statistic, aim)


@dataclass(frozen=True, eq=False)
class Figure:
    """A quantity's value with its interval; None where no case asks for it."""

    name: str
    cases: int
    value: float | None
    low: float | None
    high: float | None
    aim: Aim | None
    draws: NDArray[np.float64]

    @property
    def met(self) -> bool | None:
        """Whether the aim lies inside or beyond the interval; None where there is no aim."""
        if self.aim is None or self.low is None or self.high is None:
            return None
        return self.aim.met(self.low, self.high)


def figure(quantity: Quantity, rng: np.random.Generator, draws: int = DRAWS) -> Figure:
    """Value and interval of a quantity: Wilson's of a share, else percentiles of draws.

    Draws for which it is undefined are left out. Of a share that is 0 or 1 draws say nothing.
    """
    n = len(quantity.rows)
    value = quantity.statistic(quantity.rows) if n else np.nan
    if not np.isfinite(value):
        return Figure(quantity.name, n, None, None, None, quantity.aim, np.empty(0))
    found = np.array([
        quantity.statistic(quantity.rows[rng.integers(0, n, n)]) for _ in range(draws)
    ])  # fmt: skip
    kept = found[np.isfinite(found)]
    low, high = np.quantile(kept, [0.5 - LEVEL / 2, 0.5 + LEVEL / 2])
    if quantity.statistic is mean and np.isin(quantity.rows[:, 0], (0.0, 1.0)).all():
        low, high = _share(value, n)
    return Figure(quantity.name, n, float(value), float(low), float(high), quantity.aim, found)


def _share(p: float, n: int) -> tuple[float, float]:
    """Wilson's interval of a share."""
    middle = p + _NORMAL**2 / (2 * n)
    half = _NORMAL * math.sqrt(p * (1.0 - p) / n + _NORMAL**2 / (4 * n * n))
    scale = 1.0 + _NORMAL**2 / n
    return max(0.0, (middle - half) / scale), min(1.0, (middle + half) / scale)
