"""Motion of shaft, bushing and clamp at one operating condition: the core of the simulator."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.rig import Rig
from models.show import short_repr
from sim.bushing import lumped_bushing
from sim.effects import EFFECTS
from sim.effects.effect import ActiveEffect, activated
from sim.friction import friction_law
from sim.parameters import resolve
from sim.shaft import ShaftMotion
from sim.solvers.contact_solver import LONGEST_STEP, N_MOTION, ContactRun, Hook
from sim.solvers.stick_slip import DIRECTION, advance_stick_slip, rest_state

STICK_SPEED_SHARE = 0.05
"""The contact counts as stuck while it slides slower than this share of the shaft's speed."""


@short_repr
@dataclass(frozen=True, eq=False)
class Motion:
    """Motion and torques over time, sampled at `rate`.

    Parameters
    ----------
    rate : float
        [Hz]
    torque : ndarray, shape (n,)
        Torque of the bushing on the clamp, T_E [Nm]; the thesis plots it, and the torque cell is
        assumed to read it.
    friction_torque : ndarray, shape (n,)
        Torque in the contact [Nm]; it differs from `torque` by the inertia torque of the elastomer.
    shaft_angle, shaft_speed : ndarray, shape (n,)
        [rad], [rad/s]
    interface_angle, interface_speed : ndarray, shape (n,)
        Angle and speed of the bushing's surface [rad], [rad/s].
    clamp_angle, clamp_speed : ndarray, shape (n,)
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
        """Sliding speed of the shaft over the bushing's surface [rad/s], shape (n,)."""
        return self.shaft_speed - self.interface_speed

    def part(self, start: int, stop: int | None = None) -> Motion:
        """Return the motion from sample `start` to before `stop`, by default to its end."""
        return Motion(self.rate, *(values[start:stop] for values in self.arrays))

    def followed_by(self, *later: Motion) -> Motion:
        """Return the motion joined with the motions that follow it."""
        parts = zip(self.arrays, *(one.arrays for one in later), strict=True)
        return Motion(self.rate, *(np.concatenate(part) for part in parts))

    @property
    def arrays(self) -> list[NDArray[np.float64]]:
        """All signals in the order of the fields, each of shape (n,)."""
        return [getattr(self, field.name) for field in fields(self) if field.name != "rate"]

    @property
    def stuck(self) -> NDArray[np.bool_]:
        """Whether the contact sticks: it slides slower than a share of the shaft's speed."""
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
    effects: Sequence[ActiveEffect] | None = None,
    rng: np.random.Generator | None = None,
    tolerance: float | None = None,
) -> Motion:
    """Simulate the motion of a rig from rest.

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
        Rate of the output [Hz]. At constant and ramped speed the solution does not depend on it;
        other motions of the shaft are taken as linear between samples, which shifts events by some
        5e-9 s at 30 kHz, in proportion to the square of the step.
    effects : sequence of ActiveEffect, optional
        Active effects, of which those on drive and friction act, in this order; by default the
        rig's, from `sim.effects`.
    rng : numpy.random.Generator, optional
        Generator of effects that scatter; by default seeded with 0.
    tolerance : float, optional
        Error of a step where the motion has no exact solution [-]; by default that of the friction
        law, which is smaller than regimes and spectra need.

    Returns
    -------
    Motion

    Raises
    ------
    ParameterError
        If a value cannot be used, or the friction law's parameters are out of range.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
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
    drive = shaft.speed(np.arange(n, dtype=np.float64) * (1.0 / rate))
    effects = activated(rig.effects, EFFECTS) if effects is None else effects
    for active in effects:
        drive = active.apply_drive(drive, rate, rng)
    solver = MotionSolver(
        rig, interference, support_stiffness, rate, effects, rng,
        start_speed=float(drive[0]), tolerance=tolerance,
    )  # fmt: skip
    return solver.advance(drive, n)


def lookahead_samples(rate: float) -> int:
    """Return the number of samples by which a solver step may reach beyond a block.

    Parameters
    ----------
    rate : float
        [Hz]

    Examples
    --------
    >>> lookahead_samples(30e3)
    4
    """
    return math.ceil(LONGEST_STEP / (1.0 / rate)) + 1


class MotionSolver:
    """Block-wise solver of the rig's motion from rest.

    Parameters
    ----------
    rig, interference, support_stiffness, rate, effects, rng, tolerance
        As for `simulate_motion`; effects on the drive are already applied.
    start_speed : float
        Speed of the drive at the start [rad/s].
    """

    def __init__(
        self,
        rig: Rig,
        interference: float,
        support_stiffness: float,
        rate: float,
        effects: Sequence[ActiveEffect],
        rng: np.random.Generator,
        *,
        start_speed: float,
        tolerance: float | None,
    ) -> None:
        self._rig, self._rate, self._step = rig, rate, 1.0 / rate
        self._system = lumped_bushing(rig, interference, support_stiffness)
        self._packed = self._system.packed()
        fit = rig.fit(interference)
        self._torques = fit.critical_torque, fit.kinetic_torque
        law = friction_law(rig.friction.name)
        values = resolve(f"friction law {law.name!r}", law.parameters, rig.friction.parameters)
        hooks = contact_hooks(effects, rng)
        self._angle = 0.0
        self._state = rest_state(start_speed)
        self._contact: ContactRun | None = None
        if law.torque is not None or hooks:
            self._contact = ContactRun(
                self._packed, *self._torques, start_speed, self._step, law=law.torque,
                coefficients=law.coefficients(values), law_state=law.state(), hooks=hooks,
                name=_friction(law.name, effects), tolerance=tolerance or law.tolerance,
            )  # fmt: skip

    def continue_from(self, before: MotionSolver, shaft_speed: float) -> None:
        """Start from the current state of another solver, at a speed of the shaft [rad/s].

        The motion and the inner states that both have continue; the forces may jump.
        """
        self._angle = before._angle
        if self._contact is None:
            if before._contact is None:
                self._state[:] = before._state
                return
            motion, direction = before._contact.motion(shaft_speed)
            self._state[:] = rest_state(shaft_speed)
            self._state[: motion.size], self._state[DIRECTION] = motion, direction
        elif before._contact is None:
            motion = before._state[:N_MOTION].copy()
            self._contact.start_from(motion, before._state[DIRECTION], before._angle)
        else:
            self._contact.continue_from(before._contact, shaft_speed)
        if self._system.clamp_is_fixed:
            state = self._state if self._contact is None else self._contact.end_state
            state[3] = 0.0  # speed of the clamp

    def advance(self, drive: NDArray[np.float64], n: int) -> Motion:
        """Solve the next `n` samples.

        `drive`, shape (m,) [rad/s], reaches beyond them unless the run ends.
        """
        if self._contact is None:
            states, _, _ = advance_stick_slip(
                self._packed, *self._torques, drive[: n + 1], self._step, self._state, n
            )
            speed = drive[:n]
        else:
            states, _ = self._contact.advance(drive, n)
            speed = states[:, 6]
        if not np.isfinite(states[-1]).all():
            raise ParameterError(
                f"with friction {self._rig.friction} the motion grows without bound; make parts "
                "softer, heavier or less damped"
            )
        angles = self._angle + _integral(drive[: n + 1], self._step)
        self._angle = float(angles[-1])
        return Motion(
            rate=self._rate,
            torque=states[:, 1],
            friction_torque=states[:, 0],
            shaft_angle=angles[:n],
            shaft_speed=speed,
            interface_angle=states[:, 2],
            interface_speed=states[:, 3],
            clamp_angle=states[:, 4],
            clamp_speed=states[:, 5],
        )


def _integral(speed: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    angle = np.zeros_like(speed)
    np.cumsum(0.5 * step * (speed[1:] + speed[:-1]), out=angle[1:])
    return angle


def contact_hooks(effects: Sequence[ActiveEffect], rng: np.random.Generator) -> tuple[Hook, ...]:
    """Return the compiled functions of the effects on the contact, in their order."""
    return tuple(
        Hook(active.effect.contact, active.packed(rng), active.effect.n_states)
        for active in effects
        if active.effect.contact is not None
    )


def _friction(law: str, effects: Sequence[ActiveEffect]) -> str:
    names = [active.effect.name for active in effects if active.effect.contact is not None]
    return f"friction law {law!r}" + (f" with {', '.join(names)}" if names else "")
