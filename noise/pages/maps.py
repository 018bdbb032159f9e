"""Interactive condition maps over speed and interference, coloured by label.

Axes are numeric, so maps of a screen and of measurements are comparable. Areas show labels of a
screen, spots have sounds. The cell of a point ends half-way to its neighbours. Maps of different
points are compared on the union of their cell edges.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from noise.base.labels import Look
from noise.labels.conditions import Place, Range, conditions_map
from noise.pages.cards import round_ticks
from noise.pictures.figure import place_title

MAP_SIZE = (500.0, 300.0)
"""Width and height of a condition map [px]."""

LEVEL_STEPS = (50.0, 60.0, 70.0, 80.0, 90.0)
"""Bounds of the level colours [dB(A)]."""

LEVELS = {
    "level-0": Look("#fdf1cf", "#8a6d2f", "plain", "below 50"),
    "level-1": Look("#fccf96", "#8a6d2f", "plain", "50 to 60"),
    "level-2": Look("#f89b6c", "#7a3600", "plain", "60 to 70"),
    "level-3": Look("#dd5f6b", "#6b1f2e", "plain", "70 to 80"),
    "level-4": Look("#a63a80", "#4b1d3e", "plain", "80 to 90"),
    "level-5": Look("#5e2379", "#2b0d3e", "plain", "90 and more"),
}
"""Looks of the level steps, from soft to loud."""


@dataclass(frozen=True)
class Area:
    """Rectangle of one label [px], `y` from the top."""

    x: float
    y: float
    width: float
    height: float
    label: str


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of a map.

    Parameters
    ----------
    speed_edges : ndarray, shape (n_columns + 1,)
        [rad/s]
    interference_edges : ndarray, shape (n_rows + 1,)
        [mm]
    point : ndarray of int, shape (n_rows, n_columns)
        Index of the point of each cell, lowest row first; -1 without one.
    """

    speed_edges: NDArray[np.float64]
    interference_edges: NDArray[np.float64]
    point: NDArray[np.int64]


def cells_of(speed: NDArray[np.float64], interference: NDArray[np.float64]) -> Cells:
    """Return the cells of the points of a map.

    Parameters
    ----------
    speed, interference : ndarray, shape (n,)
        [rad/s], [mm]

    Examples
    --------
    >>> found = cells_of(np.array([1.0, 3.0, 1.0, 3.0]), np.array([0.2, 0.2, 0.4, 0.4]))
    >>> found.speed_edges, found.point
    (array([0., 2., 4.]), array([[0, 1],
           [2, 3]]))
    """
    columns, column = np.unique(speed, return_inverse=True)
    rows, row = np.unique(interference, return_inverse=True)
    point = np.full((rows.size, columns.size), -1)
    point[row, column] = np.arange(speed.size)
    return Cells(_edges(columns), _edges(rows), point)


def common_cells(maps: Sequence[Cells]) -> list[Cells]:
    """Return maps with the common cells of all of them.

    Parameters
    ----------
    maps : sequence of Cells

    Returns
    -------
    list of Cells
        Maps with the same edges, over the union of their ranges.

    Examples
    --------
    >>> one = cells_of(np.array([1.0, 3.0]), np.array([0.2, 0.2]))
    >>> other = cells_of(np.array([2.0, 4.0, 6.0]), np.array([0.2, 0.2, 0.2]))
    >>> [found.point.tolist() for found in common_cells([one, other])]
    [[[0, 0, 1, 1, -1, -1]], [[-1, 0, 0, 1, 1, 2]]]
    """
    speeds = _merged([one.speed_edges for one in maps])
    fits = _merged([one.interference_edges for one in maps])
    return [Cells(speeds, fits, _looked_up(one, speeds, fits)) for one in maps]


def areas_of(
    cells: Cells, labels: Sequence[str], across: Axis, up: Axis, size: tuple[float, float]
) -> tuple[Area, ...]:
    """Return areas of adjacent cells with the same label.

    Parameters
    ----------
    cells : Cells
    labels : sequence of str
        Of the points.
    across, up : Axis
        In [rad/s] and [mm].
    size : tuple of float
        Width and height of the drawing [px].

    Returns
    -------
    tuple of Area
        Merged cells, lowest row first; no area without a point.

    Examples
    --------
    >>> from noise.pages.maps import axis_of
    >>> cells = cells_of(np.array([1.0, 3.0, 1.0, 3.0]), np.array([0.2, 0.2, 0.4, 0.4]))
    >>> across, up = axis_of([0.0, 4.0], edges=True), axis_of([0.1, 0.5], edges=True)
    >>> areas = areas_of(cells, ["creak", "none", "none", "none"], across, up, (500.0, 300.0))
    >>> [(area.x, area.width, area.label) for area in areas]
    [(0.0, 250.0, 'creak'), (250.0, 250.0, 'none'), (0.0, 500.0, 'none')]
    """
    x = [size[0] * across.share(float(edge)) for edge in cells.speed_edges]
    y = [size[1] * (1.0 - up.share(float(edge))) for edge in cells.interference_edges]
    rows = [
        (number, _runs([labels[one] if one >= 0 else "" for one in row.tolist()]))
        for number, row in enumerate(cells.point)
    ]
    areas = []
    for runs, group in groupby(rows, key=lambda row: row[1]):
        alike = [number for number, _ in group]
        bottom, top = y[alike[0]], y[alike[-1] + 1]
        for first, last, label in runs:
            if label:
                left, width = round(x[first], 2), round(x[last] - x[first], 2)
                areas.append(Area(left, round(top, 2), width, round(bottom - top, 2), label))
    return tuple(areas)


def _runs(labels: Sequence[str]) -> tuple[tuple[int, int, str], ...]:
    """Return start, end and label of runs of equal labels."""
    runs, first = [], 0
    for label, run in groupby(labels):
        end = first + len(list(run))
        runs.append((first, end, label))
        first = end
    return tuple(runs)


def _edges(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return cell edges half-way between neighbours, and as far beyond the ends, not below 0."""
    if values.size == 1:
        half = 0.25 * abs(values[0]) or 1.0
        return np.array([values[0] - half, values[0] + half])
    middles = 0.5 * (values[1:] + values[:-1])
    first = 2 * values[0] - middles[0]
    return np.concatenate(
        ([max(first, 0.0) if values[0] > 0.0 else first], middles, [2 * values[-1] - middles[-1]])
    )


def _middles(edges: NDArray[np.float64]) -> NDArray[np.float64]:
    return 0.5 * (edges[1:] + edges[:-1])


def _merged(edges: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the union of edges without duplicates by rounding."""
    every = np.unique(np.concatenate(edges))
    apart = 1e-9 * max(float(np.ptp(every)), 1e-12)
    return every[np.concatenate(([True], np.diff(every) > apart))]


def _looked_up(
    cells: Cells, speeds: NDArray[np.float64], fits: NDArray[np.float64]
) -> NDArray[np.int64]:
    n_rows, n_columns = cells.point.shape
    row = np.searchsorted(cells.interference_edges, _middles(fits)) - 1
    column = np.searchsorted(cells.speed_edges, _middles(speeds)) - 1
    inside = ((row >= 0) & (row < n_rows))[:, None] & ((column >= 0) & (column < n_columns))
    point = cells.point[row.clip(0, n_rows - 1)[:, None], column.clip(0, n_columns - 1)]
    return np.where(inside, point, -1)


_MARGIN = 0.12  # of an axis, beyond its outermost spots
_MOST_TICKS, _FEWER_TICKS, _SHORT = 7, 4, 4
"""Numbers on an axis; fewer where one has more characters than the last."""

_NEAR = 0.11
"""Distance of spots at which they touch [-]."""


@dataclass(frozen=True)
class Axis:
    """Axis of a map.

    Parameters
    ----------
    low, high : float
        Ends of the axis in its unit, such as [rad/s].
    ticks : tuple of (float, str)
        Position from 0 to 1 [-] and text.
    """

    low: float
    high: float
    ticks: tuple[tuple[float, str], ...]

    def share(self, value: float) -> float:
        """Return the position of a value of the axis from 0 to 1 [-]."""
        return (value - self.low) / (self.high - self.low)


@dataclass(frozen=True)
class Spot:
    """Spot of a map with sounds.

    Parameters
    ----------
    x, y : float
        Position on the axes from 0 to 1 [-].
    label : str
    words : str
        Description.
    sounds : tuple of str
        Ids; successive clicks play successive sounds.
    mates : tuple of str
        Ids of the sound of each compared design there, empty without one.
    """

    x: float
    y: float
    label: str
    words: str
    sounds: tuple[str, ...]
    mates: tuple[str, ...] = ()


@dataclass(frozen=True)
class ConditionMap:
    """Condition map of a page.

    Parameters
    ----------
    title : str
    speed, interference : Axis
    areas : tuple of Area
    spots : tuple of Spot
    note : str
    across : str
        Name of the speed axis.
    height : float
        Height [px].
    design : int or None
        Index of the compared design; None for other maps.
    compared : bool
        Whether it is one of several maps on common axes.
    levels : tuple of Area
        Areas by keys of `LEVELS`, and ``none``.
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
    levels: tuple[Area, ...] = ()


def axis_of(values: Iterable[float], *, edges: bool) -> Axis:
    """Return the axis of values.

    Parameters
    ----------
    values : iterable of float
        In any unit, such as [rad/s].
    edges : bool
        Whether it ends at the outermost values, as areas do, or leaves room for spots.

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
    marks = round_ticks(low, high, _MOST_TICKS)
    if max(len(f"{mark:.6g}") for mark in marks) > _SHORT:
        marks = round_ticks(low, high, _FEWER_TICKS)
    ticks = tuple((round((mark - low) / (high - low), 4), f"{mark:.6g}") for mark in marks)
    return Axis(low, high, ticks)


def recorded_maps(
    rows: Sequence[Mapping[str, object]], titles: Mapping[str, str], with_sound: Iterable[str]
) -> tuple[list[ConditionMap], int]:
    """Return condition maps of recordings by their logged conditions.

    Parameters
    ----------
    rows : sequence of mapping
        Rows of a label table whose files are ids.
    titles : mapping of str to str
        By id.
    with_sound : iterable of str
        Ids of playable sounds.

    Returns
    -------
    maps : list of ConditionMap
        One per material and support.
    left_out : int
        Number of recordings with unknown speed or interference.
    """
    playable = set(with_sound)
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
        apart = _moved_apart(spots)
        note = "" if apart == spots else _MOVED
        maps.append(ConditionMap(title, across, up, (), apart, note))
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


_MOVED = "Spots that would overlap are moved apart in speed; each names its own condition."


def _moved_apart(spots: Sequence[Spot]) -> tuple[Spot, ...]:
    """Move spots that would overlap along the speed, if the map has room for it."""
    apart: list[Spot] = []
    for spot in sorted(spots, key=lambda one: one.x):
        beside = max((one.x for one in apart if abs(one.y - spot.y) < _NEAR), default=-1.0)
        apart.append(replace(spot, x=round(max(spot.x, beside + _NEAR), 4)))
    moved = {(one.x, one.y) for one in apart} - {(one.x, one.y) for one in spots}
    return tuple(apart if moved and apart[-1].x <= 1.0 else spots)


def _title(place: Place) -> str:
    return place_title(place.material, place.support_stiffness)


def _middle(span: Range | None) -> float:
    return math.nan if span is None else span.middle
