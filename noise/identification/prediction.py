"""What a model foretells of the excerpts of a recording, each begun where the recording has it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.rig import LawSpec
from sim.bushing import LumpedBushing
from sim.contact import CRITICAL, KINETIC, N_CONTACT, call_law
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import friction_law
from sim.motion import contact_hooks
from sim.parameters import resolve
from sim.solvers.contact_solver import ContactRun, Hook

if TYPE_CHECKING:
    from noise.identification.excerpts import Excerpts
    from sim.friction.law import FrictionLaw


_TOLERANCE = 1e-6
"""Of the solver, over one cycle."""

_SUBSTEPS = 12
"""Between two samples, of a contact that is driven: it settles within microseconds."""


@dataclass(frozen=True, eq=False)
class Friction:
    """A law of friction ready to be solved."""

    law: FrictionLaw
    coefficients: NDArray[np.float64]
    hooks: tuple[Hook, ...]


def friction_of(law: LawSpec, effects: tuple[LawSpec, ...] = ()) -> Friction:
    """Prepare a law and the effects that act on the contact.

    Raises
    ------
    ParameterError
        A parameter is out of its range.
    """
    found = friction_law(law.name)
    values = resolve(f"friction law {law.name!r}", found.parameters, law.parameters)
    hooks = contact_hooks(activated(effects, EFFECTS), np.random.default_rng(0))
    return Friction(found, found.coefficients(values), hooks)


@njit(cache=True, error_model="numpy", nogil=True)
def _driven(law, speed, step, substeps, coefficients, contact, state) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    """Carry the inner state of a contact through sliding that is known (Heun's method)."""
    first, second, guess = np.zeros_like(state), np.zeros_like(state), np.zeros_like(state)
    h = step / substeps
    for i in range(speed.size - 1):
        slope = (speed[i + 1] - speed[i]) / substeps
        for j in range(substeps):
            v = speed[i] + slope * j
            call_law(law, v, coefficients, contact, state, first)
            for m in range(state.size):
                guess[m] = state[m] + h * first[m]
            call_law(law, v + slope, coefficients, contact, guess, second)
            for m in range(state.size):
                state[m] += 0.5 * h * (first[m] + second[m])


def foretold(
    excerpts: Excerpts, bushing: LumpedBushing, friction: Friction, critical: float, kinetic: float
) -> NDArray[np.float64]:
    """Foretell the torque of the cell in each excerpt.

    Parameters
    ----------
    excerpts : Excerpts
    bushing : LumpedBushing
    friction : Friction
    critical, kinetic : float
        Torques as the law means them [Nm].

    Returns
    -------
    ndarray, shape (n_excerpts, length)
        [Nm]

    Raises
    ------
    ParameterError
        The friction is too steep to be solved.
    """
    step, packed, law = 1.0 / excerpts.rate, bushing.packed(), friction.law
    contact = np.zeros(N_CONTACT)
    contact[CRITICAL], contact[KINETIC] = critical, kinetic
    motions, run_ins, speeds = _begun(
        excerpts, bushing.elastomer_stiffness, bushing.elastomer_damping,
        bushing.support_stiffness, bushing.support_damping, bushing.clamp_inertia,
    )  # fmt: skip
    torque = np.empty((excerpts.starts.size, excerpts.length))
    for row, motion, run_in, speed in zip(torque, motions, run_ins, speeds, strict=True):
        inner = law.state()
        if inner.size:
            _driven(law.torque, run_in, step, _SUBSTEPS, friction.coefficients, contact, inner)
        run = ContactRun(
            packed, critical, kinetic, float(speed), step, law=law.torque,
            coefficients=friction.coefficients, law_state=inner, hooks=friction.hooks,
            tolerance=_TOLERANCE, motion=motion,
        )  # fmt: skip
        row[:] = run.advance(np.full(excerpts.length, speed), excerpts.length)[0][:, 1]
    return torque


@lru_cache(maxsize=600)
def _begun(
    excerpts: Excerpts, stiffness: float, damping: float, support: float, support_damping: float,
    clamp_inertia: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:  # fmt: skip
    """Motion where each excerpt begins, sliding speed before it, and the shaft's speed in it.

    Kept, since a search moves the bushing less often than the rest.
    """
    spectrum = excerpts.spectrum
    bushing = LumpedBushing(1.0, clamp_inertia, stiffness, support, damping, support_damping)
    states = spectrum.states(bushing)
    inside = excerpts.starts[:, None] + np.arange(excerpts.length)
    before = excerpts.starts[:, None] + np.arange(-excerpts.run_in, 1)
    return (
        np.ascontiguousarray(states[:, excerpts.starts].T),
        spectrum.shaft_speed[before] - states[1][before],
        spectrum.shaft_speed[inside].mean(axis=1),
    )
