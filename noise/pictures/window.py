"""Window of a run that is shown enlarged: a few slips, where the run is at its liveliest.

At constant speed any part is as good, and the middle is taken. A shaft that swings or runs up is
quiet for most of the time; there it is the part about the largest acceleration of the beam.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from noise.thesis.repetition import repetition_rate
from sim.analysis.regime import LEAST_OSCILLATION
from sim.analysis.slips import motion_slips

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sim.motion import Motion
    from sim.run import Run

__all__ = ["Window", "oscillates", "run_window"]

_CYCLES = 6
_SHORTEST, _LONGEST = 2e-3, 0.1
_WITHOUT_CYCLES = 0.04
"""Length of a window [s]."""

_AROUND = 0.25
"""How much of the run on either side the period is taken from [s]."""

_LEAST_SAMPLES = 1000
"""In which a period is sought."""


@dataclass(frozen=True)
class Window:
    """A part of a motion.

    Parameters
    ----------
    first, last : int
        Samples of the motion, `last` being the first one after it.
    frequency : float, optional
        Repetition rate of slips, or of the oscillation, thereabouts [Hz].
    """

    first: int
    last: int
    frequency: float | None


def run_window(run: Run) -> Window:
    """Choose the part of a run that is shown enlarged.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> run = simulate(load_material_rig("fluorocarbon-thesis"), 1.0, support_stiffness=3745.0)
    >>> window = run_window(run)
    >>> round(window.frequency), round((window.last - window.first) / run.motion.rate, 3)
    (150, 0.04)
    """
    motion, recording = run.motion, run.recording
    n, rate = motion.torque.size, motion.rate
    middle = n // 2
    if recording.condition.speed is None:
        loudest = int(np.argmax(np.abs(recording["acceleration"])))
        middle = min(round(loudest * rate / recording.rate), n - 1)
    reach = round(_AROUND * rate)
    frequency = _cycles(motion.part(max(0, middle - reach), middle + reach))
    seconds = _WITHOUT_CYCLES
    if frequency is not None:
        seconds = min(max(_CYCLES / frequency, _SHORTEST), _LONGEST)
    size = min(n, round(seconds * rate))
    first = min(max(0, middle - size // 2), n - size)
    return Window(first, first + size, frequency)


def _cycles(motion: Motion) -> float | None:
    """Slips a second, or periods of the torque [Hz]; None where it does not oscillate."""
    if motion.torque.size < _LEAST_SAMPLES or not oscillates(motion.torque):
        return None
    found = repetition_rate(motion_slips(motion), motion.torque, motion.rate)
    return None if math.isnan(found) else found


def oscillates(torque: NDArray[np.floating]) -> bool:
    """Whether a torque oscillates, as `sim.analysis.regime` has it."""
    return bool(np.std(torque) > LEAST_OSCILLATION * abs(np.mean(torque)))
