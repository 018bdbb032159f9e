# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
"""Exact solver of the lumped model with true stick and constant torques.

Between events the system is linear, so a step is one product with a matrix; signs at its ends show
whether stick or slip ends within the step. If so, the Taylor series of the motion gives the instant
to machine precision: there is no step-size error, and no re-stick at the end of a step, which makes
the thesis's listing (and any fixed-step method) first order only.

Grazing, where the torque reaches T_crit or the sliding speed reaches zero and turns back within a
step, is detected by the slopes at both ends and in the middle. A missed graze would have to turn
twice within half a step, so it passes the limit by less than (omega h / 2)^3 / 12 of the amplitude
of the fastest mode (omega h is at most 0.7, and 0.2 on the thesis's rig at 30 kHz: 0.01 %).

Matrix and series come from the same recurrence, so they agree to rounding. A step is divided until
the series converges fast and no quantity turns twice within a part.
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
"""Longest part of a step, times the fastest rate."""

_MOST_PARTS = 100_000

SLIP, STICK = 0, 20
"""Start of the matrices in one array: slip (4 x 5: state, torque), stick (2 x 5: theta1, speed,
rate of the speed, theta2, theta2')."""

_INVERSE = 1.0 / np.arange(1.0, ORDER + 2.0)


def parts_of_a_step(system: NDArray[np.float64], step: float) -> int:
    """Return the number of parts of a step.

    The fastest rate of M x'' + C x' + K x = 0 is at most tr(C/M) + sqrt(tr(K/M)).

    Parameters
    ----------
    system : ndarray, shape (6,)
        System as of `sim.bushing.LumpedBushing.packed`.
    step : float
        [s]

    Raises
    ------
    ParameterError
        If there are more than 100,000 parts, or the system is not finite.

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
    """Append the inertias' reciprocals (0 for a fixed clamp) and that of the longest part.

    Parameters
    ----------
    system : ndarray, shape (6,)
        System as of `sim.bushing.LumpedBushing.packed`.

    Returns
    -------
    ndarray, shape (9,)
        The system, two reciprocals of inertia [1/(kg m2)] and one of time [1/s].

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
    """Fill the matrices of a step of length `h` from the series of unit states, built in `one`."""
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


_MOST_EVENTS = 100
"""Most events in one part of a step; equal torques can chatter by rounding."""

_SAME_TORQUE = 1e-13
"""Share of T_crit below which T_crit - T_kin is rounding."""

# State between blocks: theta1, theta1', theta2, theta2', then
DIRECTION = 4
"""Direction of sliding: +1 or -1, 0 in stick."""
SAMPLE = 5
"""Index of the next sample."""
N_STATE = 6


def rest_state(shaft_speed: float) -> NDArray[np.float64]:
    """Return the state at rest with sticking surfaces, shape (N_STATE,), at a shaft speed [rad/s].

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
    """Solve the next `n` samples of a run and update its state.

    Parameters
    ----------
    system : ndarray, shape (6,)
        System as of `LumpedBushing.packed`.
    critical_torque, kinetic_torque : float
        [Nm]
    step : float
        Time between samples [s].
    shaft_speed : ndarray, shape (n,) or (n + 1,)
        At the samples [rad/s], and at the start of the next block; without the latter the run ends
        here.
    state : ndarray, shape (N_STATE,)
        State as of `rest_state`, or from the previous block; changed in place.
    n : int
        Samples to solve.

    Returns
    -------
    states : ndarray, shape (n, 6)
        Friction torque and elastomer torque [Nm], theta1 [rad], theta1' [rad/s], theta2, theta2'.
    direction : ndarray, shape (n,)
        Direction of sliding: +1 or -1, 0 in stick [-].
    events : ndarray, shape (n_events,)
        Times at which stick or slip ended, since the start of the run [s].

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


@njit(**PART)
def _through_events(
    x, length, speed, acceleration, time, s, t_crit, t_kin, c, p, event_times, events
) -> int:
    """Advance the state `x` by a part of a step that has events; return their number."""
    elapsed = 0.0
    fresh = False  # whether a slip has just begun, at a sliding speed of zero
    for _ in range(_MOST_EVENTS):
        left = length - elapsed
        if left <= 0.0:
            return events
        now = speed + acceleration * elapsed
        way = x[DIRECTION]
        inertia = s[0] * acceleration
        # The series loses less than 1e-17 at this order.
        order = min(ORDER, 9 + int(np.ceil(8.0 * (left * s[8]))))
        fill_series(c, order, x[0], x[1], x[2], x[3], way, way * t_kin, acceleration, s)
        t_event, next_way = -1.0, 0.0
        if way == 0.0:
            # Two ways to break loose: holding torque up to +T_crit or down to -T_crit.
            for sign in (1.0, -1.0):
                for k in range(1, order + 1):
                    p[k] = -sign * c[k, 4]
                p[0] = t_crit - sign * (c[0, 4] + inertia)
                root = 0.0 if p[0] < 0.0 else first_crossing(p, order, left)
                if root >= 0.0 and (t_event < 0.0 or root < t_event):
                    t_event, next_way = root, sign
        else:
            # Sliding speed, positive during the slip; roots at its start are divided out.
            for k in range(order + 1):
                p[k] = -way * c[k, 1]
            p[0] += way * now
            p[1] += way * acceleration
            shifts = 0
            if fresh or (p[0] <= 0.0 < p[1]):
                shifts = 2 if p[1] <= _SAME_TORQUE * t_crit * s[6] else 1
                for k in range(order + 1 - shifts):
                    p[k] = p[k + shifts]
            t_event = 0.0 if p[0] < 0.0 else first_crossing(p, order - shifts, left)
        t = left if t_event < 0.0 else t_event
        x0, x1, x2, x3 = c[order, 0], c[order, 1], c[order, 2], c[order, 3]
        for k in range(order - 1, -1, -1):
            x0, x1, x2, x3 = x0 * t + c[k, 0], x1 * t + c[k, 1], x2 * t + c[k, 2], x3 * t + c[k, 3]
        x[0], x[1], x[2], x[3] = x0, x1, x2, x3
        if t_event < 0.0:
            return events
        elapsed += t
        x[1] = speed + acceleration * elapsed
        if way != 0.0:
            holding = s[2] * (x0 - x2) + s[4] * (x[1] - x3) + inertia
            if abs(holding) > t_crit:
                next_way = 1.0 if holding > 0.0 else -1.0
        x[DIRECTION] = next_way
        fresh = next_way != 0.0
        if events < event_times.size:
            event_times[events] = time + elapsed
        events += 1
    # Chatter: finish the part without further events.
    t = length - elapsed
    order, way = c.shape[0] - 1, x[DIRECTION]
    fill_series(c, order, x[0], x[1], x[2], x[3], way, way * t_kin, acceleration, s)
    for j in range(4):
        y = c[order, j]
        for k in range(order - 1, -1, -1):
            y = y * t + c[k, j]
        x[j] = y
    return events


@njit(**PART)
def _row(m, i, x0, x1, x2, x3, x4) -> float:
    """Return a row of a matrix times a state."""
    return m[i] * x0 + m[i + 1] * x1 + m[i + 2] * x2 + m[i + 3] * x3 + m[i + 4] * x4


@njit(cache=True, error_model="numpy", nogil=True)
def step_through(
    s, t_crit, t_kin, shaft_speed, step, parts, x, out, direction_out, event_times
) -> int:
    """Fill the columns of `out` and advance to the sample after them, if its speed is there.

    `s` is the system from `extended`.
    """
    j_e, k_e, k_b, c_e, c_b, j_e_inverse, j_c_inverse = s[0], s[2], s[3], s[4], s[5], s[6], s[7]
    h = step / parts
    c = np.empty((ORDER + 1, 5))
    p = np.empty(ORDER + 1)
    m = np.empty(STICK + 10)
    fill_matrices(m, c, p, h, s)
    x0, x1, x2, x3, way = x[0], x[1], x[2], x[3], x[DIRECTION]
    elastomer = k_e * (x0 - x2) + c_e * (x1 - x3)
    n = direction_out.size
    events = n - n  # a literal 0 would be a second type to compile for
    for i in range(n):
        speed = shaft_speed[i]
        goes_on = i + 1 < shaft_speed.size
        acceleration = (shaft_speed[i + 1] - speed) / step if goes_on else 0.0
        inertia = j_e * acceleration
        out[0, i] = elastomer + inertia if way == 0.0 else way * t_kin
        out[1, i], out[2, i], out[3, i], out[4, i], out[5, i] = elastomer, x0, x1, x2, x3
        direction_out[i] = int(way)
        if not goes_on:
            break
        for part in range(parts):
            before = speed + acceleration * (part * h)
            after = shaft_speed[i + 1] if part + 1 == parts else before + acceleration * h
            if way == 0.0:
                y0 = x0 + 0.5 * h * (before + after)
                y1 = after
                y2 = _row(m, STICK + 0, x0, before, acceleration, x2, x3)
                y3 = _row(m, STICK + 5, x0, before, acceleration, x2, x3)
                torque = k_e * (y0 - y2) + c_e * (y1 - y3)
                slope = k_e * (before - x3) + c_e * (
                    acceleration - (elastomer - k_b * x2 - c_b * x3) * j_c_inverse
                )
                end_slope = k_e * (after - y3) + c_e * (
                    acceleration - (torque - k_b * y2 - c_b * y3) * j_c_inverse
                )
                turns = turns_within(elastomer, torque, slope, end_slope, h)
                least = t_crit - max(abs(elastomer + inertia), abs(torque + inertia))
            else:
                drive = way * t_kin
                y0 = _row(m, SLIP + 0, x0, x1, x2, x3, drive)
                y1 = _row(m, SLIP + 5, x0, x1, x2, x3, drive)
                y2 = _row(m, SLIP + 10, x0, x1, x2, x3, drive)
                y3 = _row(m, SLIP + 15, x0, x1, x2, x3, drive)
                torque = k_e * (y0 - y2) + c_e * (y1 - y3)
                start_sliding, sliding = way * (before - x1), way * (after - y1)
                slope = (way * (elastomer + inertia) - t_kin) * j_e_inverse
                end_slope = (way * (torque + inertia) - t_kin) * j_e_inverse
                turns = turns_within(start_sliding, sliding, slope, end_slope, h)
                least = min(start_sliding, sliding)
                if sliding > 0.0 and slope >= 0.0 and not turns:
                    least = sliding  # the slip has just begun at zero
            if least <= 0.0 or (turns and least < h * max(abs(slope), abs(end_slope))):
                x[0], x[1], x[2], x[3] = x0, x1, x2, x3
                events = _through_events(
                    x, h, before, acceleration, (x[SAMPLE] + i) * step + part * h, s,
                    t_crit, t_kin, c, p, event_times, events,
                )  # fmt: skip
                y0, y1, y2, y3, way = x[0], x[1], x[2], x[3], x[DIRECTION]
                if way == 0.0:
                    y1 = after
                torque = k_e * (y0 - y2) + c_e * (y1 - y3)
            x0, x1, x2, x3, elastomer = y0, y1, y2, y3, torque
    x[0], x[1], x[2], x[3] = x0, x1, x2, x3
    x[SAMPLE] += n
    return events


_ROUNDING = 4.0e-16
"""Share of the interval below which bisection no longer moves."""


@njit(**PART)
def turns_within(start, end, slope, end_slope, length) -> bool:
    """Return whether a cubic turns, by its slopes at both ends and in the middle."""
    middle = 1.5 * (end - start) / length - 0.25 * (slope + end_slope)
    return (slope < 0.0) != (end_slope < 0.0) or (slope < 0.0) != (middle < 0.0)


@njit(**PART)
def first_crossing(p, order, end) -> float:
    """Return the first t in (0, end] where sum(p[k] t^k) falls to zero or below; -1 if none."""
    value, slope = _value_and_slope(p, order, end)
    if turns_within(p[0], value, p[1], slope, end):
        middle_value, middle_slope = _value_and_slope(p, order, 0.5 * end)
        t = _crossing(p, order, 0.0, 0.5 * end, p[0], middle_value, p[1], middle_slope)
        if t >= 0.0:
            return t
        return _crossing(p, order, 0.5 * end, end, middle_value, value, middle_slope, slope)
    return _crossing(p, order, 0.0, end, p[0], value, p[1], slope)


@njit(**PART)
def _crossing(p, order, start, end, start_value, end_value, start_slope, end_slope):
    if end_value <= 0.0:
        return _root(p, order, start, end, start_value, end_value)
    if start_slope >= 0.0 or end_slope <= 0.0:
        return -1.0
    low, high = start, end  # bracket of a minimum
    while high - low > _ROUNDING * end:
        middle = 0.5 * (low + high)
        value, slope = _value_and_slope(p, order, middle)
        if value <= 0.0:
            return _root(p, order, start, middle, start_value, value)
        if slope < 0.0:
            low = middle
        else:
            high = middle
    return -1.0


@njit(**PART)
def _value_and_slope(p, order, t):
    value, slope = p[order], 0.0
    for k in range(order - 1, -1, -1):
        slope = slope * t + value
        value = value * t + p[k]
    return value, slope


@njit(**PART)
def _root(p, order, start, end, start_value, end_value):
    low, high = start, end
    t = start
    if start_value > 0.0:
        t += (end - start) * start_value / (start_value - end_value)
    for _ in range(100):
        value, slope = _value_and_slope(p, order, t)
        if value > 0.0:
            low = t
        else:
            high = t
        new = t - value / slope
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - t) <= _ROUNDING * end:
            return new
        t = new
    return t
