"""The motion of shaft, bushing and clamp at one condition: the simulator's core."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from sim.bushing import LumpedBushing, lumped_bushing
from sim.friction import friction_law
from sim.parameters import resolve
from sim.solvers.contact_solver import Hook, solve_contact
from sim.solvers.contact_state import MOST_HOOKS
from sim.solvers.stick_slip import solve_stick_slip

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from models.rig import Rig
    from sim.effects.effect import ActiveEffect
    from sim.shaft import ShaftMotion

__all__ = ["STICK_SPEED_SHARE", "Motion", "contact_hooks", "simulate_motion"]

STICK_SPEED_SHARE = 0.05
"""The contact counts as stuck while it slides slower than this share of the shaft's speed."""

_FASTEST_SLIP = 60.0
"""Sliding speeds exceed the shaft's by about so much [rad/s]; the thesis has 45 (Figure 6.7)."""

_FASTEST_RATE = 3e7
"""That the solver of contacts follows in a bearable time [1/s]."""


@dataclass(frozen=True, eq=False)
class Motion:
    """Motion and torques over time, sampled at `rate`; all arrays have shape (n,).

    Parameters
    ----------
    rate : float
        [Hz]
    torque : ndarray
        Torque that the bushing puts into the clamp, T_E [Nm]; what the thesis plots and the
        torque cell is taken to read.
    friction_torque : ndarray
        Torque in the contact [Nm]; differs from `torque` by the inertia of the elastomer.
    shaft_angle, shaft_speed : ndarray
        [rad], [rad/s]
    interface_angle, interface_speed : ndarray
        Of the bushing's surface: how far it has been carried along [rad], [rad/s].
    clamp_angle, clamp_speed : ndarray
        [rad], [rad/s]
    """

    rate: float
    torque: NDArray[np.float64]
    friction_torque: NDArray[np.float64]
    shaft_angle: NDArray[np.float64]
    shaft_speed: NDArray[np.float64]
    interface_angle: NDArray[np.float64]
    interface_speed: NDArray[np.float64]
    clamp_angle: NDArray[np.float64]
    clamp_speed: NDArray[np.float64]

    @property
    def sliding_speed(self) -> NDArray[np.float64]:
        """Speed of the shaft over the bushing's surface [rad/s]."""
        return self.shaft_speed - self.interface_speed

    def since(self, first: int) -> Motion:
        """Return the motion from sample `first` on."""
        kept = {
            field.name: getattr(self, field.name)[first:]
            for field in fields(self)
            if field.name != "rate"
        }
        return Motion(rate=self.rate, **kept)

    @property
    def stuck(self) -> NDArray[np.bool_]:
        """Where the contact sticks: slides slower than `STICK_SPEED_SHARE` of the shaft's speed."""
        slow = np.abs(self.sliding_speed) <= STICK_SPEED_SHARE * np.abs(self.shaft_speed)
        return np.asarray(slow & (self.shaft_speed != 0.0))


def simulate_motion(
    rig: Rig,
    shaft: ShaftMotion,
    *,
    interference: float,
    support_stiffness: float,
    seconds: float,
    rate: float,
    effects: Sequence[ActiveEffect] = (),
    rng: np.random.Generator | None = None,
    tolerance: float | None = None,
) -> Motion:
    """Simulate the rig from rest.

    Parameters
    ----------
    rig : Rig
    shaft : ShaftMotion
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.
    seconds : float
        Length [s].
    rate : float
        Of the output [Hz]. At constant and ramped speed the solution does not depend on it; other
        motions of the shaft are linear between its samples, which moves events by some 5e-9 s at
        30 kHz, and by the square of the step.
    effects : sequence of ActiveEffect
        Those of drive and friction act, in this order; the others are left to others.
    rng : numpy.random.Generator, optional
        Of effects that scatter; by default seeded with 0.
    tolerance : float, optional
        Error of a step where the motion has no exact solution; by default that of the friction law,
        which is less than regimes and spectra need.

    Returns
    -------
    Motion

    Raises
    ------
    ParameterError
        If a value cannot be used, or the friction law's parameters are out of range.

    Examples
    --------
    >>> from models.rig_files.rig_file import load_material_rig
    >>> from sim.shaft import ConstantSpeed
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> run = simulate_motion(rig, ConstantSpeed(1.0), interference=0.279e-3,
    ...                       support_stiffness=3745.0, seconds=0.1, rate=30e3)
    >>> round(float(run.torque.max()), 1)
    10.7
    """
    rng = rng or np.random.default_rng(0)
    n = round(seconds * rate)
    if not n >= 2:
        raise ParameterError(f"seconds = {seconds:g} at rate = {rate:g} Hz gives no samples")
    system = lumped_bushing(rig, interference, support_stiffness)
    fit = rig.fit(interference)
    law = friction_law(rig.friction.name)
    values = resolve(f"friction law {law.name!r}", law.parameters, rig.friction.parameters)
    step = 1.0 / rate
    drive = shaft.speed(np.arange(n, dtype=np.float64) * step)
    for active in effects:
        if active.effect.drive is not None:
            drive = active.effect.drive(drive, rate, active.form, active.values, rng)
    hooks = contact_hooks(effects, rng)
    torques = fit.critical_torque, fit.kinetic_torque
    if law.torque is None and not hooks:
        states, _, _ = solve_stick_slip(system.packed(), *torques, drive, step)
        speed = drive
    else:
        _refuse_fast(system, rig, fit.kinetic_torque, values, drive)
        coefficients = law.coefficients(values)
        states, _ = solve_contact(
            system.packed(), *torques, drive, step, law=law.torque, coefficients=coefficients,
            law_state=law.state(coefficients), hooks=hooks, name=_friction(law.name, effects),
            tolerance=tolerance or law.tolerance,
        )  # fmt: skip
        speed = states[:, 6]
    _refuse_overflow(states, system, rig, drive)
    return Motion(
        rate=rate,
        torque=states[:, 1],
        friction_torque=states[:, 0],
        shaft_angle=_integral(drive, step),
        shaft_speed=speed,
        interface_angle=states[:, 2],
        interface_speed=states[:, 3],
        clamp_angle=states[:, 4],
        clamp_speed=states[:, 5],
    )


def contact_hooks(effects: Sequence[ActiveEffect], rng: np.random.Generator) -> tuple[Hook, ...]:
    """List what acts on the contact, in the order of the effects."""
    acting = [active for active in effects if active.effect.contact is not None]
    if len(acting) > MOST_HOOKS:
        names = ", ".join(active.effect.name for active in acting)
        raise ParameterError(f"{names}: at most {MOST_HOOKS} effects can act on the contact")
    return tuple(_hook(active, rng) for active in acting)


def _hook(active: ActiveEffect, rng: np.random.Generator) -> Hook:
    effect = active.effect
    values = np.array(list(active.values.values()))
    if effect.pack is not None:
        values = effect.pack(active.form, active.values, rng)
    return Hook(effect.contact, values, effect.n_states)


def _friction(law: str, effects: Sequence[ActiveEffect]) -> str:
    names = [active.effect.name for active in effects if active.effect.contact is not None]
    return f"friction law {law!r}" + (f" with {', '.join(names)}" if names else "")


def _integral(speed: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    angle = np.zeros_like(speed)
    np.cumsum(0.5 * step * (speed[1:] + speed[:-1]), out=angle[1:])
    return angle


def _refuse_fast(
    system: LumpedBushing,
    rig: Rig,
    kinetic_torque: float,
    law: Mapping[str, float],
    drive: NDArray[np.float64],
) -> None:
    """Refuse what no bearable number of steps follows, by an estimate of the fastest rate."""
    contact = law.get("contact_stiffness_per_torque", 0.0)
    damping = system.elastomer_damping
    damping += law.get("contact_damping_per_torque", 0.0) * kinetic_torque
    sliding = float(np.abs(drive).max()) + _FASTEST_SLIP
    stiffness = contact * kinetic_torque + system.elastomer_stiffness
    rates = [
        math.sqrt(stiffness / system.elastomer_inertia),
        damping / system.elastomer_inertia,
        contact * sliding,
        sliding / law["renewal_angle"] if "renewal_angle" in law else 0.0,
    ]
    if not system.clamp_is_fixed:
        stiffness = system.elastomer_stiffness + system.support_stiffness
        rates += [
            math.sqrt(stiffness / system.clamp_inertia),
            (damping + system.support_damping) / system.clamp_inertia,
        ]
    fastest = max(rates)
    if fastest > _FASTEST_RATE:
        raise ParameterError(
            f"{_what(system, rig, drive)}: some part moves {fastest:.3g} times a second, which "
            f"no step of this solver follows; make it softer, heavier or less damped"
        )


def _refuse_overflow(
    states: NDArray[np.float64], system: LumpedBushing, rig: Rig, drive: NDArray[np.float64]
) -> None:
    if not np.isfinite(states[-1]).all():
        raise ParameterError(f"{_what(system, rig, drive)}: the motion grows without bound")


def _what(system: LumpedBushing, rig: Rig, drive: NDArray[np.float64]) -> str:
    return (
        f"with speeds up to {np.abs(drive).max():g} rad/s, friction {rig.friction}, inertia "
        f"{system.elastomer_inertia:g} and {system.clamp_inertia:g} kg m2, stiffness "
        f"{system.elastomer_stiffness:g} and {system.support_stiffness:g} Nm/rad, damping "
        f"{system.elastomer_damping:g} and {system.support_damping:g} Nm s/rad"
    )
