"""Critical speeds: the last speed of stick-slip (V_crit1) and of vibration (V_crit2), and damping.

Tables 5.1 and 5.2 give speeds determined by ear and eye. For a comparison they need a definition:
the rig runs from rest for a second or more, at speeds 0.25 rad/s apart, and `sim.analysis.regime`
judges the last half. V_crit1 is the last speed of stick-slip ("the maximum velocity at which
stick-slip occurs", 5.1.1), V_crit2 the last at which the torque oscillates, islands included, for
measured and simulated rigs alike. The first torsional mode decays slowly: after 0.2 s a decaying
oscillation is not yet distinct from a lasting one. The search starts at the highest speed, so
speeds below both critical speeds cost nothing. All runs use the rig's constant version
(`sim.effects.constant_version`).

The critical damping is the largest damping with stick-slip, by bisection (6.3.2 does it by hand).
There may be several changes between stick and no stick, since slightly less damping can end
stick-slip again at an unlucky phase of the clamp. So the search comes from above.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from models.errors import ParameterError
from models.rig import Fit, Rig
from models.schema import declared
from sim.analysis.regime import Regime, friction_regime
from sim.effects import constant_version
from sim.motion import Motion, simulate_motion
from sim.plan import REGIME_RATE
from sim.shaft import ConstantSpeed

SPEEDS = tuple(0.25 * i for i in range(1, 53))
"""Speeds of the search, from 0.25 to 13 rad/s, the range of the measurements."""

_LEAST = declared(Fit)["damping"].value.low
"""Smallest damping of a fit [Nm s/rad]."""

_HIGHEST, _STEP, _TOLERANCE = 0.3, 0.01, 1e-5
"""Where the search for a damping starts, its first step and its last [Nm s/rad]."""


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
    if not (speeds and speeds[0] > 0.0 and all(a < b for a, b in pairwise(speeds))):
        raise ParameterError("critical speeds: the speeds to try must rise from above 0 rad/s")
    v_crit2 = 0.0
    for speed in reversed(speeds):
        motion = motion_from_rest(rig, speed, interference, support_stiffness)
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
    seconds: float = 1.0,
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


def with_damping(rig: Rig, damping: float) -> Rig:
    """Return a rig with a damping c_E [Nm s/rad] for all fits and supports.

    Zero becomes the smallest damping of a fit.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> rig = with_damping(load_material_rig("fluorocarbon-thesis"), 0.05)
    >>> sorted({c for fit in rig.fits for c in fit.damping.values()})
    [0.05]
    """
    damping = max(damping, _LEAST)
    return replace(rig, fits=tuple(replace(fit, damping={math.inf: damping}) for fit in rig.fits))


def critical_damping(
    rig: Rig, speed: float, *, interference: float, support_stiffness: float
) -> float:
    """Find the largest damping c_E at which a rig has stick-slip.

    Parameters
    ----------
    rig : Rig
        Its own damping is not used, except for its share in the elastomer.
    speed : float
        Speed of the shaft [rad/s].
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.

    Returns
    -------
    float
        [Nm s/rad]; 0 if there is no stick-slip, ``inf`` if there is even at 0.3 Nm s/rad.

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    The thesis prints 0.7599 with a misplaced point; its own program gives 0.0760:

    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> round(critical_damping(rig, 7.5, interference=0.279e-3, support_stiffness=3745.0), 4)
    0.0781
    """

    def sticks(damping: float) -> bool:
        damped = with_damping(rig, damping)
        motion = motion_from_rest(damped, speed, interference, support_stiffness)
        return friction_regime(motion) is Regime.STICK_SLIP

    above, below = math.inf, _HIGHEST
    while not sticks(below):
        if below == 0.0:
            return 0.0
        above, below = below, max(below - _STEP, 0.0)
    if math.isinf(above):
        return above
    while above - below > _TOLERANCE:
        middle = 0.5 * (above + below)
        if sticks(middle):
            below = middle
        else:
            above = middle
    return below
