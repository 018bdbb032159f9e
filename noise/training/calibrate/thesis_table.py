"""Measurements of the fluorocarbon in the thesis, by which the calibration is judged.

The six critical speeds at 0.279 mm (Tables 5.1 and 5.2) are what is fitted, and what can be left
out. The rest steers the search with less weight: V_crit2 at 0.178 mm, stick-slip beyond 13 rad/s at
0.381 mm and how slowly the rate of slips rises there, mean torques that hardly vary with speed
(5.1.1), and the noises of 5.2.3.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from models.condition import FIXED
from noise.identification.table_fit import TableNumber
from noise.thesis.runs import LONG, SHORT
from sim.analysis.slips import LEAST_SUDDEN

TRANSITIONS = {
    (0.178, LONG): (1.0, 4.6), (0.178, SHORT): (1.0, 5.9), (0.178, FIXED): (1.0, 2.7),
    (0.279, LONG): (4.5, 7.9), (0.279, SHORT): (2.6, 12.5), (0.279, FIXED): (2.5, 8.3),
}  # fmt: skip
"""V_crit1, at 0.178 mm its bound, and V_crit2 by interference [mm] and k_B (Tables 5.1, 5.2)."""

SUPPORTS = (LONG, SHORT, FIXED)
"""k_B [Nm/rad]."""

_COARSE = np.geomspace(1.6, 14.4, 12)
_THIN_GRID = tuple(np.geomspace(1.0, 9.0, 10).tolist())

_FINE = (0.25, 0.5)
"""Spacing about a measured V_crit1 and V_crit2 [rad/s]."""

_WINDOW = 0.8, 1.35
"""Over what was measured: where the grid is fine."""

_CRITICAL_SPEEDS, _THIN, _FLATNESS, _STICK, _NOISE = 20.0, 1.25, 2.0, 0.15, 0.25
_RISE, _TIGHT_TORQUE = 0.25, 1.0
"""Weights."""

_FLAT = 1.10
"""Mean torque may vary by a tenth over the speeds (5.1.1)."""


def _grid(support_stiffness: float) -> tuple[float, ...]:
    """Speeds to try at 0.279 mm, coarse but about what was measured."""
    low, high = _WINDOW
    measured = TRANSITIONS[0.279, support_stiffness]
    fine = [
        np.arange(low * speed, high * speed, spacing)
        for speed, spacing in zip(measured, _FINE, strict=True)
    ]
    return tuple(np.unique(np.concatenate([_COARSE, *fine])).tolist())


CELLS = tuple(
    TableNumber(
        item, TRANSITIONS[0.279, support][i], 0.279e-3, support, _grid(support),
        _CRITICAL_SPEEDS, "critical speeds",
    )
    for i, item in enumerate(("v_crit1", "v_crit2"))
    for support in SUPPORTS
)  # fmt: skip
"""At 0.279 mm: what is fitted."""

THIN_CELLS = tuple(
    TableNumber(
        "v_crit2", TRANSITIONS[0.178, support][1], 0.178e-3, support, _THIN_GRID, _THIN, "thin"
    )
    for support in SUPPORTS
)
"""At 0.178 mm, where stiffness and damping were not measured."""

_FLAT_TORQUES = tuple(
    TableNumber("mean_torque_spread", _FLAT, 0.279e-3, support, _grid(support), _FLATNESS)
    for support in SUPPORTS
)

_RISES = tuple(
    TableNumber("slip_rate_rise", 17.5 / 2.5, 0.381e-3, LONG, speeds, _RISE)
    for speeds in pairwise((2.5, 5.0, 7.5, 10.0))
)
"""By 10 to 25 Hz for each 2.5 rad/s (5.2.1)."""

_TIGHT_MEAN = (
    TableNumber("mean_torque", 30.0, 0.381e-3, LONG, (5.0,), _TIGHT_TORQUE),
)  # Appendix G

_STICKING = tuple(
    TableNumber("sudden_share", LEAST_SUDDEN, 0.381e-3, support, (speed,), _STICK)
    for support, speed in (*((support, 13.0) for support in SUPPORTS), (LONG, 5.0))
)
NOISES = tuple(
    TableNumber(noise, 1.0, 1e-3 * mm, support, (speed,), _NOISE)
    for mm, support, speed, noise in (
        (0.279, LONG, 5.0, "squawk"),
        (0.279, LONG, 7.5, "squawk"),
        (0.279, SHORT, 5.0, "squawk"),
        (0.279, SHORT, 10.0, "squeal"),
        (0.279, LONG, 10.0, "none"),
        (0.178, LONG, 1.0, "squawk"),
        (0.178, LONG, 2.5, "squawk"),
        (0.178, LONG, 5.0, "none"),
    )
)
"""Conditions without creak whose noise 5.2.3 states; creak does not depend on what is searched."""

SPEEDS_ALONE = CELLS + _FLAT_TORQUES
"""Without the other interferences and the noises."""

THESIS_TABLE = SPEEDS_ALONE + THIN_CELLS + _STICKING + _RISES + _TIGHT_MEAN + NOISES
