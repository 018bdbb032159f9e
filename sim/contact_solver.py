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

_FIXED = 6
"""States of the mechanics: theta1, theta1', theta2, theta2', and lag of the shaft and its rate."""


_TIME_TOLERANCE = 1e-14
"""To which the ends of stick and slip are found [s]."""


@dataclass(frozen=True, eq=False)
class Hook:
    """An effect's compiled function with its numbers."""

    function: Any
    values: NDArray[np.float64]
    n_states: int


@njit(HOOK_SIGNATURE, cache=True)
def _no_hook(context, values, state, state_rates, contact):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    pass


@njit(LAW_SIGNATURE, cache=True)
def _no_law(sliding_speed, coefficients, contact, state, state_rates):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202, ARG001
    return 0.0


_HOOK = types.FunctionType(HOOK_SIGNATURE)
_LAW = types.FunctionType(LAW_SIGNATURE)
_VECTOR = float64[::1]
_MATRIX = float64[:, ::1]


@njit(cache=True, error_model="numpy", inline="always")
def _rates(
    stage, mode, x, rates, drive, acceleration, s, torques, law, has_law, coefficients, n_law,
    h0, h1, h2, h3, n_hooks, values, offsets, context, contact, result,
):  # type: ignore[no-untyped-def]  # fmt: skip
    """Fill row `stage` of `rates`, and of `result`: friction, elastomer, holding, critical."""
    j_e, j_c, k_e, k_b, c_e, c_b = s[0], s[1], s[2], s[3], s[4], s[5]
    shaft_speed = drive - x[5]
    surface_speed = shaft_speed if mode == 0 and not has_law else x[1]
    twist = x[0] - x[2]
    twist_rate = surface_speed - x[3]
    torque = k_e * twist + c_e * twist_rate
    critical, kinetic, creep, mobility, shaft_torque = torques[0], torques[1], 0.0, 0.0, 0.0
    if n_hooks > 0 or has_law:
        contact[CRITICAL] = critical
        contact[KINETIC] = kinetic
    if n_hooks > 0:
        context[SHAFT_SPEED] = shaft_speed
        context[SLIDING_SPEED] = shaft_speed - surface_speed
        context[TWIST] = twist
        context[TWIST_RATE] = twist_rate
        context[TORQUE] = torque
        context[SHAFT_LAG] = x[4]
        context[SHAFT_LAG_RATE] = x[5]
        contact[STIFFNESS] = k_e
        contact[ELASTOMER_TORQUE] = 0.0
        contact[CREEP] = 0.0
        contact[SHAFT_INERTIA] = math.inf
        contact[SHAFT_TORQUE] = 0.0
        a, b = offsets[0], offsets[1]
        h0(context, values[0], x[a:b], rates[stage, a:b], contact)
        if n_hooks > 1:
            a, b = offsets[1], offsets[2]
            h1(context, values[1], x[a:b], rates[stage, a:b], contact)
        if n_hooks > 2:
            a, b = offsets[2], offsets[3]
            h2(context, values[2], x[a:b], rates[stage, a:b], contact)
        if n_hooks > 3:
            a, b = offsets[3], offsets[4]
            h3(context, values[3], x[a:b], rates[stage, a:b], contact)
        torque += (contact[STIFFNESS] - k_e) * twist + contact[ELASTOMER_TORQUE]
        critical = max(contact[CRITICAL], contact[KINETIC])
        kinetic = contact[KINETIC]
        creep = contact[CREEP]
        mobility = 1.0 / contact[SHAFT_INERTIA]  # zero on a rigid shaft
        shaft_torque = contact[SHAFT_TORQUE]
    # What holds the surfaces together, on a shaft whose end yields to the same torque.
    free = acceleration if mobility == 0.0 else shaft_torque * mobility
    holding = (torque + j_e * free) / (1.0 + j_e * mobility)
    if has_law:
        a, b = _FIXED, _FIXED + n_law
        friction = law(
            shaft_speed - surface_speed, coefficients, contact, x[a:b], rates[stage, a:b]
        )
    elif mode == 0:
        friction = holding
    else:
        friction = mode * kinetic
    if mode == 0 and not has_law:
        rates[stage, 0] = shaft_speed * (1.0 - creep)
        rates[stage, 1] = 0.0
    else:
        rates[stage, 0] = x[1]
        rates[stage, 1] = (friction - torque) / j_e
    if k_b < 0.0:
        rates[stage, 2] = 0.0
        rates[stage, 3] = 0.0
    else:
        rates[stage, 2] = x[3]
        rates[stage, 3] = (torque - k_b * x[2] - c_b * x[3]) / j_c
    # The lag is that of the shaft's end behind its drive.
    rates[stage, 4] = x[5]
    rates[stage, 5] = (
        0.0 if mobility == 0.0 else acceleration - (shaft_torque - friction) * mobility
    )
    result[stage, 0] = friction
    result[stage, 1] = torque
    result[stage, 2] = holding
    result[stage, 3] = critical


@njit(
    types.void(
        _VECTOR, _VECTOR, _LAW, boolean, _VECTOR, _VECTOR, _HOOK, _HOOK, _HOOK, _HOOK, int64,
        _MATRIX, int64[::1], int64, _VECTOR, float64, int64, _MATRIX, int64[::1],
    ),
    cache=True,
    error_model="numpy",
)  # fmt: skip
def _solve(
    s, torques, law, has_law, coefficients, law_state, h0, h1, h2, h3, n_hooks, values, offsets,
    n_states, shaft_speed, step, substeps, out, direction_out,
):  # type: ignore[no-untyped-def]  # fmt: skip
    n_law = law_state.size
    x = np.zeros(n_states)
    y = np.zeros(n_states)
    beyond = np.zeros(n_states)
    w = np.zeros(n_states)
    # Rows 0 to 3 are the stages of a step, row 4 its end.
    rates = np.zeros((5, n_states))
    result = np.zeros((5, 4))
    context = np.zeros(N_CONTEXT)
    contact = np.zeros(N_CONTACT)
    for j in range(n_law):
        x[_FIXED + j] = law_state[j]
    mode = 0
    stick_start = 0.0
    angle = 0.0
    acceleration = 0.0
    started = False
    n = shaft_speed.size
    h = step / substeps
    last_stage = 4 if has_law else 5
    if not has_law:
        x[1] = shaft_speed[0]
    for i in range(n):
        previous = acceleration
        acceleration = (shaft_speed[i + 1] - shaft_speed[i]) / step if i + 1 < n else 0.0
        if acceleration != previous:
            started = False
        done = 0.0  # since the start of this output step
        written = False
        sub = 0
        low, high, high_holding = 0.0, -1.0, 0.0  # where the phase ends, once that is bracketed
        trial = h
        while sub < substeps:
            drive = shaft_speed[i] + acceleration * done
            time = i * step + done
            # A step that was accepted has left what the next one starts with, a retry finds its own.
            for stage in range(1 if started else 0, last_stage):
                offset = 0.0 if stage == 0 else (0.5 * trial if stage < 3 else trial)
                if stage == 0:
                    for j in range(n_states):
                        w[j] = x[j]
                elif stage < 4:
                    for j in range(n_states):
                        w[j] = x[j] + offset * rates[stage - 1, j]
                else:
                    for j in range(n_states):
                        w[j] = x[j] + trial / 6.0 * (
                            rates[0, j] + 2.0 * (rates[1, j] + rates[2, j]) + rates[3, j]
                        )
                if n_hooks > 0:
                    context[TIME] = time + offset
                    since = done + offset
                    context[SHAFT_ANGLE] = angle + since * (
                        shaft_speed[i] + 0.5 * acceleration * since
                    )
                    if mode == 0:
                        context[STICK_TIME] = time + offset - stick_start
                _rates(
                    stage, mode, w, rates, drive + acceleration * offset, acceleration, s,
                    torques, law, has_law, coefficients, n_law, h0, h1, h2, h3, n_hooks, values,
                    offsets, context, contact, result,
                )  # fmt: skip
            started = True
            if not written:
                out[i, 0] = result[0, 0]
                out[i, 1] = result[0, 1]
                for j in range(4):
                    out[i, 2 + j] = x[j]
                out[i, 6] = drive - x[5]
                direction_out[i] = mode
                written = True
                if i + 1 == n:
                    break
            if has_law:
                for j in range(n_states):
                    x[j] += (
                        trial
                        / 6.0
                        * (rates[0, j] + 2.0 * (rates[1, j] + rates[2, j]) + rates[3, j])
                    )
                sub += 1
                done = sub * h
                started = False
                continue
            if mode == 0 and result[0, 3] < abs(result[0, 2]):
                # It cannot hold from the start: it slides on, or back.
                mode = 1 if result[0, 2] > 0.0 else -1
                started = False
                continue
            for j in range(n_states):
                y[j] = w[j]
            if mode == 0:
                y[1] = rates[4, 0]
                far = result[4, 3] - abs(result[4, 2])
            else:
                far = mode * (drive + acceleration * trial - y[5] - y[1])
            if high < 0.0 and far >= 0.0:  # the phase outlasts the step
                for j in range(n_states):
                    x[j] = y[j]
                    rates[0, j] = rates[4, j]
                for j in range(4):
                    result[0, j] = result[4, j]
                started = True
                sub += 1
                done = sub * h
                trial = h
                continue
            if far < 0.0:
                high = trial
                high_holding = result[4, 2]
                for j in range(n_states):
                    beyond[j] = y[j]
            else:
                low = trial
            trial = 0.5 * (low + high)
            if high - low > _TIME_TOLERANCE and low < trial < high:
                continue
            for j in range(n_states):
                x[j] = beyond[j]
            done += high
            if mode == 0:
                mode = 1 if high_holding > 0.0 else -1
                x[1] = shaft_speed[i] + acceleration * done - x[5]
            else:
                x[1] = shaft_speed[i] + acceleration * done - x[5]
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
    offsets[0] = _FIXED + law_state.size
    for i in range(MOST_HOOKS):
        offsets[i + 1] = offsets[i] + (hooks[i].n_states if i < len(hooks) else 0)
    widest = max((hook.values.size for hook in hooks), default=1)
    values = np.zeros((MOST_HOOKS, widest))
    for row, hook in zip(values, hooks, strict=False):
        row[: hook.values.size] = hook.values
    functions = [hook.function for hook in hooks] + [_no_hook] * (MOST_HOOKS - len(hooks))
    states = np.empty((shaft_speed.size, 7))
    direction = np.zeros(shaft_speed.size, dtype=np.int64)
    _solve(
        system, np.array([critical_torque, kinetic_torque]), law or _no_law, law is not None,
        np.zeros(1) if coefficients is None else coefficients, law_state, *functions, len(hooks),
        values, offsets, int(offsets[-1]), np.ascontiguousarray(shaft_speed), step, substeps,
        states, direction,
    )  # fmt: skip
    return states, direction
