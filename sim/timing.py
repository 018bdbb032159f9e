"""Presets of how finely runs are computed, and how long the rig has run before they are kept.

They differ on purpose. What a rate or a settling time is changes the samples of a run, if little:
another rate moves the corner of the anti-alias filter, another settling the phase of the slips.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

__all__ = [
    "DIAGNOSIS", "LEARNING", "REGIME_RATE", "SCREENING", "SCREENING_SLOW", "SIMULATION", "Timing",
]  # fmt: skip


@dataclass(frozen=True)
class Timing:
    """Rate and settling of a kind of run.

    Parameters
    ----------
    least_rate : float
        Motion and sound are computed at a multiple of the sampling rate no lower than this [Hz].
    settling : float
        How long a shaft at constant speed has turned before a run is kept [s].
    tolerance : float, optional
        Error of a step of the solver where the motion has no exact solution [-]; by default that
        of the friction law.

    Examples
    --------
    >>> SIMULATION.rate(30e3), SIMULATION.rate(48e3), DIAGNOSIS.rate(25.6e3)
    (90000.0, 96000.0, 76800.0)
    """

    least_rate: float
    settling: float
    tolerance: float | None = None

    def decimation(self, sampling_rate: float) -> int:
        """By what the rate of motion and sound is divided for a sampling rate [Hz]."""
        return math.ceil(self.least_rate / sampling_rate)

    def rate(self, sampling_rate: float) -> float:
        """Rate of motion and sound for a sampling rate [Hz]."""
        return self.decimation(sampling_rate) * sampling_rate


SIMULATION = Timing(least_rate=90e3, settling=0.5)
"""Of recordings that are simulated to be kept: sound is right up to 20 kHz and beyond."""

DIAGNOSIS = Timing(least_rate=75e3, settling=0.25, tolerance=3e-6)
"""Of the many runs that a diagnosis compares with recordings: settled as long as structures are
followed to ring on, torques right to four digits. The shipped posterior of causes was fitted to
runs of exactly these, so they change with it only."""

LEARNING = replace(DIAGNOSIS, least_rate=60e3)
"""Of the cases that it was fitted to: usual rates are still at least halved, so that what lies
above half of them is filtered out as in a recording and does not fold back."""

SCREENING = Timing(least_rate=30e3, settling=0.6)
"""Of a point of a map, named by its physics: creaks reach 15 kHz."""

SCREENING_SLOW = Timing(least_rate=30e3, settling=1.5)
"""Of a point whose vibration still grows or dies after that; some creaks set in that late."""

REGIME_RATE = 15e3
"""Of a motion of which only the regime and slow lines are asked [Hz]; it resolves stick, and the
solution does not depend on it."""
