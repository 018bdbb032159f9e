"""Friction laws with an inner state: classical Runge-Kutta at a small fixed step.

Such a contact has no events to find; its fastest time is that of the elastomer's inertia on the
contact's stiffness (some 5-10 kHz), which a step of a few microseconds follows with an error far
below what the law's own parameters are known to.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import float64, int64, njit, types

from sim.friction.law import FUNCTION_TYPE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sim.friction.law import FrictionLaw

__all__ = ["solve_smooth_contact"]


@njit(
    types.void(
        FUNCTION_TYPE,
        float64[::1],
        float64[::1],
        float64[::1],
        float64[::1],
        float64,
        int64,
        float64[:, ::1],
    ),
    cache=True,
    error_model="numpy",
)
def _solve(law, s, coefficients, contact, shaft_speed, step, substeps, out):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    j_e, j_c, k_e, k_b, c_e, c_b = s
    fixed = k_b < 0.0
    m = contact.size
    size = 4 + m
    x = np.zeros(size)
    x[4:] = contact
    trial = np.empty(size)
    rates = np.zeros((4, size))
    state = np.empty(m)
    state_rates = np.empty(m)
    h = step / substeps
    n = shaft_speed.size
    for i in range(n):
        slope = (shaft_speed[i + 1] - shaft_speed[i]) / step if i + 1 < n else 0.0
        for sub in range(substeps):
            for stage in range(4):
                if stage == 0:
                    offset = 0.0
                    for j in range(size):
                        trial[j] = x[j]
                else:
                    offset = h if stage == 3 else 0.5 * h
                    for j in range(size):
                        trial[j] = x[j] + offset * rates[stage - 1, j]
                for j in range(m):
                    state[j] = trial[4 + j]
                speed = shaft_speed[i] + slope * (sub * h + offset)
                torque = law(speed - trial[1], state, coefficients, state_rates)
                elastomer = k_e * (trial[0] - trial[2]) + c_e * (trial[1] - trial[3])
                rates[stage, 0] = trial[1]
                rates[stage, 1] = (torque - elastomer) / j_e
                if not fixed:
                    rates[stage, 2] = trial[3]
                    rates[stage, 3] = (elastomer - k_b * trial[2] - c_b * trial[3]) / j_c
                for j in range(m):
                    rates[stage, 4 + j] = state_rates[j]
                if stage == 0 and sub == 0:
                    out[i, 0] = torque
                    out[i, 1] = elastomer
                    for j in range(4):
                        out[i, 2 + j] = x[j]
            if i + 1 == n:
                break
            for j in range(size):
                x[j] += h / 6.0 * (rates[0, j] + 2.0 * (rates[1, j] + rates[2, j]) + rates[3, j])


def solve_smooth_contact(
    law: FrictionLaw,
    coefficients: NDArray[np.float64],
    system: NDArray[np.float64],
    shaft_speed: NDArray[np.float64],
    step: float,
    substeps: int,
) -> NDArray[np.float64]:
    """Solve the lumped model with a friction law that has `rates`, from rest.

    Parameters
    ----------
    law : FrictionLaw
    coefficients : ndarray
        Of the law.
    system : ndarray, shape (6,)
        `LumpedBushing.packed`.
    shaft_speed : ndarray, shape (n,)
        At the output times [rad/s], linear between them.
    step : float
        Time between outputs [s].
    substeps : int
        Steps of the integration in each.

    Returns
    -------
    ndarray, shape (n, 6)
        Friction torque and elastomer torque [Nm], theta1 [rad], theta1' [rad/s], theta2, theta2'.
    """
    assert law.initial_state is not None
    out = np.empty((shaft_speed.size, 6))
    _solve(
        law.rates,
        system,
        coefficients,
        law.initial_state(coefficients),
        np.ascontiguousarray(shaft_speed),
        step,
        substeps,
        out,
    )
    return out
