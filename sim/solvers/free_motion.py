# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001, ANN202
"""The lumped model between events, where it is linear: as a Taylor series, and as one matrix.

A whole step needs only the matrix of that step, which is fast; a part of one, up to an event,
needs the series, which is exact at any time within. Both come from the same recurrence, so they
agree to rounding. A step is cut up until the series converges fast and no quantity turns twice
within a part.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.compilation import PART
from models.errors import ParameterError

ORDER = 17
"""Most terms of the series: 0.7^18 / 18! is below rounding."""

_LONGEST_PART = 0.7
"""Of the reciprocal of the fastest rate."""

_MOST_PARTS = 100_000

SLIP, STICK = 0, 20
"""Where the matrices start: slip (4 x 5: state, torque), stick (2 x 5: theta1, speed, rate of the
speed, theta2, theta2')."""

_INVERSE = 1.0 / np.arange(1.0, ORDER + 2.0)


def parts_of_a_step(system: NDArray[np.float64], step: float) -> int:
    """Into how many parts a step is cut.

    The fastest rate of M x'' + C x' + K x = 0 is at most tr(C/M) + sqrt(tr(K/M)).

    Parameters
    ----------
    system : ndarray, shape (6,)
        As of `sim.bushing.LumpedBushing.packed`.
    step : float
        [s]

    Raises
    ------
    ParameterError
        If it were more than 100,000 parts, or the system is not finite.

    Examples
    --------
    >>> parts_of_a_step(np.array([1 / 65000, 1 / 1200, 665.0, 3745.0, 0.0425, 0.0425]), 1e-3)
    15
    """
    parts = math.inf
    if step > 0.0 and system[0] > 0.0 and system[1] > 0.0:
        parts = _fastest_rate(system.tolist()) * step / _LONGEST_PART
    if not parts <= _MOST_PARTS:
        raise ParameterError(
            f"a step of {step:g} s is too long for inertia {system[0]:g} and {system[1]:g} kg m2, "
            f"stiffness {system[2]:g} Nm/rad and damping {system[4]:g} Nm s/rad"
        )
    return max(1, math.ceil(parts))


def _fastest_rate(system: list[float]) -> float:
    j_e, j_c, k_e, k_b, c_e, c_b = system
    stiffness, damping = k_e / j_e, c_e / j_e
    if k_b >= 0.0:
        stiffness += (k_e + k_b) / j_c
        damping += (c_e + c_b) / j_c
    return damping + math.sqrt(stiffness) if stiffness >= 0.0 else math.nan


def extended(system: NDArray[np.float64]) -> NDArray[np.float64]:
    """Append the inertias' reciprocals, none for a fixed clamp, and the longest part's own.

    Parameters
    ----------
    system : ndarray, shape (6,)
        As of `sim.bushing.LumpedBushing.packed`.

    Returns
    -------
    ndarray, shape (9,)
        The same, then two of [1/(kg m2)] and one of [1/s].

    Examples
    --------
    >>> system = np.array([1 / 65000, 1 / 1200, 665.0, 3745.0, 0.0425, 0.0425])
    >>> extended(system)[6:].round()
    array([65000.,  1200., 14043.])
    """
    j_e, j_c, _, k_b, _, _ = values = system.tolist()
    j_c_inverse = 0.0 if k_b < 0.0 else 1.0 / j_c
    return np.array([*values, 1.0 / j_e, j_c_inverse, _fastest_rate(values) / _LONGEST_PART])


@njit(**PART)
def order_for(share) -> int:
    """Order that the series needs over this share of the longest part: it loses below 1e-17."""
    return min(ORDER, 9 + int(np.ceil(8.0 * share)))


@njit(**PART)
def fill_series(c, order, x0, x1, x2, x3, way, torque, acceleration, s) -> None:
    """Fill `c[k]` with the coefficients of theta1, theta1', theta2, theta2' and T_E.

    `way` is the direction of the sliding, 0 in stick.
    """
    k_e, k_b, c_e, c_b, j_e_inverse, j_c_inverse = s[2], s[3], s[4], s[5], s[6], s[7]
    drive = acceleration if way == 0.0 else torque * j_e_inverse
    pull = 0.0 if way == 0.0 else j_e_inverse
    for k in range(order):
        elastomer = k_e * (x0 - x2) + c_e * (x1 - x3)
        c[k, 0], c[k, 1], c[k, 2], c[k, 3], c[k, 4] = x0, x1, x2, x3, elastomer
        w = _INVERSE[k]
        x0, x1, x2, x3 = (
            w * x1,
            w * (drive - pull * elastomer),
            w * x3,
            w * (elastomer - k_b * x2 - c_b * x3) * j_c_inverse,
        )
        drive = 0.0
    c[order, 0], c[order, 1], c[order, 2], c[order, 3] = x0, x1, x2, x3
    c[order, 4] = k_e * (x0 - x2) + c_e * (x1 - x3)


@njit(**PART)
def fill_matrices(matrices, c, one, h, s) -> None:
    """Fill the matrices of a step of length `h`, from the series of unit states in `one`."""
    order = c.shape[0] - 1
    for column in range(5):
        for i in range(5):
            one[i] = 1.0 if i == column else 0.0
        fill_series(c, order, one[0], one[1], one[2], one[3], 1.0, one[4], 0.0, s)
        for row in range(4):
            matrices[SLIP + 5 * row + column] = _sum(c, row, h)
        fill_series(c, order, one[0], one[1], one[3], one[4], 0.0, 0.0, one[2], s)
        for row in range(2):
            matrices[STICK + 5 * row + column] = _sum(c, row + 2, h)


@njit(**PART)
def _sum(c, column, t):
    y = c[ORDER, column]
    for k in range(ORDER - 1, -1, -1):
        y = y * t + c[k, column]
    return y
