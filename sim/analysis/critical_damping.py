"""Critical damping: the largest damping with stick-slip, by bisection (6.3.2 does it by hand).

There may be several changes between stick and no stick, since slightly less damping can end
stick-slip again at an unlucky phase of the clamp. So the search comes from above.
"""

import math
from collections.abc import Callable
from dataclasses import replace

from models.errors import ParameterError
from models.rig import Fit, Rig
from models.schema import declared
from sim.analysis.critical_speeds import motion_from_rest
from sim.analysis.regime import Regime, friction_regime

_LEAST = declared(Fit)["damping"].value.low
"""Smallest damping of a fit [Nm s/rad]."""

_STEP = 0.01
"""Step of the search for a bracket [Nm s/rad]."""


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
    rig: Rig,
    speed: float,
    *,
    interference: float,
    support_stiffness: float,
    highest: float = 0.3,
    tolerance: float = 1e-5,
    seconds: float = 1.0,
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
    highest : float
        Where the search starts [Nm s/rad].
    tolerance : float
        [Nm s/rad]
    seconds : float
        Length of each run, of which the last half is judged [s].

    Returns
    -------
    float
        [Nm s/rad]; 0 if there is no stick-slip, ``inf`` if there is even at `highest`.

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    The thesis prints 0.7599 with a misplaced point; its own program gives 0.0760:

    >>> from models.rig_file import load_material_rig
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> round(critical_damping(rig, 7.5, interference=0.279e-3, support_stiffness=3745.0,
    ...                        highest=0.1), 4)
    0.0781
    """

    def sticks(damping: float) -> bool:
        motion = motion_from_rest(
            with_damping(rig, damping), speed, interference, support_stiffness, seconds=seconds
        )
        return friction_regime(motion) is Regime.STICK_SLIP

    return largest_sticking(sticks, highest, tolerance)


def largest_sticking(sticks: Callable[[float], bool], highest: float, tolerance: float) -> float:
    """Find the largest damping at which `sticks` is true, by steps from above and bisection.

    Parameters
    ----------
    sticks : callable
        Function of a damping [Nm s/rad].
    highest, tolerance : float
        [Nm s/rad]

    Returns
    -------
    float
        [Nm s/rad]; 0 if `sticks` is nowhere true, ``inf`` if it is at `highest`.

    Raises
    ------
    ParameterError
        If limits are not positive.

    Examples
    --------
    >>> round(largest_sticking(lambda c: c < 0.0777 or 0.1 < c < 0.123, 0.3, 1e-5), 4)
    0.123
    """
    if not (highest > 0.0 and tolerance > 0.0):
        raise ParameterError(
            f"critical damping: highest = {highest:g} and tolerance = {tolerance:g} must be "
            "positive"
        )
    if sticks(highest):
        return math.inf
    above = highest
    below = max(highest - _STEP, 0.0)
    while not sticks(below):
        if below == 0.0:
            return 0.0
        above, below = below, max(below - _STEP, 0.0)
    while above - below > tolerance:
        middle = 0.5 * (above + below)
        if sticks(middle):
            below = middle
        else:
            above = middle
    return below
