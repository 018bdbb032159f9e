# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001
r"""Stabilizer bar in two bushings, with its links: the car's model of Recommendation 7.

The bar turns in two bushings on the body; an arm at each end is linked to a wheel. In torsion it is
a chain of inertias and springs,

.. math::
    k = G J / l, \qquad J_i = \rho J l, \qquad J = \pi (d^4 - d_i^4) / 32

for each piece of length l, with an arm's inertia at either end, where the link exerts the force k_L
(s - r theta) on the arm r; s is the travel of the wheel, expressed as the angle s / r of the arm.

Links also load the bar in bending. By the statics of a beam of length B on two supports of spacing
w, with forces F_l and F_r at its ends, the left bushing carries F_l (1/2 + B / 2w) +
F_r (1/2 - B / 2w), so wheels in opposite directions load a bushing with B / w times the force of a
link. Where the load lifts the bar off a part of a bushing, its torques rise (`torque_gain`).

Each bushing is the lumped model of `sim.solvers.contact_solver`, whose shaft is the bar at its
place; its friction torque acts back on the bar. Only friction laws with an inner state are
supported, since constant torques would need event location at each contact. Steps are those of
`sim.solvers.tsitouras` with error control.

The torque of each bushing excites clamp, beams and plate as on the rig, at its own place on the
plate. Each bushing has an accelerometer, and one microphone records the sum. The brackets are
coupled through the bar only.

Limits: wheels that move together do not twist the bar, which is then the rig twice.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.compilation import PART
from models.errors import ParameterError
from models.recording import Channel, Recording
from models.suspension import WHEELS, Suspension
from sim.acquisition import Acquisition
from sim.analysis.regime import never_slips
from sim.bushing import lumped_bushing
from sim.contact import CRITICAL, KINETIC
from sim.effects.effect import Effect
from sim.friction import friction_law
from sim.motion import Motion, contact_hooks
from sim.parameters import resolve
from sim.plan import Plan, Setting, plan_run
from sim.run import record_motions
from sim.shaft import ShaftMotion, shaft_motion
from sim.solvers import contact_solver as at
from sim.solvers.contact_solver import (
    LONGEST_STEP,
    contact_rates,
    contact_record,
    hooks_record,
    n_variables,
)
from sim.solvers.tsitouras import ERROR, NODES, factor_of_step, fill_between, fill_stage

LONGEST_SUSPENSION_RUN = 20.0
"""Longest run [s], since the whole motion is in memory."""

_PIECES = 12
"""Approximate number of pieces of the bar; its first mode between fixed arms is then 0.3 % low."""

_STRONGEST = 1e9
"""Shear strength beyond that of any spring steel: 1.7 GPa in tension over sqrt(3) [Pa]."""

_TURN_SHARE = 0.1
"""Share of the law's tolerance, since reversals of sliding are left to the error control."""

_FIRST_STEP = 1e-6
"""First step [s]."""

_LEAST_STEP = 1e-10
"""Step at which any error is accepted, since something jumps [s]."""

_GRACE = 2e-3
"""Time at the start that does not count towards the average step [s]."""

_NEWTON_STEPS = 12


class TorsionChain(NamedTuple):
    """Bar in torsion as a chain of inertias with springs between them and links to the travel.

    Parameters
    ----------
    inertia : ndarray, shape (n,)
        [kg m2]; an infinite inertia keeps its speed.
    stiffness, damping : ndarray, shape (n - 1,)
        Between neighbours [Nm/rad], [Nm s/rad].
    link_stiffness, link_damping : ndarray, shape (n,)
        Between the travel and each inertia [Nm/rad], [Nm s/rad].
    travel, start : ndarray, shape (n,)
        Travel at each inertia, and its initial speed, over those of the drive [-].
    bushings : ndarray of int, shape (n_bushings,)
        Inertias at the bushings.
    load : ndarray, shape (n_bushings, n)
        Normal force on each bushing per torque of each link [N/Nm].
    """

    inertia: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    damping: NDArray[np.float64]
    link_stiffness: NDArray[np.float64]
    link_damping: NDArray[np.float64]
    travel: NDArray[np.float64]
    start: NDArray[np.float64]
    bushings: NDArray[np.int64]
    load: NDArray[np.float64]


def torsion_chain(car: Suspension) -> TorsionChain:
    """Return the torsion chain of a suspension, from the left arm to the right one.

    Examples
    --------
    >>> from models.suspension import SHIPPED, load_suspension
    >>> chain = torsion_chain(load_suspension(SHIPPED))
    >>> chain.bushings, chain.load[:, [0, -1]].round(3)
    (array([ 2, 10]), array([[ 5., -1.],
           [-1.,  5.]]))
    """
    length, spacing = car.bar_length, car.spacing
    overhang = 0.5 * (length - spacing)
    spans = (overhang, spacing, overhang)
    counts = [max(1, round(_PIECES * span / length)) for span in spans]
    lengths = np.repeat([s / n for s, n in zip(spans, counts, strict=True)], counts)
    polar_moment = (
        math.pi / 32.0 * (car.bar_diameter**4 - (car.bar_diameter - 2.0 * car.bar_wall) ** 4)
    )
    stiffness = car.shear_modulus * polar_moment / lengths
    inertia = np.zeros(lengths.size + 1)
    inertia[:-1] += 0.5 * car.density * polar_moment * lengths
    inertia[1:] += 0.5 * car.density * polar_moment * lengths
    inertia[[0, -1]] += car.arm_inertia
    # Stiffness-proportional: 2 zeta / omega of the bar's own first mode, sqrt(G / rho) pi / length.
    first = math.pi / length * math.sqrt(car.shear_modulus / car.density)
    ends, travel = np.zeros((2, inertia.size))
    ends[[0, -1]] = car.arm_length**2
    travel[[0, -1]] = left, right = WHEELS[car.wheels]
    place = np.concatenate([[0.0], np.cumsum(lengths)]) / length
    lever = 0.5 * length / spacing
    load = np.zeros((2, inertia.size))
    load[:, 0] = 0.5 + lever, 0.5 - lever
    load[:, -1] = 0.5 - lever, 0.5 + lever
    return TorsionChain(
        inertia=inertia,
        stiffness=stiffness,
        damping=2.0 * car.damping_ratio / first * stiffness,
        link_stiffness=car.link_stiffness * ends,
        link_damping=car.link_damping * ends,
        travel=travel,
        start=left + (right - left) * place,
        bushings=np.array([counts[0], counts[0] + counts[1]]),
        load=load / car.arm_length,
    )


class SuspensionMotion(NamedTuple):
    """Motion of bar and bushings over time.

    Parameters
    ----------
    bushings : tuple of Motion
        Left and right bushing; the shaft of each is the bar at its place.
    load : ndarray, shape (n_bushings, n)
        Normal force of the links on each bushing [N].
    angle : ndarray, shape (n_inertias, n)
        Angle of the bar along its length [rad].
    """

    bushings: tuple[Motion, ...]
    load: NDArray[np.float64]
    angle: NDArray[np.float64]


def run_suspension(
    suspension: Suspension,
    shaft: ShaftMotion | float,
    *,
    interference: float,
    support_stiffness: float,
    temperature: float,
    seconds: float,
    acquisition: Acquisition,
    library: Mapping[str, Effect] | None = None,
    rng: np.random.Generator | None = None,
) -> Recording:
    """Simulate one run of a suspension.

    Parameters
    ----------
    suspension : Suspension
    shaft : ShaftMotion or float
        Travel of the wheels, as the speed of an arm [rad/s].
    interference, support_stiffness, temperature, seconds, acquisition, library, rng
        As for `sim.run.simulate`.

    Returns
    -------
    Recording
        ``torque``, ``acceleration`` and ``angle`` of the left bushing, ``torque_2`` and so on of
        the right one; ``pressure`` of both together. Its notes are for the user.

    Raises
    ------
    ParameterError
        If a value cannot be used, or the run is too long.

    Examples
    --------
    >>> from models.suspension import SHIPPED, load_suspension
    >>> from sim.shaft import Oscillation
    >>> run = run_suspension(load_suspension(SHIPPED), Oscillation(0.1, 2.0), interference=0.279e-3,
    ...     support_stiffness=2214.0, temperature=23.0, seconds=0.1, acquisition=Acquisition(30e3))
    >>> run.channel_names
    ('torque', 'acceleration', 'pressure', 'angle', 'torque_2', 'acceleration_2', 'angle_2')
    """
    if seconds > LONGEST_SUSPENSION_RUN:
        raise ParameterError(
            f"suspension: --seconds {seconds:g} is too long, since the whole run is held in "
            f"memory; give {LONGEST_SUSPENSION_RUN:g} or less"
        )
    acquisition = acquisition.over(suspension.rig.sensors)
    noise_rng, effect_rng = (rng or np.random.default_rng(0)).spawn(2)
    drive = shaft_motion(shaft)
    setting = Setting(suspension.rig, drive, interference, support_stiffness, temperature)
    plan = plan_run(setting, seconds=seconds, rate=acquisition.rate, library=library)
    speed = plan.shaft.speed(np.arange(plan.n_settling + plan.n_recorded) / plan.rate)
    for active in plan.effects:
        speed = active.apply_drive(speed, plan.rate, effect_rng)
    chain, preload = torsion_chain(suspension), suspension.preload(interference)
    _refuse_twist(suspension, chain, speed, plan.rate)
    motion = solve_chain(chain, plan, speed, preload, effect_rng)
    plate, (across, _) = plan.rig.plate, plan.rig.plate.clamp_position
    rigs = [
        replace(plan.rig, plate=replace(plate, clamp_position=(across, along)))
        for along in (-0.5 * suspension.spacing, 0.5 * suspension.spacing)
    ]
    signals, _ = record_motions(plan, motion.bushings, rigs, acquisition, noise_rng, effect_rng)
    microphone = plan.rig.microphone.position
    return Recording(
        samples=np.stack(list(signals.values())),
        rate=acquisition.rate,
        channels=tuple(
            Channel(name, position=microphone if name == "pressure" else None) for name in signals
        ),
        condition=replace(plan.condition, speed=None),
        notes=_notes(motion, preload),
    )


def _refuse_twist(
    car: Suspension, chain: TorsionChain, speed: NDArray[np.float64], rate: float
) -> None:
    """Raise if the bar's shear stress exceeds any strength."""
    twist = abs(chain.travel[0] - chain.travel[-1]) * float(np.abs(_integral(speed, rate)).max())
    stress = 0.5 * car.shear_modulus * car.bar_diameter * twist / car.bar_length
    if stress > _STRONGEST:
        raise ParameterError(
            f"suspension: the wheels' travel twists the bar by {math.degrees(twist):.3g} degrees, "
            f"a shear stress of {stress / 1e6:.0f} MPa where steel bears {_STRONGEST / 1e6:.0f}; "
            'let it swing less (--oscillate), or the wheels go together (wheels = "together")'
        )


def solve_chain(
    chain: TorsionChain,
    plan: Plan,
    speed: NDArray[np.float64],
    preload: float,
    rng: np.random.Generator,
    tolerance: float | None = None,
) -> SuspensionMotion:
    """Solve the motion of a bar in any number of bushings.

    Parameters
    ----------
    chain : TorsionChain
    plan : Plan
        Plan of the run; all bushings are those of its rig.
    speed : ndarray, shape (n,)
        Speed of the travel, linear between the samples [rad/s].
    preload : float
        Contact pressure times radius and length of a bushing [N].
    rng : numpy.random.Generator
        Generator of effects that scatter, independently for each bushing.
    tolerance : float, optional
        Error of a step [-]; by default a share of that of the friction law.

    Raises
    ------
    ParameterError
        The friction law has constant torques, or no steps can follow the motion.
    """
    rig, rate = plan.rig, plan.rate
    law = friction_law(rig.friction.name)
    if law.torque is None:
        raise ParameterError(
            f"suspension: friction law {law.name!r} holds by constant torques, which are solved on "
            "the rig alone; take one with an inner state, such as lugre or contact_with_memory"
        )
    system = lumped_bushing(rig, plan.interference, plan.support_stiffness)
    fit = rig.fit(plan.interference)
    values = resolve(f"friction law {law.name!r}", law.parameters, rig.friction.parameters)
    rest, torque_limits = law.state(), (fit.critical_torque, fit.kinetic_torque)
    places = range(chain.bushings.size)
    hooks = [contact_hooks(plan.effects, stream) for stream in rng.spawn(len(places))]
    first, block = 2 * chain.inertia.size, n_variables(rest, hooks[0])
    rows = tuple(at.empty_rows(block) for _ in places)
    bushings = tuple(
        contact_record(system.packed(), *torque_limits, law.torque, law.coefficients(values))
        for _ in places
    )
    n, start = speed.size, np.zeros(first + block * len(places))
    start[1:first:2] = chain.start * speed[0]
    # Scales of angles and speeds: the twist at the critical torque, and the speed it releases.
    scale = np.zeros(start.size)
    twist = max(torque_limits) / system.elastomer_stiffness
    scales = twist, twist * math.sqrt(system.elastomer_stiffness / system.elastomer_inertia)
    scale[0:first:2], scale[1:first:2] = scales
    for b in places:
        begin = first + block * b
        start[begin + at.N_MOTION :][: rest.size] = rest
        scale[begin : begin + at.N_MOTION : 2] = scales[0]
        scale[begin + 1 : begin + at.N_MOTION : 2] = scales[1]
        if hooks[b]:
            scale[begin + block - at.N_LAG : begin + block] = scales
    states, torques = np.empty((n, start.size)), np.empty((n, len(places), 3))
    slope = np.append(np.diff(speed) * rate, 0.0)
    compiled: Any = _solve
    compiled(
        chain, bushings,
        tuple(hooks_record(own, row, rest.size) for own, row in zip(hooks, rows, strict=True)),
        rows,
        at.Drive(1.0 / rate, speed, slope, _integral(speed, rate)),
        at.Drive(1.0, np.zeros(1), np.zeros(1), np.zeros(1)),
        at.Limits(LONGEST_STEP, tolerance or _TURN_SHARE * law.tolerance), preload, torque_limits,
        start, scale, states, torques,
    )  # fmt: skip
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
        angle=angle,
    )  # fmt: skip


def _notes(motion: SuspensionMotion, preload: float) -> tuple[str, ...]:
    load = float(np.abs(motion.load).max())
    gain = torque_gain(load / preload)
    lifted = (
        f"lifts the bar off a part of it and raises its torque up to {gain:.3g} times"
        if gain > 1.0
        else "is carried by the contact pressure and leaves its torque as it is"
    )
    return (
        "torque, acceleration and angle are of the left bushing, those with _2 of the right "
        "one; the pressure is of both",
        f"the links load a bushing with up to {load:.0f} N, which {lifted}",
        *(
            f"{side} bushing: its contact holds from first to last"
            for side, own in zip(("left", "right"), motion.bushings, strict=True)
            if never_slips(own)
        ),
    )


def _integral(speed: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    steps = 0.5 * (speed[1:] + speed[:-1]) / rate
    return np.concatenate([[0.0], np.cumsum(steps)])


@njit(cache=True, error_model="numpy")
def torque_gain(load) -> float:
    r"""Return the torque of a loaded bushing over that without load [-].

    A radial load R changes the pressure to p0 (1 + rho cos(phi)). For rho < 1 the increase on one
    side balances the decrease on the other, so the torque, which is proportional to the integral of
    the pressure, does not change. Rubber that is not bonded to the bar cannot pull: for rho > 1
    only |phi| < phi0 touches, where cos(phi0) = -1 / rho, with

    .. math::
        R / (p_0 a L) &= 2 \sin\varphi_0 + \rho (\varphi_0 + \sin\varphi_0 \cos\varphi_0) \\
        T / T_0 &= (\varphi_0 + \rho \sin\varphi_0) / \pi

    an elastic foundation (Johnson, Contact Mechanics, 4.3) in partial contact. Limits: T = T0 for R
    up to pi p0 a L; T = 4 / pi mu R a without interference, the cosine pressure of a journal.

    Parameters
    ----------
    load : float
        R / (p0 a L), signed [-].

    Examples
    --------
    >>> torque_gain(3.0), round(torque_gain(31.4), 3), round(torque_gain(-31.4), 3)
    (1.0, 6.466, 6.466)
    """
    load = abs(load)
    if not load > math.pi:
        return 1.0
    rho = load / math.pi
    for _ in range(_NEWTON_STEPS):  # monotone from below, since the curve is concave
        cosine = -1.0 / rho
        sine = math.sqrt(1.0 - cosine * cosine)
        angle = math.acos(cosine)
        slope = angle + sine * cosine
        step = (load - 2.0 * sine - rho * slope) / slope
        rho += step
        if abs(step) < 1e-14 * rho:
            break
    cosine = -1.0 / rho
    return (math.acos(cosine) + rho * math.sqrt(1.0 - cosine * cosine)) / math.pi


@njit(**PART)
def _fill_rates(
    stage, since, i, time, u, k, chain, bushings, hooks, rows, drive, place, preload, limits, out
) -> None:
    """Fill the rates `k` of the state `u` at a stage, and friction, elastomer and load in `out`."""
    n = chain.inertia.size
    wheel = drive.speed[i] + drive.slope[i] * since
    angle = drive.angle[i] + since * (drive.speed[i] + 0.5 * drive.slope[i] * since)
    for j in range(n):
        k[2 * j, stage] = u[2 * j + 1]
        k[2 * j + 1, stage] = 0.0
    for b in range(chain.bushings.size):
        out[b, 2] = 0.0
    for j in range(n):
        if chain.link_stiffness[j] == 0.0 and chain.link_damping[j] == 0.0:
            continue
        link = chain.link_stiffness[j] * (chain.travel[j] * angle - u[2 * j])
        link += chain.link_damping[j] * (chain.travel[j] * wheel - u[2 * j + 1])
        k[2 * j + 1, stage] += link
        for b in range(chain.bushings.size):
            out[b, 2] += chain.load[b, j] * link
    for j in range(n - 1):
        torque = chain.stiffness[j] * (u[2 * j + 2] - u[2 * j])
        torque += chain.damping[j] * (u[2 * j + 3] - u[2 * j + 1])
        k[2 * j + 1, stage] += torque
        k[2 * j + 3, stage] -= torque
    first = 2 * n
    for b in range(chain.bushings.size):
        node, row, bushing = chain.bushings[b], rows[b], bushings[b]
        for j in range(row.state.size):
            row.state[j] = u[first + j]
        gain = torque_gain(out[b, 2] / preload)
        bushing.system[8], bushing.system[9] = gain * limits[0], gain * limits[1]
        bushing.contact[CRITICAL], bushing.contact[KINETIC] = bushing.system[8], bushing.system[9]
        place.speed[0], place.angle[0] = u[2 * node + 1], u[2 * node]
        friction, elastomer, _, _, _, _ = contact_rates(
            stage, 0.0, 0, time, time, 0, bushing, hooks[b], place, row
        )
        k[2 * node + 1, stage] -= friction
        out[b, 0], out[b, 1] = friction, elastomer
        for j in range(row.state.size):
            k[first + j, stage] = row.stages[j, stage]
        first += row.state.size
    for j in range(n):
        k[2 * j + 1, stage] *= 1.0 / chain.inertia[j]


@njit(**PART)
def _step_error(k, h, start, end, scale) -> float:
    """Return the largest error of a step over its scale [-]; 0 stands for the variable's size."""
    largest = 0.0
    for j in range(end.size):
        error = 0.0
        for b in range(at.N_STAGES):
            error += ERROR[b] * k[j, b]
        if not math.isfinite(error):
            return math.inf
        own = max(abs(start[j]), abs(end[j])) + h * abs(k[j, 0]) + 1e-300
        largest = max(largest, abs(h * error) / (scale[j] if scale[j] > 0.0 else own))
    return largest


@njit(cache=True, nogil=True, error_model="numpy")
def _solve(
    chain, bushings, hooks, rows, drive, place, steps, preload, limits, start, scale, states,
    torques,
) -> None:  # fmt: skip
    """Fill states and torques at the samples of the drive; NaN where the solution is aborted."""
    d, n, step = start.size, states.shape[0], drive.step
    k, u, following = np.zeros((d, at.N_STAGES + 1)), np.empty(d), np.empty(d)
    torques_now = np.empty((len(bushings), 3))
    last = n - 2
    t, h, sample, n_steps, error_before = 0.0, _FIRST_STEP, 0, 0.0, 0.0
    # `int64`, since a function is compiled once more for a literal.
    _fill_rates(
        np.int64(0), 0.0, np.int64(0), 0.0, start, k, chain, bushings, hooks, rows, drive, place,
        preload, limits, torques_now,
    )  # fmt: skip
    while sample < n:
        n_steps += 1.0
        if n_steps * at.SHORTEST_STEP > _GRACE + t:
            states[sample:] = math.nan
            return
        for stage in range(1, at.N_STAGES):
            fill_stage(u, start, k, stage, h)
            time = t + NODES[stage] * h
            i = min(int(time / step), last)
            _fill_rates(
                stage, time - i * step, i, time, u, k, chain, bushings, hooks,
                rows, drive, place, preload, limits, torques_now,
            )  # fmt: skip
        error = _step_error(k, h, start, u, scale) / steps.tolerance
        factor = factor_of_step(error, error_before)
        if error > 1.0 and h > _LEAST_STEP:
            h *= factor
            continue
        if not math.isfinite(error):
            states[sample:] = math.nan
            return
        end = t + h
        for j in range(d):
            following[j] = u[j]
        while sample < n and sample * step <= end:
            fill_between(u, start, k, rows[0].weights, (sample * step - t) / h, h)
            for j in range(d):
                states[sample, j] = u[j]
            i = min(sample, last)
            _fill_rates(
                np.int64(at.N_STAGES), (sample - i) * step, i, sample * step, u, k, chain, bushings,
                hooks, rows, drive, place, preload, limits, torques[sample],
            )  # fmt: skip
            sample += 1
        for j in range(d):
            start[j] = following[j]
            k[j, 0] = k[j, at.N_STAGES - 1]
        t, error_before = end, error
        h = min(h * factor, steps.longest)
