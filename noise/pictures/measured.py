"""Measurements of the thesis on the fluorocarbon, as they are drawn beside the simulation.

The curves of its figures are lost. What its tables and text say of them is what can be drawn:
levels of torque, critical speeds, first torsional modes, and the lines it names.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from models.condition import FIXED
from noise.thesis.runs import LONG, SHORT

__all__ = ["FIRST_MODE", "FITS", "LINES", "MEAN_TORQUE", "V_CRIT1", "V_CRIT2", "Line", "lines_at"]

FITS = (0.178, 0.279, 0.381)
"""Interference [mm]."""

MEAN_TORQUE = {0.178: 4.0, 0.279: 8.0, 0.381: 30.0}
"""Level that hardly varies from 1 to 13 rad/s, by fit [Nm]: 5.2.1, Appendices F and G."""

V_CRIT1 = {(0.279, LONG): 4.5, (0.279, SHORT): 2.6, (0.279, FIXED): 2.5}
"""Last speed with stick-slip, by fit [mm] and support [rad/s]: Table 5.1, where it has numbers."""

V_CRIT2 = {
    (0.178, LONG): 4.6, (0.178, SHORT): 5.9, (0.178, FIXED): 2.7,
    (0.279, LONG): 7.9, (0.279, SHORT): 12.5, (0.279, FIXED): 8.3,
}  # fmt: skip
"""Last speed with any oscillation, likewise [rad/s]: Table 5.2."""

FIRST_MODE = {LONG: 250.0, SHORT: 310.0}
"""First torsional mode, which the slip frequency never exceeds [Hz]: 5.2.2, Conclusion 3."""


class Line(NamedTuple):
    """A line that the thesis names: where, how fast [rad/s], its frequency [Hz], what to know."""

    interference_mm: float
    support_stiffness: float
    speed: float
    frequency: float
    note: str = ""


LINES = (
    Line(0.178, FIXED, 1.0, 1250.0),  # 5.2.1, over all speeds that vibrate
    Line(0.178, FIXED, 2.5, 1250.0),
    Line(0.279, FIXED, 1.0, 620.0),  # 5.1.1, harmonics of the slip frequency
    Line(0.279, FIXED, 1.0, 930.0),
    Line(0.279, SHORT, 10.0, 6570.0 / (2.0 * math.pi), "6570 rad/s"),  # 5.2.3, printed as Hz
)
"""Lines at given speeds."""


def lines_at(interference_mm: float, support_stiffness: float, speed: float) -> list[float]:
    """Frequencies that the thesis names at a condition [Hz].

    Examples
    --------
    >>> lines_at(0.279, FIXED, 1.0)
    [620.0, 930.0]
    """
    place = interference_mm, support_stiffness, speed
    return [line.frequency for line in LINES if line[:3] == place]
