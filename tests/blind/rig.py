"""The second rig: two degrees of freedom, true stick, and whatever an effect hangs on to it.

A `Setup` is one run before it is made: the scalars, tables and modulations of the compiled loop,
all neutral, and lists of what happens to the signals behind it. Effects change a setup; `turn`
runs it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from . import contact, kernel

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Signals = dict[str, NDArray[np.float64]]

__all__ = ["FIXED", "STEP_RATE", "Parameters", "Setup", "Turned", "plain", "turn"]

FIXED = -1.0
"""Support stiffness of the clamp that is bolted down."""

STEP_RATE = 300e3
"""Steps per second, at least; in proportion more where the elastomer's mode is much faster."""

_SLOW_ENOUGH = 14e3
"""Of the elastomer's mode, for so many steps [rad/s]."""


@dataclass(frozen=True)
class Parameters:
    """The rig's own numbers at one fit and support, SI units."""

    elastomer_inertia: float = 1.0 / 65000.0
    clamp_inertia: float = 1.0 / 1200.0
    elastomer_stiffness: float = 665.0
    support_stiffness: float = 2214.0
    damping: float = 0.105
    critical_torque: float = 10.7
    kinetic_torque: float = 8.0


@dataclass
class Setup:
    """A run before it is made; `rate` is that of its signals, `settle` samples are dropped."""

    parameters: Parameters
    rate: float
    n: int
    settle: int
    p: NDArray[np.float64]
    omega: NDArray[np.float64]
    torque_gain: NDArray[np.float64]
    film_noise: NDArray[np.float64]
    stiffness_gain: NDArray[np.float64]
    weakening: NDArray[np.float64]
    ageing: NDArray[np.float64]
    scatter: NDArray[np.float64]
    creep: NDArray[np.float64]
    angle_gain: NDArray[np.float64]
    film: NDArray[np.float64]
    softening_by_heat: NDArray[np.float64]
    softening: NDArray[np.float64]
    heat: NDArray[np.float64]
    branches: NDArray[np.float64]
    friction: NDArray[np.float64]
    law: int = contact.TRUE_STICK
    contact: NDArray[np.float64] = field(default_factory=lambda: np.zeros(contact.N_CONTACT))
    structure: list[Callable[[Signals, Turned], None]] = field(default_factory=list)
    radiation: list[Callable[[Signals, Turned], None]] = field(default_factory=list)
    sensors: list[Callable[[Signals, Turned], None]] = field(default_factory=list)

    @property
    def time(self) -> NDArray[np.float64]:
        """Time of the samples of `omega` and of the modulations [s]."""
        return np.arange(self.n + 1) / self.rate

    @property
    def speed(self) -> float:
        """Mean speed of the shaft [rad/s]."""
        return float(self.omega.mean())

    @property
    def static_twist(self) -> float:
        """Where the support rests under the kinetic torque [rad]."""
        return self.parameters.kinetic_torque / max(self.parameters.support_stiffness, 1.0)


@dataclass(frozen=True, eq=False)
class Turned:
    """What a run gives, from rest on: `states` as the kernel's columns, slips as time and drop."""

    rate: float
    settle: int
    states: NDArray[np.float64]
    slips: NDArray[np.float64]

    @property
    def torque(self) -> NDArray[np.float64]:
        """Of the elastomer on the clamp, settled [Nm]."""
        return self.states[self.settle :, kernel.TORQUE]


def plain(
    parameters: Parameters, speed: float, *, rate: float, seconds: float, settling: float = 0.3
) -> Setup:
    """Return the plain rig at a constant speed."""
    settle = round(settling * rate)
    n = settle + round(seconds * rate)
    p = np.zeros(kernel.N_SCALARS)
    half = 0.5 * parameters.damping
    p[:8] = (
        parameters.elastomer_inertia, parameters.clamp_inertia, parameters.elastomer_stiffness,
        parameters.support_stiffness, half, half, parameters.critical_torque,
        parameters.kinetic_torque,
    )  # fmt: skip
    p[kernel.SHAFT_J] = 1.0

    def ones() -> NDArray[np.float64]:
        return np.ones(kernel.POINTS)

    return Setup(
        parameters, rate, n, settle, p,
        omega=np.full(n + 1, speed), torque_gain=np.ones(n + 1), film_noise=np.zeros(n + 1),
        stiffness_gain=np.ones(n + 1), weakening=ones(), ageing=ones(), scatter=np.ones(1),
        creep=0.0 * ones(), angle_gain=ones(), film=0.0 * ones(), softening_by_heat=ones(),
        softening=ones(), heat=np.zeros((0, 2)), branches=np.zeros((0, 3)),
        friction=np.zeros((0, 2)),
    )  # fmt: skip


def turn(setup: Setup, start: NDArray[np.float64] | None = None) -> Turned:
    """Run a setup; `start` holds x1, v1, a1, x2, v2, a2 and those of shaft's end and absorber."""
    p = setup.parameters
    fastest = np.sqrt(p.elastomer_stiffness / p.elastomer_inertia)
    steps = int(np.ceil(STEP_RATE * max(1.0, fastest / _SLOW_ENOUGH) / setup.rate))
    if start is None:
        start = np.zeros(12)
        start[1] = start[7] = setup.omega[0]
    result = np.empty((setup.n, kernel.N_COLUMNS))
    slips = np.empty((20_000, 2))
    n_slips = kernel.integrate(
        steps, 1.0 / (steps * setup.rate), setup.p, start, setup.omega, setup.torque_gain,
        setup.film_noise, setup.stiffness_gain, setup.weakening, setup.ageing, setup.scatter,
        setup.creep, setup.angle_gain, setup.film, setup.heat, setup.softening_by_heat,
        setup.branches, setup.friction, setup.softening, setup.law, setup.contact, result, slips,
    )  # fmt: skip
    return Turned(setup.rate, setup.settle, result, slips[:n_slips].copy())
