"""Measurements of the fluorocarbon in the thesis, by which the calibration is judged.

A cell is one number of Tables 5.1 and 5.2. The six critical speeds at 0.279 mm are what is fitted,
and what can be left out. The rest steers the search with less weight: V_crit2 at 0.178 mm, stick
beyond 13 rad/s at 0.381 mm, and the noises of 5.2.3.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log

__all__ = ["CELLS", "NOISES", "STICKING", "SUPPORTS", "THIN_CELLS", "Cell", "NoiseCell"]

SUPPORTS = (2214.0, 3745.0, inf)
"""k_B [Nm/rad]."""


@dataclass(frozen=True)
class Cell:
    """One measured critical speed.

    Parameters
    ----------
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    item : str
        ``v_crit1`` or ``v_crit2``.
    speed : float
        As measured [rad/s].
    """

    interference: float
    support_stiffness: float
    item: str
    speed: float

    def log_error(self, speed: float) -> float:
        """Logarithm of a simulated speed [rad/s] over the measured one [-]."""
        return log(speed / self.speed) if speed > 0.0 else -inf

    def __str__(self) -> str:
        support = (
            "fixed" if self.support_stiffness == inf else f"{self.support_stiffness:.0f} Nm/rad"
        )
        return f"{self.item} at {1e3 * self.interference:.3f} mm, {support}"


@dataclass(frozen=True)
class NoiseCell:
    """An operating condition whose noise the thesis names.

    Parameters
    ----------
    interference, support_stiffness, speed : float
        [m], [Nm/rad], [rad/s]
    noise : str
        ``squawk``, ``squeal`` or ``none``.
    """

    interference: float
    support_stiffness: float
    speed: float
    noise: str


def _cells(interference: float, item: str, speeds: tuple[float, ...]) -> tuple[Cell, ...]:
    return tuple(
        Cell(interference, support, item, speed)
        for support, speed in zip(SUPPORTS, speeds, strict=True)
    )


CELLS = _cells(0.279e-3, "v_crit1", (4.5, 2.6, 2.5)) + _cells(0.279e-3, "v_crit2", (7.9, 12.5, 8.3))
"""Tables 5.1 and 5.2 at 0.279 mm: what is fitted."""

THIN_CELLS = _cells(0.178e-3, "v_crit2", (4.6, 5.9, 2.7))
"""At 0.178 mm, where stiffness and damping were not measured: a hint."""

STICKING = (*((0.381e-3, support, 13.0) for support in SUPPORTS), (0.381e-3, 2214.0, 5.0))
"""Interference [m], support stiffness [Nm/rad] and speed [rad/s] at which it sticks."""

NOISES = (
    NoiseCell(0.279e-3, 2214.0, 5.0, "squawk"),
    NoiseCell(0.279e-3, 2214.0, 7.5, "squawk"),
    NoiseCell(0.279e-3, 3745.0, 5.0, "squawk"),
    NoiseCell(0.279e-3, 3745.0, 10.0, "squeal"),
    NoiseCell(0.279e-3, 2214.0, 10.0, "none"),
    NoiseCell(0.178e-3, 2214.0, 1.0, "squawk"),
    NoiseCell(0.178e-3, 2214.0, 2.5, "squawk"),
    NoiseCell(0.178e-3, 2214.0, 5.0, "none"),
)
"""Conditions without creak whose noise 5.2.3 states; creak does not depend on what is searched."""
