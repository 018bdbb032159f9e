"""Labels by physics: the definition of the noises of a simulated run, which the classifier learns.

The thesis names the noises by what makes them (5.2.3, 6.2), and so does this page, the one place
where they are defined. It looks at the motion and at the sound free of noise, room and microphone,
none of which the classifier sees; lines are found as `features.kernels.lines` does.

- *none*: the torque settles to steady sliding, but for changes too slow to be heard; or the sound
  drowns in a quiet room's.
- *creak*: slips strike the plate, and the sound that those blows make through it is no more than
  10 dB below all the rest, A-weighted. Stick-slip too weak to excite the plate is no creak.
- *squeal*: the torque oscillates at one predominant frequency; lines more than 18 dB below it do
  not count (the third harmonic of a triangle lies 19 dB below the first, and Figure 5.1(c) is one).
- *squawk*: it oscillates at several discrete frequencies, or sticks and slips without a period, as
  natural rubber's chatter does, "much like squawk".
- *creak*, too: friction that is random without stick, as on a transfer film; its sound "resembled
  the creaking, except that it was not as loud" (6.2).

Every bound in here is a number where nature has none. A run whose name changes when one of them is
moved by 2 dB, or a share by a fifth, is `ambiguous`: two listeners would differ, and neither
learning nor a score should depend on which of them is asked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.levels import overall_level
from features.kernels.lines import Lines, find_lines
from features.kernels.spectra import autospectrum
from models.recording import REFERENCE_PRESSURE
from sim.analysis.regime import LEAST_OSCILLATION

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from sim.motion import Motion
    from sim.run import Run

__all__ = [
    "LEAST_LEVEL", "NoiseCriteria", "is_ambiguous", "label_by_physics", "noise_criteria",
    "run_criteria",
]  # fmt: skip

LEAST_LEVEL = 35.0
"""Sound below it is not heard in a quiet room [dB(A) re 20 uPa]."""

_LEAST_STICK = 0.02
"""Of the time that the contact sticks, for a torque without lines to chatter. That is the solver's
stick, which tells contact from none; whether the torque shows stick-slip is another thing
(`sim.analysis.regime`), on which no noise depends."""

_CREAK_MARGIN = 10.0
"""How far the blows' sound may lie below all the rest [dB(A)]."""

_LEAST_SHARE = 0.5
"""Of the torque's power from 20 Hz to 5 kHz in one line, for it to be predominant."""

_LINE_RANGE = 18.0
"""Lines weaker than the strongest by more than this do not count [dB]."""

_DECIBELS, _SHARE = 2.0, 0.2
"""How far a bound is moved to see whether a label depends on it."""


@dataclass(frozen=True)
class NoiseCriteria:
    """What a run's label follows from, each over its bound.

    Parameters
    ----------
    level : float
        Of the sound, re the least level that is heard [dB].
    blows : float
        Level of the blows' sound re all the rest, re the least of a creak [dB].
    swing : float
        Standard deviation of the torque over its mean, re the least of an oscillation [-].
    audible : float
        The same of its part from 20 Hz to 5 kHz [-].
    stick : float
        Share of the time that the contact sticks, re the least of chatter [-].
    second : float
        Level of the second line of the torque re the first, re the least that counts [dB].
    share : float
        Of that part's power in the strongest line, re the least of a predominant one [-].
    """

    level: float
    blows: float
    swing: float
    audible: float
    stick: float
    second: float
    share: float

    @property
    def label(self) -> str:
        """The noise."""
        if self.swing <= 1.0 or self.level < 0.0:
            return "none"
        if self.blows >= 0.0:
            return "creak"
        if self.audible <= 1.0:
            return "none"
        if self.second >= 0.0:
            return "squawk"
        if self.share > 1.0:
            return "squeal"
        return "squawk" if self.stick > 1.0 else "creak"

    def with_moved_bounds(self) -> Iterator[NoiseCriteria]:
        """Yield the criteria with each bound moved down and up in turn."""
        for step in (-_DECIBELS, _DECIBELS):
            yield replace(self, level=self.level + step)
            yield replace(self, blows=self.blows + step)
            yield replace(self, second=self.second + step)
        for factor in (1.0 - _SHARE, 1.0 / (1.0 - _SHARE)):
            yield replace(self, swing=self.swing * factor)
            yield replace(self, audible=self.audible * factor)
            yield replace(self, stick=self.stick * factor)
            yield replace(self, share=self.share * factor)


def run_criteria(run: Run) -> NoiseCriteria:
    """Measure what the label of a run at constant speed follows from.

    Parameters
    ----------
    run : Run

    Returns
    -------
    NoiseCriteria
        Of the motion's second half, and of all the sound.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> run_criteria(simulate(load_material_rig("PDMS"), 5.0)).swing < 1e-3
    True
    """
    settled = run.motion.part(run.motion.torque.size // 2)
    return noise_criteria(settled, run.pressure, run.pulse_pressure)


def noise_criteria(
    motion: Motion, pressure: NDArray[np.float64], pulse_pressure: NDArray[np.float64]
) -> NoiseCriteria:
    """Measure what the label follows from, of a motion that has settled and of its sound.

    Parameters
    ----------
    motion : Motion
        At constant speed, or so nearly that its lines stay lines.
    pressure, pulse_pressure : ndarray, shape (n,)
        At the motion's rate [Pa]: the sound, and the part of it that slip pulses make.

    Returns
    -------
    NoiseCriteria

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.5)
    >>> noise_criteria(run.motion, run.pressure, run.pulse_pressure).label
    'none'
    """
    rate = motion.rate
    mean = abs(float(np.mean(motion.torque)))
    lines = find_lines(autospectrum(motion.torque, rate), low=20.0, high=5e3)
    blows = _level(pulse_pressure, rate) - _level(pressure - pulse_pressure, rate)
    return NoiseCriteria(
        level=_level(pressure, rate) - LEAST_LEVEL,
        blows=-math.inf if math.isnan(blows) else blows + _CREAK_MARGIN,
        swing=float(np.std(motion.torque)) / mean / LEAST_OSCILLATION,
        audible=math.sqrt(lines.total) / mean / LEAST_OSCILLATION,
        stick=float(np.mean(motion.stuck)) / _LEAST_STICK,
        second=_second(lines) + _LINE_RANGE,
        share=lines.strongest_share / _LEAST_SHARE,
    )


def label_by_physics(run: Run) -> str:
    """Return the noise of a run at constant speed: creak, squawk, squeal or none.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> rig = load_material_rig("fluorocarbon")
    >>> label_by_physics(simulate(rig, 10.0, interference=0.279e-3, support_stiffness=3745.0))
    'squeal'
    >>> label_by_physics(simulate(rig, 1.0, interference=0.381e-3, support_stiffness=2214.0))
    'creak'
    """
    return run_criteria(run).label


def is_ambiguous(found: NoiseCriteria) -> bool:
    """Whether the label changes where one of the bounds is moved by 2 dB or a fifth.

    Examples
    --------
    >>> clear = NoiseCriteria(20.0, -30.0, 5.0, 5.0, 0.0, -9.0, 1.8)
    >>> clear.label, is_ambiguous(clear), is_ambiguous(replace(clear, second=-1.0))
    ('squeal', False, True)
    """
    return any(other.label != found.label for other in found.with_moved_bounds())


def _second(lines: Lines) -> float:
    """Level of the second line re the first [dB]."""
    if lines.power.size < 2 or not lines.power[1] > 0.0:
        return -math.inf
    return 10.0 * math.log10(float(lines.power[1] / lines.power[0]))


def _level(pressure: NDArray[np.float64], rate: float) -> float:
    if not np.any(pressure):
        return -math.inf
    spectrum = autospectrum(pressure, rate)
    return overall_level(spectrum, reference=REFERENCE_PRESSURE, weighting="A")
