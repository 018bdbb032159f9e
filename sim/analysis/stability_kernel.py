# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001, ANN202
"""Compiled parts of stability: mean contacts, steady states, the linear model about them.

Laws and effects are called through pointers, as the solver of contacts calls them, so that one
compiled function serves all.
"""

from __future__ import annotations

import math

import numpy as np
from numba import boolean, float64, njit, types

from sim.contact import (
    HOOK_SIGNATURE,
    KINETIC,
    LAW_SIGNATURE,
    N_CONTEXT,
    SHAFT_SPEED,
    SLIDING_SPEED,
    STICK_TIME,
    STIFFNESS,
    TIME,
    TORQUE,
    TWIST,
)

__all__ = ["STEP", "averaged_contacts", "linearised"]

STEP = 1e-5
"""Of the differences, as a share of what is changed."""

_GONE = -1e6
"""Eigenvalue in place of a clamp that cannot move [1/s]."""

_LONG = 1.0
"""Steady sliding over which effects with a state are averaged [s]."""

_VECTOR = float64[::1]


@njit(
    types.void(
        types.FunctionType(HOOK_SIGNATURE), _VECTOR, float64[:, ::1], types.int64, _VECTOR,
        float64[:, ::1],
    ),
    cache=True, error_model="numpy",
)  # fmt: skip
def averaged_contacts(hook, values, states, moments, speeds, contacts) -> None:
    """Replace each contact by the mean over the last half of steady sliding."""
    context = np.zeros(N_CONTEXT)
    contact = np.zeros(contacts.shape[1])
    for run in range(speeds.size):
        state, rates, moved, rates_moved = states[0], states[1], states[2], states[3]
        state[:] = 0.0
        given = contacts[run].copy()
        mean = np.zeros(given.size)
        context[SHAFT_SPEED] = context[SLIDING_SPEED] = speeds[run]
        context[TORQUE] = given[KINETIC]
        context[TWIST] = given[KINETIC] / given[STIFFNESS]
        step = _LONG / moments
        first = moments // 2
        for moment in range(moments):
            context[TIME] = context[STICK_TIME] = moment * step
            contact[:] = given
            rates[:] = 0.0
            # Each state on its own, by its exponential: heat flows at rates far above the steps.
            moved[:] = state + 1e-6
            rates_moved[:] = 0.0
            hook(context, values, moved, rates_moved, contact)
            contact[:] = given
            hook(context, values, state, rates, contact)
            for i in range(state.size):
                decay = min((rates_moved[i] - rates[i]) * 1e6 * step, 0.0)
                state[i] += step * rates[i] * (math.expm1(decay) / decay if decay else 1.0)
            if moment >= first:
                mean[:] += contact / (moments - first)
        contacts[run] = mean


@njit(cache=True, error_model="numpy")
def _rates_and_slopes(law, c, v, contact, state, rates, slopes):
    """Fill the state's rates and their slopes over it."""
    n = state.size
    low = np.empty(n)
    law(v, c, contact, state, rates)
    for j in range(n):
        kept = state[j]
        change = STEP * abs(kept) + 1e-12
        state[j] = kept + change
        law(v, c, contact, state, slopes[n])
        state[j] = kept - change
        law(v, c, contact, state, low)
        state[j] = kept
        for i in range(n):
            slopes[i, j] = (slopes[n, i] - low[i]) / (2.0 * change)


@njit(
    types.void(
        types.FunctionType(LAW_SIGNATURE), boolean, _VECTOR, _VECTOR, float64[:, ::1], _VECTOR,
        float64[:, :, ::1], float64[:, :, ::1],
    ),
    cache=True, error_model="numpy",
)  # fmt: skip
def linearised(law, has_law, c, rest, systems, speeds, contacts, matrices) -> None:
    """Fill the matrix of each condition: theta1, theta1', theta2, theta2', inner state."""
    n = rest.size if has_law else 0
    state, rates, above, below = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    slopes = np.empty((n + 1, n))
    for run in range(speeds.size):
        v, contact = speeds[run], contacts[0, run]
        j_e, j_c, k_b = systems[run, 0], systems[run, 1], systems[run, 3]
        c_e, c_b, k_e = systems[run, 4], systems[run, 5], contact[STIFFNESS]
        a = matrices[run]
        slope = 0.5 * (contacts[1, run, KINETIC] - contacts[2, run, KINETIC]) / (STEP * v)
        if has_law:
            # Implicit steps in time that grow until they are Newton's: the state of steady sliding.
            state[:] = rest
            pause = 1e-7
            for _ in range(80):
                _rates_and_slopes(law, c, v, contact, state, rates, slopes)
                system = -slopes[:n].copy()
                for j in range(n):
                    system[j, j] += 1.0 / pause
                change = np.linalg.solve(system, rates)
                state += change
                pause *= 1.6
                if pause > 1.0 and np.max(np.abs(change) / (np.abs(state) + 1e-15)) < 1e-10:
                    break
            _rates_and_slopes(law, c, v, contact, state, rates, slopes)
            dv = STEP * v
            high = law(v + dv, c, contacts[1, run], state, above)
            low = law(v - dv, c, contacts[2, run], state, below)
            slope = (high - low) / (2.0 * dv)
            for j in range(n):
                a[4 + j, 1] = -(above[j] - below[j]) / (2.0 * dv)
                for i in range(n):
                    a[4 + i, 4 + j] = slopes[i, j]
                kept = state[j]
                change_of = STEP * abs(kept) + 1e-12
                state[j] = kept + change_of
                high = law(v, c, contact, state, rates)
                state[j] = kept - change_of
                low = law(v, c, contact, state, rates)
                state[j] = kept
                a[1, 4 + j] = (high - low) / (2.0 * change_of) / j_e
        a[0, 1] = 1.0
        a[1, 0], a[1, 1] = -k_e / j_e, -(c_e + slope) / j_e
        if k_b < 0.0:
            a[2, 2] = a[3, 3] = _GONE
        else:
            a[1, 2], a[1, 3] = k_e / j_e, c_e / j_e
            a[2, 3] = 1.0
            a[3, 0], a[3, 1] = k_e / j_c, c_e / j_c
            a[3, 2], a[3, 3] = -(k_e + k_b) / j_c, -(c_e + c_b) / j_c
