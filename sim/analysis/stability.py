r"""Linear stability of steady sliding: whether a vibration that is small grows.

About steady sliding at the shaft's speed the lumped model is linear in the motion of surface and
clamp and in the inner state s of the friction law,

.. math::
    J_E \ddot\theta_1 = \frac{\partial T}{\partial v} \delta v
        + \frac{\partial T}{\partial s} \delta s - \delta T_E, \qquad
    \delta \dot s = \frac{\partial f}{\partial v} \delta v + \frac{\partial f}{\partial s} \delta s,

with delta v = -theta1'. Where an eigenvalue has a positive real part, nothing keeps the shaft
sliding steadily: it vibrates at any start. Where all are negative a small disturbance dies, which
does not exclude that a large one, such as the first breaking loose, goes on as stick-slip; nor
does it tell how large a vibration grows, hence whether it sticks. A constant kinetic torque has no
slope: with it steady sliding is stable at any speed, and stick-slip is wholly of the large kind.

Slopes are central differences of the compiled law itself, so that a new law needs nothing here.
Effects on the contact count as they are at each speed where they have no state, and else by their
mean along steady sliding; what a temperature does, as if the contact followed its speed at once. A
shaft that yields and an elastomer with a memory do not count.
"""
# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import float64, int64, njit, types
from numpy.typing import ArrayLike, NDArray

from models.compilation import COMPILED, PART
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
from sim.effects import EFFECTS
from sim.effects.effect import Effect, activated
from sim.friction import friction_law
from sim.motion import contact_hooks
from sim.parameters import resolve
from sim.rig_effects import constant_version
from sim.solvers.contact_solver import Hook
from sim.temperature import FRICTION_SHIFT

_MOMENTS = 48
"""Of steady sliding, over which effects with a state are averaged."""


_STEP = 1e-5
"""Of the differences, as a share of what is changed."""

_GONE = -1e6
"""Eigenvalue in place of a clamp that cannot move [1/s]."""

_VECTOR = float64[::1]


@dataclass(frozen=True, eq=False)
class Stability:
    """What becomes of a small vibration about steady sliding; arrays of one shape.

    Parameters
    ----------
    growth : ndarray, shape (...)
        Largest real part of an eigenvalue [1/s]; positive where the vibration grows.
    frequency : ndarray, shape (...)
        Of that vibration [Hz].
    """

    growth: NDArray[np.float64]
    frequency: NDArray[np.float64]

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Where small vibrations die; with no slope at all none grows."""
        return np.asarray(self.growth <= 0.0)


def steady_sliding(
    rig: Rig,
    speed: ArrayLike,
    interference: ArrayLike = 0.279e-3,
    support_stiffness: ArrayLike = 2214.0,
    *,
    library: Mapping[str, Effect] = EFFECTS,
) -> Stability:
    """Tell whether steady sliding is stable, at many conditions at once.

    Parameters
    ----------
    rig : Rig
    speed : array_like
        Of the shaft, other than zero [rad/s]; either sign is alike.
    interference, support_stiffness : array_like
        [m] and [Nm/rad]; all three are broadcast against each other.
    library : mapping of str to Effect
        Effects that the rig's can be found among.

    Returns
    -------
    Stability

    Raises
    ------
    ParameterError
        If a parameter of the friction law or of an effect cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> found = steady_sliding(load_material_rig("fluorocarbon"), [5.0, 13.0])
    >>> found.stable.tolist()
    [False, True]
    >>> bool(steady_sliding(load_material_rig("fluorocarbon-thesis"), 1.0).stable)
    True
    """
    shape = np.broadcast_shapes(
        np.shape(speed), np.shape(interference), np.shape(support_stiffness)
    )
    v, fit, support = (
        np.ascontiguousarray(np.broadcast_to(np.asarray(x, dtype=np.float64), shape).ravel())
        for x in (speed, interference, support_stiffness)
    )
    v = np.abs(v)
    law = friction_law(rig.friction.name)
    values = resolve(f"friction law {law.name!r}", law.parameters, rig.friction.parameters)
    coefficients = law.coefficients(values)
    systems = packed_systems(rig, fit, support)
    acting = activated(constant_version(rig, library).effects, library)
    contacts = _contacts(contact_hooks(acting, np.random.default_rng(0)), systems, v)
    state = law.state()
    matrices = np.zeros((v.size, 4 + state.size, 4 + state.size))
    compiled: Any = _linearised
    compiled(
        address_of(law.torque), coefficients, state, systems, v, contacts, matrices,
    )  # fmt: skip
    eigenvalues = np.linalg.eigvals(matrices) if v.size else np.zeros((0, 1), dtype=complex)
    rows, leading = np.arange(v.size), eigenvalues.real.argmax(axis=1)
    found = eigenvalues[rows, leading]
    return Stability(
        growth=found.real.reshape(shape),
        frequency=(np.abs(found.imag) / (2.0 * math.pi)).reshape(shape),
    )


def _contacts(
    hooks: tuple[Hook, ...], systems: NDArray[np.float64], speed: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Contact at each speed, somewhat above it, and somewhat below; shape (3, n, N_CONTACT)."""
    contacts = np.zeros((3, speed.size, N_CONTACT))
    contacts[:, :, CRITICAL], contacts[:, :, KINETIC] = systems[:, 6], systems[:, 7]
    contacts[:, :, STIFFNESS] = systems[:, 2]
    contacts[:, :, SHAFT_INERTIA] = math.inf
    for hook in hooks:
        follows = hook.function is FRICTION_SHIFT.contact  # its state is that of the speed
        if hook.n_states and not follows:
            before = contacts[0, :, :SHAFT_INERTIA].copy()
            _averaged(hook, _MOMENTS, speed, contacts[0])
            contacts[1:, :, :SHAFT_INERTIA] += contacts[0, :, :SHAFT_INERTIA] - before
            continue
        for i, factor in enumerate((1.0, 1.0 + _STEP, 1.0 - _STEP)):
            _averaged(hook, _MOMENTS if follows else 1, factor * speed, contacts[i])
    contacts[:, :, CRITICAL] = np.maximum(contacts[:, :, CRITICAL], contacts[:, :, KINETIC])
    return contacts


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
def _rates_and_slopes(law, c, v, contact, state, rates, high, low, slopes) -> None:
    """Fill the state's rates and, over it, their slopes and in the last row the torque's."""
    n = state.size
    call_law_at(law, v, c.ctypes, contact.ctypes, state.ctypes, rates.ctypes)
    for j in range(n):
        kept = state[j]
        change = _STEP * abs(kept) + 1e-12
        state[j] = kept + change
        above = call_law_at(law, v, c.ctypes, contact.ctypes, state.ctypes, high.ctypes)
        state[j] = kept - change
        below = call_law_at(law, v, c.ctypes, contact.ctypes, state.ctypes, low.ctypes)
        state[j] = kept
        for i in range(n):
            slopes[i, j] = (high[i] - low[i]) / (2.0 * change)
        slopes[n, j] = (above - below) / (2.0 * change)


@njit(
    types.void(
        int64, _VECTOR, _VECTOR, float64[:, ::1], _VECTOR,
        float64[:, :, ::1], float64[:, :, ::1],
    ),
    cache=True, error_model="numpy",
)  # fmt: skip
def _linearised(law, c, rest, systems, speeds, contacts, matrices) -> None:
    """Fill the matrix of each condition: theta1, theta1', theta2, theta2', inner state."""
    has_law = law != 0
    n = rest.size if has_law else 0
    state, rates, above, below = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    system, slopes = np.empty((n, n)), np.empty((n + 1, n))
    for run in range(speeds.size):
        v, contact = speeds[run], contacts[0, run]
        j_e, j_c, k_b = systems[run, 0], systems[run, 1], systems[run, 3]
        c_e, c_b, k_e = systems[run, 4], systems[run, 5], contact[STIFFNESS]
        a = matrices[run]
        slope = 0.5 * (contacts[1, run, KINETIC] - contacts[2, run, KINETIC]) / (_STEP * v)
        if has_law:
            # Implicit steps in time that grow until they are Newton's: the state of steady sliding.
            for i in range(n):
                state[i] = rest[i]
            pause = 1e-7
            for _ in range(80):
                _rates_and_slopes(law, c, v, contact, state, rates, above, below, slopes)
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
            _rates_and_slopes(law, c, v, contact, state, rates, above, below, slopes)
            dv = _STEP * v
            high = call_law_at(
                law, v + dv, c.ctypes, contacts[1, run].ctypes, state.ctypes, above.ctypes
            )
            low = call_law_at(
                law, v - dv, c.ctypes, contacts[2, run].ctypes, state.ctypes, below.ctypes
            )
            slope = (high - low) / (2.0 * dv)
            for j in range(n):
                a[4 + j, 1] = -(above[j] - below[j]) / (2.0 * dv)
                a[1, 4 + j] = slopes[n, j] / j_e
                for i in range(n):
                    a[4 + i, 4 + j] = slopes[i, j]
        a[0, 1] = 1.0
        a[1, 0], a[1, 1] = -k_e / j_e, -(c_e + slope) / j_e
        if k_b < 0.0:
            a[2, 2] = a[3, 3] = _GONE
        else:
            a[1, 2], a[1, 3] = k_e / j_e, c_e / j_e
            a[2, 3] = 1.0
            a[3, 0], a[3, 1] = k_e / j_c, c_e / j_c
            a[3, 2], a[3, 3] = -(k_e + k_b) / j_c, -(c_e + c_b) / j_c


_LONG = 1.0
"""Steady sliding over which effects with a state are averaged [s]."""


def _averaged(
    hook: Hook, moments: int, speed: NDArray[np.float64], contacts: NDArray[np.float64]
) -> None:
    """Replace the contact at each speed by the mean over the last half of steady sliding.

    The effect acts at so many moments; `contacts`, shape (n, N_CONTACT), are changed in place.
    """
    compiled: Any = _average
    compiled(
        address_of(hook.function), hook.values, moments, speed,
        np.zeros((4, hook.n_states)), np.zeros(N_CONTEXT), np.zeros((2, contacts.shape[1])),
        contacts,
    )  # fmt: skip


@njit(cache=True, **COMPILED)  # when the first effect needs it
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
