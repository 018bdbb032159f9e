"""How far recordings are from a rig, in floors: by what repeats of a condition agree in.

The distance is that of `noise.diagnosis.gap`, in units of what simulated repeats of the rig that
fits best differ by.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from models.errors import ParameterError
from models.rig import Rig
from noise.diagnosis.gap.distance import group_costs
from noise.diagnosis.gap.signature import channel_signature, joined_signature
from noise.diagnosis.simulated.repeats import Scatter, perturb_run
from sim.motion import simulate_motion
from sim.shaft import ConstantSpeed

if TYPE_CHECKING:
    from noise.identification.measured import Measured


_SETTLING = 0.1
"""Simulated before what is looked at [s]; assumed."""

_SECONDS = 0.6
"""Looked at, at most [s]; assumed."""

_TOLERANCE = 1e-6
"""Of the solver: neighbouring motions part, but what they are made of does not."""

_REPEATS = 8
"""Simulated repeats, as few as tell a floor, and their least scatter, as
`noise.diagnosis.gap.distance` has it; a law that breaks down is so many floors off. Assumed."""
_LEAST_SCALE = 0.03
_HOPELESS = 30.0


def repeats_scale(rig: Rig, like: Measured, first: int) -> NDArray[np.float64]:
    """Return what repeats of a recording differ by, by simulating some.

    Parameters
    ----------
    rig : Rig
    like : Measured
    first : int
        Seed of the first.

    Returns
    -------
    ndarray, shape (n_values,)
        Standard deviation of each value of the signature [-].
    """
    repeats = []
    for seed in range(first, first + _REPEATS):
        try:
            repeats.append(_signature(_simulated(rig, like, seed=seed), like.rate))
        except ParameterError:
            continue
    if len(repeats) < 3:
        return np.full(_signature(like.torque, like.rate).size, 0.1)
    spread = np.std(repeats, axis=0, ddof=1)
    # a run that is a little longer or shorter than another, and their error of eight
    typical = float(np.nanmedian(spread))
    return np.asarray(
        np.sqrt(0.7 * spread**2 + 0.3 * typical**2 + _LEAST_SCALE**2) * math.sqrt(1.1)
    )


def squared_distance(
    rig: Rig, recordings: Sequence[Measured], scales: Sequence[NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Squared distance of recordings from a rig, in floors.

    Parameters
    ----------
    rig : Rig
    recordings : sequence of Measured
    scales : sequence of ndarray, shape (n_values,)
        Of each, by `repeats_scale` [-].

    Returns
    -------
    ndarray, shape (n_recordings,)
        [-]
    """
    squares = []
    for one, scale in zip(recordings, scales, strict=True):
        try:
            away = _signature(one.torque, one.rate) - _signature(_simulated(rig, one), one.rate)
        except ParameterError:
            squares.append(_HOPELESS**2)
            continue
        squares.append(float(np.nanmean(group_costs(away / scale))))
    return np.array(squares)


def _signature(torque: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    return joined_signature({"torque": channel_signature(torque, rate, "torque")})


def _simulated(rig: Rig, like: Measured, *, seed: int | None = None) -> NDArray[np.float64]:
    """Simulate the torque at the condition of a recording, with a seed as a repeat of it."""
    once, at = rig, like.condition
    if seed is not None:
        once, at = perturb_run(rig, at, Scatter(), np.random.default_rng([seed, 0]))
    motion = simulate_motion(
        once, ConstantSpeed(at.speed), interference=at.interference,
        support_stiffness=at.support_stiffness, rate=like.rate, tolerance=_TOLERANCE,
        seconds=_SETTLING + min(like.torque.size / like.rate, _SECONDS),
    )  # fmt: skip
    return motion.torque[round(_SETTLING * like.rate) :]
