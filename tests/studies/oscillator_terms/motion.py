"""The oscillator's motion, compiled: fourth-order Runge-Kutta on an oversampled drive.

The restoring force that is to be tried comes in as a compiled function of one fixed signature, so
that the stepping loop is compiled once for the whole library and for a user's own force.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit, types

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["FORCE_SIGNATURE", "move", "no_force"]

FORCE_SIGNATURE = "f8(f8, f8, f8, f8[::1])"
"""Of a force: displacement, velocity, time, coefficients; all as `move` normalises them."""

_FORCE = types.FunctionType(
    types.float64(types.float64, types.float64, types.float64, types.float64[::1])
)


@njit(FORCE_SIGNATURE, cache=True)
def no_force(x: float, v: float, t: float, p: NDArray[np.float64]) -> float:
    """Return zero: the linear oscillator."""
    return 0.0


@njit(
    types.float64[::1](
        types.float64[::1],
        types.int64,
        types.float64,
        types.float64,
        types.float64,
        types.float64,
        types.float64,
        types.float64,
        types.float64,
        _FORCE,
        types.float64[::1],
    ),
    cache=True,
)
def move(drive, steps, rate, omega, zeta, gain, speed_unit, t_first, t_step, force, p):
    """Displacement at the sampling instants, from rest in the first drive's equilibrium.

    Solves ``x'' + 2 zeta omega x' + omega^2 (x + force(x, x' / speed_unit, t, p)) =
    omega^2 gain drive``.

    Parameters
    ----------
    drive : ndarray, shape (n_samples * 2 * steps,)
        Drive at twice as many instants as there are steps.
    steps : int
        Runge-Kutta steps a sample.
    rate : float
        Sampling rate [Hz].
    omega, zeta, gain : float
        Natural frequency [rad/s], damping ratio, static displacement a drive.
    speed_unit : float
        What the velocity is divided by before the force sees it [rad/s].
    t_first, t_step : float
        The force's time at the first sample, and how much it grows a sample.
    force : compiled function
        Of `FORCE_SIGNATURE`; in units of the linear spring's force at unit displacement.
    p : ndarray, shape (n_coefficients,)
        The force's coefficients.

    Returns
    -------
    ndarray, shape (n_samples,)
        Displacement.
    """
    n = len(drive) // (2 * steps)
    x_of = np.empty(n)
    h = 1.0 / (rate * steps)
    w2 = omega * omega
    c = 2.0 * zeta * omega
    x = gain * drive[0]
    v = 0.0
    last = len(drive) - 1
    for i in range(n):
        x_of[i] = x
        for s in range(steps):
            j = 2 * (i * steps + s)
            before = gain * drive[j]
            middle = gain * drive[j + 1]
            after = gain * drive[min(j + 2, last)]
            t = t_first + t_step * (i + s / steps)
            a1 = w2 * (before - x - force(x, v / speed_unit, t, p)) - c * v
            x2 = x + 0.5 * h * v
            v2 = v + 0.5 * h * a1
            a2 = w2 * (middle - x2 - force(x2, v2 / speed_unit, t, p)) - c * v2
            x3 = x + 0.5 * h * v2
            v3 = v + 0.5 * h * a2
            a3 = w2 * (middle - x3 - force(x3, v3 / speed_unit, t, p)) - c * v3
            x4 = x + h * v3
            v4 = v + h * a3
            a4 = w2 * (after - x4 - force(x4, v4 / speed_unit, t, p)) - c * v4
            x += h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
            v += h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
    return x_of
