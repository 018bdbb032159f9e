# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001
"""The compiled loop of `sim.contact_solver`.

One function, because what it calls through pointers makes every variable go through memory at each
call, and a further layer would do so twice. What each hook reads of the inner states is a view made
once, since making one costs more than the call.
"""

from __future__ import annotations

import math

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

__all__ = ["ANGLE", "MODE", "N_MOTION", "SAMPLE", "STICK_START", "run_contact"]

# Motion that is carried on: theta1, theta1', theta2, theta2', the shaft's lag and its rate, then
MODE = 6
"""+1 or -1 while it slides, 0 in stick."""
STICK_START = 7
"""When the last stick began [s]."""
ANGLE = 8
"""Of the drive [rad]."""
SAMPLE = 9
"""The next one."""
N_MOTION = 10

_TIME_TOLERANCE = 1e-14
"""To which the ends of stick and slip are found [s]."""

_HOOK = types.FunctionType(HOOK_SIGNATURE)
_LAW = types.FunctionType(LAW_SIGNATURE)
_VECTOR = float64[::1]
_MATRIX = float64[:, ::1]


@njit(
    types.void(
        _VECTOR, _VECTOR, _LAW, boolean, _VECTOR, _HOOK, _HOOK, _HOOK, _HOOK, int64, _MATRIX,
        int64[::1], _VECTOR, float64, int64, _VECTOR, _VECTOR, _VECTOR, _MATRIX, int64[::1],
    ),
    cache=True, error_model="numpy", nogil=True,
)  # fmt: skip
def run_contact(
    s, torques, law, has_law, coefficients, h0, h1, h2, h3, n_hooks, values, offsets,
    shaft_speed, step, substeps, motion, inner, context, out, direction_out,
) -> None:  # fmt: skip
    """Write the columns of `out` and go on to the sample after them, if there is a speed for it.

    `motion`, `inner` (the states of law and effects) and `context` are carried on.
    """
    j_e, k_e, k_b, c_e, c_b, j_e_inverse, j_c_inverse = s[0], s[2], s[3], s[4], s[5], s[6], s[7]
    t_crit, t_kin = torques[0], torques[1]
    m = inner.size
    trial_inner, inner_rates = np.zeros(m), np.zeros(m)
    inner_start = np.zeros(m)  # rates at the start of a step
    inner_sum, inner_beyond = np.zeros(m), np.zeros(m)
    o0, o1, o2, o3, o4 = offsets[0], offsets[1], offsets[2], offsets[3], offsets[4]
    values0, values1, values2, values3 = values[0], values[1], values[2], values[3]
    inner0, inner1 = trial_inner[o0:o1], trial_inner[o1:o2]
    inner2, inner3 = trial_inner[o2:o3], trial_inner[o3:o4]
    rates0, rates1 = inner_rates[o0:o1], inner_rates[o1:o2]
    rates2, rates3 = inner_rates[o2:o3], inner_rates[o3:o4]
    contact = np.zeros(N_CONTACT)
    contact[CRITICAL], contact[KINETIC] = t_crit, t_kin
    n = direction_out.size
    h = step / substeps
    last_stage = 3 if has_law else 4
    x0, x1, x2, x3, x4, x5 = motion[0], motion[1], motion[2], motion[3], motion[4], motion[5]
    mode, first = int(motion[MODE]), int(motion[SAMPLE])
    stick_start, angle = motion[STICK_START], motion[ANGLE]
    acceleration = 0.0
    started = False  # whether the rates at the start of the step are known already
    q0, q1, q2, q3, q4, q5, friction, torque, holding, critical = (
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    )  # fmt: skip
    for i in range(n):
        goes_on = i + 1 < shaft_speed.size
        previous = acceleration
        acceleration = (shaft_speed[i + 1] - shaft_speed[i]) / step if goes_on else 0.0
        if acceleration != previous:
            started = False
        done = 0.0  # since the start of this output step
        written = False
        sub = 0
        # Where the phase ends, once that is bracketed, and how far from it the brackets are.
        low, high, far_low, far_high, high_holding, side = 0.0, -1.0, 0.0, 0.0, 0.0, 0
        b0, b2, b3, b4, b5 = 0.0, 0.0, 0.0, 0.0, 0.0  # the state just beyond
        trial = h
        while sub < substeps:
            drive = shaft_speed[i] + acceleration * done
            time = (first + i) * step + done
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
                shaft = drive + acceleration * offset - w5
                surface = shaft if mode == 0 and not has_law else w1
                twist = w0 - w2
                twist_rate = surface - w3
                e = k_e * twist + c_e * twist_rate
                c, kinetic, creep, mobility, shaft_torque = t_crit, t_kin, 0.0, 0.0, 0.0
                if n_hooks > 0:
                    context[TIME] = time + offset
                    since = done + offset
                    context[SHAFT_ANGLE] = angle + since * (
                        shaft_speed[i] + 0.5 * acceleration * since
                    )
                    if mode == 0:
                        context[STICK_TIME] = time + offset - stick_start
                    context[SHAFT_SPEED], context[SLIDING_SPEED] = shaft, shaft - surface
                    context[TWIST], context[TWIST_RATE], context[TORQUE] = twist, twist_rate, e
                    context[SHAFT_LAG], context[SHAFT_LAG_RATE] = w4, w5
                    contact[CRITICAL], contact[KINETIC] = t_crit, t_kin
                    contact[STIFFNESS], contact[ELASTOMER_TORQUE] = k_e, 0.0
                    contact[CREEP], contact[SHAFT_TORQUE] = 0.0, 0.0
                    contact[SHAFT_INERTIA] = math.inf
                    h0(context, values0, inner0, rates0, contact)
                    if n_hooks > 1:
                        h1(context, values1, inner1, rates1, contact)
                    if n_hooks > 2:
                        h2(context, values2, inner2, rates2, contact)
                    if n_hooks > 3:
                        h3(context, values3, inner3, rates3, contact)
                    e += (contact[STIFFNESS] - k_e) * twist + contact[ELASTOMER_TORQUE]
                    kinetic = contact[KINETIC]
                    # What slides at a torque can be held by it, whatever an effect says.
                    c = max(contact[CRITICAL], kinetic)
                    creep = contact[CREEP]
                    if contact[SHAFT_INERTIA] != math.inf:
                        mobility = 1.0 / contact[SHAFT_INERTIA]
                        shaft_torque = contact[SHAFT_TORQUE]
                # What holds the surfaces together, on a shaft whose end yields to the same torque.
                if mobility == 0.0:
                    g = e + j_e * acceleration
                else:
                    g = (e + j_e * shaft_torque * mobility) / (1.0 + j_e * mobility)
                if has_law:
                    # Laws have the first of the inner states, effects those after.
                    f = law(shaft - surface, coefficients, contact, trial_inner, inner_rates)
                elif mode == 0:
                    f = g
                else:
                    f = mode * kinetic
                if mode == 0 and not has_law:
                    p0, p1 = shaft * (1.0 - creep), 0.0
                else:
                    p0, p1 = w1, (f - e) * j_e_inverse
                p2, p4 = w3, w5
                p3 = (e - k_b * w2 - c_b * w3) * j_c_inverse
                # The lag is that of the shaft's end behind its drive.
                p5 = 0.0 if mobility == 0.0 else acceleration - (shaft_torque - f) * mobility
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
                out[0, i], out[1, i] = friction, torque
                out[2, i], out[3, i], out[4, i], out[5, i] = x0, x1, x2, x3
                out[6, i] = drive - x5
                direction_out[i] = mode
                written = True
                if not goes_on:
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
            if high < 0.0:
                far_low = critical - abs(holding) if mode == 0 else mode * (drive - x5 - x1)
                side = 0
            # Regula falsi; the end that stays twice counts for half (the Illinois algorithm).
            if far < 0.0:
                if side > 0:
                    far_low *= 0.5
                side = 1
                high, far_high, high_holding = trial, far, g
                b0, b2, b3, b4, b5 = w0, w2, w3, w4, w5
                for j in range(m):
                    inner_beyond[j] = trial_inner[j]
            else:
                if side < 0:
                    far_high *= 0.5
                side = -1
                low, far_low = trial, far
            trial = 0.5 * (low + high)
            if far_low > 0.0:
                secant = low + (high - low) * far_low / (far_low - far_high)
                margin = 0.4 * _TIME_TOLERANCE
                trial = min(max(secant, low + margin), high - margin)
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
                stick_start = (first + i) * step + done
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
    motion[0], motion[1], motion[2], motion[3], motion[4], motion[5] = x0, x1, x2, x3, x4, x5
    motion[MODE], motion[STICK_START], motion[ANGLE] = mode, stick_start, angle
    motion[SAMPLE] = first + n
