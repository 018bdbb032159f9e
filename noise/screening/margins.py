"""Critical speeds of a mapped design, by simulation and by stability, and their margins to its use.

V_crit1 is the last speed of the map at which it sticks and slips, V_crit2 the last at which it
vibrates (`sim.analysis.critical_speeds`), be it that the vibration only persists there. A map
knows them to a step: the true one lies between that speed and the next of the map. Margins are to
the safe side, from the next speed. Stability gives the last speed at which steady sliding cannot
last; a vibration may outlive it, and of a constant kinetic torque it says nothing.

The margin is the distance of the use from the speeds that vibrate: positive where no speed of use
does, and by how many rad/s; negative where some do, and by how much the use would have to move.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from noise.screening.mapping import DesignMap
from sim.analysis.regime import Regime


@dataclass(frozen=True)
class CriticalPoint:
    """Critical speeds at one temperature, support and fit, all in rad/s.

    Parameters
    ----------
    design, environment : str
    temperature : float
        [degree Celsius]
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    v_crit1, v_crit1_high, v_crit2, v_crit2_high : float
        By simulation, and the next speed of the map, at which it no longer sticks, or vibrates
        [rad/s]; 0 if there is none, ``inf`` beyond the map.
    v_crit2_stability : float
        By stability [rad/s]; likewise.
    margin_v_crit1, margin_v_crit2, margin_stability : float
        Of the use to stick-slip, to what vibrates, and to where sliding is unstable [rad/s];
        positive where no speed of use does.
    """

    design: str
    environment: str
    temperature: float
    interference: float
    support_stiffness: float
    v_crit1: float
    v_crit1_high: float
    v_crit2: float
    v_crit2_high: float
    v_crit2_stability: float
    margin_v_crit1: float
    margin_v_crit2: float
    margin_stability: float


def critical_points(found: DesignMap) -> list[CriticalPoint]:
    """Critical speeds of each temperature, support and fit of a map; none of a swinging shaft's."""
    if found.motion != "steady":
        return []
    speed = np.array(found.grid.speed)
    sticks = found.regime == Regime.STICK_SLIP.value
    vibrates = found.regime != Regime.STEADY_SLIDING.value
    points = []
    for at in np.ndindex(found.growth.shape[:3]):
        last, spans = zip(
            *(safe_range(speed, one[at]) for one in (sticks, vibrates, found.growth > 0.0)),
            strict=True,
        )
        points.append(
            CriticalPoint(
                found.design, found.environment, found.grid.temperature[at[0]],
                found.grid.interference[at[2]], found.grid.support_stiffness[at[1]],
                last[0], spans[0][1], last[1], spans[1][1], last[2],
                *(margin_of(span, found.grid.use) for span in spans),
            )
        )  # fmt: skip
    return points


def safe_range(
    speed: NDArray[np.float64], happens: NDArray[np.bool_]
) -> tuple[float, tuple[float, float]]:
    """Return the last speed at which something happens, and the speeds between which it may.

    Parameters
    ----------
    speed : ndarray, shape (n,)
        Rising [rad/s].
    happens : ndarray of bool, shape (n,)

    Returns
    -------
    last : float
        [rad/s]; 0 if it never happens, ``inf`` if at the fastest.
    span : (float, float)
        Neighbours of the first and the last at which it does not [rad/s]; 0 and ``inf`` beyond the
        ends, ``inf`` and 0 where it never happens.

    Examples
    --------
    >>> safe_range(np.array([1.0, 2.0, 3.0, 4.0]), np.array([False, True, True, False]))
    (3.0, (1.0, 4.0))
    """
    where = np.flatnonzero(happens)
    if where.size == 0:
        return 0.0, (math.inf, 0.0)
    first, last = int(where[0]), int(where[-1])
    low = float(speed[first - 1]) if first else 0.0
    if last == speed.size - 1:
        return math.inf, (low, math.inf)
    return float(speed[last]), (low, float(speed[last + 1]))


def margin_of(span: tuple[float, float], use: tuple[float, float]) -> float:
    """Distance of a use from a range of speeds [rad/s], negative where they overlap.

    Examples
    --------
    >>> margin_of((0.0, 4.0), (5.0, 13.0)), margin_of((0.0, 8.0), (5.0, 13.0))
    (1.0, -3.0)
    >>> margin_of((math.inf, 0.0), (5.0, 13.0))
    inf
    """
    if span[0] > span[1]:
        return math.inf
    return max(use[0] - span[1], span[0] - use[1])
