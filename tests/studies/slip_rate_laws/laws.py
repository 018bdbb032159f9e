"""Five laws of a contact on a ring and a clamp, compiled: equations in `slip_rate_laws.md`.

States are theta, theta', theta_c, theta_c', then those of the law. A fixed clamp has 1 / J_C = 0.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

__all__ = ["LAWS", "simulate"]

LAWS = ("shipped", "brush", "front", "normal", "stiffness")
SHIPPED, BRUSH, FRONT, NORMAL, STIFFNESS = range(5)

ELEMENTS = 5
SKIN_SHARE, SKIN_DAMPING = 0.3, 8e-6
"""Of the front: what its patches hold of J_E [-]; damping of its springs over stiffness [s]."""
RELAXATION = 3e-4, 6e-5
"""Of the stiffness's two branches [s]."""
LEAST_PRESSURE = 0.05

(K_E, K_B, C_E, C_B, INVERSE_J_E, INVERSE_J_C) = range(6)
(STIFF, DAMPING, KINETIC, DROP, RENEWAL, AGEING, WEAKENING, WEAKENING_SPEED) = range(6, 14)

_RATE, _STEPS = 30e3, 3


@njit(cache=True, error_model="numpy")
def _weakened(speed, c):
    return c[KINETIC] + c[WEAKENING] * math.exp(-((speed / c[WEAKENING_SPEED]) ** 2))


@njit(cache=True, error_model="numpy")
def _shipped(v, z, age, c):
    """Torque [Nm] and the rates of shear and age."""
    speed = abs(v)
    g = _weakened(speed, c) + c[DROP] * age / (age + c[AGEING])
    shearing = v - c[STIFF] * speed * z / g
    return c[STIFF] * z + c[DAMPING] * shearing, shearing, 1.0 - speed * age / c[RENEWAL]


@njit(cache=True, error_model="numpy")
def _brush(v, u, r, c, x):
    spread, rise, rise_speed, softness, own_age, relaxing, relaxation_time = x
    speed = abs(v)
    least = _weakened(speed, c)
    drop = c[DROP] * (1.0 + rise * speed / (speed + rise_speed))
    mean = 0.0
    for i in range(ELEMENTS):
        mean += math.exp(spread * _place(i)) / ELEMENTS
    torque = 0.0
    for i in range(ELEMENTS):
        z, age, arm = u[4 + i], u[4 + ELEMENTS + i], u[4 + 2 * ELEMENTS + i]
        stiffness = c[STIFF] * math.exp(spread * _place(i)) / mean
        force = stiffness * z + arm
        load = force / (least + drop * age / (age + c[AGEING]))
        slip = speed * load * (1.0 - softness + softness * abs(load))
        r[4 + i] = v - slip
        renewing = (1.0 - own_age) * speed + own_age * abs(slip)
        r[4 + ELEMENTS + i] = 1.0 - age * renewing / c[RENEWAL]
        r[4 + 2 * ELEMENTS + i] = relaxing * stiffness * r[4 + i] - arm / relaxation_time
        torque += (force + c[DAMPING] * r[4 + i]) / ELEMENTS
    return torque


@njit(cache=True, error_model="numpy")
def _place(i):
    return 2.0 * i / (ELEMENTS - 1) - 1.0


@njit(cache=True, error_model="numpy")
def _front(omega, u, r, c, x):
    slope, skin, coupling = x[0], x[1] * c[K_E], x[2] * x[1] * c[K_E]
    q, p, z, age = 4, 4 + ELEMENTS, 4 + 2 * ELEMENTS, 4 + 3 * ELEMENTS
    torque = 0.0
    for i in range(ELEMENTS):
        own, r[z + i], r[age + i] = _shipped(omega - u[p + i], u[z + i], u[age + i], c)
        held = skin * (u[q + i] - u[0] + SKIN_DAMPING * (u[p + i] - u[1]))
        force = (1.0 + slope * _place(i)) * own - held
        for j in (i - 1, i + 1):
            if 0 <= j < ELEMENTS:
                between = u[q + j] - u[q + i] + SKIN_DAMPING * (u[p + j] - u[p + i])
                force += coupling * between
        r[q + i] = u[p + i]
        r[p + i] = force * c[INVERSE_J_E] / SKIN_SHARE
        torque += held / ELEMENTS
    return torque


@njit(cache=True, error_model="numpy")
def _rates(law, omega, u, r, c, x):
    """Write the rates of the states and return the torque in the elastomer [Nm]."""
    v = omega - u[1]
    stiffness, inverse, extra = c[K_E], c[INVERSE_J_E], 0.0
    if law == BRUSH:
        torque = _brush(v, u, r, c, x)
    elif law == FRONT:
        torque = _front(omega, u, r, c, x)
        stiffness /= 1.0 - 1.0 / x[1]
        inverse /= 1.0 - SKIN_SHARE
    else:
        torque, r[4], r[5] = _shipped(v, u[4], u[5], c)
    if law == NORMAL:
        coupling, own, ratio = x
        torque *= max(1.0 + u[6], LEAST_PRESSURE)
        r[6] = u[7]
        forced = coupling * (torque / c[KINETIC] - 1.0)
        r[7] = own * own * (forced - u[6]) - 2.0 * ratio * own * u[7]
    elif law == STIFFNESS:
        for i in range(2):
            r[6 + i] = (u[0] - u[2] - u[6 + i]) / RELAXATION[i]
            extra += c[K_E] * x[i] * (u[0] - u[2] - u[6 + i])
    elastic = stiffness * (u[0] - u[2]) + c[C_E] * (u[1] - u[3]) + extra
    r[0], r[1] = u[1], (torque - elastic) * inverse
    r[2], r[3] = u[3], (elastic - c[K_B] * u[2] - c[C_B] * u[3]) * c[INVERSE_J_C]
    return elastic


@njit(cache=True, error_model="numpy")
def _integrate(law, omega, u, c, x, samples, steps, step):
    torques = np.empty(samples)
    r1, r2, r3, r4 = np.empty_like(u), np.empty_like(u), np.empty_like(u), np.empty_like(u)
    for k in range(samples):
        for s in range(steps):
            torque = _rates(law, omega, u, r1, c, x)
            if s == 0:
                torques[k] = torque
            _rates(law, omega, u + 0.5 * step * r1, r2, c, x)
            _rates(law, omega, u + 0.5 * step * r2, r3, c, x)
            _rates(law, omega, u + step * r3, r4, c, x)
            u = u + step / 6.0 * (r1 + 2.0 * (r2 + r3) + r4)
    return torques


def _rest(law):
    """States before the shaft turns: long at rest, so that the contacts are old."""
    u = np.zeros({BRUSH: 4 + 3 * ELEMENTS, FRONT: 4 + 4 * ELEMENTS, SHIPPED: 6}.get(law, 8))
    first = {BRUSH: 4 + ELEMENTS, FRONT: 4 + 3 * ELEMENTS}.get(law)
    u[5 if first is None else slice(first, first + ELEMENTS)] = 1.0
    return u


def simulate(law, omega, constants, unknowns, seconds=1.2):
    """Torque in the elastomer from rest [Nm], and its sampling rate [Hz]; RK4 at 90 kHz."""
    index = LAWS.index(law)
    torques = _integrate(
        index, float(omega), _rest(index), np.asarray(constants, float),
        np.asarray(unknowns, float), round(seconds * _RATE), _STEPS, 1.0 / _RATE / _STEPS,
    )  # fmt: skip
    return torques, _RATE
