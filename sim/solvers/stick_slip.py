"""True stick and constant torques, solved in closed form between events.

Between events the system is linear, so a step is one product with the matrix of that step; signs
at its ends tell whether stick or slip ends within. If so, the motion's Taylor series gives the
instant to machine precision: no step-size error, and no re-stick at the end of a step, which makes
the thesis's listing (and any fixed-step method) first order only.
"""

import numpy as np
from numpy.typing import NDArray

from sim.solvers.free_motion import extended, parts_of_a_step
from sim.solvers.stick_slip_kernel import N_STATE, step_through


def rest_state(shaft_speed: float) -> NDArray[np.float64]:
    """State for `advance_stick_slip` to start from: at rest, the surfaces sticking.

    Of shape (N_STATE,), for a shaft that starts at a speed [rad/s].

    Examples
    --------
    >>> rest_state(2.5)[:4]
    array([0. , 2.5, 0. , 0. ])
    """
    state = np.zeros(N_STATE)
    state[1] = shaft_speed
    return state


def advance_stick_slip(
    system: NDArray[np.float64],
    critical_torque: float,
    kinetic_torque: float,
    shaft_speed: NDArray[np.float64],
    step: float,
    state: NDArray[np.float64],
    n: int,
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Solve the next `n` samples of a long run and carry its state on.

    Parameters
    ----------
    system : ndarray, shape (6,)
        As of `LumpedBushing.packed`.
    critical_torque, kinetic_torque : float
        [Nm]
    step : float
        Time between samples [s].
    shaft_speed : ndarray, shape (n,) or (n + 1,)
        At the samples [rad/s]; the one after them is where the next block starts. Without it the
        run ends here.
    state : ndarray, shape (N_STATE,)
        As of `rest_state`, or from the block before; changed in place.
    n : int
        Samples to solve.

    Returns
    -------
    states : ndarray, shape (n, 6)
        Friction torque and elastomer torque [Nm], theta1 [rad], theta1' [rad/s], theta2, theta2'.
    direction : ndarray, shape (n,)
        Of the sliding: +1 or -1, 0 in stick [-].
    events : ndarray, shape (n_events,)
        Times at which stick or slip ended [s], of the whole run.

    Raises
    ------
    ParameterError
        If the step is too long for the system.

    Examples
    --------
    >>> rig = np.array([1 / 65000, 1 / 1200, 665.0, 3745.0, 0.0425, 0.0425])
    >>> state, speed = rest_state(1.0), np.full(3001, 1.0)
    >>> blocks = [advance_stick_slip(rig, 10.7, 8.0, speed, 1e-4, state, 3000) for _ in range(2)]
    >>> len(blocks[1][2]) // 2  # slips from 0.3 to 0.6 s
    44
    """
    parts = parts_of_a_step(system, step)
    states = np.empty((6, n))
    direction = np.empty(n, dtype=np.int64)
    event_times = np.empty(2 * n * parts + 64)
    count = step_through(
        extended(system), float(critical_torque), float(kinetic_torque),
        np.ascontiguousarray(shaft_speed, dtype=np.float64), step, parts, state, states,
        direction, event_times,
    )  # fmt: skip
    return states.T, direction, event_times[:count].copy()
