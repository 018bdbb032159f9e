"""Estimate of a number from samples, with its confidence interval."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Estimate:
    """An estimate and its confidence interval.

    Parameters
    ----------
    value : float
        In the unit of what is estimated; of a probability [-].
    low, high : float
        Bounds in that unit, at the confidence that whoever made the estimate was given.

    Examples
    --------
    >>> Estimate(0.5, 0.25, 0.75).half_width
    0.25
    """

    value: float
    low: float
    high: float

    @property
    def half_width(self) -> float:
        """Half the length of the interval, in the unit of the value [-]."""
        return 0.5 * (self.high - self.low)
