"""Definition of the noises by physics: the labels of simulated runs, which the classifier learns.

The thesis defines the noises by their mechanism (5.2.3, 6.2). The label follows from the motion and
the sound without background noise, room and microphone, which the classifier does not have. Lines
are those of `features.kernels.lines`.

- *none*: the torque settles to steady sliding, apart from inaudibly slow changes, or the sound is
  quieter than a quiet room.
- *creak*: slips excite the plate, and the A-weighted level of the sound of these pulses is at most
  10 dB below the remaining sound. Stick-slip too weak to excite the plate is no creak.
- *squeal*: the torque oscillates at one predominant frequency. Lines more than 18 dB below it do
  not count (the third harmonic of a triangle wave, as in Figure 5.1(c), is 19 dB below the first).
- *squawk*: the torque oscillates at several discrete frequencies, or sticks and slips without a
  period like the chatter of natural rubber, "much like squawk".
- *creak* as well: random friction without stick, as on a transfer film, whose sound "resembled the
  creaking, except that it was not as loud" (6.2).

All bounds are conventions. If the label of a run changes when a bound moves by 2 dB, or a ratio by
20 %, the run is ambiguous: listeners would disagree, so it is not used for training or scores.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from features.kernels.levels import band_levels
from features.kernels.lines import find_lines
from features.kernels.spectra import autospectrum
from features.kernels.weighting import a_weighting
from models.recording import REFERENCE_PRESSURE
from sim.analysis.regime import LEAST_OSCILLATION
from sim.motion import Motion
from sim.run import Run

LEAST_LEVEL = 35.0
"""Lowest audible level in a quiet room [dB(A) re 20 uPa]."""

_LEAST_STICK = 0.02
"""Smallest fraction of time in stick for chatter, if the torque has no lines [-]. This is stick of
the contact in the solver, not stick-slip of the torque (`sim.analysis.regime`)."""

_CREAK_MARGIN = 10.0
"""Largest level of the remaining sound re the pulses for a creak [dB(A)]."""

_LEAST_SHARE = 0.5
"""Smallest fraction of the torque's power from 20 Hz to 5 kHz in a predominant line [-]."""

_LINE_RANGE = 18.0
"""Largest level difference of a line that counts to the strongest one [dB]."""

_DECIBELS, _SHARE = 2.0, 0.2
"""Changes of the bounds for the test of ambiguity [dB], [-]."""


@dataclass(frozen=True)
class NoiseCriteria:
    """Criteria of the label of a run, each relative to its bound.

    Parameters
    ----------
    level : float
        Level of the sound re the lowest audible level [dB].
    blows : float
        Level of the pulses re the remaining sound, re the bound of a creak [dB].
    swing : float
        Standard deviation of the torque over its mean, over the bound of an oscillation [-].
    audible : float
        The same for the torque from 20 Hz to 5 kHz [-].
    stick : float
        Fraction of time in stick, over the bound of chatter [-].
    second : float
        Level of the second line of the torque re the first, re the bound [dB]; NaN without lines.
    share : float
        Fraction of the power from 20 Hz to 5 kHz in the strongest line, over the bound [-].
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
        """Label of the noise."""
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


def run_criteria(run: Run) -> NoiseCriteria:
    """Return the criteria of a run at constant speed.

    Parameters
    ----------
    run : Run

    Returns
    -------
    NoiseCriteria
        Criteria from the second half of the motion and the whole sound.

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
    """Return the criteria of a settled motion and its sound.

    Parameters
    ----------
    motion : Motion
        Motion at constant or nearly constant speed.
    pressure, pulse_pressure : ndarray, shape (n,)
        Sound, and the part of it from slip pulses, at the sampling rate of the motion [Pa].

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
        second=lines.second_level + _LINE_RANGE,
        share=lines.strongest_share / _LEAST_SHARE,
    )


def label_by_physics(run: Run) -> str:
    """Return the label of a run at constant speed: creak, squawk, squeal or none.

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


def is_ambiguous(criteria: NoiseCriteria) -> bool:
    """Whether the label changes when one of the bounds moves by 2 dB or 20 %.

    Examples
    --------
    >>> clear = NoiseCriteria(20.0, -30.0, 5.0, 5.0, 0.0, -9.0, 1.8)
    >>> clear.label, is_ambiguous(clear), is_ambiguous(replace(clear, second=-1.0))
    ('squeal', False, True)
    """
    moved = [
        replace(criteria, **{name: getattr(criteria, name) + step})
        for name in ("level", "blows", "second")
        for step in (-_DECIBELS, _DECIBELS)
    ] + [
        replace(criteria, **{name: getattr(criteria, name) * factor})
        for name in ("swing", "audible", "stick", "share")
        for factor in (1.0 - _SHARE, 1.0 / (1.0 - _SHARE))
    ]
    return any(other.label != criteria.label for other in moved)


def _level(pressure: NDArray[np.float64], rate: float) -> float:
    """Return the A-weighted level of a sound [dB(A) re 20 uPa]."""
    if not np.any(pressure):
        return -math.inf
    spectrum = autospectrum(pressure, rate)
    density = spectrum.density * 10.0 ** (0.1 * a_weighting(spectrum.frequency))
    return float(band_levels(density.sum() * spectrum.spacing, REFERENCE_PRESSURE))
