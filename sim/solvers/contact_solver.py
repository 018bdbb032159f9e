"""Runge-Kutta solver of the lumped model with any friction law and any effects.

The method is Tsitouras's pair of fifth order with error control, which takes few steps in stick and
many in the fastest parts of a slip. Outputs lie anywhere in a step. Where the contact breaks or
catches, the right-hand side changes; where a law's sliding reverses, it has the kink of |v|. A step
ends there, with its length iterated, so that the order is preserved. A step also ends where the
slope of the drive changes visibly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from sim.contact import N_CONTACT, N_CONTEXT, address_of
from sim.solvers import contact_rates as at

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
    refined : float
        Factor by which steps are shortened, to estimate their error.
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
        refined: float = 1.0,
        motion: NDArray[np.float64] | None = None,
    ) -> None:
        # Imported here, so that the kernel is not compiled for runs that do not need it.
        from sim.solvers.contact_kernel import run_contact

        law_state = np.zeros(0) if law_state is None else law_state
        self._rows = at.empty_rows(n_variables(law_state, hooks))
        self._functions = law, hooks  # kept alive: the loop reads them by address
        self._constants = (
            contact_record(system, critical_torque, kinetic_torque, law, coefficients),
            hooks_record(hooks, self._rows, law_state.size),
        )
        self._loop: Any = run_contact
        # The error of a step is proportional to the fifth power of its length.
        self._limits = at.Limits(LONGEST_STEP / refined, tolerance / refined**5)
        self._step, self._name = step, name
        self._parts = _parts(law, law_state.size, hooks)
        self._carried = np.zeros(at.N_CARRIED)
        self._carried[[at.STEP_OF_STICK, at.STEP_OF_SLIP]] = _FIRST_STEP
        self._carried[at.FRESH] = 1.0
        if motion is not None:
            self._rows.end[:4] = motion
            if law is None:
                self._carried[[at.MODE, at.NEXT_MODE]] = math.copysign(1.0, start_speed - motion[1])
        elif law is None:
            self._rows.end[1] = start_speed
        self._rows.end[at.N_MOTION : at.N_MOTION + law_state.size] = law_state

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
        motion = self._rows.end[: at.N_MOTION].copy()
        if not self._constants[0].law:
            return motion, float(self._carried[at.NEXT_MODE])
        return motion, math.copysign(1.0, shaft_speed - motion[1])

    def start_from(self, motion: NDArray[np.float64], direction: float, angle: float) -> None:
        """Start from a motion, shape (4,), as of `motion`, with the shaft at an angle [rad]."""
        self._rows.end[: at.N_MOTION] = motion
        self._carried[at.ANGLE] = angle
        if not self._constants[0].law:
            self._carried[[at.MODE, at.NEXT_MODE]] = direction

    def continue_from(self, before: ContactRun, shaft_speed: float) -> None:
        """Start from the motion of another run, and from the inner states that both have.

        States that the other run lacks start as after a long rest. The shaft has a speed [rad/s].
        """
        self._constants[0].context[:] = before._constants[0].context
        initial = self._carried.copy()
        self._carried[:] = before._carried
        self._carried[at.FRESH] = 1.0  # the forces change
        if self._parts == before._parts:
            for name in ("start", "end", "stages"):
                getattr(self._rows, name)[...] = getattr(before._rows, name)
            return
        for key, part in self._parts.items():
            if key in before._parts:
                self._rows.end[part] = before._rows.end[before._parts[key]]
        motion, direction = before.motion(shaft_speed)
        restarted = [at.STEP_START, at.STEP_END, at.STEP_OF_STICK, at.STEP_OF_SLIP]
        restarted += [at.ERROR, at.FAR, at.SLIDE]
        self._carried[restarted] = initial[restarted]
        self._carried[[at.MODE, at.NEXT_MODE]] = 0.0
        self.start_from(motion, direction, float(before._carried[at.ANGLE]))

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
        if self._carried[at.STEPS] < 0.0:
            raise ParameterError(
                f"{self._name}: the motion changes so fast that steps of {at.SHORTEST_STEP:g} s "
                "cannot follow; make the torque less steep with speed, shear and time, and parts "
                "softer, heavier or less damped"
            )
        return states.T, direction

    def _drive(self, speed: NDArray[np.float64], n: int) -> at.Drive:
        """Return the drive from the next sample on, for `n` samples to solve."""
        available, size = speed.size, max(n + 1, speed.size)
        slope, angle = np.zeros(size), np.zeros(size)
        np.divide(np.diff(speed), self._step, out=slope[: available - 1])
        slope[max(available - 1, 1) :] = slope[max(available - 2, 0)]
        angle[0] = self._carried[at.ANGLE]
        angle[1:available] = 0.5 * self._step * (speed[:-1] + speed[1:])
        np.cumsum(angle[:available], out=angle[:available])
        return at.Drive(self._step, np.ascontiguousarray(speed), slope, angle)


def _parts(law: Any, n_law: int, hooks: tuple[Hook, ...]) -> dict[Any, slice]:
    """Return the variables of law and effects, by their functions, and of the lag, by name."""
    lengths = [(law, n_law), *((hook.function, hook.n_states) for hook in hooks)]
    lengths += [("lag", at.N_LAG)] if hooks else []
    parts, first = {}, at.N_MOTION
    for key, length in lengths:
        parts[key], first = slice(first, first + length), first + length
    return parts


def n_variables(law_state: NDArray[np.float64], hooks: tuple[Hook, ...]) -> int:
    """Return the number of variables: motion, `law_state` of shape (n,), effects, shaft's lag."""
    lag = at.N_LAG if hooks else 0
    return at.N_MOTION + law_state.size + sum(hook.n_states for hook in hooks) + lag


def contact_record(
    system: NDArray[np.float64],
    critical_torque: float,
    kinetic_torque: float,
    law: Any,
    coefficients: NDArray[np.float64] | None,
) -> at.Bushing:
    """Return the lumped model and its friction for compiled code; arguments as of `ContactRun`."""
    j_e, j_c, _, k_b, _, _ = system
    mobilities = [1.0 / j_e, 0.0 if k_b < 0.0 else 1.0 / j_c]  # a fixed clamp does not move
    return at.Bushing(
        np.array([*system, *mobilities, critical_torque, kinetic_torque]),
        address_of(law),
        np.zeros(1) if coefficients is None else coefficients,
        np.zeros(N_CONTEXT),
        np.zeros(N_CONTACT),
    )


def hooks_record(hooks: tuple[Hook, ...], rows: at.Rows, n_law: int) -> at.Hooks:
    """Return the arguments of the effects' compiled functions.

    Parameters
    ----------
    hooks : tuple of Hook
    rows : at.Rows
        Their inner states are those of the law, then those of the effects. Rows and hooks must
        outlive the record.
    n_law : int
        Number of inner states of the law.
    """
    addresses, first = np.zeros((len(hooks), 4), dtype=np.int64), at.N_MOTION + n_law
    for row, hook in zip(addresses, hooks, strict=True):
        arrays = hook.values, rows.state[first:], rows.rates[first:]
        row[:] = [address_of(hook.function), *(array.ctypes.data for array in arrays)]
        first += hook.n_states
    return at.Hooks(len(hooks), addresses)
