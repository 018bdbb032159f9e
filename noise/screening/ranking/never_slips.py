"""Designs whose contact never lets go in use, which are quiet for no good reason.

A shaft that turns on winds the bushing up until the contact slips. Where it would have to wind it
up further than rubber bears, or longer than a run of the map lasts at the fastest speed of use,
with every fit and support, nothing is known of the design's noise, and it gets no rank; most often
a torque or a stiffness is in another unit. A shaft that swings may well never make the contact
slip, which is a result.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

from models.rig import Rig, effective_stiffness
from noise.screening.map.point import LONGEST_POINT
from sim.analysis.critical_speeds import motion_from_rest
from sim.analysis.regime import never_slips

if TYPE_CHECKING:
    from noise.screening.map.grid import Grid


_MOST_TWIST = 2.0
"""Of a bushing [rad]: one half as thick as its radius is then sheared by 400 %, and tears."""


def why_never_slipping(rig: Rig, grid: Grid) -> str:
    """Say why the contact slips at no point of a map; empty where it does.

    Parameters
    ----------
    rig : Rig
        In its environment.
    grid : Grid

    Examples
    --------
    >>> from noise.screening.design.design import Use, load_design
    >>> from noise.screening.map.grid import grid_of
    >>> design = load_design("fluorocarbon-thesis")
    >>> grid = grid_of(design, Use(speed=(5.0,), interference=(0.279e-3,)))
    >>> why_never_slipping(design.rig, grid)
    ''
    >>> in_nmm = design.rig.changed(critical_torque="x1000", kinetic_torque="x1000")
    >>> why_never_slipping(in_nmm, grid)
    'never slips: the contact holds 10700 Nm, for which the shaft winds the bushing up by 16.1 rad'
    """
    twist, torque, interference, support = min(
        (fit.critical_torque / effective_stiffness(fit, support), fit.critical_torque, at, support)
        for at, support in itertools.product(grid.interference, grid.support_stiffness)
        for fit in (rig.fit(at),)
    )
    swing = bool(grid.frequency)
    fastest = grid.use[1]
    way = fastest / (2.0 * math.pi * min(grid.frequency)) if swing else fastest * LONGEST_POINT
    if twist <= (way if swing else min(way, _MOST_TWIST)):
        return ""
    if not swing and twist <= _MOST_TWIST:
        motion = motion_from_rest(rig, fastest, interference, support, seconds=LONGEST_POINT)
        if not never_slips(motion):
            return ""
    return (
        f"never slips: the contact holds {torque:g} Nm, for which the shaft winds the bushing up "
        f"by {twist:.3g} rad"
    )
