# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001, ANN201
"""Compiled functions of the unknown effects; one serves all that act on the contact."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim.contact import (
    CRITICAL,
    ELASTOMER_TORQUE,
    HOOK_SIGNATURE,
    KINETIC,
    SHAFT_ANGLE,
    STIFFNESS,
    TIME,
    TORQUE,
    TWIST,
    TWIST_RATE,
)

TORQUES, STIFFNESSES, SPRING, BESIDE, ABSORBER, LOADED = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0
"""What is changed."""

OVER_TIME, OVER_ANGLE = 0.0, 1.0
HEADER = 4


@njit(HOOK_SIGNATURE, cache=True, error_model="numpy")
def table_hook(context, values, state, state_rates, contact):
    """Change one thing, the first value.

    Torques or stiffness by a table over time or angle: whether over angle, period, length; table.
    A spring beside the elastomer: 0, twist from which on, power (0 on one side alone); stiffness.
    Dry friction beside it: its torque, twist over which it builds up, 0.
    A mass that swings in it: stiffness, angular frequency, damping ratio.
    Torques by the elastomer's own torque: share, torque at which nothing changes, 0.
    """
    what, over, scale = values[0], values[1], values[2]
    if what == SPRING:
        deep = context[TWIST] - scale
        if values[3] > 0.0 or deep > 0.0:
            contact[ELASTOMER_TORQUE] += values[HEADER] * deep * abs(deep) ** values[3]
        return
    if what == BESIDE:
        bent, rate = state[0], context[TWIST_RATE] / scale
        state_rates[0] = rate * (1.0 - abs(bent)) if rate * bent > 0.0 else rate
        contact[ELASTOMER_TORQUE] += over * bent
        return
    if what == ABSORBER:
        stretch = context[TWIST] - state[0]
        slip = context[TWIST_RATE] - state[1]
        pull = scale * scale * stretch + 2.0 * values[3] * scale * slip
        state_rates[0], state_rates[1] = state[1], pull
        contact[ELASTOMER_TORQUE] += over * pull / (scale * scale)
        return
    if what == LOADED:
        factor = max(1.0 + over * (abs(context[TORQUE]) / scale - 1.0), 0.2)
        contact[KINETIC] *= factor
        contact[CRITICAL] *= factor
        return
    n = int(values[3])
    x = (context[TIME] if over == OVER_TIME else context[SHAFT_ANGLE]) / scale
    x = (x - math.floor(x)) * n
    i = int(x)
    part = x - i
    table = (1.0 - part) * values[HEADER + i % n] + part * values[HEADER + (i + 1) % n]
    if what == STIFFNESSES:
        contact[STIFFNESS] *= 1.0 + table
    else:
        contact[KINETIC] *= 1.0 + table
        contact[CRITICAL] *= 1.0 + table


@njit(cache=True)
def lagging(x, width):
    """Follow a signal, shape (n,), with play of half the width to each side."""
    y = np.empty_like(x)
    held = x[0]
    for i in range(x.size):
        held = min(max(held, x[i] - width), x[i] + width)
        y[i] = held
    return y


@njit(cache=True)
def slewing(x, most):
    """Follow a signal, shape (n,), by so much a sample at most."""
    y = np.empty_like(x)
    held = x[0]
    for i in range(x.size):
        held += min(max(x[i] - held, -most), most)
        y[i] = held
    return y
