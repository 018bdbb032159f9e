"""Torque against speed and frequency against speed, over a sweep of speeds.

Of a sweep only the torque is kept, at a rate that holds all its lines; means, extremes and lines
follow from it for any friction law in the same way; slips are those of `sim.analysis.slips`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.lines import find_lines
from features.kernels.spectra import autospectrum
from models.show import short_repr
from noise.pictures.window import oscillates
from noise.thesis.repetition import repetition_rate
from sim.analysis.slips import find_slips
from sim.analysis.sweep import Sweep

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from models.rig import Rig

__all__ = ["SweptTorque", "sweep_torque"]

_SECONDS, _SETTLING = 1.0, 0.5
"""[s]; the first torsional mode dies in 0.1 s or so."""

_RATE, _EVERY = 30e3, 3
"""Of the simulation [Hz], and how many of its samples make one of the torque that is kept."""

_LOWEST, _HIGHEST = 20.0, 4e3
"""Where lines are sought [Hz]: the torque has little above 2 kHz (5.2.3)."""


@short_repr
@dataclass(frozen=True, eq=False)
class SweptTorque:
    """Torques of one rig over speeds and supports; arrays have shape (n_supports, n_speeds).

    Parameters
    ----------
    speed : ndarray, shape (n_speeds,)
        [rad/s]
    support_stiffness : tuple of float, length n_supports
        [Nm/rad]
    mean, low, high : ndarray, shape (n_supports, n_speeds)
        Mean torque, and the lowest and highest [Nm].
    slip_frequency : ndarray, shape (n_supports, n_speeds)
        Slips, or periods of the torque, a second [Hz]; NaN where it does not oscillate.
    strongest_line : ndarray, shape (n_supports, n_speeds)
        Of the torque [Hz]; NaN likewise.
    """

    speed: NDArray[np.float64]
    support_stiffness: tuple[float, ...]
    mean: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    slip_frequency: NDArray[np.float64]
    strongest_line: NDArray[np.float64]


def sweep_torque(
    rig: Rig,
    speed: Sequence[float] | NDArray[np.float64],
    *,
    interference: float,
    support_stiffness: Sequence[float],
) -> SweptTorque:
    """Simulate a rig at all speeds on all supports, for `noise.pictures.speeds.plot_sweep`.

    Parameters
    ----------
    rig : Rig
    speed : array_like, shape (n_speeds,)
        [rad/s]
    interference : float
        [m]
    support_stiffness : sequence of float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.

    Returns
    -------
    SweptTorque

    Raises
    ------
    ParameterError
        A condition that cannot be simulated.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> sweep = sweep_torque(rig, [1.0, 2.5], interference=0.279e-3, support_stiffness=[3745.0])
    >>> sweep.slip_frequency.round(), sweep.mean.round(1)
    (array([[150., 307.]]), array([[8.7, 8.6]]))
    """
    speeds = np.asarray(speed, dtype=np.float64)
    supports = np.array(support_stiffness, dtype=np.float64)
    runs = Sweep(
        rig,
        speeds[None, :],
        interference=interference,
        support_stiffness=supports[:, None],
        seconds=_SECONDS,
        settling=_SETTLING,
        rate=_RATE,
    )
    torque = runs.torque(every=_EVERY).astype(np.float64)
    stiffness = rig.fit(interference).elastomer_stiffness
    own_period = 2.0 * math.pi * math.sqrt(rig.elastomer_inertia / stiffness)
    rate = _RATE / _EVERY

    def cycles(one: NDArray[np.float64], at_speed: float) -> float:
        if not oscillates(one):
            return math.nan
        slips = find_slips(one / stiffness, at_speed, rate, own_period=own_period)
        return repetition_rate(slips, one, rate)

    slips = [[cycles(*pair) for pair in zip(row, speeds, strict=True)] for row in torque]
    return SweptTorque(
        speed=speeds,
        support_stiffness=tuple(map(float, supports)),
        mean=torque.mean(axis=-1),
        low=torque.min(axis=-1),
        high=torque.max(axis=-1),
        slip_frequency=np.array(slips),
        strongest_line=_each(torque, _strongest_line),
    )


def _strongest_line(torque: NDArray[np.float64]) -> float | None:
    if not oscillates(torque):
        return None
    rate = _RATE / _EVERY
    found = find_lines(autospectrum(torque, rate), low=_LOWEST, high=_HIGHEST)
    return float(found.frequency[0]) if found.frequency.size else None


def _each(
    torque: NDArray[np.float64], of: Callable[[NDArray[np.float64]], float | None]
) -> NDArray[np.float64]:
    found = [of(one) for one in torque.reshape(-1, torque.shape[-1])]
    numbers = [math.nan if value is None else value for value in found]
    return np.array(numbers).reshape(torque.shape[:-1])
