"""Slips of a contact in numbers: the mean cycle, and the friction torque over the sliding speed.

Averaged over all cycles at fixed times from the slip's start or the catch, noise and scatter fall
away while the shape stays: how the contact lets go, how far the torque falls, at which frequency
and how long the bushing rings. What rings while the surface sticks tells the elastomer's stiffness
at some hundred hertz, what the torque does over a whole stick that at a few: one changed parameter
moves both alike, a stiffness that depends on frequency does not.

Of the friction torque the way up and the way down of a slip are kept apart, since a contact with a
memory has another torque on either. A fitted level, slope and bend use all samples at once and
scatter less than the classes do.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.rig import Fit
    from noise.diagnosis.evidence.reconstruction import Reconstruction

__all__ = ["cycle_shape", "torque_by_speed"]

_BEFORE = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)
"""Times before a slip starts at which the torque is looked at [s]."""

_AFTER = (3e-4, 6e-4, 9e-4, 1.2e-3, 1.6e-3, 2e-3, 2.5e-3, 3e-3, 3.5e-3, 4.2e-3, 5e-3, 6e-3, 8e-3)
"""Times after the surface is caught [s]."""

_MARGIN = 6e-4
"""Of a stick at either end, which the band limit smears the slip into [s]."""

_FEWEST = 4
"""Cycles, or samples of ringing per unknown, that make a mean."""


def cycle_shape(
    found: Reconstruction,
    fit: Fit,
    starts: NDArray[np.int64],
    ends: NDArray[np.int64],
) -> dict[str, float]:
    """Summarise the mean cycle.

    Parameters
    ----------
    found : Reconstruction
    fit : Fit
        As the rig file has it.
    starts, ends : ndarray of int, shape (n_slips,)
        Samples at which the surface begins to slip, and at which it is caught.

    Returns
    -------
    dict of str to float
        Torques over the critical one, speeds over that of the shaft, relative changes of stiffness,
        damping and inertia [-]; a time that hardly any cycle reaches is left out.
    """
    if starts.size < _FEWEST:
        return {}
    torque = found.torque / fit.critical_torque
    creep = found.sliding_speed / np.maximum(np.abs(found.shaft_speed), 0.05)
    earlier = np.concatenate([[0], ends[:-1]])
    later = np.concatenate([starts[1:], [torque.size]])
    numbers: dict[str, float] = {}
    for i, time in enumerate(_BEFORE):
        at = starts - round(time * found.rate)
        inside = at > earlier
        numbers |= _means(f"before_{i}", torque, creep, at[inside])
    for i, time in enumerate(_AFTER):
        at = ends + round(time * found.rate)
        inside = at < later
        numbers |= _means(f"after_{i}", torque, creep, at[inside])
    return numbers | _ringing(found, starts, ends)


def _means(
    name: str, torque: NDArray[np.float64], creep: NDArray[np.float64], at: NDArray[np.int64]
) -> dict[str, float]:
    if at.size < _FEWEST:
        return {}
    return {
        f"{name}_torque": float(torque[at].mean()),
        f"{name}_creep": float(creep[at].mean()),
    }


def _ringing(
    found: Reconstruction, starts: NDArray[np.int64], ends: NDArray[np.int64]
) -> dict[str, float]:
    """Find what explains the creep within sticks, and what their means.

    In stick the surface moves with the shaft; what it seems to slide is linear in the errors of
    stiffness, damping and inertia.
    """
    margin = round(_MARGIN * found.rate)
    first, last = ends[:-1] + margin, starts[1:] - margin
    long = last - first > 3 * margin
    first, last = first[long], last[long]
    if first.size < _FEWEST:
        return {}
    lengths = last - first
    stick = np.repeat(np.arange(first.size), lengths)
    at = np.arange(lengths.sum()) + np.repeat(first - (np.cumsum(lengths) - lengths), lengths)

    columns = [found.sliding_speed, found.by_stiffness, found.by_damping, found.by_clamp]
    means = [np.bincount(stick, x[at]) / lengths for x in columns]
    rings = [x[at] - mean[stick] for x, mean in zip(columns, means, strict=True)]
    numbers = {
        "slow_stiffness": float(np.sum(lengths * means[0]) / (np.sum(lengths * means[1]) + 1e-9)),
        "ring": math.log(float(np.std(rings[1])) + 1e-3),
    }
    known = [k for k in (1, 2, 3) if float(np.std(rings[k])) > 1e-6]
    a = np.stack([rings[k] for k in known], axis=1)
    gram = a.T @ a
    gram += 1e-4 * np.diag(np.diag(gram))
    x = np.linalg.solve(gram, a.T @ rings[0])
    names = {1: "ring_stiffness", 2: "ring_damping", 3: "ring_clamp"}
    numbers |= {names[k]: float(value) for k, value in zip(known, x, strict=True)}
    spread = float(np.var(rings[0]))
    numbers["ring_left"] = 0.5 * math.log(float(np.var(rings[0] - a @ x)) / (spread + 1e-12) + 1e-6)
    numbers["ring_unlike"] = numbers["ring_stiffness"] - numbers["slow_stiffness"]
    return numbers


_SPEED_EDGES = np.array([2.0, 5.0, 9.0, 14.0, 20.0, 28.0, 40.0])
"""Of classes of the sliding speed [rad/s]."""

_FITTED = (3.0, 40.0)
"""Sliding speeds over which the law is fitted [rad/s]."""

_FEWEST_SAMPLES = 8
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
            numbers[f"law_{name}_{i}"] = (
                float(here.mean()) if here.size >= _FEWEST_SAMPLES else math.nan
            )
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
