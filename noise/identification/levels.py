"""Levels of the torque in one recording: what breaks the contact, and what it slides at."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from noise.identification.bushing_fit import BushingFit


_FAST = 0.6
"""Share of the fastest sliding from which the contact counts as sliding fast; assumed."""

_SLOW = 0.6
"""Sliding speed over the shaft's below which it has been slow; assumed."""

_LEAST_SAMPLES = 20


@dataclass(frozen=True)
class Levels:
    """Torque levels of one recording.

    Parameters
    ----------
    mean : float
        Of the torque [Nm].
    critical, kinetic : float
        Median of the highest torque of each cycle, and torque of the contact in fast sliding [Nm].
    slips : int
        Cycles that were seen.
    fastest : float
        Sliding speed that 1 in 200 samples exceeds [rad/s].
    """

    mean: float
    critical: float
    kinetic: float
    slips: int
    fastest: float


def torque_levels(fit: BushingFit) -> Levels:
    """Read the levels off a recording that has been fitted.

    Parameters
    ----------
    fit : BushingFit

    Returns
    -------
    Levels
        Where nothing sticks, critical and kinetic torque are the mean torque of the contact.
    """
    torque, contact = fit.spectrum.torque, fit.contact
    v = contact.sliding_speed
    mean = float(np.mean(torque))
    fastest = float(np.quantile(v, 0.995))
    fast = v > max(_FAST * fastest, 1.1 * float(np.mean(fit.spectrum.shaft_speed)))
    begins = _slips(v, fit.spectrum.shaft_speed)
    if begins.size < 2 or fast.sum() < _LEAST_SAMPLES:
        return Levels(mean, mean, mean, 0, fastest)
    peaks = np.array([
        np.max(torque[a:b]) for a, b in itertools.pairwise(begins)
    ])  # fmt: skip
    return Levels(
        mean, float(np.median(peaks)), float(np.mean(contact.torque[fast])), int(begins.size),
        fastest,
    )  # fmt: skip


def _slips(v: NDArray[np.float64], shaft_speed: NDArray[np.float64]) -> NDArray[np.int64]:
    """Find the samples at which the contact begins to slide, having been slow before."""
    state = np.where(v > shaft_speed, 1, np.where(v < _SLOW * shaft_speed, -1, 0))
    told = np.flatnonzero(state)
    return np.asarray(told[1:][(state[told[1:]] == 1) & (state[told[:-1]] == -1)])
