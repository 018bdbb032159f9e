r"""Linear stability of steady sliding: the growth rate of a small vibration.

About steady sliding at the shaft's speed the lumped model is linear in the motion of surface and
clamp and in the inner state s of the friction law,

.. math::
    J_E \ddot\theta_1 = \frac{\partial T}{\partial v} \delta v
        + \frac{\partial T}{\partial s} \delta s - \delta T_E, \qquad
    \delta \dot s = \frac{\partial f}{\partial v} \delta v + \frac{\partial f}{\partial s} \delta s,

with delta v = -theta1'. Where an eigenvalue has a positive real part, steady sliding is unstable:
the bushing vibrates after any start. Where all are negative a small disturbance decays, but a large
one, such as the first breaking loose, may go on as stick-slip; nor does linear stability give the
amplitude of a vibration, hence whether it sticks. A constant kinetic torque has no slope: with it
steady sliding is stable at any speed, and stick-slip always needs a large disturbance.

Slopes are central differences of the compiled law itself, so a new law needs nothing here. Effects
on the contact without a state act as they do at each speed; those with a state act by their mean
along steady sliding; the effect of temperature acts as if the contact followed its speed at once.
Compliance of the shaft and memory of the elastomer are ignored.
"""
# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001

import math
from typing import Any, cast

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from models.compilation import COMPILED
from models.rig import Rig
from sim.bushing import packed_systems
from sim.contact import (
    CRITICAL,
    KINETIC,
    N_CONTACT,
    N_CONTEXT,
    SHAFT_INERTIA,
    SHAFT_SPEED,
    SLIDING_SPEED,
    STICK_TIME,
    STIFFNESS,
    TIME,
    TORQUE,
    TWIST,
    address_of,
    call_hook_at,
    call_law_at,
)  # fmt: skip
from sim.effects import EFFECTS, constant_version
from sim.effects.effect import activated
from sim.friction import friction_law
from sim.friction.law import FrictionLaw
from sim.motion import contact_hooks
from sim.parameters import resolve
from sim.solvers.contact_solver import Hook
from sim.temperature import FRICTION_SHIFT

_MOMENTS = 48
"""Moments of steady sliding over which effects with a state are averaged."""


_STEP = 1e-5
"""Relative step of the differences."""

_FIXED_CLAMP = -1e6
"""Eigenvalue that stands for a fixed clamp [1/s]."""


def sliding_growth(
    rig: Rig,
    speed: ArrayLike,
    interference: ArrayLike = 0.279e-3,
    support_stiffness: ArrayLike = 2214.0,
) -> NDArray[np.float64]:
    """Return the growth rate of a small vibration about steady sliding at many conditions.

    Parameters
    ----------
    rig : Rig
    speed : array_like
        Speed of the shaft, not zero [rad/s]; its sign does not matter.
    interference, support_stiffness : array_like
        [m] and [Nm/rad]; all three are broadcast against each other.

    Returns
    -------
    ndarray, shape (...)
        Largest real part of an eigenvalue [1/s]; positive where the vibration grows.

    Raises
    ------
    ParameterError
        If a parameter of the friction law or of an effect cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> (sliding_growth(load_material_rig("fluorocarbon"), [5.0, 13.0]) > 0.0).tolist()
    [True, False]
    >>> bool(sliding_growth(load_material_rig("fluorocarbon-thesis"), 1.0) > 0.0)
    False
    """
    shape = np.broadcast_shapes(
        np.shape(speed), np.shape(interference), np.shape(support_stiffness)
    )
    v, fit, support = (
        np.ascontiguousarray(np.broadcast_to(np.asarray(x, dtype=np.float64), shape).ravel())
        for x in (speed, interference, support_stiffness)
    )
    v, systems = np.abs(v), packed_systems(rig, fit, support)
    law = friction_law(rig.friction.name)
    values = resolve(f"friction law {law.name!r}", law.parameters, rig.friction.parameters)
    acting = activated(constant_version(rig).effects, EFFECTS)
    contacts = _contacts(contact_hooks(acting, np.random.default_rng(0)), systems, v)
    matrices = _linearised(law, law.coefficients(values), systems, v, contacts)
    eigenvalues = np.linalg.eigvals(matrices) if v.size else np.zeros((0, 1), dtype=complex)
    return np.asarray(eigenvalues.real.max(axis=1).reshape(shape))


def _contacts(
    hooks: tuple[Hook, ...], systems: NDArray[np.float64], speed: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the contact at each speed, slightly above and below it, shape (3, n, N_CONTACT)."""
    contacts = np.zeros((3, speed.size, N_CONTACT))
    contacts[:, :, CRITICAL], contacts[:, :, KINETIC] = systems[:, 6], systems[:, 7]
    contacts[:, :, STIFFNESS] = systems[:, 2]
    contacts[:, :, SHAFT_INERTIA] = math.inf
    for hook in hooks:
        follows = hook.function is FRICTION_SHIFT.contact  # its state is a function of the speed
        if hook.n_states and not follows:
            before = contacts[0, :, :SHAFT_INERTIA].copy()
            _averaged(hook, _MOMENTS, speed, contacts[0])
            contacts[1:, :, :SHAFT_INERTIA] += contacts[0, :, :SHAFT_INERTIA] - before
            continue
        for i, factor in enumerate((1.0, 1.0 + _STEP, 1.0 - _STEP)):
            _averaged(hook, _MOMENTS if follows else 1, factor * speed, contacts[i])
    contacts[:, :, CRITICAL] = np.maximum(contacts[:, :, CRITICAL], contacts[:, :, KINETIC])
    return contacts


def _linearised(
    law: FrictionLaw,
    coefficients: NDArray[np.float64],
    systems: NDArray[np.float64],
    v: NDArray[np.float64],
    contacts: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the system matrix of each condition: theta1, theta1', theta2, theta2', inner state."""
    rest = law.state()
    n, (contact, above, below), dv = rest.size, contacts, _STEP * v
    a = np.zeros((v.size, 4 + n, 4 + n))
    j_e, j_c, _, k_b, c_e, c_b = systems[:, :6].T
    k_e = contact[:, STIFFNESS]
    slope = 0.5 * (above[:, KINETIC] - below[:, KINETIC]) / dv
    if law.torque is not None:
        address, compiled, work = address_of(law.torque), cast("Any", _fill_slopes), np.empty(n + 1)

        def law_at(
            v: NDArray[np.float64], contact: NDArray[np.float64], state: NDArray[np.float64]
        ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
            """Return the rates of the state and the torque, and their slopes over the state."""
            rates, slopes = np.empty((v.size, n + 1)), np.empty((v.size, n + 1, n))
            compiled(address, coefficients, v, contact, state, rates, slopes, work, work.copy())
            return rates, slopes

        state, moving, pause = np.tile(rest, (v.size, 1)), np.arange(v.size), 1e-7
        for _ in range(80):  # backward Euler with growing steps, until each state is steady
            rates, slopes = law_at(v[moving], contact[moving], state[moving])
            stiff = np.eye(n) / pause - slopes[:, :n]
            step = np.linalg.solve(stiff, rates[:, :n, np.newaxis])[:, :, 0]
            state[moving] += step
            pause *= 1.6
            if pause > 1.0:
                still = np.abs(step) < 1e-10 * (np.abs(state[moving]) + 1e-15)
                moving = moving[~still.all(axis=1)]
                if not moving.size:
                    break
        _, slopes = law_at(v, contact, state)
        (high, _), (low, _) = law_at(v + dv, above, state), law_at(v - dv, below, state)
        by_speed = (high - low).T / (2.0 * dv)
        slope = by_speed[n]
        a[:, 4:, 1] = -by_speed[:n].T
        a[:, 1, 4:] = slopes[:, n] / j_e[:, np.newaxis]
        a[:, 4:, 4:] = slopes[:, :n]
    a[:, 0, 1] = 1.0
    a[:, 1, 0], a[:, 1, 1] = -k_e / j_e, -(c_e + slope) / j_e
    a[:, 1, 2], a[:, 1, 3] = k_e / j_e, c_e / j_e
    a[:, 2, 3] = 1.0
    a[:, 3, 0], a[:, 3, 1] = k_e / j_c, c_e / j_c
    a[:, 3, 2], a[:, 3, 3] = -(k_e + k_b) / j_c, -(c_e + c_b) / j_c
    fixed = k_b < 0.0
    a[fixed, 2:4], a[fixed, :, 2:4] = 0.0, 0.0
    a[fixed, 2, 2] = a[fixed, 3, 3] = _FIXED_CLAMP
    return a


@njit(cache=True, **COMPILED)
def _fill_slopes(law, c, speeds, contacts, states, rates, slopes, high, low) -> None:
    """Fill rates and torque of a law, and their slopes over the state, at each condition."""
    n = states.shape[1]
    for run in range(speeds.size):
        v, contact, state = speeds[run], contacts[run].ctypes, states[run]
        at = state.ctypes
        rates[run, n] = call_law_at(law, v, c.ctypes, contact, at, rates[run].ctypes)
        for j in range(n):
            value = state[j]
            change = _STEP * abs(value) + 1e-12
            state[j] = value + change
            high[n] = call_law_at(law, v, c.ctypes, contact, at, high.ctypes)
            state[j] = value - change
            low[n] = call_law_at(law, v, c.ctypes, contact, at, low.ctypes)
            state[j] = value
            for i in range(n + 1):
                slopes[run, i, j] = (high[i] - low[i]) / (2.0 * change)


_LONG = 1.0
"""Time of steady sliding over which effects with a state are averaged [s]."""


def _averaged(
    hook: Hook, moments: int, speed: NDArray[np.float64], contacts: NDArray[np.float64]
) -> None:
    """Replace the contact at each speed by its mean over the last half of steady sliding.

    Each step is exact for a rate that is linear in the state.
    """
    step, first = _LONG / moments, moments // 2
    context = np.zeros((speed.size, N_CONTEXT))
    context[:, SHAFT_SPEED] = context[:, SLIDING_SPEED] = speed
    context[:, TORQUE] = contacts[:, KINETIC]
    context[:, TWIST] = contacts[:, KINETIC] / contacts[:, STIFFNESS]
    state, mean = np.zeros((speed.size, hook.n_states)), np.zeros_like(contacts)
    address, compiled = address_of(hook.function), _call_hook

    def hook_at(state: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        contact, rates = contacts.copy(), np.zeros_like(state)
        compiled(address, hook.values, context, state, rates, contact)
        return contact, rates

    for moment in range(moments):
        context[:, TIME] = context[:, STICK_TIME] = moment * step
        (contact, rates), (_, moved) = hook_at(state), hook_at(state + 1e-6)
        decay = np.minimum((moved - rates) * 1e6 * step, 0.0)
        state += step * rates * np.divide(
            np.expm1(decay), decay, out=np.ones_like(decay), where=decay < 0.0
        )  # fmt: skip
        if moment >= first:
            mean += contact / (moments - first)
    contacts[:] = mean


@njit(cache=True, **COMPILED)  # compiled at the first call
def _call_hook(hook, values, contexts, states, rates, contacts) -> None:
    """Call an effect's compiled function at each condition."""
    for i in range(len(contexts)):
        call_hook_at(
            hook, contexts[i].ctypes, values.ctypes, states[i].ctypes, rates[i].ctypes,
            contacts[i].ctypes,
        )  # fmt: skip
