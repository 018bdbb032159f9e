"""Critical speeds: the last speed of stick-slip (V_crit1) and of vibration (V_crit2).

Tables 5.1 and 5.2 give speeds determined by ear and eye. For a comparison they need a definition:
the rig runs from rest for a second or more, at speeds 0.25 rad/s apart, and `sim.analysis.regime`
judges the last half. V_crit1 is the last speed of stick-slip ("the maximum velocity at which
stick-slip occurs", 5.1.1), V_crit2 the last at which the torque oscillates, islands included, for
measured and simulated rigs alike. The first torsional mode decays slowly: after 0.2 s a decaying
oscillation is not yet distinct from a lasting one. The search starts at the highest speed, so
speeds below both critical speeds cost nothing. All runs use the rig's constant version
(`sim.effects.constant_version`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from models.errors import ParameterError
from models.rig import Rig
from sim.analysis.regime import Regime, friction_regime
from sim.effects import constant_version
from sim.motion import Motion, simulate_motion
from sim.plan import REGIME_RATE
from sim.shaft import ConstantSpeed

SPEEDS = tuple(0.25 * i for i in range(1, 53))
"""Speeds of the search, from 0.25 to 13 rad/s, the range of the measurements."""

_SECONDS = 1.0


@dataclass(frozen=True)
class CriticalSpeeds:
    """Critical speeds of a rig at one condition.

    Parameters
    ----------
    v_crit1 : float
        Last speed of stick-slip [rad/s]; 0 if there is none, ``inf`` if it is the highest speed.
    v_crit2 : float
        Last speed at which the torque oscillates [rad/s]; likewise.
    """

    v_crit1: float
    v_crit2: float


def critical_speeds(
    rig: Rig,
    interference: float,
    support_stiffness: float,
    speeds: Sequence[float] = SPEEDS,
    *,
    seconds: float = _SECONDS,
) -> CriticalSpeeds:
    """Find the critical speeds of a rig.

    Parameters
    ----------
    rig : Rig
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.
    speeds : sequence of float
        Speeds of the search [rad/s], positive and rising.
    seconds : float
        Length of each run [s].

    Returns
    -------
    CriticalSpeeds

    Raises
    ------
    ParameterError
        If the speeds do not rise from above zero, or a value cannot be used.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> critical_speeds(rig, 0.279e-3, 3745.0, (5.0, 6.0, 6.75, 7.5))
    CriticalSpeeds(v_crit1=6.75, v_crit2=6.75)
    """
    _check(speeds)
    v_crit2 = 0.0
    for speed in reversed(speeds):
        motion = motion_from_rest(rig, speed, interference, support_stiffness, seconds=seconds)
        regime = friction_regime(motion)
        if regime is Regime.STEADY_SLIDING:
            continue
        last = math.inf if speed == speeds[-1] else speed
        v_crit2 = max(v_crit2, last)
        if regime is Regime.STICK_SLIP:
            return CriticalSpeeds(last, v_crit2)
    return CriticalSpeeds(0.0, v_crit2)


def motion_from_rest(
    rig: Rig,
    speed: float,
    interference: float,
    support_stiffness: float,
    *,
    seconds: float = _SECONDS,
) -> Motion:
    """Simulate the constant version of a rig from rest at constant speed.

    Parameters
    ----------
    rig : Rig
    speed : float
        Speed of the shaft [rad/s].
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    seconds : float
        Length of the run [s].

    Returns
    -------
    Motion
        At 15 kHz.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> motion_from_rest(load_material_rig("PDMS"), 1.0, 0.279e-3, 2214.0).torque.shape
    (15000,)
    """
    return simulate_motion(
        constant_version(rig),
        ConstantSpeed(speed),
        interference=interference,
        support_stiffness=support_stiffness,
        seconds=seconds,
        rate=REGIME_RATE,
    )


def _check(speeds: Sequence[float]) -> None:
    rising = all(a < b for a, b in pairwise(speeds))
    if not (speeds and speeds[0] > 0.0 and rising):
        raise ParameterError("critical speeds: the speeds to try must rise from above 0 rad/s")
