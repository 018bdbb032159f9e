"""Friction torque over sliding speed in numbers: by classes of speed, and as a law of all slips.

The way up and the way down of a slip are kept apart, since a contact with a memory has another
torque on either. A fitted level, slope and bend use all samples at once and scatter less than the
classes do.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.rig import Fit
    from noise.diagnosis.evidence.reconstruction import Reconstruction

__all__ = ["torque_by_speed"]

_SPEED_EDGES = np.array([2.0, 5.0, 9.0, 14.0, 20.0, 28.0, 40.0])
"""Of classes of the sliding speed [rad/s]."""

_FITTED = (3.0, 40.0)
"""Sliding speeds over which the law is fitted [rad/s]."""

_FEWEST = 8
"""Samples that make a mean."""

_ENOUGH = 60
"""Samples that make a law."""


def torque_by_speed(
    found: Reconstruction, fit: Fit, slipping: NDArray[np.bool_]
) -> dict[str, float]:
    """Summarise the friction torque of a slipping contact.

    Parameters
    ----------
    found : Reconstruction
    fit : Fit
        As the rig file has it.
    slipping : ndarray of bool, shape (n,)
        When the contact slips.

    Returns
    -------
    dict of str to float
        Torques over the kinetic one of the rig file [-].
    """
    faster = np.gradient(found.sliding_speed) > 0.0
    numbers: dict[str, float] = {}
    for name, chosen in (("up", slipping & faster), ("down", slipping & ~faster)):
        place = np.digitize(found.sliding_speed[chosen], _SPEED_EDGES)
        torque = found.friction_torque[chosen] / fit.kinetic_torque
        for i in range(1, _SPEED_EDGES.size):
            here = torque[place == i]
            numbers[f"law_{name}_{i}"] = float(here.mean()) if here.size >= _FEWEST else math.nan
            if name == "down":
                numbers[f"law_spread_{i}"] = float(here.std()) if here.size > 20 else math.nan
    inside = slipping & (found.sliding_speed > _FITTED[0])
    inside &= found.sliding_speed < _FITTED[1]
    if inside.sum() > _ENOUGH:
        v = found.sliding_speed[inside] / _FITTED[1] - 0.5
        a = np.stack([np.ones_like(v), v, v * v - 1.0 / 12.0, faster[inside] - 0.5], axis=1)
        b = found.friction_torque[inside] / fit.kinetic_torque
        x = np.linalg.solve(a.T @ a + 1e-6 * len(a) * np.eye(4), a.T @ b)
        names = ("law_level", "law_slope", "law_bend", "law_loop")
        numbers |= {name: float(value) for name, value in zip(names, x, strict=True)}
        numbers["law_left"] = float(np.std(b - a @ x))
    return numbers
