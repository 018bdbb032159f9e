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

    from numpy.typing import NDArray

    from noise.labels.conditions import Place, Range

__all__ = [
    "Area", "Axis", "ConditionMap", "Spot", "areas_of", "axis_of",
    "recorded_maps",
]  # fmt: skip

_WIDTH, _HEIGHT = MAP_SIZE

_MARGIN = 0.12  # of an axis, beyond its outermost spots
_MOST_TICKS = 7
_RASTER = (100, 60)
"""Into how many areas a map is divided whose points make no grid."""


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
class Area:
    """A rectangle of one label, in units of the drawing, `y` from the top."""

    x: float
    y: float
    width: float
    height: float
    label: str


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
    """

    x: float
    y: float
    label: str
    words: str
    sounds: tuple[str, ...]


@dataclass(frozen=True)
class ConditionMap:
    """One map, drawn by the page."""

    title: str
    speed: Axis
    interference: Axis
    areas: tuple[Area, ...]
    spots: tuple[Spot, ...]
    note: str = ""
    across: str = "Speed"


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


def areas_of(
    speed: NDArray[np.float64],
    interference: NDArray[np.float64],
    labels: Sequence[str],
) -> tuple[Axis, Axis, tuple[Area, ...]]:
    """Divide a map among its points.

    Parameters
    ----------
    speed, interference : ndarray, shape (n,)
        [rad/s], [mm]
    labels : sequence of str, length n

    Returns
    -------
    speed, interference : Axis
    areas : tuple of Area
        Each point's surroundings, half-way to its neighbours where the points make a grid, else
        what is nearer to it than to any other; equal neighbours taken together, the lowest row
        first.

    Examples
    --------
    >>> speed, fit = np.array([1.0, 3.0, 1.0, 3.0]), np.array([0.2, 0.2, 0.4, 0.4])
    >>> _, _, areas = areas_of(speed, fit, ["creak", "none", "none", "none"])
    >>> [(area.x, area.width, area.label) for area in areas]
    [(0.0, 250.0, 'creak'), (250.0, 250.0, 'none'), (0.0, 500.0, 'none')]
    """
    columns, rows = np.unique(speed), np.unique(interference)
    at = dict(zip(zip(speed.tolist(), interference.tolist(), strict=True), labels, strict=True))
    if len(at) == columns.size * rows.size:
        x_edges, y_edges = _edges(columns), _edges(rows)
        grid = [[at[column, row] for column in columns] for row in rows]
    else:
        x_edges = np.linspace(columns[0], columns[-1], _RASTER[0] + 1)
        y_edges = np.linspace(rows[0], rows[-1], _RASTER[1] + 1)
        grid = _nearest(x_edges, y_edges, speed, interference, labels)
    across = axis_of(x_edges, edges=True)
    up = axis_of(y_edges, edges=True)
    rows_up = [
        (float(y_edges[number]), float(y_edges[number + 1]), _runs(labels_across))
        for number, labels_across in enumerate(grid)
    ]
    areas = []
    for _, group in groupby(rows_up, key=lambda row: row[2]):
        alike = list(group)
        bottom, top = up.share(alike[0][0]), up.share(alike[-1][1])
        for first, last, label in alike[0][2]:
            left = across.share(float(x_edges[first]))
            right = across.share(float(x_edges[last]))
            areas.append(
                Area(
                    round(_WIDTH * left, 2),
                    round(_HEIGHT * (1.0 - top), 2),
                    round(_WIDTH * (right - left), 2),
                    round(_HEIGHT * (top - bottom), 2),
                    label,
                )
            )
    return across, up, tuple(areas)


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


def _runs(labels: Sequence[str]) -> tuple[tuple[int, int, str], ...]:
    """First, end and label of equal neighbours."""
    runs, first = [], 0
    for label, run in groupby(labels):
        end = first + len(list(run))
        runs.append((first, end, label))
        first = end
    return tuple(runs)


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


def _edges(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Half-way between neighbours, and as far beyond the outermost."""
    if values.size == 1:
        half = 0.25 * abs(values[0]) or 1.0
        return np.array([values[0] - half, values[0] + half])
    middles = 0.5 * (values[1:] + values[:-1])
    return np.concatenate(([2 * values[0] - middles[0]], middles, [2 * values[-1] - middles[-1]]))


def _nearest(
    x_edges: NDArray[np.float64],
    y_edges: NDArray[np.float64],
    speed: NDArray[np.float64],
    interference: NDArray[np.float64],
    labels: Sequence[str],
) -> list[list[str]]:
    """Label of the nearest point at each place, distances being shares of the axes."""
    from scipy.spatial import cKDTree

    width = (x_edges[-1] - x_edges[0]) or 1.0
    height = (y_edges[-1] - y_edges[0]) or 1.0
    tree = cKDTree(np.column_stack((speed / width, interference / height)))
    x = 0.5 * (x_edges[1:] + x_edges[:-1]) / width
    y = 0.5 * (y_edges[1:] + y_edges[:-1]) / height
    _, found = tree.query(np.stack(np.meshgrid(x, y), axis=-1))
    return [[labels[one] for one in row] for row in found]
