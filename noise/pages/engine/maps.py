"""Condition maps to click on: speed across, interference up, coloured by label.

Axes are numbers, not places in a table, so that the maps of a screen and of a campaign can be laid
beside each other. A map has areas, where a label is known all over, as a screen knows it, and
spots, where there is something to be heard.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from noise.labels.conditions import conditions_map
from noise.pages.engine.page import MAP_SIZE
from noise.pages.engine.ticks import round_ticks
from noise.pictures.titles import place_title

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from noise.labels.conditions import Place, Range
    from noise.pages.engine.cells import Area

__all__ = ["Axis", "ConditionMap", "Spot", "axis_of", "recorded_maps"]

_MARGIN = 0.12  # of an axis, beyond its outermost spots
_MOST_TICKS = 7


@dataclass(frozen=True)
class Axis:
    """Of a map.

    Parameters
    ----------
    low, high : float
        Its ends, in the unit of the axis, such as [rad/s].
    ticks : tuple of (float, str)
        Where along it, from 0 to 1 [-], and what stands there.
    """

    low: float
    high: float
    ticks: tuple[tuple[float, str], ...]

    def share(self, value: float) -> float:
        """Where a value, in the unit of the axis, lies from 0 to 1 [-]."""
        return (value - self.low) / (self.high - self.low)


@dataclass(frozen=True)
class Spot:
    """Where something can be heard.

    Parameters
    ----------
    x, y : float
        Along the axes, from 0 to 1 [-].
    label : str
    words : str
        What is there.
    sounds : tuple of str
        Ids; one click plays the first, the next one the second.
    mates : tuple of str
        Of designs compared, the ids of each one's sound there, empty where it has none.
    """

    x: float
    y: float
    label: str
    words: str
    sounds: tuple[str, ...]
    mates: tuple[str, ...] = ()


@dataclass(frozen=True)
class ConditionMap:
    """One map, drawn by the page.

    Parameters
    ----------
    title : str
    speed, interference : Axis
    areas : tuple of Area
    spots : tuple of Spot
    note : str
    across : str
        What the speed is.
    height : float
        Of the drawing [px].
    design : int or None
        Number of the design among those that are compared with one another; None of any other map.
    compared : bool
        Whether it is one of several maps of the same axes side by side.
    """

    title: str
    speed: Axis
    interference: Axis
    areas: tuple[Area, ...]
    spots: tuple[Spot, ...]
    note: str = ""
    across: str = "Speed"
    height: float = MAP_SIZE[1]
    design: int | None = None
    compared: bool = False


def axis_of(values: Iterable[float], *, edges: bool) -> Axis:
    """Return the axis of values.

    Parameters
    ----------
    values : iterable of float
        In any unit, such as [rad/s].
    edges : bool
        Whether it ends with the outermost values, because areas do, or leaves room for spots.

    Examples
    --------
    >>> axis_of([1.0, 11.0], edges=True).ticks[:2]
    ((0.1, '2'), (0.3, '4'))
    """
    array = np.fromiter(values, dtype=float)
    low, high = float(array.min()), float(array.max())
    room = 0.0 if edges else _MARGIN * (high - low)
    if high - low <= 1e-9 * max(abs(high), 1e-9):
        room = 0.25 * abs(high) or 1.0
    low, high = low - room, high + room
    ticks = tuple(
        (round((tick - low) / (high - low), 4), f"{tick:.6g}")
        for tick in round_ticks(low, high, _MOST_TICKS)
    )
    return Axis(low, high, ticks)


def recorded_maps(
    rows: Sequence[Mapping[str, object]], titles: Mapping[str, str], heard: Iterable[str]
) -> tuple[list[ConditionMap], int]:
    """Lay recordings out by the conditions that were logged with them.

    Parameters
    ----------
    rows : sequence of mapping
        Of a label table whose files are ids.
    titles : mapping of str to str
        By id.
    heard : iterable of str
        Ids that can be played.

    Returns
    -------
    maps : list of ConditionMap
        One a material and support.
    left_out : int
        Recordings whose speed or interference is not known.
    """
    playable = set(heard)
    places = conditions_map(rows)
    known = [p for p in places if p.speed is not None and p.interference is not None]
    placed = {one for place in known for one in place.recordings}
    everything = {one for place in places for one in place.recordings}
    maps = []
    for title, group in groupby(known, key=_title):
        here = list(group)
        across = axis_of([_middle(place.speed) for place in known], edges=False)
        up = axis_of([_middle(place.interference) for place in known], edges=False)
        spots = tuple(_spot(place, across, up, titles, playable) for place in here)
        maps.append(ConditionMap(title, across, up, (), spots))
    return maps, len(everything - placed)


def _spot(
    place: Place, across: Axis, up: Axis, titles: Mapping[str, str], playable: set[str]
) -> Spot:
    sounds = sorted(place.recordings & playable, key=lambda one: titles[one])
    names = ", ".join(titles[one] for one in sorted(place.recordings, key=lambda one: titles[one]))
    speed, fit = _middle(place.speed), _middle(place.interference)
    words = f"{speed:.3g} rad/s, {fit:.3g} mm: {place.label}; {names}"
    x, y = round(across.share(speed), 4), round(up.share(fit), 4)
    return Spot(x, y, place.label, words, tuple(sounds))


def _title(place: Place) -> str:
    return place_title(place.material, place.support_stiffness)


def _middle(found: Range | None) -> float:
    return math.nan if found is None else found.middle
