"""How much of the gap was closed, against what the effect's own absence closes.

Taken from the entry of ``effects`` that the verdict names, the most probable first. Saying nothing
closes nothing, and an interval not given covers nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .bootstrap import Quantity, at_least, at_most, between

if TYPE_CHECKING:
    from .answers import Answer
    from .truth import Truth

__all__ = ["closing"]

LEAST_CLOSED = 0.88
"""Median that is aimed at for forms which the library does not have."""


def _median(rows: np.ndarray) -> float:
    return float(np.median(rows[:, 0]))


def _tenth(rows: np.ndarray) -> float:
    return float(np.quantile(rows[:, 0], 0.1))


def _ninety_fifth(rows: np.ndarray) -> float:
    return float(np.quantile(rows[:, 0], 0.95))


def closing(
    pairs: list[tuple[Truth, Answer]], least_closed: float = LEAST_CLOSED
) -> list[Quantity]:
    """Return closed fractions, their errors, coverage of their intervals, and the time taken."""
    asked = [(t, a) for t, a in pairs if t.counts and t.kind in ("one", "pair", "triple")]
    closed = [a.closed or 0.0 for _, a in asked]
    errors = [abs((a.closed or 0.0) - t.closed) for t, a in asked]
    covers = [
        a.interval is not None and a.interval[0] <= t.closed <= a.interval[1] for t, a in asked
    ]
    widths = [a.interval[1] - a.interval[0] for _, a in asked if a.interval is not None]
    seconds = [a.seconds for _, a in pairs if a.seconds is not None]
    return [
        Quantity.of("closed, median", closed, _median, at_least(least_closed)),
        Quantity.of("closed, tenth percentile", closed, _tenth, at_least(0.75)),
        Quantity.of("closed, error against the truth's own", errors, _median),
        Quantity.of("interval of closed covers", covers, aim=between(0.86, 0.94)),
        Quantity.of("interval of closed, width", widths, _median),
        Quantity.of("seconds, median", seconds, _median),
        Quantity.of("seconds, 95th percentile", seconds, _ninety_fifth, at_most(60.0)),
    ]
