"""What noise a simulated run makes, by its physics: the definition that the classifier learns.

The thesis names the noises by what makes them (5.2.3, 6.2), and so does this page, the one place
where they are defined. It looks at the motion and at the sound free of noise, room and microphone,
none of which the classifier sees; lines are found as `features.lines` does.

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
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from features.bands import overall_level
from features.lines import Lines, find_lines
from features.spectra import autospectrum
from models.recording import REFERENCE_PRESSURE
from sim.regime import LEAST_OSCILLATION, Regime, friction_regime

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sim.run import Run

__all__ = ["LEAST_LEVEL", "noise_of", "sustained_frequencies"]

LEAST_LEVEL = 35.0
"""Sound below it is not heard in a quiet room [dB(A) re 20 uPa]."""

_CREAK_MARGIN = 10.0
"""How far the blows' sound may lie below all the rest [dB(A)]."""

_LEAST_SHARE = 0.5
"""Of the torque's power from 20 Hz to 5 kHz in one line, for it to be predominant."""

_LINE_RANGE = 18.0
"""Lines weaker than the strongest by more than this do not count [dB]."""


def noise_of(run: Run) -> str:
    """Return the noise of a run at constant speed: creak, squawk, squeal or none.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> rig = load_material_rig("fluorocarbon")
    >>> noise_of(simulate(rig, 10.0, interference=0.279e-3, support_stiffness=3745.0))
    'squeal'
    >>> noise_of(simulate(rig, 1.0, interference=0.381e-3, support_stiffness=2214.0))
    'creak'
    """
    rate = run.motion.rate
    level = _level(run.pressure, rate)
    if friction_regime(run.motion) is Regime.STEADY_SLIDING or level < LEAST_LEVEL:
        return "none"
    if _level(run.pulse_pressure, rate) >= _level(run.pressure - run.pulse_pressure, rate) - (
        _CREAK_MARGIN
    ):
        return "creak"
    lines = _torque_lines(run)
    if _audible_oscillation(run, lines) <= LEAST_OSCILLATION:
        return "none"
    if _sustained(lines).size > 1:
        return "squawk"
    if lines.strongest_share > _LEAST_SHARE:
        return "squeal"
    return "squawk" if friction_regime(run.motion) is Regime.STICK_SLIP else "creak"


def sustained_frequencies(run: Run) -> NDArray[np.float64]:
    """Frequencies of the torque's lines within 18 dB of the strongest [Hz], strongest first."""
    return _sustained(_torque_lines(run))


def _torque_lines(run: Run) -> Lines:
    torque = run.motion.torque
    spectrum = autospectrum(torque[torque.size // 2 :], run.motion.rate)
    return find_lines(spectrum, low=20.0, high=5e3)


def _sustained(lines: Lines) -> NDArray[np.float64]:
    if not lines.power.size:
        return lines.frequency
    strong = lines.power >= lines.power[0] * 10.0 ** (-_LINE_RANGE / 10.0)
    return np.asarray(lines.frequency[strong])


def _audible_oscillation(run: Run, lines: Lines) -> float:
    """Root mean square of the torque from 20 Hz to 5 kHz, over its mean."""
    torque = run.motion.torque
    return math.sqrt(lines.total) / abs(float(np.mean(torque[torque.size // 2 :])))


def _level(pressure: NDArray[np.float64], rate: float) -> float:
    if not np.any(pressure):
        return -math.inf
    spectrum = autospectrum(pressure, rate)
    return overall_level(spectrum, reference=REFERENCE_PRESSURE, weighting="A")
