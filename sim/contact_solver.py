"""The lumped model with any friction law and any effects: Runge-Kutta with event location.

Classical fourth order at a small fixed step. Where the contact truly sticks, the instants at which
it breaks and catches again lie between steps: they are found by repeating the step with other
lengths, to the accuracy of the method itself, so that re-stick costs no order as it does where a
step simply ends. Laws with an inner state have no such instants.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import njit

from sim.contact import HOOK_SIGNATURE, LAW_SIGNATURE, N_CONTEXT
from sim.contact_kernel import N_MOTION, run_contact

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["MOST_HOOKS", "ContactRun", "Hook", "solve_contact"]

MOST_HOOKS = 4
"""Effects that can act on the contact at once."""


@dataclass(frozen=True, eq=False)
class Hook:
    """An effect's compiled function with its numbers."""

    function: Any
    values: NDArray[np.float64]
    n_states: int


@njit(HOOK_SIGNATURE, cache=True)
def _no_hook(context, values, state, state_rates, contact):
    pass


@njit(LAW_SIGNATURE, cache=True)
def _no_law(sliding_speed, coefficients, contact, state, state_rates):  # noqa: ARG001
    return 0.0


class ContactRun:
    """A run of the lumped model that goes on from block to block, from rest.

    Parameters
    ----------
    system : ndarray, shape (6,)
        `LumpedBushing.packed`.
    critical_torque, kinetic_torque : float
        [Nm]
    start_speed : float
        Of the shaft [rad/s].
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

    Examples
    --------
    >>> rig = np.array([1 / 65000, 1 / 1200, 665.0, 3745.0, 0.0425, 0.0425])
    >>> run = ContactRun(rig, 10.7, 8.0, 1.0, 1e-4, 9)
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
        substeps: int,
        *,
        law: Any = None,
        coefficients: NDArray[np.float64] | None = None,
        law_state: NDArray[np.float64] | None = None,
        hooks: tuple[Hook, ...] = (),
    ) -> None:
        if len(hooks) > MOST_HOOKS:
            raise ValueError(f"{len(hooks)} effects act on the contact; at most {MOST_HOOKS} can")
        law_state = np.zeros(0) if law_state is None else law_state
        offsets = np.zeros(MOST_HOOKS + 1, dtype=np.int64)
        offsets[0] = law_state.size
        for i in range(MOST_HOOKS):
            offsets[i + 1] = offsets[i] + (hooks[i].n_states if i < len(hooks) else 0)
        values = np.zeros((MOST_HOOKS, max((hook.values.size for hook in hooks), default=1)))
        for row, hook in zip(values, hooks, strict=False):
            row[: hook.values.size] = hook.values
        j_e, j_c, _, k_b, _, _ = system
        mobilities = [1.0 / j_e, 0.0 if k_b < 0.0 else 1.0 / j_c]  # a fixed clamp does not move
        functions = [hook.function for hook in hooks] + [_no_hook] * (MOST_HOOKS - len(hooks))
        self._constants = (
            np.append(system, mobilities),
            np.array([critical_torque, kinetic_torque]),
            law or _no_law,
            law is not None,
            np.zeros(1) if coefficients is None else coefficients,
            *functions,
            len(hooks),
            values,
            offsets,
        )
        self._step, self._substeps = step, substeps
        self._motion = np.zeros(N_MOTION)
        if law is None:
            self._motion[1] = start_speed
        self._inner = np.zeros(int(offsets[-1]))
        self._inner[: law_state.size] = law_state
        self._context = np.zeros(N_CONTEXT)

    def advance(
        self, shaft_speed: NDArray[np.float64], n: int
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Solve the next `n` samples.

        Parameters
        ----------
        shaft_speed : ndarray, shape (n,) or (n + 1,)
            Of the drive at the samples [rad/s], linear between them; the one after them is where
            the next block starts. Without it the run ends here.
        n : int

        Returns
        -------
        states, direction
            As from `solve_contact`.
        """
        states, direction = np.empty((7, n)), np.empty(n, dtype=np.int64)
        compiled: Any = run_contact
        compiled(
            *self._constants, np.ascontiguousarray(shaft_speed), self._step, self._substeps,
            self._motion, self._inner, self._context, states, direction,
        )  # fmt: skip
        return states.T, direction


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
    run = ContactRun(
        system, critical_torque, kinetic_torque, float(shaft_speed[0]), step, substeps,
        law=law, coefficients=coefficients, law_state=law_state, hooks=hooks,
    )  # fmt: skip
    return run.advance(shaft_speed, shaft_speed.size)
