"""Critical speeds of a rig as errors: log(simulated / measured), cell by cell.

There are two readings of the same definition (`sim.analysis.critical_speeds`). The search takes a
coarse one: runs of 0.7 s at speeds 20 % apart, from the fastest down, interpolated where the sudden
share, or the oscillation, crosses its limit, so that a small change of a parameter shows. What
is reported comes from runs of 1 s at speeds 0.5 rad/s apart and one bisection to 0.25, so an island
narrower than 0.5 rad/s can be missed. A cell without any critical speed counts as 0.5 rad/s, which
is below the slowest speed measured, one that never ends as 16 rad/s: errors of about -2 and +1.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from noise.training.calibrate.thesis_table import CELLS, SUPPORTS, THIN_CELLS
from sim.analysis.critical_speeds import (
    CriticalSpeeds,
    critical_speeds,
    falls_below,
    motion_from_rest,
    regime_at,
)
from sim.analysis.regime import LEAST_OSCILLATION, Regime, regime_measures
from sim.analysis.slips import LEAST_SUDDEN

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.rig import Rig

__all__ = ["cell_error", "coarse_errors", "errors", "other_fits_errors", "reading_error"]

_INTERFERENCE = 0.279e-3
_NONE, _MOST = 0.5, 16.0
"""What counts where nothing vibrates, and where nothing ends [rad/s]."""

_COARSE = tuple(float(v) for v in np.geomspace(1.0, _MOST, 16))
_COARSE_SECONDS = 0.7
_STEP = 0.5
_LAST_MEASURED = 13.0

_READING = 0.5
"""Step of speed at the rig, of 0.25 to 0.5 rad/s, the greater [rad/s]."""


def reading_error() -> NDArray[np.float64]:
    """Return the standard error of each cell that reading alone makes, shape (n_cells,).

    The measured speed lies anywhere within a step of 0.5 rad/s, the simulated one within 0.25.

    Examples
    --------
    >>> reading_error().round(3).tolist()
    [0.036, 0.062, 0.065, 0.02, 0.013, 0.019]
    """
    step = math.hypot(_READING, 0.5 * _STEP) / math.sqrt(12.0)
    return np.array([step / cell.value for cell in CELLS])


def coarse_errors(rig: Rig) -> NDArray[np.float64]:
    """Errors at the six cells of 0.279 mm as the search sees them, shape (n_cells,)."""
    return _errors([_coarse(rig, support) for support in SUPPORTS])


def errors(rig: Rig) -> NDArray[np.float64]:
    """Errors at the six cells of 0.279 mm as they are reported, shape (n_cells,).

    Examples
    --------
    >>> from tests.studies.thesis_gap.candidates import nominal_rig
    >>> errors(nominal_rig()).round(2).tolist()
    [0.2, 0.99, 1.31, -0.36, -0.58, 0.11]
    """
    return _errors([_fine(rig, _INTERFERENCE, support, _MOST) for support in SUPPORTS])


def cell_error(rig: Rig, position: int) -> float:
    """Error at one of the six cells, as it is reported."""
    cell = CELLS[position]
    found = _fine(rig, cell.interference, cell.support_stiffness, _MOST)
    return _log(getattr(found, cell.item), cell.value)


def other_fits_errors(rig: Rig) -> NDArray[np.float64]:
    """Errors at the other interference fits, which nothing is fitted to, shape (9,).

    Three ends of vibration at 0.178 mm, and six ends beyond 13 rad/s at 0.381 mm, where the error
    is nil if the simulated one lies there too. V_crit1 at 0.178 mm is left out: Table 5.1 and 5.2.1
    contradict each other.

    Examples
    --------
    >>> from tests.studies.thesis_gap.candidates import nominal_rig
    >>> other_fits_errors(nominal_rig()).round(2).tolist()
    [-0.97, -0.96, 0.45, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    """
    found = [
        _log(_fine(rig, cell.interference, cell.support_stiffness, _MOST).v_crit2, cell.value)
        for cell in THIN_CELLS
    ]
    for support in SUPPORTS:
        thick = _fine(rig, 0.381e-3, support, _LAST_MEASURED)
        found += [min(0.0, _log(v, _LAST_MEASURED)) for v in (thick.v_crit1, thick.v_crit2)]
    return np.array(found)


def _errors(found: list[CriticalSpeeds]) -> NDArray[np.float64]:
    speeds = [s.v_crit1 for s in found] + [s.v_crit2 for s in found]
    return np.array([_log(v, cell.value) for v, cell in zip(speeds, CELLS, strict=True)])


def _log(simulated: float, measured: float) -> float:
    return math.log(min(max(simulated, _NONE), _MOST) / measured)


def _fine(rig: Rig, interference: float, support: float, highest: float) -> CriticalSpeeds:
    """Critical speeds to 0.25 rad/s; none for a rig that cannot be simulated."""
    place = interference, support
    speeds = tuple(_STEP * i for i in range(1, round(highest / _STEP) + 1))
    try:
        found = critical_speeds(rig, *place, speeds)
        for name, regimes in (
            ("v_crit1", (Regime.STICK_SLIP,)),
            ("v_crit2", (Regime.STICK_SLIP, Regime.QUASI_HARMONIC)),
        ):
            between = getattr(found, name) + 0.5 * _STEP
            if math.isfinite(between) and regime_at(rig, between, *place) in regimes:
                found = replace(found, **{name: between})
    except ParameterError:
        return CriticalSpeeds(0.0, 0.0)
    return found


def _coarse(rig: Rig, support: float) -> CriticalSpeeds:
    v_crit2 = 0.0
    sudden_above = oscillation_above = 0.0
    above = _MOST
    for speed in reversed(_COARSE):
        try:
            sudden, oscillation = _measures(rig, speed, support)
        except ParameterError:
            return CriticalSpeeds(0.0, 0.0)
        if oscillation > LEAST_OSCILLATION:
            v_crit2 = max(
                v_crit2, _crossing(speed, oscillation, above, oscillation_above, LEAST_OSCILLATION)
            )
            if sudden > LEAST_SUDDEN:
                v_crit1 = _crossing(speed, sudden, above, sudden_above, LEAST_SUDDEN)
                return CriticalSpeeds(min(v_crit1, v_crit2), v_crit2)
        above, sudden_above, oscillation_above = speed, sudden, oscillation
    return CriticalSpeeds(0.0, v_crit2)


def _measures(rig: Rig, speed: float, support: float) -> tuple[float, float]:
    return regime_measures(
        motion_from_rest(rig, speed, _INTERFERENCE, support, seconds=_COARSE_SECONDS)
    )


def _crossing(speed: float, value: float, above: float, value_above: float, limit: float) -> float:
    """Speed at which a value falls below its limit, on logarithmic scales."""
    if speed == above or value_above >= limit:
        return above
    return falls_below(limit, speed, value, above, value_above)
