# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001
"""Simulation of a stabilizer bar in its two bushings: motion, loads and recording.

The drive is the travel of the wheels, expressed as the angle of an arm. Each bushing is the lumped
model of `sim.solvers.contact_rates`, whose shaft is the bar at its place; its friction torque acts
back on the bar. Links load the bushings, and where the load lifts the bar off a part of a bushing,
its torques rise (`torque_gain`). Only friction laws with an inner state are supported, since
constant torques would need event location at each contact. Steps are those of
`sim.solvers.tsitouras` with error control.

The torque of each bushing excites clamp, beams and plate as on the rig, at its own place on the
plate. Each bushing has an accelerometer, and one microphone records the sum. The brackets are
coupled through the bar only.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from models.compilation import PART
from models.errors import ParameterError
from models.recording import Channel, Recording
from models.suspension import Suspension, TorsionChain, torsion_chain
from sim.acquisition import Acquisition
from sim.analysis.regime import never_slips
from sim.bushing import lumped_bushing
from sim.contact import CRITICAL, KINETIC
from sim.effects.effect import Effect
from sim.friction import friction_law
from sim.motion import Motion, contact_hooks, unusual_values_first
from sim.parameters import resolve
from sim.plan import Plan, Setting, plan_run
from sim.run import record_motions
from sim.shaft import ShaftMotion, shaft_motion
from sim.solvers import contact_rates as at
from sim.solvers.contact_rates import contact_rates
from sim.solvers.contact_solver import LONGEST_STEP, contact_record, hooks_record, n_variables
from sim.solvers.tsitouras import ERROR, NODES, factor_of_step, fill_between, fill_stage

LONGEST_SUSPENSION_RUN = 20.0
"""Longest run [s], since the whole motion is in memory."""

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


@dataclass(frozen=True, eq=False)
class SuspensionMotion:
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


@dataclass(frozen=True, eq=False)
class SuspensionRun:
    """Result of a simulated run of a suspension.

    Parameters
    ----------
    recording : Recording
        ``torque``, ``acceleration`` and ``angle`` of the left bushing, ``torque_2`` and so on of
        the right one; ``pressure`` of both together.
    motion : SuspensionMotion
        Motion from rest at the rate of the computation.
    remarks : tuple of str
        Notes for the user, one line each.
    """

    recording: Recording
    motion: SuspensionMotion
    remarks: tuple[str, ...]


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
) -> SuspensionRun:
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
    SuspensionRun

    Raises
    ------
    ParameterError
        If a value cannot be used, or the run is too long.

    Examples
    --------
    >>> from models.suspension import load_suspension, suspension_file
    >>> from sim.shaft import Oscillation
    >>> run = run_suspension(load_suspension(suspension_file()), Oscillation(0.1, 2.0),
    ...     interference=0.279e-3, support_stiffness=2214.0, temperature=23.0, seconds=0.1,
    ...     acquisition=Acquisition(30e3))
    >>> run.recording.channel_names
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
    suspension = replace(suspension, rig=plan.rig)  # at the temperature
    motion = _simulated(suspension, plan, effect_rng)
    plate, (across, _) = plan.rig.plate, plan.rig.plate.clamp_position
    rigs = [
        replace(plan.rig, plate=replace(plate, clamp_position=(across, along)))
        for along in suspension.positions
    ]
    signals, _ = record_motions(plan, motion.bushings, rigs, acquisition, noise_rng, effect_rng)
    microphone = plan.rig.microphone.position
    recording = Recording(
        samples=np.stack(list(signals.values())),
        rate=acquisition.rate,
        channels=tuple(
            Channel(name, position=microphone if name == "pressure" else None) for name in signals
        ),
        condition=replace(plan.condition, speed=None),
    )
    return SuspensionRun(recording, motion, _remarks(suspension, motion, interference))


def _simulated(suspension: Suspension, plan: Plan, rng: np.random.Generator) -> SuspensionMotion:
    """Simulate bar and bushings from rest; raise if the bar's shear stress exceeds any strength."""
    bar, rate = suspension.bar, plan.rate
    speed = plan.shaft.speed(np.arange(plan.n_settling + plan.n_recorded) / rate)
    for active in plan.effects:
        speed = active.apply_drive(speed, rate, rng)
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
    with unusual_values_first(plan.rig):
        return solve_chain(chain, plan, speed, suspension.preload(plan.interference), rng)


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


def _remarks(
    suspension: Suspension, motion: SuspensionMotion, interference: float
) -> tuple[str, ...]:
    load, preload = float(np.abs(motion.load).max()), suspension.preload(interference)
    gain = torque_gain(load / preload)
    lifted = (
        f"lifts the bar off a part of it and raises its torque up to {gain:.3g} times"
        if gain > 1.0
        else "is carried by the contact pressure and leaves its torque as it is"
    )
    sleeve = suspension.rig.sleeve
    assert sleeve is not None  # checked by `Suspension`
    torque = suspension.rig.fit(interference).kinetic_torque
    coefficient = torque / (2.0 * np.pi * sleeve.inner_radius * preload)
    pressure = suspension.contact_pressure(interference)
    return (
        "torque, acceleration and angle are of the left bushing, those with _2 of the right "
        "one; the pressure is of both",
        f"the links load a bushing with up to {load:.0f} N, which {lifted}",
        f"the contact pressure is taken to be {pressure / 1e6:.3g} MPa, which with the "
        f"kinetic torque is a friction coefficient of {coefficient:.3g}; where "
        "that is not believed, friction_coefficient under [suspension] gives the pressure",
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
