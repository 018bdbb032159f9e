"""Friction regimes of a motion: stick-slip, quasi-harmonic, steady sliding (Section 5.1).

They are defined by the torque, which a rig measures, and not by the solver's stick:

- *steady sliding*: its standard deviation is no more than a hundredth of its mean;
- *stick-slip*: it rises with time, and then suddenly drops, faster than a sticking contact could
  load it; `sim.analysis.slips` has the equation and its limits;
- *quasi-harmonic*: any other oscillation, harmonic, triangular or with several frequencies, with
  grazing contact or without.

The limits are not critical: over the cells of Tables 5.1 and 5.2, twice or half of either shifts no
critical speed by more than 0.25 rad/s, the spacing of the speeds.
"""

from __future__ import annotations

import math
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from sim.analysis.slips import LEAST_SUDDEN, motion_slips

if TYPE_CHECKING:
    from sim.motion import Motion

LEAST_OSCILLATION = 0.01
"""Standard deviation of the torque over its mean above which it oscillates [-]."""


class Regime(StrEnum):
    """Friction regimes observed in the thesis."""

    STICK_SLIP = "stick-slip"
    QUASI_HARMONIC = "quasi-harmonic"
    STEADY_SLIDING = "steady sliding"


def friction_regime(motion: Motion) -> Regime:
    """Return the regime of the last half of a motion at constant speed.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    Regime

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> friction_regime(simulate(load_material_rig("PDMS"), 5.0, seconds=0.1).motion).value
    'steady sliding'
    """
    sudden, oscillation = regime_measures(motion)
    if oscillation <= LEAST_OSCILLATION:
        return Regime.STEADY_SLIDING
    return Regime.STICK_SLIP if sudden > LEAST_SUDDEN else Regime.QUASI_HARMONIC


_CARRIED_ALONG = 0.2
"""Share of the shaft's highest speed below which a sliding contact has not broken loose.

A contact with an inner state, or with creep, yields by up to 0.16 while it is loaded, and exceeds
the shaft's speed when it breaks loose (shipped materials, rotation and oscillation).
"""

_START = 5e-3
"""Time in which a contact at rest takes up the motion of the shaft [s]."""


def never_slips(motion: Motion) -> bool:
    """Return whether the contact carries the bushing's surface along all the time.

    Parameters
    ----------
    motion : Motion

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> never_slips(simulate(rig, 5.0, seconds=0.1).motion)
    False
    >>> never_slips(simulate(rig.changed(critical_torque="x1000"), 5.0, seconds=0.1).motion)
    True
    """
    later = motion.sliding_speed[math.ceil(_START * motion.rate) :]
    fastest = float(np.abs(motion.shaft_speed).max())
    turned = fastest > 0.0 and later.size > 0
    return turned and float(np.abs(later).max()) <= _CARRIED_ALONG * fastest


def regime_measures(motion: Motion) -> tuple[float, float]:
    """Return the two measures that define the regime, over the last half of a motion.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    sudden : float
        Sudden share of the torque's falls [-], by `sim.analysis.slips`.
    oscillation : float
        Standard deviation of the torque over its mean [-]; infinite for a mean of zero.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> sudden, oscillation = regime_measures(
    ...     simulate(load_material_rig("fluorocarbon"), 1.0, seconds=0.5).motion
    ... )
    >>> round(sudden, 1), round(oscillation, 1)
    (0.7, 0.1)
    """
    last = motion.part(motion.torque.size // 2)
    deviation, mean = float(np.std(last.torque)), abs(float(np.mean(last.torque)))
    oscillation = deviation / mean if mean > 0.0 else math.inf if deviation > 0.0 else 0.0
    return motion_slips(last).sudden_share, oscillation
