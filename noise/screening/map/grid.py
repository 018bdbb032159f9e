"""Grid of conditions over which a design is mapped: the caller's, its use's or its rig's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from models.condition import FIXED
from noise.screening.design.axis_values import SPEED_STEP, spread
from noise.screening.design.design import Use
from noise.screening.design.environments import DRY, environment

if TYPE_CHECKING:
    from collections.abc import Sequence

    from models.rig import Rig
    from noise.screening.design.design import Design, Swinging

__all__ = ["DEFAULT_SPEEDS", "Grid", "grid_of"]

DEFAULT_SPEEDS = (0.25, 13.0)
"""Limits of use where nobody says any: the range that the thesis measured [rad/s]."""

_DEFAULT_SUPPORT = 2214.0
_DEFAULT_TEMPERATURE = 23.0
_BEYOND = 1.5
"""A map reaches from the slowest of `DEFAULT_SPEEDS`, or of use, so far beyond the fastest use."""


@dataclass(frozen=True)
class Grid:
    """Conditions of a map.

    Parameters
    ----------
    speed : tuple of float
        [rad/s]; of a swinging shaft the peak.
    frequency : tuple of float
        Of the swing at each speed [Hz]; empty at constant speed.
    interference, support_stiffness, temperature : tuple of float
        [m], [Nm/rad], [degree Celsius]
    use : tuple of float
        Slowest and fastest speed of use [rad/s].
    """

    speed: tuple[float, ...]
    frequency: tuple[float, ...]
    interference: tuple[float, ...]
    support_stiffness: tuple[float, ...]
    temperature: tuple[float, ...]
    use: tuple[float, float]

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Numbers of temperatures, supports, fits and speeds."""
        return (
            len(self.temperature),
            len(self.support_stiffness),
            len(self.interference),
            len(self.speed),
        )


def grid_of(
    design: Design, given: Use | None = None, *, where: str = DRY, swinging: Swinging | None = None
) -> Grid:
    """Return the conditions of a design's map.

    Parameters
    ----------
    design : Design
    given : Use, optional
        What the caller says; it wins over the design's own.
    where : str
        Environment; any but ``dry`` has a temperature of its own.
    swinging : Swinging, optional
        How the shaft swings, instead of turning at constant speed.

    Returns
    -------
    Grid

    Examples
    --------
    >>> from noise.screening.design.design import load_design
    >>> grid_of(load_design("natural-rubber")).shape
    (1, 3, 1, 103)
    """
    given = given or Use()
    use = design.use
    speed = given.speed or use.speed or DEFAULT_SPEEDS
    limits = (use.speed or speed)[0], (use.speed or speed)[-1]
    grid = given.speed or (use.speed if len(use.speed) > 2 else _speeds(limits))
    if not (given.speed or use.speed):
        grid = _spaced(*DEFAULT_SPEEDS)
    if swinging is not None:
        grid = swinging.peak_speed
        limits = 0.0, grid[-1]
    temperature = given.temperature or use.temperature or (_DEFAULT_TEMPERATURE,)
    if where != DRY:
        temperature = (environment(where).temperature,)
    return Grid(
        speed=grid,
        frequency=() if swinging is None else swinging.frequency,
        interference=given.interference or use.interference or _fits(design.rig),
        support_stiffness=given.support_stiffness or use.support_stiffness or _supports(design.rig),
        temperature=temperature,
        use=limits,
    )


def _speeds(limits: Sequence[float]) -> tuple[float, ...]:
    return _spaced(min(limits[0], DEFAULT_SPEEDS[0]), max(DEFAULT_SPEEDS[1], _BEYOND * limits[-1]))


def _spaced(low: float, high: float) -> tuple[float, ...]:
    return spread(low, high, max(2, round((high - low) / SPEED_STEP) + 1))


def _fits(rig: Rig) -> tuple[float, ...]:
    return tuple(fit.interference for fit in rig.fits)


def _supports(rig: Rig) -> tuple[float, ...]:
    """Supports that the rig's damping was given for, else that of the bench."""
    given = sorted({support for fit in rig.fits for support in fit.damping})
    return tuple(given) if any(math.isfinite(k) for k in given) else (_DEFAULT_SUPPORT, FIXED)
