# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001
"""The compiled loop of a bar in its bushings: rates of the chain, steps, their errors, the outputs.

Each bushing is the lumped model as `sim.solvers.contact_rates` has it, with the bar at its place
for a shaft; what its surface takes is taken from the bar. Links load the bushings, and where that
lifts the bar off a part of one, its torques rise (`torque_gain`). Steps are those of
`sim.solvers.tsitouras`, as long as their error allows.

The state holds angle and speed of each inertia, then for each bushing what `contact_rates` works
on.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import float64, njit

from models.compilation import COMPILED, PART
from sim.contact import CRITICAL, KINETIC
from sim.solvers.contact_rates import N_STAGES, SHORTEST_STEP, contact_rates
from sim.solvers.tsitouras import ERROR, NODES, factor_of_step, fill_between, fill_stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FIRST_STEP = 1e-6
"""[s]"""

_LEAST_STEP = 1e-10
"""At which an error is accepted: something jumps [s]."""

_GRACE = 2e-3
"""Time that is granted before steps are counted [s]."""

_NEWTON_STEPS = 12


class Chain(NamedTuple):
    """The bar, as compiled code reads it: a `models.suspension.TorsionChain`."""

    mobility: NDArray[np.float64]
    """Reciprocals of the inertias [1/(kg m2)]."""
    stiffness: NDArray[np.float64]
    damping: NDArray[np.float64]
    link_stiffness: NDArray[np.float64]
    link_damping: NDArray[np.float64]
    travel: NDArray[np.float64]
    bushings: NDArray[np.int64]
    load: NDArray[np.float64]
    preload: NDArray[np.float64]
    """Contact pressure by interference times radius and length, of each bushing [N]."""
    torques: NDArray[np.float64]
    """Critical and kinetic torque of each bushing without load [Nm], shape (n_bushings, 2)."""


@njit(float64(float64), cache=True, error_model="numpy")
def torque_gain(load) -> float:
    r"""Torque of a loaded bushing over that without load [-].

    A radial load R presses the sleeve as p0 (1 + rho cos(phi)). As long as rho < 1 what one side
    gains the other loses, and the torque, which goes with the integral of the pressure, stays.
    Rubber that is not glued to the bar does not pull: beyond, only |phi| < phi0 touches, where
    cos(phi0) = -1 / rho, with

    .. math::
        R / (p_0 a L) &= 2 \sin\varphi_0 + \rho (\varphi_0 + \sin\varphi_0 \cos\varphi_0) \\
        T / T_0 &= (\varphi_0 + \rho \sin\varphi_0) / \pi

    an elastic foundation (Johnson, Contact Mechanics, 4.3) that touches in part. Limits: R up to
    pi p0 a L, T = T0; without interference the cosine pressure of a journal, T = 4 / pi mu R a.

    Parameters
    ----------
    load : float
        R / (p0 a L), of either sign [-].

    Examples
    --------
    >>> torque_gain(3.0), round(torque_gain(31.4), 3), round(torque_gain(-31.4), 3)
    (1.0, 6.466, 6.466)
    """
    load = abs(load)
    if not load > math.pi:
        return 1.0
    rho = load / math.pi
    for _ in range(_NEWTON_STEPS):  # from below, on a curve that bends downwards
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
    stage, since, i, time, u, k, chain, bushings, hooks, rows, drive, place, out
) -> None:
    """Fill the rates `k` of the state `u` at a stage; `out` gets friction, elastomer, load."""
    n = chain.mobility.size
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
        gain = torque_gain(out[b, 2] / chain.preload[b])
        bushing.system[8], bushing.system[9] = (
            gain * chain.torques[b, 0],
            gain * chain.torques[b, 1],
        )
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
        k[2 * j + 1, stage] *= chain.mobility[j]


@njit(**PART)
def _step_error(k, h, start, end, scale) -> float:
    """Largest error of a step over its scale [-]; a scale of 0 is what the variable itself is."""
    largest = 0.0
    for j in range(end.size):
        error = 0.0
        for b in range(N_STAGES):
            error += ERROR[b] * k[j, b]
        if not math.isfinite(error):
            return math.inf
        own = max(abs(start[j]), abs(end[j])) + h * abs(k[j, 0]) + 1e-300
        largest = max(largest, abs(h * error) / (scale[j] if scale[j] > 0.0 else own))
    return largest


@njit(cache=True, nogil=True, **COMPILED)
def run_suspension(
    chain, bushings, hooks, rows, drive, place, limits, start, scale, k, work, states, torques_now,
    torques,
) -> None:  # fmt: skip
    """Write states and torques at the samples of the drive; not a number where it is given up."""
    d, n, step = start.size, states.shape[0], drive.step
    u, following = work[0], work[1]
    last = n - 2
    t, h, sample, n_done, error_before = 0.0, _FIRST_STEP, 0, 0.0, 0.0
    _fill_rates(
        0, 0.0, 0, 0.0, start, k, chain, bushings, hooks, rows, drive, place,
        torques_now,
    )  # fmt: skip
    while sample < n:
        n_done += 1.0
        if n_done * SHORTEST_STEP > _GRACE + t:
            states[sample:] = math.nan
            return
        for stage in range(1, N_STAGES):
            fill_stage(u, start, k, stage, h)
            time = t + NODES[stage] * h
            i = min(int(time / step), last)
            _fill_rates(
                stage, time - i * step, i, time, u, k, chain, bushings, hooks,
                rows, drive, place, torques_now,
            )  # fmt: skip
        error = _step_error(k, h, start, u, scale) / limits.tolerance
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
                N_STAGES, (sample - i) * step, i, sample * step, u, k, chain, bushings, hooks,
                rows, drive, place, torques[sample],
            )  # fmt: skip
            sample += 1
        for j in range(d):
            start[j] = following[j]
            k[j, 0] = k[j, N_STAGES - 1]
        t, error_before = end, error
        h = min(h * factor, limits.longest)
