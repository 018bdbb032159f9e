# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any, disable-error-code=call-arg
"""Runge-Kutta solver of the lumped model with any friction law and any effects.

The method is Tsitouras's pair of fifth order with error control, which takes few steps in stick and
many in the fastest parts of a slip. Outputs lie anywhere in a step. Where the contact breaks or
catches, the right-hand side changes; where a law's sliding reverses, it has the kink of |v|. A step
ends there, with its length iterated, so that the order is preserved. A step also ends where the
slope of the drive changes visibly.

The right-hand side is inlined into `sim.solvers.contact_kernel`: calls through pointers pass every
variable through memory, and a further call would do so twice. Each hook's view of the inner states
is made once, since making one costs more than the call.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.compilation import PART
from models.errors import ParameterError
from sim import contact as shared

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


LONGEST_STEP = 1e-4
"""Longest step, whatever its error, since an effect may act at any time [s]."""

_TOLERANCE = 1e-7
"""Error of a step relative to the twist at the critical torque, the speed that this twist releases,
and the inner states."""

_FIRST_STEP = 1e-6
"""First step [s]."""


@dataclass(frozen=True, eq=False)
class Hook:
    """Compiled function of an effect, with its numbers and its number of states."""

    function: Any
    values: NDArray[np.float64]
    n_states: int

    def __post_init__(self) -> None:
        values = np.ascontiguousarray(self.values, dtype=np.float64)
        object.__setattr__(self, "values", values)  # compiled code reads it by address


class ContactRun:
    """Block-wise solution of the lumped model, from rest or from the middle of a slip.

    Parameters
    ----------
    system : ndarray, shape (6,)
        System as of `LumpedBushing.packed`.
    critical_torque, kinetic_torque : float
        [Nm]
    start_speed : float
        Speed of the shaft at the start [rad/s].
    step : float
        Time between outputs [s].
    law : compiled function, optional
        Friction law by `sim.contact.LAW_SIGNATURE`; without one the contact has true stick.
    coefficients, law_state : ndarray, shape (n,), optional
        Coefficients of the law, and its state at the start, in the units of the law [unit].
    hooks : tuple of Hook
        Effects that act on the contact, in this order.
    name : str
        Name of the friction in error messages.
    tolerance : float
        Error of a step [-]; `sim.friction.law.FrictionLaw.tolerance` with a law.
    motion : ndarray, shape (4,), optional
        theta1 [rad], theta1' [rad/s], theta2, theta2' to start from in the middle of a slip; by
        default the run starts from rest.

    Examples
    --------
    >>> rig = np.array([1 / 65000, 1 / 1200, 665.0, 3745.0, 0.0425, 0.0425])
    >>> run = ContactRun(rig, 10.7, 8.0, 1.0, 1e-4)
    >>> blocks = [run.advance(np.full(301, 1.0), 300)[0] for _ in range(4)]
    >>> round(float(np.concatenate(blocks)[:, 0].max()), 1)
    10.7
    """

    def __init__(
        self,
        system: NDArray[np.float64],
        critical_torque: float,
        kinetic_torque: float,
        start_speed: float,
        step: float,
        *,
        law: Any = None,
        coefficients: NDArray[np.float64] | None = None,
        law_state: NDArray[np.float64] | None = None,
        hooks: tuple[Hook, ...] = (),
        name: str = "friction",
        tolerance: float = _TOLERANCE,
        motion: NDArray[np.float64] | None = None,
    ) -> None:
        # Imported here, so that the kernel is not compiled for runs that do not need it.
        from sim.solvers.contact_kernel import run_contact

        law_state = np.zeros(0) if law_state is None else law_state
        self._rows = empty_rows(n_variables(law_state, hooks))
        self._functions = law, hooks  # kept alive: the loop reads them by address
        self._constants = (
            contact_record(system, critical_torque, kinetic_torque, law, coefficients),
            hooks_record(hooks, self._rows, law_state.size),
        )
        self._loop: Any = run_contact
        self._limits = Limits(LONGEST_STEP, tolerance)
        self._step, self._name = step, name
        self._parts = _parts(law, law_state.size, hooks)
        self._carried = np.zeros(N_CARRIED)
        self._carried[[STEP_OF_STICK, STEP_OF_SLIP]] = _FIRST_STEP
        self._carried[FRESH] = 1.0
        if motion is not None:
            self._rows.end[:4] = motion
            if law is None:
                self._carried[[MODE, NEXT_MODE]] = math.copysign(1.0, start_speed - motion[1])
        elif law is None:
            self._rows.end[1] = start_speed
        self._rows.end[N_MOTION : N_MOTION + law_state.size] = law_state

    @property
    def end_state(self) -> NDArray[np.float64]:
        """Variables at the end of the last step, motion first, shape (n,) [SI]."""
        return self._rows.end

    def motion(self, shaft_speed: float) -> tuple[NDArray[np.float64], float]:
        """Return the motion at the end of the last step, with the shaft at a speed [rad/s].

        Returns
        -------
        motion : ndarray, shape (4,)
            theta1 [rad], theta1' [rad/s], theta2, theta2'.
        direction : float
            Sign of the sliding speed: +1 or -1, 0 in stick [-].
        """
        motion = self._rows.end[:N_MOTION].copy()
        if not self._constants[0].law:
            return motion, float(self._carried[NEXT_MODE])
        return motion, math.copysign(1.0, shaft_speed - motion[1])

    def start_from(self, motion: NDArray[np.float64], direction: float, angle: float) -> None:
        """Start from a motion, shape (4,), as of `motion`, with the shaft at an angle [rad]."""
        self._rows.end[:N_MOTION] = motion
        self._carried[ANGLE] = angle
        if not self._constants[0].law:
            self._carried[[MODE, NEXT_MODE]] = direction

    def continue_from(self, before: ContactRun, shaft_speed: float) -> None:
        """Start from the motion of another run, and from the inner states that both have.

        States that the other run lacks start as after a long rest. The shaft has a speed [rad/s].
        """
        self._constants[0].context[:] = before._constants[0].context
        initial = self._carried.copy()
        self._carried[:] = before._carried
        self._carried[FRESH] = 1.0  # the forces change
        if self._parts == before._parts:
            for name in ("start", "end", "stages"):
                getattr(self._rows, name)[...] = getattr(before._rows, name)
            return
        for key, part in self._parts.items():
            if key in before._parts:
                self._rows.end[part] = before._rows.end[before._parts[key]]
        motion, direction = before.motion(shaft_speed)
        restarted = [STEP_START, STEP_END, STEP_OF_STICK, STEP_OF_SLIP]
        restarted += [ERROR, FAR, SLIDE]
        self._carried[restarted] = initial[restarted]
        self._carried[[MODE, NEXT_MODE]] = 0.0
        self.start_from(motion, direction, float(before._carried[ANGLE]))

    def advance(
        self, shaft_speed: NDArray[np.float64], n: int
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Solve the next `n` samples.

        Parameters
        ----------
        shaft_speed : ndarray, shape (n,) or more
            Speed of the drive at the samples [rad/s], linear between them. Unless the run ends,
            at least one more sample is needed; with `sim.motion.lookahead_samples` more, the steps
            equal those of a run in one block.
        n : int

        Returns
        -------
        states : ndarray, shape (n, 7)
            Friction torque and elastomer torque [Nm], theta1 [rad], theta1' [rad/s], theta2,
            theta2', speed of the shaft at the bushing [rad/s].
        direction : ndarray, shape (n,)
            Direction of sliding [-]: +1 or -1, 0 in stick; always 0 with a law.

        Raises
        ------
        ParameterError
            If the friction changes too fast for any reasonable number of steps.
        """
        states, direction = np.empty((7, n)), np.empty(n, dtype=np.int64)
        self._loop(
            *self._constants, self._drive(shaft_speed, n), self._limits, self._carried, self._rows,
            states, direction,
        )  # fmt: skip
        if self._carried[STEPS] < 0.0:
            raise ParameterError(
                f"{self._name}: the motion changes so fast that steps of {SHORTEST_STEP:g} s "
                "cannot follow; make the torque less steep with speed, shear and time, and parts "
                "softer, heavier or less damped"
            )
        return states.T, direction

    def _drive(self, speed: NDArray[np.float64], n: int) -> Drive:
        """Return the drive from the next sample on, for `n` samples to solve."""
        available, size = speed.size, max(n + 1, speed.size)
        slope, angle = np.zeros(size), np.zeros(size)
        np.divide(np.diff(speed), self._step, out=slope[: available - 1])
        slope[max(available - 1, 1) :] = slope[max(available - 2, 0)]
        angle[0] = self._carried[ANGLE]
        angle[1:available] = 0.5 * self._step * (speed[:-1] + speed[1:])
        np.cumsum(angle[:available], out=angle[:available])
        return Drive(self._step, np.ascontiguousarray(speed), slope, angle)


def _parts(law: Any, n_law: int, hooks: tuple[Hook, ...]) -> dict[Any, slice]:
    """Return the variables of law and effects, by their functions, and of the lag, by name."""
    lengths = [(law, n_law), *((hook.function, hook.n_states) for hook in hooks)]
    lengths += [("lag", N_LAG)] if hooks else []
    parts, first = {}, N_MOTION
    for key, length in lengths:
        parts[key], first = slice(first, first + length), first + length
    return parts


def n_variables(law_state: NDArray[np.float64], hooks: tuple[Hook, ...]) -> int:
    """Return the number of variables: motion, `law_state` of shape (n,), effects, shaft's lag."""
    lag = N_LAG if hooks else 0
    return N_MOTION + law_state.size + sum(hook.n_states for hook in hooks) + lag


def contact_record(
    system: NDArray[np.float64],
    critical_torque: float,
    kinetic_torque: float,
    law: Any,
    coefficients: NDArray[np.float64] | None,
) -> Bushing:
    """Return the lumped model and its friction for compiled code; arguments as of `ContactRun`."""
    j_e, j_c, _, k_b, _, _ = system
    mobilities = [1.0 / j_e, 0.0 if k_b < 0.0 else 1.0 / j_c]  # a fixed clamp does not move
    return Bushing(
        np.array([*system, *mobilities, critical_torque, kinetic_torque]),
        shared.address_of(law),
        np.zeros(1) if coefficients is None else coefficients,
        np.zeros(shared.N_CONTEXT),
        np.zeros(shared.N_CONTACT),
    )


def hooks_record(hooks: tuple[Hook, ...], rows: Rows, n_law: int) -> Hooks:
    """Return the arguments of the effects' compiled functions.

    Parameters
    ----------
    hooks : tuple of Hook
    rows : Rows
        Their inner states are those of the law, then those of the effects. Rows and hooks must
        outlive the record.
    n_law : int
        Number of inner states of the law.
    """
    addresses, first = np.zeros((len(hooks), 4), dtype=np.int64), N_MOTION + n_law
    for row, hook in zip(addresses, hooks, strict=True):
        arrays = hook.values, rows.state[first:], rows.rates[first:]
        row[:] = [shared.address_of(hook.function), *(array.ctypes.data for array in arrays)]
        first += hook.n_states
    return Hooks(len(hooks), addresses)
