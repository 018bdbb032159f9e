"""The motion of a stabilizer bar in its two bushings: friction law, effects and loads put together.

The drive is the travel of the wheels, as the angle that it asks of an arm. Bushings are the rig's,
each with a contact, an elastomer and a clamp of its own. Only friction laws with an inner state are
solved: they stick by themselves, where the constant torques of the thesis's own model would need to
be told apart at each contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.suspension import torsion_chain
from sim.bushing import lumped_bushing
from sim.effects import EFFECTS
from sim.effects.effect import activated
from sim.friction import friction_law
from sim.motion import Motion, blaming_the_unusual, contact_hooks, refuse_fast
from sim.parameters import resolve
from sim.solvers.contact_rates import (
    N_LAG,
    N_MOTION,
    N_STAGES,
    Drive,
    Limits,
    empty_rows,
)
from sim.solvers.contact_solver import (
    LONGEST_STEP,
    contact_record,
    hooks_record,
    n_variables,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from models.rig import Rig
    from models.suspension import Suspension, TorsionChain
    from sim.effects.effect import ActiveEffect
    from sim.shaft import ShaftMotion

_STRONGEST = 1e9
"""Shear stress that no spring steel bears: 1.7 GPa in tension, over the root of 3 [Pa]."""

_TURN_SHARE = 0.1
"""Of the law's tolerance: where the sliding turns is left to the error, not sought."""


@dataclass(frozen=True, eq=False)
class SuspensionMotion:
    """Motion of bar and bushings over time.

    Parameters
    ----------
    bushings : tuple of Motion
        Left and right; the shaft of each is the bar at its place.
    load : ndarray, shape (n_bushings, n)
        Normal force on each by the links [N].
    travel : ndarray, shape (n,)
        Of the wheels, as the angle asked of an arm [rad].
    angle, speed : ndarray, shape (n_inertias, n)
        Of the bar along its length [rad], [rad/s].
    """

    bushings: tuple[Motion, ...]
    load: NDArray[np.float64]
    travel: NDArray[np.float64]
    angle: NDArray[np.float64]
    speed: NDArray[np.float64]


def simulate_suspension(
    suspension: Suspension,
    travel: ShaftMotion,
    *,
    interference: float,
    support_stiffness: float,
    seconds: float,
    rate: float,
    effects: Sequence[ActiveEffect] | None = None,
    rng: np.random.Generator | None = None,
    tolerance: float | None = None,
) -> SuspensionMotion:
    """Simulate bar and bushings from rest.

    Parameters
    ----------
    suspension : Suspension
    travel : ShaftMotion
        Of the wheels: the speed that it asks of an arm [rad/s].
    interference, support_stiffness, seconds, rate, effects, rng, tolerance
        As for `sim.motion.simulate_motion`.

    Returns
    -------
    SuspensionMotion

    Raises
    ------
    ParameterError
        The friction law is one of constant torques, the rig does not say its sleeve, or the bar
        would be twisted beyond what it bears.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from models.suspension import Bar, Suspension
    >>> from sim.shaft import Oscillation
    >>> car = Suspension(load_material_rig("PDMS"), Bar(0.03, 0.004, 0.9, 0.2, 0.02), 0.4, 2e6,
    ...                  100.0, "opposite")
    >>> run = simulate_suspension(car, Oscillation(0.2, 2.0), interference=0.279e-3,
    ...                           support_stiffness=2214.0, seconds=0.05, rate=30e3)
    >>> len(run.bushings), run.load.shape
    (2, (2, 1500))
    """
    rig, bar = suspension.rig, suspension.bar
    rng = rng or np.random.default_rng(0)
    effects = activated(rig.effects, EFFECTS) if effects is None else effects
    n = round(seconds * rate)
    if not n >= 2:
        raise ParameterError(f"seconds = {seconds:g} at rate = {rate:g} Hz gives no samples")
    speed = travel.speed(np.arange(n) / rate)
    for active in effects:
        speed = active.driven(speed, rate, {"rng": rng, "whole": True})
    chain = torsion_chain(
        bar, suspension.spacing, suspension.link_stiffness, suspension.link_damping,
        suspension.wheels,
    )  # fmt: skip
    twist = abs(chain.travel[0] - chain.travel[-1]) * float(np.abs(_integral(speed, rate)).max())
    stress = 0.5 * bar.shear_modulus * bar.diameter * twist / bar.length
    if stress > _STRONGEST:
        raise ParameterError(
            f"suspension: the wheels' travel twists the bar by {math.degrees(twist):.3g} degrees, "
            f"a shear stress of {stress / 1e6:.0f} MPa where steel bears {_STRONGEST / 1e6:.0f}; "
            'let it swing less (--oscillate), or the wheels go together (wheels = "together")'
        )
    with blaming_the_unusual(rig):
        return solve_chain(
            chain, rig, speed, interference=interference, support_stiffness=support_stiffness,
            preload=suspension.preload(interference), rate=rate, effects=effects, rng=rng,
            tolerance=tolerance,
        )  # fmt: skip


def solve_chain(
    chain: TorsionChain,
    rig: Rig,
    speed: NDArray[np.float64],
    *,
    interference: float,
    support_stiffness: float,
    preload: float,
    rate: float,
    effects: Sequence[ActiveEffect],
    rng: np.random.Generator,
    tolerance: float | None,
) -> SuspensionMotion:
    """Solve a bar in any number of bushings.

    Parameters
    ----------
    chain : TorsionChain
    rig : Rig
        Of every bushing.
    speed : ndarray, shape (n,)
        Of the travel, linear between the samples [rad/s].
    interference, support_stiffness, rate, effects, rng, tolerance
        As of `simulate_suspension`.
    preload : float
        Contact pressure times radius and length of a bushing [N].

    Raises
    ------
    ParameterError
        The friction law is one of constant torques, or no steps follow the motion.
    """
    from sim.suspension.kernel import Chain, run_suspension

    law = friction_law(rig.friction.name)
    if law.torque is None:
        raise ParameterError(
            f"suspension: friction law {law.name!r} holds by constant torques, which are solved on "
            "the rig alone; take one with an inner state, such as lugre or contact_with_memory"
        )
    system, fit = lumped_bushing(rig, interference, support_stiffness), rig.fit(interference)
    values = resolve(f"friction law {law.name!r}", law.parameters, rig.friction.parameters)
    top = float(np.abs(speed).max())
    refuse_fast(system, rig, fit.kinetic_torque, values, top)
    rest, torque_limits = law.state(), (fit.critical_torque, fit.kinetic_torque)
    places = range(chain.bushings.size)
    hooks = [contact_hooks(effects, stream) for stream in rng.spawn(len(places))]
    first, block = 2 * chain.inertia.size, n_variables(rest, hooks[0])
    rows = tuple(empty_rows(block) for _ in places)
    bushings = tuple(
        contact_record(system.packed(), *torque_limits, law.torque, law.coefficients(values))
        for _ in places
    )
    n, start = speed.size, np.zeros(first + block * len(places))
    start[1:first:2] = chain.start * speed[0]
    # Errors of angles and speeds go with the twist at the critical torque, and what it releases.
    scale = np.zeros(start.size)
    twist = max(torque_limits) / system.elastomer_stiffness
    scales = twist, twist * math.sqrt(system.elastomer_stiffness / system.elastomer_inertia)
    scale[0:first:2], scale[1:first:2] = scales
    for b in places:
        begin = first + block * b
        start[begin + N_MOTION :][: rest.size] = rest
        scale[begin : begin + N_MOTION : 2] = scales[0]
        scale[begin + 1 : begin + N_MOTION : 2] = scales[1]
        if hooks[b]:
            scale[begin + block - N_LAG : begin + block] = scales
    states, torques = np.empty((n, start.size)), np.empty((n, len(places), 3))
    arguments = (
        Chain(
            1.0 / chain.inertia, chain.stiffness, chain.damping, chain.link_stiffness,
            chain.link_damping, chain.travel, chain.bushings, chain.load,
            np.full(len(places), preload), np.tile(torque_limits, (len(places), 1)),
        ),
        bushings,
        tuple(hooks_record(own, row, rest.size) for own, row in zip(hooks, rows, strict=True)),
        rows,
        Drive(1.0 / rate, speed, _slope(speed, rate), _integral(speed, rate)),
        Drive(1.0, np.zeros(1), np.zeros(1), np.zeros(1)),
        Limits(LONGEST_STEP, tolerance or _TURN_SHARE * law.tolerance),
        start, scale, np.zeros((start.size, N_STAGES + 1)), np.empty((2, start.size)), states,
        np.empty((len(places), 3)), torques,
    )  # fmt: skip
    run_suspension(*arguments)
    if not np.isfinite(states[-1]).all():
        raise ParameterError(
            "suspension: the motion cannot be followed; make links, bar or contact softer or "
            "heavier, or the swing smaller"
        )
    columns = states.T
    angle, turning = columns[0:first:2], columns[1:first:2]
    return SuspensionMotion(
        bushings=tuple(
            Motion(
                rate, torques[:, b, 1], torques[:, b, 0], angle[node], turning[node],
                *columns[first + block * b : first + block * b + 4],
            )
            for b, node in enumerate(chain.bushings)
        ),
        load=torques[:, :, 2].T,
        travel=_integral(speed, rate),
        angle=angle,
        speed=turning,
    )  # fmt: skip


def _slope(speed: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    return np.append(np.diff(speed) * rate, 0.0)


def _integral(speed: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    steps = 0.5 * (speed[1:] + speed[:-1]) / rate
    return np.concatenate([[0.0], np.cumsum(steps)])
