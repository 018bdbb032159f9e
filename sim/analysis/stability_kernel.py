# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001
"""Compiled parts of stability: steady states, and the linear model about them.

Laws are called through pointers, as the solver of contacts calls them, so that one compiled
function serves all.
"""

from __future__ import annotations

import numpy as np
from numba import boolean, float64, njit, types

from models.compilation import PART
from sim.contact import KINETIC, LAW_SIGNATURE, STIFFNESS

__all__ = ["STEP", "linearised"]

STEP = 1e-5
"""Of the differences, as a share of what is changed."""

_GONE = -1e6
"""Eigenvalue in place of a clamp that cannot move [1/s]."""

_VECTOR = float64[::1]


@njit(**PART)
def _solve(a, x) -> None:
    """Replace `x` by the solution y of a y = x, by elimination with the largest pivots."""
    n = x.size
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[pivot, k]):
                pivot = i
        for j in range(k, n):
            a[k, j], a[pivot, j] = a[pivot, j], a[k, j]
        x[k], x[pivot] = x[pivot], x[k]
        for i in range(k + 1, n):
            factor = a[i, k] / a[k, k]
            for j in range(k + 1, n):
                a[i, j] -= factor * a[k, j]
            x[i] -= factor * x[k]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            x[k] -= a[k, j] * x[j]
        x[k] /= a[k, k]


@njit(**PART)
def _rates_and_slopes(law, c, v, contact, state, rates, low, slopes) -> None:
    """Fill the state's rates and their slopes over it."""
    n = state.size
    law(v, c.ctypes, contact.ctypes, state.ctypes, rates.ctypes)
    for j in range(n):
        kept = state[j]
        change = STEP * abs(kept) + 1e-12
        state[j] = kept + change
        law(v, c.ctypes, contact.ctypes, state.ctypes, slopes[n].ctypes)
        state[j] = kept - change
        law(v, c.ctypes, contact.ctypes, state.ctypes, low.ctypes)
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
    system, slopes = np.empty((n, n)), np.empty((n + 1, n))
    for run in range(speeds.size):
        v, contact = speeds[run], contacts[0, run]
        j_e, j_c, k_b = systems[run, 0], systems[run, 1], systems[run, 3]
        c_e, c_b, k_e = systems[run, 4], systems[run, 5], contact[STIFFNESS]
        a = matrices[run]
        slope = 0.5 * (contacts[1, run, KINETIC] - contacts[2, run, KINETIC]) / (STEP * v)
        if has_law:
            # Implicit steps in time that grow until they are Newton's: the state of steady sliding.
            for i in range(n):
                state[i] = rest[i]
            pause = 1e-7
            for _ in range(80):
                _rates_and_slopes(law, c, v, contact, state, rates, below, slopes)
                for i in range(n):
                    for j in range(n):
                        system[i, j] = -slopes[i, j]
                    system[i, i] += 1.0 / pause
                _solve(system, rates)
                pause *= 1.6
                settled = pause > 1.0
                for i in range(n):
                    state[i] += rates[i]
                    settled &= abs(rates[i]) / (abs(state[i]) + 1e-15) < 1e-10
                if settled:
                    break
            _rates_and_slopes(law, c, v, contact, state, rates, below, slopes)
            dv = STEP * v
            high = law(v + dv, c.ctypes, contacts[1, run].ctypes, state.ctypes, above.ctypes)
            low = law(v - dv, c.ctypes, contacts[2, run].ctypes, state.ctypes, below.ctypes)
            slope = (high - low) / (2.0 * dv)
            for j in range(n):
                a[4 + j, 1] = -(above[j] - below[j]) / (2.0 * dv)
                for i in range(n):
                    a[4 + i, 4 + j] = slopes[i, j]
                kept = state[j]
                change_of = STEP * abs(kept) + 1e-12
                state[j] = kept + change_of
                high = law(v, c.ctypes, contact.ctypes, state.ctypes, rates.ctypes)
                state[j] = kept - change_of
                low = law(v, c.ctypes, contact.ctypes, state.ctypes, rates.ctypes)
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
