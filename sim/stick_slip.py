"""True stick and constant torques, solved in closed form between events.

Between events the system is linear, so its motion over a step is its Taylor series, summed to
rounding. Slip and stick begin at roots of that same series, found to machine precision: no
step-size error, and no re-stick at the end of a step, which makes the thesis's listing (and any
fixed-step method) first order only.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numba import float64, int64, njit, types

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["solve_stick_slip"]

_ORDER = 16
"""Terms of the series: (omega h)^17 / 17! is below rounding up to omega h = 2."""

_PROBES = 8
"""Points of a step at which an event's function is looked at, so that two sign changes count."""


@njit(cache=True)
def _series(x, torque, shaft_acceleration, stuck, s, c):
    """Fill `c[k]` with the Taylor coefficients of the state (theta1, theta1', theta2, theta2')."""
    j_e, j_c, k_e, k_b, c_e, c_b = s
    fixed = k_b < 0.0
    for i in range(4):
        c[0, i] = x[i]
    for k in range(_ORDER):
        n = k + 1.0
        elastomer = k_e * (c[k, 0] - c[k, 2]) + c_e * (c[k, 1] - c[k, 3])
        c[k + 1, 0] = c[k, 1] / n
        if stuck:
            c[k + 1, 1] = shaft_acceleration if k == 0 else 0.0
        else:
            drive = torque if k == 0 else 0.0
            c[k + 1, 1] = (drive - elastomer) / (j_e * n)
        if fixed:
            c[k + 1, 2] = 0.0
            c[k + 1, 3] = 0.0
        else:
            c[k + 1, 2] = c[k, 3] / n
            c[k + 1, 3] = (elastomer - k_b * c[k, 2] - c_b * c[k, 3]) / (j_c * n)


@njit(cache=True)
def _value(p, t):
    y = p[_ORDER]
    for k in range(_ORDER - 1, -1, -1):
        y = y * t + p[k]
    return y


@njit(cache=True)
def _first_root(p, start, end):
    """First t in (start, end] where the series turns from above zero to zero or below; else -1."""
    left = start
    width = (end - start) / _PROBES
    for i in range(_PROBES):
        right = end if i == _PROBES - 1 else start + (i + 1) * width
        if _value(p, right) <= 0.0:
            a, b = left, right
            for _ in range(200):
                middle = 0.5 * (a + b)
                if middle <= a or middle >= b:
                    break
                if _value(p, middle) <= 0.0:
                    b = middle
                else:
                    a = middle
            return b
        left = right
    return -1.0


@njit(
    types.void(
        float64[::1],
        float64,
        float64,
        float64[::1],
        float64,
        float64[:, ::1],
        int64[::1],
        float64[::1],
        float64[::1],
    ),
    cache=True,
)
def _solve(s, t_crit, t_kin, shaft_speed, step, out, direction_out, event_times, counts):
    j_e, k_e, c_e = s[0], s[2], s[4]
    x = np.zeros(4)
    c = np.zeros((_ORDER + 1, 4))
    p = np.zeros(_ORDER + 1)
    n = shaft_speed.size
    direction = 0  # of the sliding; 0 is stick
    x[1] = shaft_speed[0]
    events = 0
    for i in range(n):
        acceleration = (shaft_speed[i + 1] - shaft_speed[i]) / step if i + 1 < n else 0.0
        elastomer = k_e * (x[0] - x[2]) + c_e * (x[1] - x[3])
        friction = elastomer + j_e * acceleration if direction == 0 else direction * t_kin
        out[i, 0] = friction
        out[i, 1] = elastomer
        out[i, 2] = x[0]
        out[i, 3] = x[1]
        out[i, 4] = x[2]
        out[i, 5] = x[3]
        direction_out[i] = direction
        if i + 1 == n:
            break
        done = 0.0
        while done < step:
            left = step - done
            speed_now = shaft_speed[i] + acceleration * done
            _series(x, direction * t_kin, acceleration, direction == 0, s, c)
            if direction == 0:
                # Both ways of breaking loose: holding torque up to +T_crit or down to -T_crit.
                t_event, sign = -1.0, 0
                for way in (1, -1):
                    for k in range(_ORDER + 1):
                        p[k] = -way * (k_e * (c[k, 0] - c[k, 2]) + c_e * (c[k, 1] - c[k, 3]))
                    p[0] += t_crit - way * j_e * acceleration
                    root = 0.0 if p[0] < 0.0 else _first_root(p, 0.0, left)
                    if root >= 0.0 and (t_event < 0.0 or root < t_event):
                        t_event, sign = root, way
            else:
                # Sliding speed, positive while it lasts; its root at the start is divided out.
                for k in range(_ORDER + 1):
                    p[k] = -direction * c[k, 1]
                p[0] += direction * speed_now
                p[1] += direction * acceleration
                if abs(p[0]) <= 1e-12 * (1.0 + abs(speed_now)):
                    for k in range(_ORDER):
                        p[k] = p[k + 1]
                    p[_ORDER] = 0.0
                t_event, sign = _first_root(p, 0.0, left), 0
            t_move = left if t_event < 0.0 else t_event
            for j in range(4):
                y = c[_ORDER, j]
                for k in range(_ORDER - 1, -1, -1):
                    y = y * t_move + c[k, j]
                x[j] = y
            done = step if t_event < 0.0 else done + t_move
            if t_event >= 0.0:
                if direction == 0:
                    direction = sign
                else:
                    x[1] = shaft_speed[i] + acceleration * done
                    holding = k_e * (x[0] - x[2]) + c_e * (x[1] - x[3]) + j_e * acceleration
                    direction = 0
                    if abs(holding) > t_crit:
                        direction = 1 if holding > 0.0 else -1
                if events < event_times.size:
                    event_times[events] = i * step + done
                events += 1
    counts[0] = events


def solve_stick_slip(
    system: NDArray[np.float64],
    critical_torque: float,
    kinetic_torque: float,
    shaft_speed: NDArray[np.float64],
    step: float,
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Solve the lumped model with Coulomb friction from rest.

    Parameters
    ----------
    system : ndarray, shape (6,)
        `LumpedBushing.packed`.
    critical_torque, kinetic_torque : float
        [Nm]
    shaft_speed : ndarray, shape (n,)
        At the output times [rad/s], linear between them; the surfaces stick at the start.
    step : float
        Time between outputs [s].

    Returns
    -------
    states : ndarray, shape (n, 6)
        Friction torque and elastomer torque [Nm], theta1 [rad], theta1' [rad/s], theta2, theta2'.
    direction : ndarray, shape (n,)
        Of the sliding: +1 or -1, 0 in stick.
    events : ndarray, shape (n_events,)
        Times at which stick or slip ended [s].

    Examples
    --------
    >>> rig = np.array([1 / 65000, 1 / 1200, 665.0, 3745.0, 0.0425, 0.0425])
    >>> states, direction, events = solve_stick_slip(rig, 10.7, 8.0, np.full(3000, 1.0), 1e-4)
    >>> len(events) // 2  # slips in 0.3 s
    43
    """
    n = shaft_speed.size
    states = np.empty((n, 6))
    direction = np.zeros(n, dtype=np.int64)
    counts = np.zeros(1)
    event_times = np.empty(max(64, n))
    # The series must converge within a step: no more than about one radian of the fastest mode.
    fastest = math.sqrt(system[2] / system[0])
    if fastest * step > 2.0:
        raise ValueError(f"step {step:g} s is too long; at most {2.0 / fastest:g} s")
    _solve(
        system,
        critical_torque,
        kinetic_torque,
        np.ascontiguousarray(shaft_speed),
        step,
        states,
        direction,
        event_times,
        counts,
    )
    return states, direction, event_times[: int(counts[0])].copy()
