"""Intervals of a swing in which the shaft moves fast, each nearly of one speed.

Where the shaft turns back its torque turns from one side to the other, which is neither vibration
nor noise. In between, the slow trend of the torque with the speed is taken off.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sim.motion import Motion


_FAST_SHARE = 0.5
"""Of the peak speed, above which a swing is judged."""


def fast_intervals(motion: Motion, *, swings: bool) -> list[Motion]:
    """List the parts of a motion that are nearly of one speed.

    Parameters
    ----------
    motion : Motion
        Of a whole swing, or at constant speed.
    swings : bool

    Returns
    -------
    list of Motion
        All of it, or the two longest intervals at half the peak speed or more.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.motion import simulate_motion
    >>> from sim.shaft import Oscillation
    >>> motion = simulate_motion(load_material_rig("PDMS"), Oscillation(0.26, 4.0), rate=30e3,
    ...                          interference=0.3e-3, support_stiffness=2214.0, seconds=0.25)
    >>> [round(part.torque.size / motion.rate, 3) for part in fast_intervals(motion, swings=True)]
    [0.083, 0.042]
    """
    if not swings:
        return [motion]
    fast = np.abs(motion.shaft_speed) >= _FAST_SHARE * np.abs(motion.shaft_speed).max()
    edges = np.flatnonzero(np.diff(np.concatenate([[False], fast, [False]]).astype(int)))
    pieces = sorted(edges.reshape(-1, 2), key=lambda edge: edge[0] - edge[1])[:2]
    return [_piece(motion, first, last) for first, last in pieces]


def _piece(motion: Motion, first: int, last: int) -> Motion:
    """Part of a motion, without the slow trend of its torque over a swing."""
    kept = {
        field.name: getattr(motion, field.name)[first:last]
        for field in fields(motion)
        if field.name != "rate"
    }
    time = np.linspace(-1.0, 1.0, last - first)
    trend = np.polynomial.Polynomial.fit(time, kept["torque"], 3)(time)
    kept["torque"] = kept["torque"] - trend + trend.mean()
    return replace(motion, **kept)
