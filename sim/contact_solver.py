"""The lumped model with any friction law and any effects: Runge-Kutta with event location.

Classical fourth order at a small fixed step. Where the contact truly sticks, the instants at which
it breaks and catches again lie between steps: they are found by repeating the step with other
lengths, to the accuracy of the method itself, so that re-stick costs no order as it does where a
step simply ends. Laws with an inner state have no such instants.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import boolean, float64, int64, njit, types

from sim.contact import (
    CREEP,
    CRITICAL,
    ELASTOMER_TORQUE,
    HOOK_SIGNATURE,
    KINETIC,
    LAW_SIGNATURE,
    N_CONTACT,
    N_CONTEXT,
    SHAFT_ANGLE,
    SHAFT_INERTIA,
    SHAFT_LAG,
    SHAFT_LAG_RATE,
    SHAFT_SPEED,
    SHAFT_TORQUE,
    SLIDING_SPEED,
    STICK_TIME,
    STICKS,
    STIFFNESS,
    TIME,
    TORQUE,
    TWIST,
    TWIST_RATE,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["MOST_HOOKS", "Hook", "solve_contact"]

MOST_HOOKS = 4
"""Effects that can act on the contact at once."""

_TIME_TOLERANCE = 1e-14
"""To which the ends of stick and slip are found [s]."""


@dataclass(frozen=True, eq=False)
class Hook:
    """An effect's compiled function with its numbers."""

    function: Any
    values: NDArray[np.float64]
    n_states: int


@njit(HOOK_SIGNATURE, cache=True)
def _no_hook(context, values, state, state_rates, contact):
    pass


@njit(LAW_SIGNATURE, cache=True)
def _no_law(sliding_speed, coefficients, contact, state, state_rates):  # noqa: ARG001
    return 0.0


_HOOK = types.FunctionType(HOOK_SIGNATURE)
_LAW = types.FunctionType(LAW_SIGNATURE)
_VECTOR = float64[::1]
_MATRIX = float64[:, ::1]


@njit(cache=True, error_model="numpy", inline="always")
def _rates(
    mode, x0, x1, x2, x3, x4, x5, inner, inner_rates, drive, acceleration, s, torques, law,
    has_law, coefficients, h0, h1, h2, h3, n_hooks, values, offsets, context, contact,
):  # fmt: skip
    """Rates of theta1, theta1', theta2', and of the lag's rate; four torques.

    Those are: friction, elastomer, what would hold the surfaces together, and what can. The
    states are theta1, theta1', theta2, theta2', lag and its rate; those of law and effects follow
    in `inner`.
    """
    j_e, k_e, k_b, c_e, c_b = s[0], s[2], s[3], s[4], s[5]
    shaft_speed = drive - x5
    surface_speed = shaft_speed if mode == 0 and not has_law else x1
    twist = x0 - x2
    twist_rate = surface_speed - x3
    torque = k_e * twist + c_e * twist_rate
    critical, kinetic, creep, mobility, shaft_torque = torques[0], torques[1], 0.0, 0.0, 0.0
    if n_hooks > 0:
        context[SHAFT_SPEED] = shaft_speed
        context[SLIDING_SPEED] = shaft_speed - surface_speed
        context[TWIST] = twist
        context[TWIST_RATE] = twist_rate
        context[TORQUE] = torque
        context[SHAFT_LAG] = x4
        context[SHAFT_LAG_RATE] = x5
        contact[CRITICAL] = critical
        contact[KINETIC] = kinetic
        contact[STIFFNESS] = k_e
        contact[ELASTOMER_TORQUE] = 0.0
        contact[CREEP] = 0.0
        contact[SHAFT_INERTIA] = math.inf
        contact[SHAFT_TORQUE] = 0.0
        a, b = offsets[0], offsets[1]
        h0(context, values[0], inner[a:b], inner_rates[a:b], contact)
        if n_hooks > 1:
            a, b = offsets[1], offsets[2]
            h1(context, values[1], inner[a:b], inner_rates[a:b], contact)
        if n_hooks > 2:
            a, b = offsets[2], offsets[3]
            h2(context, values[2], inner[a:b], inner_rates[a:b], contact)
        if n_hooks > 3:
            a, b = offsets[3], offsets[4]
            h3(context, values[3], inner[a:b], inner_rates[a:b], contact)
        torque += (contact[STIFFNESS] - k_e) * twist + contact[ELASTOMER_TORQUE]
        # What slides at a torque can be held by it, whatever an effect says.
        critical = max(contact[CRITICAL], contact[KINETIC])
        kinetic = contact[KINETIC]
        creep = contact[CREEP]
        mobility = 1.0 / contact[SHAFT_INERTIA]  # zero on a rigid shaft
        shaft_torque = contact[SHAFT_TORQUE]
    # What holds the surfaces together, on a shaft whose end yields to the same torque.
    if mobility == 0.0:
        holding = torque + j_e * acceleration
    else:
        holding = (torque + j_e * shaft_torque * mobility) / (1.0 + j_e * mobility)
    if has_law:
        # Laws have the first of the inner states, effects those after.
        friction = law(shaft_speed - surface_speed, coefficients, contact, inner, inner_rates)
    elif mode == 0:
        friction = holding
    else:
        friction = mode * kinetic
    if mode == 0 and not has_law:
        d0, d1 = shaft_speed * (1.0 - creep), 0.0
    else:
        d0, d1 = x1, (friction - torque) * s[6]
    d3 = (torque - k_b * x2 - c_b * x3) * s[7]
    # The lag is that of the shaft's end behind its drive.
    d5 = 0.0 if mobility == 0.0 else acceleration - (shaft_torque - friction) * mobility
    return d0, d1, d3, d5, friction, torque, holding, critical


@njit(
    types.void(
        _VECTOR, _VECTOR, _LAW, boolean, _VECTOR, _VECTOR, _HOOK, _HOOK, _HOOK, _HOOK, int64,
        _MATRIX, int64[::1], _VECTOR, float64, int64, _MATRIX, int64[::1],
    ),
    cache=True,
    error_model="numpy",
)  # fmt: skip
def _solve(
    s, torques, law, has_law, coefficients, inner, h0, h1, h2, h3, n_hooks, values, offsets,
    shaft_speed, step, substeps, out, direction_out,
):  # fmt: skip
    m = inner.size
    trial_inner = np.zeros(m)
    inner_rates = np.zeros(m)
    inner_start = np.zeros(m)  # rates at the start of a step
    inner_sum = np.zeros(m)
    inner_beyond = np.zeros(m)
    context = np.zeros(N_CONTEXT)
    contact = np.zeros(N_CONTACT)
    contact[CRITICAL] = torques[0]
    contact[KINETIC] = torques[1]
    n = shaft_speed.size
    h = step / substeps
    last_stage = 3 if has_law else 4
    x0, x1, x2, x3, x4, x5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if not has_law:
        x1 = shaft_speed[0]
    mode = 0
    stick_start = 0.0
    angle = 0.0
    acceleration = 0.0
    started = False  # whether the rates at the start of the step are known already
    q0, q1, q2, q3, q4, q5, friction, torque, holding, critical = (
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    )  # fmt: skip
    for i in range(n):
        previous = acceleration
        acceleration = (shaft_speed[i + 1] - shaft_speed[i]) / step if i + 1 < n else 0.0
        if acceleration != previous:
            started = False
        done = 0.0  # since the start of this output step
        written = False
        sub = 0
        low, high, high_holding = 0.0, -1.0, 0.0  # where the phase ends, once that is bracketed
        b0, b2, b3, b4, b5 = 0.0, 0.0, 0.0, 0.0, 0.0  # the state just beyond
        trial = h
        while sub < substeps:
            drive = shaft_speed[i] + acceleration * done
            time = i * step + done
            if started:
                for j in range(m):
                    inner_rates[j] = inner_start[j]
                    inner_sum[j] = inner_start[j]
            p0, p1, p2, p3, p4, p5 = q0, q1, q2, q3, q4, q5
            t0, t1, t2, t3, t4, t5 = q0, q1, q2, q3, q4, q5
            w0, w1, w2, w3, w4, w5 = x0, x1, x2, x3, x4, x5
            f, e, g, c = friction, torque, holding, critical
            for stage in range(1 if started else 0, last_stage + 1):
                offset = 0.0
                if stage == 0:
                    for j in range(m):
                        trial_inner[j] = inner[j]
                elif stage < 4:
                    offset = trial if stage == 3 else 0.5 * trial
                    w0, w1, w2 = x0 + offset * p0, x1 + offset * p1, x2 + offset * p2
                    w3, w4, w5 = x3 + offset * p3, x4 + offset * p4, x5 + offset * p5
                    for j in range(m):
                        trial_inner[j] = inner[j] + offset * inner_rates[j]
                else:
                    offset = trial
                    third = trial / 6.0
                    w0, w1, w2 = x0 + third * t0, x1 + third * t1, x2 + third * t2
                    w3, w4, w5 = x3 + third * t3, x4 + third * t4, x5 + third * t5
                    for j in range(m):
                        trial_inner[j] = inner[j] + third * inner_sum[j]
                if n_hooks > 0:
                    context[TIME] = time + offset
                    since = done + offset
                    context[SHAFT_ANGLE] = angle + since * (
                        shaft_speed[i] + 0.5 * acceleration * since
                    )
                    if mode == 0:
                        context[STICK_TIME] = time + offset - stick_start
                p0, p1, p3, p5, f, e, g, c = _rates(
                    mode, w0, w1, w2, w3, w4, w5, trial_inner, inner_rates,
                    drive + acceleration * offset, acceleration, s, torques, law, has_law,
                    coefficients, h0, h1, h2, h3, n_hooks, values, offsets, context, contact,
                )  # fmt: skip
                p2, p4 = w3, w5
                if stage == 0:
                    q0, q1, q2, q3, q4, q5 = p0, p1, p2, p3, p4, p5
                    t0, t1, t2, t3, t4, t5 = p0, p1, p2, p3, p4, p5
                    friction, torque, holding, critical = f, e, g, c
                    for j in range(m):
                        inner_start[j] = inner_rates[j]
                        inner_sum[j] = inner_rates[j]
                elif stage < 4:
                    weight = 1.0 if stage == 3 else 2.0
                    t0, t1, t2 = t0 + weight * p0, t1 + weight * p1, t2 + weight * p2
                    t3, t4, t5 = t3 + weight * p3, t4 + weight * p4, t5 + weight * p5
                    for j in range(m):
                        inner_sum[j] += weight * inner_rates[j]
            started = True
            if not written:
                out[i, 0], out[i, 1] = friction, torque
                out[i, 2], out[i, 3], out[i, 4], out[i, 5] = x0, x1, x2, x3
                out[i, 6] = drive - x5
                direction_out[i] = mode
                written = True
                if i + 1 == n:
                    break
            if has_law:
                third = trial / 6.0
                x0, x1, x2 = x0 + third * t0, x1 + third * t1, x2 + third * t2
                x3, x4, x5 = x3 + third * t3, x4 + third * t4, x5 + third * t5
                for j in range(m):
                    inner[j] += third * inner_sum[j]
                sub += 1
                done = sub * h
                started = False
                continue
            if mode == 0 and critical < abs(holding):
                # It cannot hold from the start: it slides on, or back.
                mode = 1 if holding > 0.0 else -1
                started = False
                continue
            if mode == 0:
                w1 = p0
                far = c - abs(g)
            else:
                far = mode * (drive + acceleration * trial - w5 - w1)
            if high < 0.0 and far >= 0.0:  # the phase outlasts the step, whose end starts the next
                x0, x1, x2, x3, x4, x5 = w0, w1, w2, w3, w4, w5
                q0, q1, q2, q3, q4, q5 = p0, p1, p2, p3, p4, p5
                friction, torque, holding, critical = f, e, g, c
                for j in range(m):
                    inner[j] = trial_inner[j]
                    inner_start[j] = inner_rates[j]
                sub += 1
                done = sub * h
                trial = h
                continue
            if far < 0.0:
                high = trial
                high_holding = g
                b0, b2, b3, b4, b5 = w0, w2, w3, w4, w5
                for j in range(m):
                    inner_beyond[j] = trial_inner[j]
            else:
                low = trial
            trial = 0.5 * (low + high)
            if high - low > _TIME_TOLERANCE and low < trial < high:
                continue
            done += high
            x0, x2, x3, x4, x5 = b0, b2, b3, b4, b5
            x1 = shaft_speed[i] + acceleration * done - x5
            for j in range(m):
                inner[j] = inner_beyond[j]
            if mode == 0:
                mode = 1 if high_holding > 0.0 else -1
            else:
                stick_start = i * step + done
                context[STICKS] += 1.0
                mode = 0
            low, high = 0.0, -1.0
            started = False
            trial = (sub + 1) * h - done
            if trial <= _TIME_TOLERANCE:
                sub += 1
                done = sub * h
                trial = h
        angle += step * (shaft_speed[i] + 0.5 * acceleration * step)


def solve_contact(
    system: NDArray[np.float64],
    critical_torque: float,
    kinetic_torque: float,
    shaft_speed: NDArray[np.float64],
    step: float,
    substeps: int,
    *,
    law: Any = None,
    coefficients: NDArray[np.float64] | None = None,
    law_state: NDArray[np.float64] | None = None,
    hooks: tuple[Hook, ...] = (),
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Solve the lumped model from rest.

    Parameters
    ----------
    system : ndarray, shape (6,)
        `LumpedBushing.packed`.
    critical_torque, kinetic_torque : float
        [Nm]
    shaft_speed : ndarray, shape (n,)
        Of the drive at the output times [rad/s], linear between them.
    step : float
        Time between outputs [s].
    substeps : int
        Steps of the integration in each.
    law : compiled function, optional
        Friction law by `sim.contact.LAW_SIGNATURE`; without one the contact truly sticks.
    coefficients, law_state : ndarray, optional
        Of the law; its state at the start.
    hooks : tuple of Hook
        Effects that act on the contact, in this order; at most `MOST_HOOKS`.

    Returns
    -------
    states : ndarray, shape (n, 7)
        Friction torque and elastomer torque [Nm], theta1 [rad], theta1' [rad/s], theta2, theta2',
        speed of the shaft at the bushing [rad/s].
    direction : ndarray, shape (n,)
        Of the sliding: +1 or -1, 0 in stick; 0 throughout with a law.
    """
    if len(hooks) > MOST_HOOKS:
        raise ValueError(f"{len(hooks)} effects act on the contact; at most {MOST_HOOKS} can")
    no_state = np.zeros(0)
    law_state = no_state if law_state is None else law_state
    offsets = np.zeros(MOST_HOOKS + 1, dtype=np.int64)
    offsets[0] = law_state.size
    for i in range(MOST_HOOKS):
        offsets[i + 1] = offsets[i] + (hooks[i].n_states if i < len(hooks) else 0)
    inner = np.zeros(int(offsets[-1]))
    inner[: law_state.size] = law_state
    widest = max((hook.values.size for hook in hooks), default=1)
    values = np.zeros((MOST_HOOKS, widest))
    for row, hook in zip(values, hooks, strict=False):
        row[: hook.values.size] = hook.values
    functions = [hook.function for hook in hooks] + [_no_hook] * (MOST_HOOKS - len(hooks))
    states = np.empty((shaft_speed.size, 7))
    direction = np.zeros(shaft_speed.size, dtype=np.int64)
    j_e, j_c, _, k_b, _, _ = system
    mobilities = [1.0 / j_e, 0.0 if k_b < 0.0 else 1.0 / j_c]  # a fixed clamp does not move
    compiled: Any = _solve
    compiled(
        np.append(system, mobilities), np.array([critical_torque, kinetic_torque]),
        law or _no_law, law is not None, np.zeros(1) if coefficients is None else coefficients, inner, *functions, len(hooks),
        values, offsets, np.ascontiguousarray(shaft_speed), step, substeps, states, direction,
    )  # fmt: skip
    return states, direction
