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
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from sim.effects.effect import Effect, Stage
from sim.parameters import Parameter

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from sim.motion import Motion

__all__ = ["EFFECT", "torque_drops"]

_REFERENCE_DROP = 6.94
"""T_crit - T_kin at 0.381 mm, from the peak sliding speed of Figure 6.7 [Nm]."""


@njit(cache=True)
def _drops(torque, least):
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


def _force(motion: Motion, form: str, values: Mapping[str, float]) -> NDArray[np.float64]:
    turning = np.sign(np.where(motion.shaft_speed == 0.0, 1.0, motion.shaft_speed))
    force = np.zeros_like(motion.torque)
    threshold, duration = values["threshold"], values["duration"]
    where, drops = torque_drops(motion.torque * turning, max(threshold, 1e-6))
    excess = (drops - threshold) / (_REFERENCE_DROP - threshold)
    peaks = values["amplitude"] * np.sqrt(np.maximum(excess, 0.0))
    shape = _shape(form, duration, motion.rate)
    for start, peak in zip(where, peaks, strict=True):
        stop = min(start + shape.size, force.size)
        force[start:stop] += turning[start] * peak * shape[: stop - start]
    return force


def _shape(form: str, duration: float, rate: float) -> NDArray[np.float64]:
    """Course of a pulse with unit peak, by its samples after the slip."""
    if form == "exponential":
        return np.exp(-np.arange(1, math.ceil(6.0 * duration * rate) + 1) / (duration * rate))
    x = np.arange(1, math.ceil(duration * rate) + 1) / (duration * rate)
    if form == "triangle":
        return np.clip(1.0 - np.abs(2.0 * x - 1.0), 0.0, None)
    return np.clip(np.sin(np.pi * x), 0.0, None)


EFFECT = Effect(
    name="slip_pulse",
    stage=Stage.STRUCTURE,
    forms=("half_sine", "exponential", "triangle"),
    parameters={
        "amplitude": Parameter(60.0, "N", 0.0, 1e4, "peak force at a torque drop of 6.94 Nm"),
        "threshold": Parameter(5.2, "Nm", 0.0, 6.9, "torque drop below which nothing happens"),
        "duration": Parameter(
            50e-6, "s", 1e-5, 1e-3, "of the pulse; its time constant if exponential"
        ),
    },
    strength="amplitude",
    force=_force,
)
