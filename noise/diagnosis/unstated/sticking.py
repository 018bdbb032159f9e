"""Whether the surface of a bushing sticks to the shaft, by the torque and a model of the bushing.

From the torque of the cell the speed of the surface follows without a law of friction
(`noise.diagnosis.evidence.reconstruction`). While it sticks it moves as the shaft does; with
another stiffness or support than the rig's it seems to move otherwise, at each moment differently.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from noise.diagnosis.evidence.reconstruction import reconstruct

if TYPE_CHECKING:
    from sim.bushing import LumpedBushing


_SHARE = 0.4
"""Share of the time that a surface sticks at least, where it sticks and slips [-]; assumed."""


@dataclass(frozen=True)
class Sticking:
    """How much like sticking a motion is.

    Parameters
    ----------
    off : float
        By how much the surface's speed differs from the shaft's while it sticks, over that [-].
    speed : float
        Of the shaft, signed [rad/s].
    """

    off: float
    speed: float


def sticking(
    torque: NDArray[np.float64], rate: float, bushing: LumpedBushing, speed: float | None = None
) -> Sticking:
    """Say how much like sticking a bushing moves.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        [Nm]
    rate : float
        Sampling rate [Hz].
    bushing : LumpedBushing
    speed : float, optional
        Of the shaft [rad/s]; without it the one that the surface has the longest.

    Returns
    -------
    Sticking

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.bushing import lumped_bushing
    >>> from sim.run import simulate
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> torque = simulate(rig, 1.0, interference=0.279e-3, support_stiffness=3745.0,
    ...                   seconds=0.4).recording["torque"]
    >>> right = sticking(torque, 30e3, lumped_bushing(rig, 0.279e-3, 3745.0))
    >>> wrong = sticking(torque, 30e3, lumped_bushing(rig, 0.279e-3, 2214.0))
    >>> right.off < 0.1 < wrong.off, abs(right.speed - 1.0) < 0.05
    (True, True)
    """
    moved = reconstruct(torque, np.zeros(torque.size), rate, bushing)
    surface = np.sort(-moved.sliding_speed)
    if speed is not None:
        return Sticking(float(np.quantile(np.abs(surface / speed - 1.0), _SHARE)), speed)
    n = int(_SHARE * surface.size)
    width = surface[n:] - surface[: surface.size - n]
    first = int(np.argmin(width))
    longest = float(np.median(surface[first : first + n]))
    return Sticking(0.5 * float(width[first]) / (abs(longest) + 1e-12), longest)
