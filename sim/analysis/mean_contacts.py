# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
# ruff: noqa: ANN001
"""The contact in steady sliding under an effect, as the mean over the second half of it.

Effects are called through pointers, as the solver of contacts calls them, so that one compiled
function serves all.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import float64, int64, njit, types

from models.compilation import COMPILED
from sim.contact import (
    KINETIC,
    N_CONTEXT,
    SHAFT_SPEED,
    SLIDING_SPEED,
    STICK_TIME,
    STIFFNESS,
    TIME,
    TORQUE,
    TWIST,
    address_of,
    call_hook_at,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sim.solvers.contact_solver import Hook

__all__ = ["average_contacts"]

_LONG = 1.0
"""Steady sliding over which effects with a state are averaged [s]."""

_VECTOR = float64[::1]
_MATRIX = float64[:, ::1]


def average_contacts(
    hook: Hook, moments: int, speed: NDArray[np.float64], contacts: NDArray[np.float64]
) -> None:
    """Replace each contact by the mean over the last half of steady sliding.

    Parameters
    ----------
    hook : Hook
        The effect.
    moments : int
        At which it acts.
    speed : ndarray, shape (n,)
        Of the shaft [rad/s].
    contacts : ndarray, shape (n, N_CONTACT)
        By `sim.contact` [units of `sim.contact`]; changed in place.

    Examples
    --------
    >>> from sim.contact import KINETIC
    >>> from sim.effects import EFFECTS
    >>> from sim.solvers.contact_solver import Hook
    >>> weaker = Hook(EFFECTS["velocity_weakening"].contact, np.array([0.5, 1.0, 0.0]), 0)
    >>> contacts = np.array([[10.7, 8.0, 665.0, 0.0, 0.0, np.inf, 0.0]])
    >>> average_contacts(weaker, 1, np.array([2.0]), contacts)
    >>> bool(contacts[0, KINETIC] < 8.0)
    True
    """
    compiled: Any = _average
    compiled(
        address_of(hook.function), hook.values, moments, speed,
        np.zeros((4, hook.n_states)), np.zeros(N_CONTEXT), np.zeros((2, contacts.shape[1])),
        contacts,
    )  # fmt: skip


@njit(
    types.void(
        int64, _VECTOR, int64, _VECTOR, _MATRIX, _VECTOR, _MATRIX, _MATRIX,
    ),
    cache=True, **COMPILED,
)  # fmt: skip
def _average(hook, values, moments, speeds, states, context, work, contacts) -> None:
    state, rates, moved, rates_moved = states[0], states[1], states[2], states[3]
    contact, mean = work[0], work[1]
    step = _LONG / moments
    first = moments // 2
    for run in range(speeds.size):
        given = contacts[run]
        for i in range(state.size):
            state[i] = 0.0
        for i in range(given.size):
            mean[i] = 0.0
        context[SHAFT_SPEED] = context[SLIDING_SPEED] = speeds[run]
        context[TORQUE] = given[KINETIC]
        context[TWIST] = given[KINETIC] / given[STIFFNESS]
        for moment in range(moments):
            context[TIME] = context[STICK_TIME] = moment * step
            # Each state on its own, by its exponential: heat flows at rates far above the steps.
            for i in range(state.size):
                rates[i] = rates_moved[i] = 0.0
                moved[i] = state[i] + 1e-6
            for i in range(given.size):
                contact[i] = given[i]
            call_hook_at(
                hook, context.ctypes, values.ctypes, moved.ctypes, rates_moved.ctypes,
                contact.ctypes,
            )  # fmt: skip
            for i in range(given.size):
                contact[i] = given[i]
            call_hook_at(
                hook, context.ctypes, values.ctypes, state.ctypes, rates.ctypes, contact.ctypes
            )
            for i in range(state.size):
                decay = min((rates_moved[i] - rates[i]) * 1e6 * step, 0.0)
                state[i] += step * rates[i] * (math.expm1(decay) / decay if decay else 1.0)
            if moment >= first:
                for i in range(given.size):
                    mean[i] += contact[i] / (moments - first)
        for i in range(given.size):
            given[i] = mean[i]
