"""The lumped model with any friction law and any effects: Runge-Kutta with event location.

Tsitouras's pair of fifth order, with steps as long as the error of each allows, which
follows stick with few and the fastest parts of a slip with as many as they need. Outputs lie
anywhere in a step. Where the contact breaks and catches again, the right-hand side changes, and
where a law's sliding turns it has the kink of |v|: a step ends there, found by repeating it with
other lengths, so that neither costs an order. Where the drive's slope changes visibly a step ends
as well.
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
"""Whatever the error says: an effect may act at any time [s]."""

_TOLERANCE = 1e-7
"""Error of a step, over the twist at the critical torque and the speed that this may become, and
over the inner states themselves."""

_FIRST_STEP = 1e-6
"""[s]"""


@dataclass(frozen=True, eq=False)
class Hook:
    """An effect's compiled function with its numbers."""

    function: Any
    values: NDArray[np.float64]
    n_states: int

    def __post_init__(self) -> None:
        values = np.ascontiguousarray(self.values, dtype=np.float64)
        object.__setattr__(self, "values", values)  # which compiled code reads where it lies


class ContactRun:
    """A run of the lumped model that goes on from block to block, from rest or from a slip.

    Parameters
    ----------
    system : ndarray, shape (6,)
        As of `LumpedBushing.packed`.
    critical_torque, kinetic_torque : float
        [Nm]
    start_speed : float
        Of the shaft [rad/s].
    step : float
        Time between outputs [s].
    law : compiled function, optional
        Friction law by `sim.contact.LAW_SIGNATURE`; without one the contact truly sticks.
    coefficients, law_state : ndarray, shape (n,), optional
        As of the law; its state at the start.
    hooks : tuple of Hook
        Effects that act on the contact, in this order.
    name : str
        What errors call the friction.
    tolerance : float
        Error of a step [-]; `sim.friction.law.FrictionLaw.tolerance` with a law.
    refined : float
        Steps are so many times shorter than by default, to tell their error.
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
        # What is not imported before it is needed is not compiled either.
        from sim.solvers.contact_kernel import run_contact

        law_state = np.zeros(0) if law_state is None else law_state
        self._rows = at.empty_rows(n_variables(law_state, hooks))
        self._functions = law, hooks  # which the loop reads by their addresses
        self._constants = (
            contact_record(system, critical_torque, kinetic_torque, law, coefficients),
            hooks_record(hooks, self._rows, law_state.size),
        )
        self._loop: Any = run_contact
        # The error of a step goes with the fifth power of its length.
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
        """All variables at the end of the last step, motion first, shape (n,) [SI]."""
        return self._rows.end

    def motion(self, shaft_speed: float) -> tuple[NDArray[np.float64], float]:
        """Where it has come to with the shaft at a speed [rad/s].

        Returns
        -------
        motion : ndarray, shape (4,)
            theta1 [rad], theta1' [rad/s], theta2, theta2'.
        direction : float
            Of the sliding, by its sign: +1 or -1, 0 in stick [-].
        """
        motion = self._rows.end[: at.N_MOTION].copy()
        if not self._constants[0].law:
            return motion, float(self._carried[at.NEXT_MODE])
        return motion, math.copysign(1.0, shaft_speed - motion[1])

    def start_from(self, motion: NDArray[np.float64], direction: float, angle: float) -> None:
        """Start from a motion, as of `motion`, with the shaft at an angle [rad]."""
        self._rows.end[: at.N_MOTION] = motion
        self._carried[at.ANGLE] = angle
        if not self._constants[0].law:
            self._carried[[at.MODE, at.NEXT_MODE]] = direction

    def go_on_from(self, before: ContactRun, shaft_speed: float) -> None:
        """Start where another run has come to: its motion, and the inner states that both have.

        What the other one lacks starts as after a long rest. The shaft has a speed [rad/s].
        """
        self._constants[0].context[:] = before._constants[0].context
        kept = self._carried.copy()
        self._carried[:] = before._carried
        self._carried[at.FRESH] = 1.0  # the forces are others
        if self._parts == before._parts:
            for name in ("start", "end", "stages"):
                getattr(self._rows, name)[...] = getattr(before._rows, name)
            return
        for key, part in self._parts.items():
            if key in before._parts:
                self._rows.end[part] = before._rows.end[before._parts[key]]
        motion, direction = before.motion(shaft_speed)
        restarted = [
            at.STEP_START,
            at.STEP_END,
            at.STEP_OF_STICK,
            at.STEP_OF_SLIP,
            at.ERROR,
            at.FAR,
            at.SLIDE,
        ]
        self._carried[restarted] = kept[restarted]
        self._carried[[at.MODE, at.NEXT_MODE]] = 0.0
        self.start_from(motion, direction, float(before._carried[at.ANGLE]))

    def advance(
        self, shaft_speed: NDArray[np.float64], n: int
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Solve the next `n` samples.

        Parameters
        ----------
        shaft_speed : ndarray, shape (n,) or more
            Of the drive at the samples [rad/s], linear between them. If the run goes on there is
            at least the one after them; steps are those of one run if there are as many as
            `LONGEST_STEP` has.
        n : int

        Returns
        -------
        states : ndarray, shape (n, 7)
            Friction torque and elastomer torque [Nm], theta1 [rad], theta1' [rad/s], theta2,
            theta2', speed of the shaft at the bushing [rad/s].
        direction : ndarray, shape (n,)
            Of the sliding [-]: +1 or -1, 0 in stick; 0 throughout with a law.

        Raises
        ------
        ParameterError
            If the friction changes faster than any reasonable number of steps could follow.
        """
        states, direction = np.empty((7, n)), np.empty(n, dtype=np.int64)
        self._loop(
            *self._constants, self._drive(shaft_speed, n), self._limits, self._carried, self._rows,
            states, direction,
        )  # fmt: skip
        if self._carried[at.DONE] < 0.0:
            raise ParameterError(
                f"{self._name}: the motion changes so fast that steps of {at.SHORTEST_STEP:g} s "
                "cannot follow; make the torque less steep with speed, shear and time, and parts "
                "softer, heavier or less damped"
            )
        return states.T, direction

    def _drive(self, speed: NDArray[np.float64], n: int) -> at.Drive:
        """Return the drive from the next sample on, of which `n` are solved."""
        known, size = speed.size, max(n + 1, speed.size)
        slope, angle = np.zeros(size), np.zeros(size)
        np.divide(np.diff(speed), self._step, out=slope[: known - 1])
        slope[max(known - 1, 1) :] = slope[max(known - 2, 0)]
        angle[0] = self._carried[at.ANGLE]
        angle[1:known] = 0.5 * self._step * (speed[:-1] + speed[1:])
        np.cumsum(angle[:known], out=angle[:known])
        return at.Drive(self._step, np.ascontiguousarray(speed), slope, angle)


def _parts(law: Any, n_law: int, hooks: tuple[Hook, ...]) -> dict[Any, slice]:
    """Which variables are whose: of law and effects by their functions, of the lag by a name."""
    lengths = [(law, n_law), *((hook.function, hook.n_states) for hook in hooks)]
    lengths += [("lag", at.N_LAG)] if hooks else []
    parts, first = {}, at.N_MOTION
    for key, length in lengths:
        parts[key], first = slice(first, first + length), first + length
    return parts


def n_variables(law_state: NDArray[np.float64], hooks: tuple[Hook, ...]) -> int:
    """Count motion, the law's inner states (`law_state`, shape (n,)), the effects', and the lag."""
    lag = at.N_LAG if hooks else 0
    return at.N_MOTION + law_state.size + sum(hook.n_states for hook in hooks) + lag


def contact_record(
    system: NDArray[np.float64],
    critical_torque: float,
    kinetic_torque: float,
    law: Any,
    coefficients: NDArray[np.float64] | None,
) -> at.Bushing:
    """Return the lumped model and its friction as compiled code reads them; as of `ContactRun`."""
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
    """Return what the effects' functions are called with.

    Parameters
    ----------
    hooks : tuple of Hook
    rows : at.Rows
        Whose inner states are the law's, then theirs.
    n_law : int
        Inner states of the law. They and the hooks must outlive what is returned.
    """
    addresses, first = np.zeros((len(hooks), 4), dtype=np.int64), at.N_MOTION + n_law
    for row, hook in zip(addresses, hooks, strict=True):
        arrays = hook.values, rows.state[first:], rows.rates[first:]
        row[:] = [address_of(hook.function), *(array.ctypes.data for array in arrays)]
        first += hook.n_states
    return at.Hooks(len(hooks), addresses)
