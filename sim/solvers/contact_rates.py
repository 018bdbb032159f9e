# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any, disable-error-code=call-arg
# ruff: noqa: ANN001
"""Right-hand side of the lumped model with any friction law and any effects, and its records.

It is inlined into `sim.solvers.contact_kernel`: calls through pointers pass every variable through
memory, and a further call would do so twice. Each hook's view of the inner states is made once,
since making one costs more than the call.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

from models.compilation import PART
from sim import contact as shared

if TYPE_CHECKING:
    from numpy.typing import NDArray


_CREEP_ACCURACY = 1e-4
"""Accuracy of a creep's share before the last secant step, which squares it."""

_MOST_CREEP_PASSES = 30


@njit(forceinline=True, **PART)
def contact_rates(
    stage, since, i, time, stick_time, mode, bushing, hooks, drive, rows
) -> tuple[float, float, float, float, float, float]:
    """Fill the rates of the state at a stage, a time `since` after sample `i` of the drive [s].

    Returns friction torque, elastomer torque, holding torque and critical torque [Nm], the speed of
    the surface in stick, and the speed of the shaft [rad/s].
    """
    s, has_law, contact, context = (
        bushing.system,
        bushing.law != 0,
        bushing.contact,
        bushing.context,
    )
    j_e, k_e, k_b, c_e, c_b, j_e_inverse, j_c_inverse = s[0], s[2], s[3], s[4], s[5], s[6], s[7]
    t_crit, t_kin = s[8], s[9]
    u, k = rows.state, rows.stages
    acceleration = drive.slope[i]
    shaft = drive.speed[i] + acceleration * since
    lag = u.size
    if hooks.n > 0:
        lag -= N_LAG
        shaft -= u[lag + 1]
    sticks = mode == 0 and not has_law
    surface = shaft if sticks else u[1]
    twist = u[0] - u[2]
    e = k_e * twist + c_e * (surface - u[3])
    critical, kinetic, creep = t_crit, t_kin, 0.0
    mobility, shaft_torque = 0.0, 0.0
    if hooks.n > 0:
        context[shared.TIME], context[shared.STICK_TIME] = time, stick_time
        turned = since * (drive.speed[i] + 0.5 * acceleration * since)
        context[shared.SHAFT_ANGLE] = drive.angle[i] + turned
        context[shared.SHAFT_SPEED], context[shared.TWIST] = shaft, twist
        context[shared.SHAFT_LAG], context[shared.SHAFT_LAG_RATE] = u[lag], u[lag + 1]
        # A creeping contact relieves the elastomer's damper, on whose torque the creep depends, so
        # its share is a fixed point, iterated by secants from rest.
        share, share_before, gap_before = 0.0, 0.0, 0.0
        for turn in range(_MOST_CREEP_PASSES):
            context[shared.SLIDING_SPEED], context[shared.TWIST_RATE] = (
                shaft - surface,
                surface - u[3],
            )
            context[shared.TORQUE] = e
            contact[shared.CRITICAL], contact[shared.KINETIC] = t_crit, t_kin
            contact[shared.STIFFNESS], contact[shared.ELASTOMER_TORQUE] = k_e, 0.0
            contact[shared.CREEP], contact[shared.SHAFT_TORQUE] = 0.0, 0.0
            contact[shared.SHAFT_INERTIA] = math.inf
            at, now, where = contact.ctypes, context.ctypes, hooks.addresses
            for a in range(hooks.n):
                shared.call_hook_at(
                    where[a, 0], now, shared.pointer(where[a, 1]), shared.pointer(where[a, 2]),
                    shared.pointer(where[a, 3]), at,
                )  # fmt: skip
            creep = contact[shared.CREEP]
            gap = creep - share
            if not sticks or gap == 0.0:
                break
            settled = turn > 0 and abs(gap) < _CREEP_ACCURACY
            change = gap
            if turn > 0 and gap != gap_before:
                change = -gap * (share - share_before) / (gap - gap_before)
            share_before, gap_before = share, gap
            share = min(max(share + change, 0.0), 1.0)
            surface = shaft * (1.0 - share)
            e = k_e * twist + c_e * (surface - u[3])
            if settled:
                break
        e += (contact[shared.STIFFNESS] - k_e) * twist + contact[shared.ELASTOMER_TORQUE]
        kinetic = contact[shared.KINETIC]
        # A contact holds at least its kinetic torque, whatever an effect does.
        critical = max(contact[shared.CRITICAL], kinetic)
        if contact[shared.SHAFT_INERTIA] != math.inf:
            mobility = 1.0 / contact[shared.SHAFT_INERTIA]
            shaft_torque = contact[shared.SHAFT_TORQUE]
    # Holding torque, on a shaft whose end yields to the same torque.
    if mobility == 0.0:
        holding = e + j_e * acceleration
    else:
        holding = (e + j_e * shaft_torque * mobility) / (1.0 + j_e * mobility)
    if has_law:
        # The inner states of the law come first, then those of the effects.
        friction = shared.call_law_at(
            bushing.law, shaft - surface, bushing.coefficients.ctypes, contact.ctypes,
            rows.inner.ctypes, rows.inner_rates.ctypes,
        )  # fmt: skip
    elif mode == 0:
        friction = holding
    else:
        friction = mode * kinetic
    k[0, stage] = surface
    k[1, stage] = 0.0 if sticks else (friction - e) * j_e_inverse
    k[2, stage] = u[3]
    k[3, stage] = (e - k_b * u[2] - c_b * u[3]) * j_c_inverse
    for j in range(N_MOTION, lag):
        k[j, stage] = rows.rates[j]
    if hooks.n > 0:  # the lag of the shaft's end behind its drive
        k[lag, stage] = u[lag + 1]
        turns = acceleration - (shaft_torque - friction) * mobility
        k[lag + 1, stage] = 0.0 if mobility == 0.0 else turns
    # A slip ends where it is as slow as the creep of the stick that follows.
    caught = surface if sticks else shaft * (1.0 - creep)
    return friction, e, holding, critical, caught, shaft


SHORTEST_STEP = 1e-7
"""Average step below which a run is aborted [s]."""

# State of the solver between blocks, by index.
(
    MODE,  # +1 or -1 in sliding, 0 in stick and with a law
    SLIDE,  # sign of the sliding speed with a law, 0 while undetermined
    STICK_START,  # start of the last stick [s]
    STICK_LENGTH,  # duration of the last stick [s]
    ANGLE,  # angle of the drive at the next sample [rad]
    FIRST,  # index of the next sample
    STEP_START,  # start of the last step, relative to the next sample [s]
    STEP_END,  # its end [s]
    STEP_OF_STICK,  # length of the next step in stick, by error control [s]
    STEP_OF_SLIP,  # the same in slip [s]
    FRESH,  # whether the rates at the end of the last step must be recomputed
    STEPS,  # number of steps since the start; -1 once there are too many
    FAR,  # distance to the end of stick or slip, at the end of the last step
    NEXT_MODE,  # mode after the last step
    ERROR,  # error of the last step, over the tolerance
    N_CARRIED,
) = range(16)

N_STAGES = 7
"""Stages of a step of `sim.solvers.tsitouras`."""

N_MOTION = 4
"""Number of variables of the motion, which come first: theta1, theta1', theta2, theta2'."""

N_LAG = 2
"""Number of variables of the shaft's lag, which come last if effects act: angle and speed."""


class Bushing(NamedTuple):
    """Lumped model and friction, for compiled code.

    Parameters
    ----------
    system : ndarray, shape (10,)
        J_E, J_C, k_E, k_B, c_E, c_B, the inertias' reciprocals, T_crit, T_kin [SI].
    law : int
        Address of the friction law's compiled function; 0 for true stick.
    coefficients : ndarray, shape (n,)
        Coefficients of the law [SI].
    context, contact : ndarray, shape (n,)
        Context and contact of `sim.contact` [SI].
    """

    system: NDArray[np.float64]
    law: int
    coefficients: NDArray[np.float64]
    context: NDArray[np.float64]
    contact: NDArray[np.float64]


class Hooks(NamedTuple):
    """Arguments of the effects' compiled functions.

    Parameters
    ----------
    n : int
        Number of effects.
    addresses : ndarray, shape (n, 4)
        Addresses of function, values, states and state rates of each effect [-]; an array would be
        seven arguments to compile and to pass.
    """

    n: int
    addresses: NDArray[np.int64]


class Drive(NamedTuple):
    """Drive of the shaft at the samples, linear between them.

    Parameters
    ----------
    step : float
        Time between samples [s].
    speed, angle : ndarray, shape (n,)
        [rad/s], [rad]
    slope : ndarray, shape (n,)
        Slope after each sample [rad/s2]; the last continues beyond them.
    """

    step: float
    speed: NDArray[np.float64]
    slope: NDArray[np.float64]
    angle: NDArray[np.float64]


class Rows(NamedTuple):
    """States and rates of all variables, and work space.

    Parameters
    ----------
    stages : ndarray, shape (n, N_STAGES + 1)
        Rates of each variable at the stages of the last step, and at an output [SI].
    weights : ndarray, shape (N_STAGES,)
        Weights of the stages [-].
    start, end : ndarray, shape (n,)
        States at start and end of the last step [SI].
    state, rates : ndarray, shape (n,)
        State at one instant, and the rates that laws and effects fill [SI].
    inner, inner_rates : ndarray, shape (n - N_MOTION,)
        Views of these after the motion: states of the law, the effects, and the lag [SI].
    """

    stages: NDArray[np.float64]
    weights: NDArray[np.float64]
    start: NDArray[np.float64]
    end: NDArray[np.float64]
    state: NDArray[np.float64]
    rates: NDArray[np.float64]
    inner: NDArray[np.float64]
    inner_rates: NDArray[np.float64]


class Limits(NamedTuple):
    """Limits of a step: its longest duration [s], and its error over its scale [-]."""

    longest: float
    tolerance: float


def empty_rows(n: int) -> Rows:
    """Return rows of `n` variables, all zero.

    Examples
    --------
    >>> empty_rows(7).inner.shape
    (3,)
    """
    start, end, state, rates = np.zeros((4, n))
    return Rows(
        np.zeros((n, N_STAGES + 1)), np.zeros(N_STAGES), start, end, state, rates,
        state[N_MOTION:], rates[N_MOTION:],
    )  # fmt: skip
