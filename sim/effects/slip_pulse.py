"""Short pulse of force at each slip, in the joint between beam and anchor.

The lumped model's anchor force above 5 kHz is some 100 dB too small to creak, and the torque cell
shows little above 2 kHz; bolting the clamp to the baseplate ends the creak (5.2.3). So the source
lies downstream of the torque cell, in clamp, beam or anchor: a micro-impact triggered by the slip.
One law covers all fits: no pulse below a threshold of the torque's drop, since the joint holds;
above it a half-sine whose peak grows with the square root of the excess, like the speed of a loose
part with its energy, and reaches `amplitude` at the drop of the creaking fit (6.94 Nm at 0.381 mm).
Limits: amplitude zero is no pulse, and neither is a drop below the threshold.
"""

import itertools
import math
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from sim.effects.effect import Effect, Parameter, Stage
from sim.motion import Motion

_REFERENCE_DROP = 6.94
"""T_crit - T_kin at 0.381 mm, from the peak sliding speed of Figure 6.7 [Nm]."""


def torque_drops(
    torque: NDArray[np.float64], least: float
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Find the falls of a torque by more than `least` between two turning points.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        [Nm]
    least : float
        Smallest fall that counts [Nm].

    Returns
    -------
    where : ndarray of int, shape (n_drops,)
        Sample of the steepest slope of each fall.
    size : ndarray, shape (n_drops,)
        Fall from the maximum before to the minimum after [Nm].

    Examples
    --------
    >>> torque_drops(np.array([0.0, 1.0, 2.0, 0.5, 0.4, 1.5, 2.0]), 1.0)
    (array([3]), array([1.6]))
    """
    change = np.diff(torque)
    moves = np.flatnonzero(change)
    rises = change[moves] > 0.0
    points = np.append(
        moves[1:][rises[1:] != rises[:-1]], torque.size - 1
    )  # turning points and the last sample
    falls, sizes = list[int](), list[float]()
    falling, start, top, extreme = False, 0, 0.0, float(torque[0])
    for i, value in zip(points.tolist(), torque[points].tolist(), strict=True):
        if not falling and value >= extreme:
            start, extreme = i, value
        elif not falling and value < extreme - least:
            falling, top, extreme = True, extreme, value
        elif falling and value < extreme:
            extreme = value
        elif falling and value > extreme + least:
            falls.append(start + 1 + int(np.argmin(change[start:i])))
            sizes.append(top - extreme)
            falling, start, extreme = False, i, value
    return np.array(falls, dtype=np.int64), np.array(sizes)


def _force(motion: Motion, form: str, values: Mapping[str, float]) -> NDArray[np.float64]:
    force = np.zeros_like(motion.torque)
    threshold = values["threshold"]
    shape = _shape(form, values["duration"], motion.rate)
    # Each stretch of one direction on its own: the torque also falls where the shaft reverses,
    # which is no slip.
    turns = np.flatnonzero(np.diff(np.signbit(motion.shaft_speed))) + 1
    edges = [0, *turns, force.size]
    for first, last in itertools.pairwise(edges):
        way = -1.0 if motion.shaft_speed[first] < 0.0 else 1.0
        where, drops = torque_drops(way * motion.torque[first:last], max(threshold, 1e-6))
        excess = (drops - threshold) / (_REFERENCE_DROP - threshold)
        peaks = values["amplitude"] * np.sqrt(np.maximum(excess, 0.0))
        for start, peak in zip(first + where, peaks, strict=True):
            stop = min(start + shape.size, force.size)
            force[start:stop] += way * peak * shape[: stop - start]
    return force


def _shape(form: str, duration: float, rate: float) -> NDArray[np.float64]:
    """Return a pulse of unit peak as its mean over each sample, which keeps its impulse."""
    length = 6.0 if form == "exponential" else 1.0
    x = np.arange(math.ceil(length * duration * rate) + 1) / (duration * rate)
    return np.diff(_IMPULSE[form](np.minimum(x, length))) * duration * rate


_IMPULSE: dict[str, Callable[[NDArray[np.float64]], NDArray[np.float64]]] = {
    "half_sine": lambda x: (1.0 - np.cos(np.pi * x)) / np.pi,
    "exponential": lambda x: 1.0 - np.exp(-x),
    "triangle": lambda x: np.where(x < 0.5, x**2, 2.0 * x - x**2 - 0.5),
}
"""Integral of each form of unit peak from its start to x durations."""


EFFECT = Effect(
    name="slip_pulse",
    stage=Stage.STRUCTURE,
    forms=("half_sine", "exponential", "triangle"),
    parameters={
        "amplitude": Parameter(60.0, "N", 0.0, 1e4, "peak force at a torque drop of 6.94 Nm"),
        "threshold": Parameter(5.2, "Nm", 0.0, 6.9, "torque drop below which there is no pulse"),
        "duration": Parameter(
            50e-6, "s", 1e-5, 1e-3, "duration of the pulse, or time constant if exponential"
        ),
    },
    strength="amplitude",
    force=_force,
)
