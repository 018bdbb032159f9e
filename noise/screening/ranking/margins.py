"""Critical speeds of a mapped design, by simulation and by stability, and their margins to its use.

V_crit1 is the last speed of the map at which it sticks and slips, V_crit2 the last at which it
vibrates (`sim.analysis.critical_speeds`). Stability gives the last speed at which steady sliding
cannot last: no vibration that is reached from rest can end below it, so V_crit2 by simulation is
that or more, by as much as stick-slip outlives the stability of sliding. It says nothing of
V_crit1, which is a matter of how large a vibration grows, and nothing at all of a constant kinetic
torque, with which steady sliding is stable at any speed however much it sticks and slips.

The margin is the distance of the use from the speeds that vibrate: positive where no speed of use
does, and by how many rad/s; negative where some do, and by how much the use, or the vibration,
would have to move.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.analysis.regime import Regime

if TYPE_CHECKING:
    from noise.screening.map.mapping import DesignMap


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
    v_crit1, v_crit2 : float
        By simulation [rad/s]; 0 if there is none, ``inf`` if it is the fastest of the map.
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
    v_crit2: float
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
        growth = found.growth[at]
        ranges = (
            range_of(speed, sticks[at]),
            range_of(speed, vibrates[at]),
            range_of(speed, growth > 0.0, growth),
        )
        points.append(
            CriticalPoint(
                found.design,
                found.environment,
                found.grid.temperature[at[0]],
                found.grid.interference[at[2]],
                found.grid.support_stiffness[at[1]],
                *(span[1] for span in ranges),
                *(margin_of(span, found.grid.use) for span in ranges),
            )
        )
    return points


def range_of(
    speed: NDArray[np.float64],
    happens: NDArray[np.bool_],
    crossing: NDArray[np.float64] | None = None,
) -> tuple[float, float]:
    """Return the first and the last speed at which something happens.

    Parameters
    ----------
    speed : ndarray, shape (n,)
        Rising [rad/s].
    happens : ndarray of bool, shape (n,)
    crossing : ndarray, shape (n,), optional
        Any measure above zero where it happens [-]; the speeds are then those at which it is zero.

    Returns
    -------
    first, last : float
        [rad/s]; 0 and ``inf`` where it happens at the slowest and the fastest speed, ``inf`` and 0
        where it never happens.

    Examples
    --------
    >>> range_of(np.array([1.0, 2.0, 3.0]), np.array([True, True, False]))
    (0.0, 2.0)
    >>> range_of(np.array([1.0, 2.0, 3.0]), np.array([True, True, False]), np.array([3.0, 1, -1]))
    (0.0, 2.5)
    """
    where = np.flatnonzero(happens)
    if where.size == 0:
        return math.inf, 0.0
    first, last = int(where[0]), int(where[-1])
    ends = [0.0 if first == 0 else float(speed[first])]
    ends.append(math.inf if last == speed.size - 1 else float(speed[last]))
    if crossing is not None:
        if first > 0:
            ends[0] = _zero(speed, crossing, first - 1)
        if last < speed.size - 1:
            ends[1] = _zero(speed, crossing, last)
    return ends[0], ends[1]


def _zero(speed: NDArray[np.float64], values: NDArray[np.float64], i: int) -> float:
    share = values[i] / (values[i] - values[i + 1])
    return float(speed[i] + share * (speed[i + 1] - speed[i]))


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
