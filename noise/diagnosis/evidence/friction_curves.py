"""Friction torque of a recording drawn over what it may depend on, with its uncertainty.

While the surface slips the torque is drawn over the sliding speed; the torque at which each slip
begins over the time for which the surface had stuck, over time and over the shaft's angle. Bins
hold about as many slips each. An error of a mean is that of the slips' scatter, taken together with
what gains differ by from run to run, which no number of slips averages out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.recording import Recording
from models.rig import Rig
from models.show import short_repr
from noise.base import SURE_90
from noise.diagnosis.evidence.contact_summary import slip_starts
from noise.diagnosis.evidence.reconstruction import reconstruct, shaft_speed
from noise.diagnosis.simulated.repeats import Scatter
from sim.bushing import lumped_bushing

_SPEED_EDGES = np.array([2.0, 4.0, 6.0, 9.0, 12.0, 16.0, 20.0, 25.0, 30.0, 40.0, 50.0])
"""Of bins of the sliding speed [rad/s]."""

_BINS = 10
"""Of slips, at most."""

_FEWEST = 4
"""Slips that make a curve, and a bin."""

_NEAR = 6e-4
"""Before a slip's start, in which its torque is looked for [s]."""


@short_repr
@dataclass(frozen=True, eq=False)
class TorqueCurve:
    """A mean torque and its 90 % interval.

    Parameters
    ----------
    x : ndarray, shape (n_bins,)
        What it is drawn over [unit of its field in `FrictionCurves`].
    torque, low, high : ndarray, shape (n_bins,)
        Mean and limits of its interval [Nm].
    """

    x: NDArray[np.float64]
    torque: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


@dataclass(frozen=True)
class FrictionCurves:
    """The friction torque of one recording.

    Parameters
    ----------
    sliding_speed : TorqueCurve
        While the surface slips, over the sliding speed [rad/s].
    time_stuck, time, angle : TorqueCurve
        When a slip begins, over the time stuck before it [s], over time [s] and over the angle by
        which the shaft has turned [rad].
    """

    sliding_speed: TorqueCurve
    time_stuck: TorqueCurve
    time: TorqueCurve
    angle: TorqueCurve


def friction_curves(recording: Recording, rig: Rig) -> FrictionCurves | None:
    """Rebuild the friction torque of a recording.

    Parameters
    ----------
    recording : Recording
    rig : Rig
        Whose stiffness, damping and inertias the torque in the contact is rebuilt with.

    Returns
    -------
    FrictionCurves or None
        None where no torque or no condition is known, or where too few slips are.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> run = simulate(rig, 1.0, interference=0.279e-3, support_stiffness=3745.0, seconds=0.4)
    >>> found = friction_curves(run.recording, rig)
    >>> bool(np.all(abs(found.time.torque - 10.7) < 0.5))  # the critical torque, at any time
    True
    """
    c = recording.condition
    row = recording.first("torque")
    if row is None or c.speed is None or c.interference is None or c.support_stiffness is None:
        return None
    turn, rate = float(np.copysign(1.0, c.speed)), recording.rate
    speed = np.full(recording.samples.shape[1], abs(c.speed))
    if (angle := recording.first("angle")) is not None:
        speed = shaft_speed(turn * recording.samples[angle], rate)
    bushing = lumped_bushing(rig, c.interference, c.support_stiffness)
    found = reconstruct(turn * recording.samples[row], speed, rate, bushing)
    starts, ends = slip_starts(found, abs(c.speed))
    if starts.size < _FEWEST + 1:
        return None
    near = round(_NEAR * rate)
    peaks = np.array([found.friction_torque[max(a - near, 0) : a + 2].max() for a in starts])
    when = found.start + starts / rate
    turned = np.cumsum(found.shaft_speed) / rate
    return FrictionCurves(
        sliding_speed=_over_speed(found.sliding_speed, found.friction_torque, starts, ends),
        time_stuck=_binned((starts[1:] - ends[:-1]) / rate, peaks[1:]),
        time=_binned(when, peaks),
        angle=_binned(turned[starts], peaks),
    )


def _over_speed(
    speed: NDArray[np.float64],
    torque: NDArray[np.float64],
    starts: NDArray[np.int64],
    ends: NDArray[np.int64],
) -> TorqueCurve:
    """Mean over slips of each slip's mean in a class of speed."""
    rows = []
    for a, b in zip(starts.tolist(), ends.tolist(), strict=True):
        place = np.digitize(speed[a:b], _SPEED_EDGES) - 1
        inside = (place >= 0) & (place < _SPEED_EDGES.size - 1)
        total = np.bincount(place[inside], torque[a:b][inside], _SPEED_EDGES.size - 1)
        count = np.bincount(place[inside], minlength=_SPEED_EDGES.size - 1)
        rows.append(np.where(count > 0, total / np.maximum(count, 1), np.nan))
    table = np.array(rows)
    known = np.isfinite(table).sum(axis=0) >= _FEWEST
    middles = 0.5 * (_SPEED_EDGES[1:] + _SPEED_EDGES[:-1])
    return _curve(middles[known], [column[np.isfinite(column)] for column in table.T[known]])


def _binned(x: NDArray[np.float64], torque: NDArray[np.float64]) -> TorqueCurve:
    order = np.argsort(x, kind="stable")
    parts = np.array_split(order, max(1, min(_BINS, x.size // _FEWEST)))
    return _curve(np.array([x[part].mean() for part in parts]), [torque[part] for part in parts])


def _curve(x: NDArray[np.float64], groups: list[NDArray[np.float64]]) -> TorqueCurve:
    mean = np.array([group.mean() for group in groups])
    error = np.array([group.std(ddof=1) / np.sqrt(group.size) for group in groups])
    sure = SURE_90 * np.hypot(error, Scatter().gain * mean)
    return TorqueCurve(x, mean, mean - sure, mean + sure)
