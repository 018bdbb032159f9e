"""Design variable: a parameter that can be changed, with its range and the cost of a change."""

from __future__ import annotations

import math
from dataclasses import dataclass

from models.errors import ParameterError


@dataclass(frozen=True)
class DesignVariable:
    """A parameter that can be changed.

    Parameters
    ----------
    name : str
    low, high : float
        The least and the most that can be had, in the unit of the parameter, such as [-] of a
        factor.
    nominal : float
        As it is; the default suits parameters that are given as factors [-].
    cost : float
        Of a change as large as the nominal value, in any unit that all variables share.

    Raises
    ------
    ParameterError
        If the nominal value is 0 or lies outside, or a cost is negative.
    """

    name: str
    low: float
    high: float
    nominal: float = 1.0
    cost: float = 1.0

    def __post_init__(self) -> None:
        inside = self.low <= self.nominal <= self.high and self.low < self.high
        if not (inside and math.isfinite(self.low) and math.isfinite(self.high)):
            raise ParameterError(
                f"design variable {self.name}: {self.low:g} to {self.high:g} must be a range that "
                f"holds the nominal value {self.nominal:g}"
            )
        if self.nominal == 0.0 or not 0.0 <= self.cost < math.inf:
            raise ParameterError(
                f"design variable {self.name}: nominal = {self.nominal:g} must not be 0, and "
                f"cost = {self.cost:g} be 0 or more"
            )

    def within(self, budget: float) -> tuple[float, float]:
        """Range that a budget allows, in the unit of the parameter.

        Parameters
        ----------
        budget : float
            In the unit of the cost [-].

        Examples
        --------
        >>> DesignVariable("damping", 0.5, 3.0, cost=2.0).within(1.0)
        (0.5, 1.5)
        """
        most = budget * abs(self.nominal) / self.cost if self.cost > 0.0 else math.inf
        return max(self.low, self.nominal - most), min(self.high, self.nominal + most)

    def price(self, value: float) -> float:
        """Cost of a change to a value of the parameter.

        Parameters
        ----------
        value : float
            In the unit of the parameter, such as [-] of a factor.

        Returns
        -------
        float
            In the unit of `cost` [-].

        Examples
        --------
        >>> DesignVariable("damping", 0.5, 3.0, cost=2.0).price(0.5)
        1.0
        """
        return abs(value / self.nominal - 1.0) * self.cost
