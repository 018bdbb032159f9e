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
from numpy.typing import NDArray

from noise.diagnosis.evidence.contact_kernel import gather_rings, gather_slipping, mean_cycle

if TYPE_CHECKING:
    from models.rig import Fit
    from noise.diagnosis.evidence.reconstruction import Reconstruction


_BEFORE = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)
"""Times before a slip starts at which the torque is looked at [s]."""

_AFTER = (3e-4, 6e-4, 9e-4, 1.2e-3, 1.6e-3, 2e-3, 2.5e-3, 3e-3, 3.5e-3, 4.2e-3, 5e-3, 6e-3, 8e-3)
"""Times after the surface is caught [s]."""

_MARGIN = 6e-4
"""Of a stick at either end, which the band limit smears the slip into [s]; assumed."""

_FEWEST = 4
"""Cycles, or samples of ringing per unknown, that make a mean; assumed."""


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
    rate = found.rate
    before, after = (np.array([round(t * rate) for t in times]) for times in (_BEFORE, _AFTER))
    sums = np.empty((before.size + after.size, 3))
    mean_cycle(
        found.torque, found.sliding_speed, found.shaft_speed, starts, ends, before, after, sums
    )
    names = [f"before_{i}" for i in range(before.size)] + [f"after_{i}" for i in range(after.size)]
    numbers: dict[str, float] = {}
    for name, (count, torque, crept) in zip(names, sums.tolist(), strict=True):
        if count >= _FEWEST:
            numbers[f"{name}_torque"] = torque / count / fit.critical_torque
            numbers[f"{name}_creep"] = crept / count
    return numbers | _ringing(found, starts, ends)


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
    rows, sums = np.empty((4, found.torque.size)), np.empty(4)
    signals = (found.sliding_speed, found.by_stiffness, found.by_damping, found.by_clamp)
    n = gather_rings(signals, first, last, rows, sums)
    rings = rows[:, :n]
    products = rings @ rings.T
    spreads = np.sqrt(np.diag(products) / n)  # their means are 0
    numbers = {
        "slow_stiffness": float(sums[0] / (sums[1] + 1e-9)),
        "ring": math.log(float(spreads[1]) + 1e-3),
    }
    known = [k for k in (1, 2, 3) if spreads[k] > 1e-6]
    gram = products[np.ix_(known, known)]
    gram += 1e-4 * np.diag(np.diag(gram))
    x = np.linalg.solve(gram, products[known, 0])
    names = {1: "ring_stiffness", 2: "ring_damping", 3: "ring_clamp"}
    numbers |= {names[k]: float(value) for k, value in zip(known, x, strict=True)}
    left = float(np.var(rings[0] - x @ rings[known]))
    numbers["ring_left"] = 0.5 * math.log(left / (float(spreads[0]) ** 2 + 1e-12) + 1e-6)
    if "ring_stiffness" in numbers:
        numbers["ring_unlike"] = numbers["ring_stiffness"] - numbers["slow_stiffness"]
    return numbers


_SPEED_EDGES = np.array([2.0, 5.0, 9.0, 14.0, 20.0, 28.0, 40.0])
"""Of classes of the sliding speed [rad/s]."""

_FITTED = (3.0, 40.0)
"""Sliding speeds over which the law is fitted [rad/s]; assumed."""

_FEWEST_SAMPLES = 8
"""Samples that make a mean; assumed."""

_ENOUGH = 60
"""Samples that make a law; assumed."""


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
    n, n_classes = slipping.size, _SPEED_EDGES.size - 1
    rows, target, classes = np.empty((n, 4)), np.empty(n), np.empty((2, n_classes, 3))
    m = gather_slipping(
        found.sliding_speed, found.friction_torque / fit.kinetic_torque, slipping, _FITTED,
        _SPEED_EDGES, rows, target, classes,
    )  # fmt: skip
    numbers: dict[str, float] = {}
    for name, row in zip(("up", "down"), classes.tolist(), strict=True):
        for i, (count, total, square) in enumerate(row, start=1):
            enough = count >= _FEWEST_SAMPLES
            numbers[f"law_{name}_{i}"] = total / count if enough else math.nan
            if name == "down":
                numbers[f"law_spread_{i}"] = math.sqrt(square / count) if count > 20 else math.nan
    if m > _ENOUGH:
        a, b = rows[:m], target[:m]
        x = np.linalg.solve(a.T @ a + 1e-6 * m * np.eye(4), a.T @ b)
        names = ("law_level", "law_slope", "law_bend", "law_loop")
        numbers |= dict(zip(names, x.tolist(), strict=True))
        numbers["law_left"] = float(np.std(b - a @ x))
    return numbers
