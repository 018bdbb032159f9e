# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001
"""Steps of Dormand and Prince's pair of fifth and fourth order, with dense output.

Dormand and Prince (1980), with the dense output of Shampine (1986). The seventh stage is the first
of the next step. Nothing here makes or keeps an array.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from scipy.integrate import RK45

from models.compilation import PART
from sim.solvers.contact_state import N_MOTION, N_STAGES

__all__ = [
    "ERROR", "NODES", "fill_dense", "fill_stage", "step_error", "vertex",
]  # fmt: skip

NODES = np.append(RK45.C, 1.0)
"""Of the stages, in shares of the step."""

_STAGES = np.zeros((N_STAGES, N_STAGES))
_STAGES[:6, :5] = RK45.A
_STAGES[6, :6] = RK45.B
ERROR = np.array(RK45.E)
"""Of a step by the rates at its stages, over its length."""

_DENSE = np.array(RK45.P)

_inlined = njit(forceinline=True, **PART)


@_inlined
def fill_stage(u, start, k, stage, h) -> None:
    """Fill the state `u` of a stage of a step of length `h` from `start`, with the rates `k`."""
    for j in range(u.size):
        u[j] = start[j]
    for b in range(stage):
        w = h * _STAGES[stage, b]
        for j in range(u.size):
            u[j] += w * k[b, j]


@_inlined
def fill_dense(q, k, length) -> None:
    """Fill the coefficients `q` of the first to fourth power of the share of the step."""
    for a in range(4):
        for j in range(q.shape[1]):
            q[a, j] = 0.0
        for b in range(N_STAGES):
            w = length * _DENSE[b, a]
            for j in range(q.shape[1]):
                q[a, j] += w * k[b, j]


@_inlined
def step_error(k, h, start, end, angle_scale, speed_scale) -> float:
    """Largest error of a step over its scale [-]; infinite if something is not finite.

    Angles and speeds, which alternate, have scales of their own; other variables that of what
    they are, and of what the step changes in them.
    """
    largest = 0.0
    for j in range(end.size):
        error = 0.0
        for b in range(N_STAGES):
            error += ERROR[b] * k[b, j]
        if not math.isfinite(error):
            return math.inf
        if j >= N_MOTION:
            scale = max(abs(start[j]), abs(end[j])) + h * abs(k[0, j]) + 1e-300
        else:
            scale = angle_scale if j % 2 == 0 else speed_scale
        largest = max(largest, abs(h * error) / scale)
    return largest


@_inlined
def vertex(x0, y0, x1, y1, x2, y2) -> tuple[float, float]:
    """Where a parabola through three points is least between the outer ones, and how little.

    One and infinity where it has no minimum there.
    """
    first, second = (y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1)
    bend = (second - first) / (x2 - x0)
    x = 0.5 * (x0 + x1 - first / bend) if bend > 0.0 else x2
    if not x0 < x < x2:
        return 1.0, math.inf
    return x, y0 + (x - x0) * (first + (x - x1) * bend)
