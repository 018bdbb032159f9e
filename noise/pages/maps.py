"""Maps of labels over speed and interference.

Axes are numeric. The cell of a point ends half-way to its neighbours; adjacent cells of one label
are one area. Spots have sounds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from noise.pages.cards import round_ticks

MAP_SIZE = (500.0, 300.0)
"""Width and largest height of a map [px]."""

_MOST_TICKS, _FEWER_TICKS, _SHORT = 7, 4, 4
"""Numbers on an axis; fewer where one has more characters than the last."""

_APART = 18.0
"""Least distance of numbers that stand at the centres of cells [px]."""


@dataclass(frozen=True, eq=False)
class Axis:
    """Axis of a map.

    Parameters
    ----------
    edges : ndarray, shape (n + 1,)
        Edges of the cells in the unit of the axis, such as [rad/s].
    ticks : tuple of (float, str)
        Position from 0 to 1 [-] and text.
    """

    edges: NDArray[np.float64]
    ticks: tuple[tuple[float, str], ...]

    @property
    def low(self) -> float:
        """Lower end, in the unit of the axis, such as [rad/s]."""
        return float(self.edges[0])

    @property
    def high(self) -> float:
        """Upper end, in the unit of the axis, such as [rad/s]."""
        return float(self.edges[-1])

    def share(self, value: float) -> float:
        """Return the position of a value of the axis from 0 to 1 [-]."""
        return (value - self.low) / (self.high - self.low)


def axis_of(centres: Sequence[float], *, named_over: float = 0.0) -> Axis:
    """Return the axis of cells around centres.

    Parameters
    ----------
    centres : sequence of float
        In any unit, such as [rad/s], ascending.
    named_over : float
        Length of an axis whose numbers stand at the centres if there is room [px]; round numbers
        by default.

    Examples
    --------
    >>> axis_of([1.0, 3.0]).edges, axis_of([1.0, 3.0]).ticks[:2]
    (array([0., 2., 4.]), ((0.0, '0'), (0.25, '1')))
    >>> axis_of([0.178, 0.279], named_over=300.0).ticks
    ((0.25, '0.178'), (0.75, '0.279'))
    """
    values = np.asarray(centres, dtype=float)
    half = 0.5 * np.diff(values) if values.size > 1 else np.array([0.25 * abs(values[0]) or 1.0])
    low = values[0] - half[0]
    if values[0] > 0.0:
        low = max(low, 0.0)
    edges = np.concatenate(([low], values[:-1] + half[: values.size - 1], [values[-1] + half[-1]]))
    axis = Axis(edges, ())
    span = axis.high - axis.low
    if named_over * np.diff(values).min(initial=span) >= _APART * span:
        marks, form = values.tolist(), ".4g"
    else:
        marks, form = round_ticks(axis.low, axis.high, _MOST_TICKS), ".6g"
        if max(len(f"{mark:.6g}") for mark in marks) > _SHORT:
            marks = round_ticks(axis.low, axis.high, _FEWER_TICKS)
    return Axis(edges, tuple((round(axis.share(mark), 4), f"{mark:{form}}") for mark in marks))


@dataclass(frozen=True)
class Area:
    """Rectangle of one label [px], `y` from the top."""

    x: float
    y: float
    width: float
    height: float
    label: str


def areas_of(
    labels: NDArray[np.str_] | Sequence[Sequence[str]], across: Axis, up: Axis, height: float
) -> tuple[Area, ...]:
    """Return areas of adjacent cells with the same label, lowest row first.

    Parameters
    ----------
    labels : array of str, shape (n_rows, n_columns)
        Of the cells, lowest row first.
    across, up : Axis
        In [rad/s] and [mm].
    height : float
        Of the drawing [px].

    Examples
    --------
    >>> axis = axis_of([1.0, 3.0])
    >>> areas = areas_of([["creak", "none"], ["none", "none"]], axis, axis, 300.0)
    >>> [(area.x, area.width, area.label) for area in areas]
    [(0.0, 250.0, 'creak'), (250.0, 250.0, 'none'), (0.0, 500.0, 'none')]
    """
    x = [MAP_SIZE[0] * across.share(float(edge)) for edge in across.edges]
    y = [height * (1.0 - up.share(float(edge))) for edge in up.edges]
    areas, row = [], 0
    for alike, rows in groupby(list(one) for one in np.asarray(labels).tolist()):
        bottom, first = y[row], 0
        row += len(list(rows))
        for label, run in groupby(alike):
            last = first + len(list(run))
            left, width = round(x[first], 2), round(x[last] - x[first], 2)
            areas.append(Area(left, round(y[row], 2), width, round(bottom - y[row], 2), label))
            first = last
    return tuple(areas)


@dataclass(frozen=True)
class Spot:
    """Spot of a map with a sound.

    Parameters
    ----------
    x, y : float
        Position on the axes from 0 to 1 [-].
    label : str
    words : str
        Description.
    sound : str
        Id of the sound.
    mates : tuple of str
        Ids of the sounds of each compared design there, empty without one.
    """

    x: float
    y: float
    label: str
    words: str
    sound: str
    mates: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class ConditionMap:
    """Map of labels over speed and interference.

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
    design : int
        Index of the design.
    """

    title: str
    speed: Axis
    interference: Axis
    areas: tuple[Area, ...]
    spots: tuple[Spot, ...] = ()
    note: str = ""
    across: str = "Speed"
    height: float = MAP_SIZE[1]
    design: int = 0
