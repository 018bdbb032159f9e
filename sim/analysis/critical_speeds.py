"""Critical speeds: where stick-slip ends (V_crit1), and where vibration ends (V_crit2).

Tables 5.1 and 5.2 give speeds found by ear and eye. To be compared they need a definition: the rig
runs from rest for a second or more, at speeds 0.25 rad/s apart, and is judged on the last half by
`sim.analysis.regime`. V_crit1 is the last speed of stick-slip ("the maximum velocity at which
stick-slip occurs", 5.1.1), V_crit2 the last at which the torque oscillates, islands included, of
measured and of simulated rigs alike: a design is free of either only beyond. The first torsional
mode dies slowly: in 0.2 s an oscillation
that is about to die out still looks alive. Speeds are tried from the fastest down, so that what
lies below both critical speeds costs nothing. All runs are those of the rig's constant version
(`sim.rig_effects`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from models.errors import ParameterError
from models.rig import Rig
from sim.analysis.regime import Regime, friction_regime
from sim.motion import Motion, simulate_motion
from sim.rig_effects import constant_version
from sim.run import REGIME_RATE
from sim.shaft import ConstantSpeed

SPEEDS = tuple(0.25 * i for i in range(1, 53))
"""From 0.25 to 13 rad/s, the range of the measurements."""

_SECONDS = 1.0


@dataclass(frozen=True)
class CriticalSpeeds:
    """Where the regimes end.

    Parameters
    ----------
    v_crit1 : float
        Last speed of stick-slip [rad/s]; 0 if there is none, ``inf`` if it is the fastest tried.
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
        To try [rad/s], positive and rising.
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
        regime = regime_at(rig, speed, interference, support_stiffness, seconds=seconds)
        if regime is Regime.STEADY_SLIDING:
            continue
        found = math.inf if speed == speeds[-1] else speed
        v_crit2 = max(v_crit2, found)
        if regime is Regime.STICK_SLIP:
            return CriticalSpeeds(found, v_crit2)
    return CriticalSpeeds(0.0, v_crit2)


def regime_at(
    rig: Rig,
    speed: float,
    interference: float,
    support_stiffness: float,
    *,
    seconds: float = _SECONDS,
) -> Regime:
    """Return the regime in which a rig that starts from rest ends up.

    Parameters
    ----------
    rig : Rig
    speed : float
        Of the shaft [rad/s].
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    seconds : float
        Length of the run, of which the last half is judged [s].

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> regime_at(load_material_rig("fluorocarbon-thesis"), 1.0, 0.279e-3, 2214.0).value
    'stick-slip'
    """
    return friction_regime(
        motion_from_rest(rig, speed, interference, support_stiffness, seconds=seconds)
    )


def motion_from_rest(
    rig: Rig,
    speed: float,
    interference: float,
    support_stiffness: float,
    *,
    seconds: float = _SECONDS,
) -> Motion:
    """Run the constant version of a rig from rest at constant speed, as regimes are judged by.

    Parameters, with their units, and errors are as for `regime_at`.

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


def falls_below(
    limit: float, speed: float, value: float, next_speed: float, next_value: float
) -> float:
    """Interpolate where a measure falls below its limit, on logarithmic scales [rad/s].

    A measure that falls below a tenth of the limit counts as a tenth of it.

    Parameters
    ----------
    limit : float
        Such as `sim.analysis.slips.LEAST_SUDDEN` [-].
    speed, next_speed : float
        [rad/s]
    value, next_value : float
        Of the measure there, above the limit and below it [-].

    Examples
    --------
    >>> round(falls_below(0.01, 4.0, 0.02, 8.0, 0.005), 3)
    5.657
    """
    after = max(next_value, 0.1 * limit)
    share = math.log(value / limit) / math.log(value / after)
    return float(speed * (next_speed / speed) ** share)


def _check(speeds: Sequence[float]) -> None:
    rising = all(a < b for a, b in pairwise(speeds))
    if not (speeds and speeds[0] > 0.0 and rising):
        raise ParameterError("critical speeds: the speeds to try must rise from above 0 rad/s")
