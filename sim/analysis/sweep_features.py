# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls
# mypy: allow-untyped-decorators, no-warn-return-any
# ruff: noqa: ANN001
"""Features that a sweep keeps of each run: a few numbers, so that thousands of runs need no memory.

The plain model is solved in blocks that stay in the processor's cache; its slips and sticks are
the solver's own. Elsewhere a run is in stick as `sim.motion.Motion.stuck` defines it, and slips are
those that its torque shows (`sim.analysis.slips`): a contact that creeps stutters. With true stick
the two are the same.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from sim.analysis.slips import motion_slips
from sim.solvers.stick_slip_kernel import (
    DIRECTION,
    FIRST_SLIP,
    LAST_SLIP,
    N_STATE,
    SAMPLE,
    SLIPS,
    STICK_START,
    STICK_TIME,
    step_through,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sim.motion import Motion

__all__ = ["FEATURES", "motion_features", "plain_features"]

FEATURES = (
    "slip_count",
    "slip_frequency",
    "stick_fraction",
    "torque_mean",
    "torque_rms",
    "torque_min",
    "torque_max",
    "clamp_speed_rms",
)
"""Number of slips; their mean rate [Hz], from the first to the last (NaN for fewer than two); share
of the time in stick; of the torque T_E: mean, rms about it and extremes [Nm]; rms of the clamp's
speed [rad/s]."""

_BLOCK = 256


@njit(cache=True, error_model="numpy", nogil=True)
def plain_features(systems, torques, speeds, step, parts, settling, n_samples, features) -> None:
    """Fill the rows of `features`: one a run of the plain model at constant speed, from rest.

    Rows of `systems` are extended, those of `torques` are T_crit and T_kin; the first `settling` of
    all `n_samples` are left out.
    """
    buffer = np.empty(6 * _BLOCK)
    direction = np.empty(_BLOCK, dtype=np.int64)
    no_events = np.empty(0)
    speed = np.empty(_BLOCK + 1)
    for run in range(speeds.size):
        state = np.zeros(N_STATE)
        state[1] = speeds[run]
        speed[:] = speeds[run]
        t_crit, t_kin = torques[run, 0], torques[run, 1]
        total, square, clamp, low, high = 0.0, 0.0, 0.0, math.inf, -math.inf
        while state[SAMPLE] < n_samples:
            first = int(state[SAMPLE])
            counts = first >= settling
            end = min(first + _BLOCK, n_samples if counts else settling)
            size = end - first
            if first == settling:
                state[STICK_TIME] = state[SLIPS] = 0.0
                state[STICK_START] = first * step
            out = buffer[: 6 * size].reshape((6, size))
            step_through(
                systems[run], t_crit, t_kin, speed[: size + 1], step, parts[run], state, out,
                direction[:size], no_events,
            )  # fmt: skip
            if counts:
                for i in range(size):
                    torque = out[1, i] - t_kin
                    total += torque
                    square += torque * torque
                    low, high = min(low, torque), max(high, torque)
                    clamp += out[5, i] * out[5, i]
        n = n_samples - settling
        if state[DIRECTION] == 0.0:
            state[STICK_TIME] += n_samples * step - state[STICK_START]
        mean = total / n
        lasted = state[LAST_SLIP] - state[FIRST_SLIP]
        features[run, 0] = state[SLIPS]
        features[run, 1] = (state[SLIPS] - 1.0) / lasted if state[SLIPS] > 1.0 else math.nan
        features[run, 2] = state[STICK_TIME] / (n * step)
        features[run, 3] = mean + t_kin
        features[run, 4] = math.sqrt(max(0.0, square / n - mean * mean))
        features[run, 5] = low + t_kin
        features[run, 6] = high + t_kin
        features[run, 7] = math.sqrt(clamp / n)


def motion_features(motion: Motion) -> NDArray[np.float64]:
    """Values of `FEATURES` for one motion.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    ndarray, shape (8,)
        In the units of `FEATURES` [Hz, Nm, rad/s and -].

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.motion import simulate_motion
    >>> from sim.shaft import ConstantSpeed
    >>> motion = simulate_motion(
    ...     load_material_rig("fluorocarbon-thesis"), ConstantSpeed(1.0),
    ...     interference=0.279e-3, support_stiffness=3745.0, seconds=0.3, rate=30e3,
    ... )
    >>> dict(zip(FEATURES, motion_features(motion).round(2), strict=True))["slip_count"]
    np.float64(43.0)
    """
    slips = motion_slips(motion)
    return np.array(
        [
            slips.times.size,
            slips.rate,
            np.mean(motion.stuck),
            np.mean(motion.torque),
            np.std(motion.torque),
            np.min(motion.torque),
            np.max(motion.torque),
            np.sqrt(np.mean(motion.clamp_speed**2)),
        ]
    )
