# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001
"""Tsitouras's Runge-Kutta pair of fifth and fourth order, with dense output.

Tsitouras (2011), "Runge-Kutta pairs of order 5(4) satisfying only the first column simplifying
assumption": a third of the error of Dormand and Prince's pair at the same number of stages. The
seventh stage is the first of the next step. No function allocates an array. Sums run over the
stages of one variable at a time, because vector loads of values just stored as scalars would stall.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from models.compilation import PART
from sim.solvers.contact_solver import N_MOTION, N_STAGES

NODES = np.array([0.0, 0.161, 0.327, 0.9, 0.9800255409045097, 1.0, 1.0])
"""Nodes of the stages, in shares of the step."""

STAGES = np.zeros((N_STAGES, N_STAGES))
for _stage, _weights in enumerate(
    (
        [0.161],
        [-0.008480655492356989, 0.335480655492357],
        [2.8971530571054935, -6.359448489975075, 4.3622954328695815],
        [5.325864828439257, -11.748883564062828, 7.4955393428898365, -0.09249506636175525],
        [
            5.86145544294642, -12.92096931784711, 8.159367898576159, -0.071584973281401,
            -0.028269050394068383,
        ],
        [
            0.09646076681806523, 0.01, 0.4798896504144996, 1.379008574103742, -3.290069515436081,
            2.324710524099774,
        ],
    ),
    start=1,
):  # fmt: skip
    STAGES[_stage, :_stage] = _weights

ERROR = np.array(
    [
        0.00178001105222577714, 0.0008164344596567469, -0.007880878010261995, 0.1447110071732629,
        -0.5823571654525552, 0.45808210592918697, -1.0 / 66.0,
    ]
)  # fmt: skip
"""Weights of the stages' rates in the error of a step, over its length."""

_BETWEEN = np.array(
    [
        [1.0, -2.763706197274826, 2.9132554618219126, -1.0530884977290216],
        [0.0, 0.1317, -0.2234, 0.1017],
        [0.0, 3.9302962368947516, -5.941033872131505, 2.490627285651253],
        [0.0, -12.411077166933676, 30.33818863028232, -16.548102889244902],
        [0.0, 37.50931341651104, -88.1789048947664, 47.37952196281928],
        [0.0, -27.896526289197286, 65.09189467479366, -34.87065786149661],
        [0.0, 1.5, -4.0, 2.5],
    ]
)
"""Weights of the stages within a step: factors of the first to fourth power of the share."""

_SAFETY, _LEAST_FACTOR, _MOST_FACTOR = 0.9, 0.2, 4.0

_SMALLEST_ERROR = 1e-4
"""Smallest error that the step control uses, over the tolerance."""

_inlined = njit(forceinline=True, **PART)


@_inlined
def _change(k, j, stage) -> float:
    change = 0.0
    for b in range(stage):
        change += STAGES[stage, b] * k[j, b]
    return change


@_inlined
def fill_stage(u, start, k, stage, h) -> None:
    """Fill the state `u` of a stage of a step of length `h` from `start`, with the rates `k`."""
    if stage == 0:
        for j in range(u.size):
            u[j] = start[j]
    elif stage == 1:
        for j in range(u.size):
            u[j] = start[j] + h * _change(k, j, 1)
    elif stage == 2:
        for j in range(u.size):
            u[j] = start[j] + h * _change(k, j, 2)
    elif stage == 3:
        for j in range(u.size):
            u[j] = start[j] + h * _change(k, j, 3)
    elif stage == 4:
        for j in range(u.size):
            u[j] = start[j] + h * _change(k, j, 4)
    elif stage == 5:
        for j in range(u.size):
            u[j] = start[j] + h * _change(k, j, 5)
    else:
        for j in range(u.size):
            u[j] = start[j] + h * _change(k, j, 6)


@_inlined
def fill_between(u, start, k, weights, x, h) -> None:
    """Fill the state `u` at the share `x` of a step; `weights` is work space, one per stage."""
    for b in range(N_STAGES):
        w = _BETWEEN[b, 2] + x * _BETWEEN[b, 3]
        weights[b] = h * x * (_BETWEEN[b, 0] + x * (_BETWEEN[b, 1] + x * w))
    for j in range(u.size):
        change = 0.0
        for b in range(N_STAGES):
            change += weights[b] * k[j, b]
        u[j] = start[j] + change


@_inlined
def value_between(start, k, j, x, h) -> float:
    """Return the value of the variable `j` at the share `x` of a step."""
    change = 0.0
    for b in range(N_STAGES):
        w = _BETWEEN[b, 2] + x * _BETWEEN[b, 3]
        change += (_BETWEEN[b, 0] + x * (_BETWEEN[b, 1] + x * w)) * k[j, b]
    return start[j] + h * x * change


@_inlined
def step_error(k, h, start, end, first_lag, per_angle, per_speed) -> float:
    """Return the largest error of a step over its scale [-]; infinite if a value is not finite.

    Angles and speeds, which alternate, have fixed scales, passed as reciprocals; inner states are
    scaled by their size and their change in the step. From `first_lag` on there are angles and
    speeds again.
    """
    largest, total = 0.0, 0.0
    for j in range(end.size):
        error = 0.0
        for b in range(N_STAGES):
            error += ERROR[b] * k[j, b]
        total += error
        error = abs(h * error)
        if N_MOTION <= j < first_lag:
            scale = max(abs(start[j]), abs(end[j])) + h * abs(k[j, 0]) + 1e-300
            largest = max(largest, error / scale)
        else:
            place = j if j < N_MOTION else j - first_lag
            largest = max(largest, error * (per_angle if place % 2 == 0 else per_speed))
    return largest if math.isfinite(total) else math.inf


@_inlined
def factor_of_step(error, error_before) -> float:
    """Return the factor to the next step's length, from the errors of this and the last step.

    Errors are over the tolerance. The proportional-integral control of Gustafsson (1991) has half
    the rejections of a control without memory; the powers are nested roots, which are cheap.
    """
    if error > 1.0:
        return max(_SAFETY / math.sqrt(math.sqrt(error)), _LEAST_FACTOR)
    ratio = math.sqrt(max(error_before, _SMALLEST_ERROR)) / error
    return min(_SAFETY * math.sqrt(math.sqrt(math.sqrt(ratio))), _MOST_FACTOR)


@_inlined
def vertex(x0, y0, x1, y1, x2, y2) -> tuple[float, float]:
    """Return place and value of the minimum of a parabola through three points.

    They are one and infinity if there is no minimum between the outer points.
    """
    first, second = (y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1)
    bend = (second - first) / (x2 - x0)
    x = 0.5 * (x0 + x1 - first / bend) if bend > 0.0 else x2
    if not x0 < x < x2:
        return 1.0, math.inf
    return x, y0 + (x - x0) * (first + (x - x1) * bend)
