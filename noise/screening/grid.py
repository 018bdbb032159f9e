"""Grid of conditions over which designs are mapped: the caller's, their uses' or their rigs'.

Designs that are compared share one grid, the union of what was asked of each: speeds, fits,
supports, temperatures and swings of all their uses and, where a use says nothing, the fits and
supports that the rig's tables are given for. On an axis that the caller names his values stand
instead. So each point is one of each design, and a rank is never a matter of where was looked.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.condition import FIXED
from models.rig import Rig
from models.show import short_repr
from noise.base.remarks import axis_words
from noise.screening.design import SPEED_STEP, Design, Swinging, Use, spread
from noise.screening.environments import DRY, environment

DEFAULT_SPEEDS = (0.25, 13.0)
"""Default limits of use: the range measured in the thesis [rad/s]."""

_DEFAULT_SUPPORT = 2214.0
_DEFAULT_TEMPERATURE = 23.0
_ALIKE = 1e-6
"""Relative distance below which two values of an axis are equal."""

_MOST_LISTED = 6
"""Largest number of values of an axis that are listed."""

_BEYOND = 1.5
"""A map reaches from the slowest of `DEFAULT_SPEEDS`, or of use, so far beyond the fastest use."""


@short_repr
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
        Slowest and fastest speed of use, of all designs that share it [rad/s].
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

    @property
    def used(self) -> NDArray[np.bool_]:
        """Mask of the speeds of use, shape (n_speeds,); the middle speed where the map has none."""
        speed, (low, high) = np.array(self.speed), self.use
        used = (speed >= low * (1.0 - _ALIKE)) & (speed <= high * (1.0 + _ALIKE))
        if not used.any():
            used[np.argmin(np.abs(speed - 0.5 * (low + high)))] = True
        return used

    @property
    def words(self) -> tuple[str, ...]:
        """Values of each axis as text."""
        moving = "speed" if not self.frequency else "peak speed"
        axes = (
            (moving, self.speed, "rad/s"),
            ("interference", [1e3 * fit for fit in self.interference], "mm"),
            ("support", self.support_stiffness, "Nm/rad"),
            ("temperature", self.temperature, "°C"),
        )
        return tuple(
            f"{name} {axis_words(values, _MOST_LISTED)} {unit}" for name, values, unit in axes
        )


def shared_grid(
    designs: Sequence[Design],
    given: Use | None = None,
    *,
    where: str = DRY,
    swinging: Swinging | None = None,
) -> Grid:
    """Return the common grid over which designs are compared.

    Parameters
    ----------
    designs : sequence of Design
        One at least.
    given : Use, optional
        Conditions that replace those of the designs.
    where : str
        Environment; any but ``dry`` has a temperature of its own.
    swinging : Swinging, optional
        Oscillation of the shaft, instead of constant speed.

    Returns
    -------
    Grid
        The use reaches from the slowest to the fastest speed of any design's.

    Examples
    --------
    >>> from noise.screening.design import load_design
    >>> grid = shared_grid([load_design("natural-rubber"), load_design("PDMS")])
    >>> [round(1e3 * fit, 3) for fit in grid.interference]
    [0.127, 0.254, 0.381]
    """
    given = given or Use()
    uses = [design.use for design in designs]
    stated = [use.speed or given.speed for use in uses if use.speed or given.speed]
    limits = _hull(stated or [DEFAULT_SPEEDS])
    speed = given.speed or _map_speeds([use.speed for use in uses if use.speed])
    if swinging is not None:
        speed = swinging.peak_speed
        limits = 0.0, speed[-1]
    temperature = given.temperature or _merged(*(use.temperature for use in uses))
    if where != DRY:
        temperature = (environment(where).temperature,)
    return Grid(
        speed=speed,
        frequency=() if swinging is None else swinging.frequency,
        interference=given.interference
        or _merged(*(one.use.interference or _fits(one.rig) for one in designs)),
        support_stiffness=given.support_stiffness
        or _merged(*(one.use.support_stiffness or _supports(one.rig) for one in designs)),
        temperature=temperature or (_DEFAULT_TEMPERATURE,),
        use=limits,
    )


def shared_motions(designs: Sequence[Design], given: Use | None = None) -> list[Swinging | None]:
    """Return the motions of the shaft in the maps of designs; None is constant speed.

    Parameters
    ----------
    designs : sequence of Design
    given : Use, optional
        With speeds alone, or with a swing alone, only that is mapped.

    Returns
    -------
    list of Swinging or None
        Swings of all designs, those of one amplitude as one.

    Examples
    --------
    >>> from noise.screening.design import load_design
    >>> shared_motions([load_design("PDMS")], Use(swinging=Swinging(0.26, (1.0, 2.0))))
    [Swinging(amplitude=0.26, frequency=(1.0, 2.0))]
    """
    given = given or Use()
    if given.speed or given.swinging is not None:
        steady: list[Swinging | None] = [None] if given.speed else []
        return steady if given.swinging is None else [*steady, given.swinging]
    swings: dict[float, tuple[float, ...]] = {}
    for one in (design.use.swinging for design in designs):
        if one is not None:
            swings[one.amplitude] = _merged(swings.get(one.amplitude, ()), one.frequency)
    return [None, *(Swinging(*swing) for swing in sorted(swings.items()))]


def _map_speeds(stated: Sequence[tuple[float, ...]]) -> tuple[float, ...]:
    """Return the speeds of a map from the limits or lists of speeds of all uses."""
    if not stated:
        return _spaced(*DEFAULT_SPEEDS)
    lists = [speeds for speeds in stated if len(speeds) > 2]
    limits = [speeds for speeds in stated if len(speeds) <= 2]
    if limits:
        low, high = _hull(limits)
        reach = min(low, DEFAULT_SPEEDS[0]), max(DEFAULT_SPEEDS[1], _BEYOND * high)
        lists.append(_spaced(*reach))
    return _merged(*lists)


def _hull(spans: Iterable[tuple[float, ...]]) -> tuple[float, float]:
    spans = list(spans)
    return min(span[0] for span in spans), max(span[-1] for span in spans)


def _merged(*axes: tuple[float, ...]) -> tuple[float, ...]:
    """Return the rising values of all axes without duplicates."""
    values: list[float] = []
    for value in sorted(itertools.chain(*axes)):
        if not (values and math.isclose(value, values[-1], rel_tol=_ALIKE)):
            values.append(value)
    return tuple(values)


def _spaced(low: float, high: float) -> tuple[float, ...]:
    return spread(low, high, max(2, round((high - low) / SPEED_STEP) + 1))


def _fits(rig: Rig) -> tuple[float, ...]:
    return tuple(fit.interference for fit in rig.fits)


def _supports(rig: Rig) -> tuple[float, ...]:
    """Return the supports for which the rig states damping, by default those of the bench."""
    given = sorted({support for fit in rig.fits for support in fit.damping})
    return tuple(given) if any(math.isfinite(k) for k in given) else (_DEFAULT_SUPPORT, FIXED)
