"""A run from rest once it has settled, as numbers read off a torque record are read off it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from models.rig import Rig
from noise.thesis.repetition import repetition_rate
from sim.analysis.critical_speeds import motion_from_rest
from sim.analysis.regime import LEAST_OSCILLATION
from sim.analysis.slips import Slips, motion_slips

_SECONDS = 0.8
_HIGHEST_LINE = 2500.0
"""Up to which the strongest line is sought [Hz]; assumed."""


@dataclass(frozen=True, eq=False)
class SettledRun:
    """The last half of a run.

    Parameters
    ----------
    slips : Slips
        Those that the torque shows.
    torque : ndarray, shape (n,)
        [Nm]
    rate : float
        [Hz]
    """

    slips: Slips
    torque: NDArray[np.float64]
    rate: float

    @property
    def oscillation(self) -> float:
        """Standard deviation of the torque over its mean [-]; infinite where that is zero."""
        deviation, mean = float(np.std(self.torque)), abs(self.mean_torque)
        return deviation / mean if mean > 0.0 else math.inf if deviation > 0.0 else 0.0

    @property
    def mean_torque(self) -> float:
        """Mean of the torque [Nm]."""
        return float(np.mean(self.torque))

    @property
    def repetition_rate(self) -> float:
        """Slips or periods a second [Hz]; NaN where nothing repeats."""
        if self.oscillation <= LEAST_OSCILLATION:
            return math.nan
        return repetition_rate(self.slips, self.torque, self.rate)

    @cached_property
    def _lines(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        torque = self.torque - self.mean_torque
        amplitude = np.asarray(np.abs(np.fft.rfft(torque * np.hanning(torque.size))))
        frequency = np.asarray(np.fft.rfftfreq(torque.size, 1.0 / self.rate))
        return frequency.astype(np.float64), amplitude.astype(np.float64)

    @property
    def strongest_line(self) -> float:
        """Frequency of the strongest line of the torque [Hz]."""
        frequency, amplitude = self._lines
        return float(frequency[np.argmax(amplitude[frequency < _HIGHEST_LINE])])

    def line_in(self, low: float, high: float) -> float:
        """Highest amplitude between two frequencies [Hz] over that of the strongest line [-]."""
        frequency, amplitude = self._lines
        strongest = max(float(amplitude[frequency < _HIGHEST_LINE].max()), 1e-12)
        return float(amplitude[(frequency >= low) & (frequency < high)].max()) / strongest


def settled_run(
    rig: Rig, interference: float, support_stiffness: float, speed: float
) -> SettledRun:
    """Run a rig from rest and keep the last half.

    Parameters
    ----------
    rig : Rig
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    speed : float
        Of the shaft [rad/s].

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> run = settled_run(load_material_rig("fluorocarbon-thesis"), 0.279e-3, 2214.0, 1.0)
    >>> run.slips.sudden_share > 0.5, 100.0 < run.repetition_rate < 200.0
    (True, True)
    """
    motion = motion_from_rest(rig, speed, interference, support_stiffness, seconds=_SECONDS)
    last = motion.since(motion.torque.size // 2)
    return SettledRun(motion_slips(last), last.torque, motion.rate)
