"""A short pulse of force at each slip, in the joint between beam and anchor.

The lumped model's anchor force above 5 kHz is some 100 dB too small to creak, and the torque cell
shows little above 2 kHz; bolting the clamp to the baseplate ends the creak (5.2.3). So the source
lies downstream of the torque cell, in clamp, beam or anchor: a micro-impact that the slip sets
off. One law for all fits: nothing below a threshold of the torque's drop, as the joint holds; above
it a half-sine whose peak grows with the root of what the drop exceeds it by, as the speed of a
part that has come loose does with its energy, through `amplitude` at the drop of the creaking fit
(6.94 Nm at 0.381 mm). Limits: amplitude zero is no pulse at all, and a drop below the threshold
makes none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numba import njit

from sim.parameters import Parameter, resolve

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from sim.motion import Motion

__all__ = ["SlipPulse", "torque_drops"]

_REFERENCE_DROP = 6.94
"""T_crit - T_kin at 0.381 mm, from the peak sliding speed of Figure 6.7 [Nm]."""


@njit(cache=True)
def _drops(torque, least):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Index of the steepest fall and size of each fall of more than `least`."""
    n = torque.size
    where = np.empty(n // 2 + 1, dtype=np.int64)
    size = np.empty(n // 2 + 1)
    count = 0
    falling = False
    extreme = torque[0]
    steepest, at = 0.0, 0
    top = torque[0]
    for i in range(1, n):
        change = torque[i] - torque[i - 1]
        if falling:
            if change < steepest:
                steepest, at = change, i
            if torque[i] < extreme:
                extreme = torque[i]
            elif torque[i] > extreme + least:
                where[count] = at
                size[count] = top - extreme
                count += 1
                falling = False
                extreme = torque[i]
                steepest = 0.0
        elif torque[i] >= extreme:
            extreme = torque[i]
            steepest, at = 0.0, i
        else:
            if change < steepest:
                steepest, at = change, i
            if torque[i] < extreme - least:
                falling = True
                top = extreme
                extreme = torque[i]
    return where[:count], size[:count]


def torque_drops(
    torque: NDArray[np.float64], least: float
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Find where a torque falls, by more than `least` between two turning points.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        [Nm]
    least : float
        Smallest fall that counts [Nm].

    Returns
    -------
    where : ndarray of int, shape (n_drops,)
        Sample of the steepest fall.
    size : ndarray, shape (n_drops,)
        From the maximum before to the minimum after [Nm].

    Examples
    --------
    >>> torque_drops(np.array([0.0, 1.0, 2.0, 0.5, 0.4, 1.5, 2.0]), 1.0)
    (array([3]), array([1.6]))
    """
    where, size = _drops(np.ascontiguousarray(torque), least)
    return where, size


@dataclass(frozen=True)
class SlipPulse:
    """Force pulse in the anchors' joint at each slip.

    Parameters
    ----------
    amplitude : float
        Peak force at a torque drop of 6.94 Nm [N].
    threshold : float
        Torque drop below which nothing happens [Nm].
    duration : float
        Of the half-sine [s].
    """

    amplitude: float
    threshold: float
    duration: float

    name: ClassVar[str] = "slip_pulse"
    stage: ClassVar[str] = "structure"
    parameters: ClassVar[dict[str, Parameter]] = {
        "amplitude": Parameter(60.0, "N", 0.0, 1e4, "peak force at a torque drop of 6.94 Nm"),
        "threshold": Parameter(5.2, "Nm", 0.0, 6.9, "torque drop below which nothing happens"),
        "duration": Parameter(50e-6, "s", 1e-5, 1e-3, "of the half-sine"),
    }

    @classmethod
    def from_parameters(cls, given: Mapping[str, float | str]) -> SlipPulse:
        """Return the effect with these parameters, the others at their defaults."""
        return cls(**resolve(cls.name, cls.parameters, given))

    def force(self, motion: Motion) -> NDArray[np.float64]:
        """Force of the pulses over the motion [N], shape (n,)."""
        turning = np.sign(np.where(motion.shaft_speed == 0.0, 1.0, motion.shaft_speed))
        force = np.zeros_like(motion.torque)
        if self.amplitude == 0.0:
            return force
        where, drops = torque_drops(motion.torque * turning, max(self.threshold, 1e-6))
        excess = (drops - self.threshold) / (_REFERENCE_DROP - self.threshold)
        peaks = self.amplitude * np.sqrt(np.maximum(excess, 0.0))
        n = math.ceil(self.duration * motion.rate)
        shape = np.sin(np.pi * np.arange(1, n + 1) / (self.duration * motion.rate))
        shape = np.clip(shape, 0.0, None)
        for start, peak in zip(where, peaks, strict=True):
            stop = min(start + n, force.size)
            force[start:stop] += turning[start] * peak * shape[: stop - start]
        return force
