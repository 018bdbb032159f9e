"""Figures of panels of curves: what is shown is data first, and one function draws it all.

Black is what the thesis measured or printed, colours are what is computed here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import cycle
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from models.drawing import BLUE, GREY, frequency_axis, padded, styled, thinned
from noise.pictures.figure import legend_below, new_figure

_THESIS_COLOUR = "black"
_ROW_HEIGHT, _LOWEST_HEIGHT = 2.3, 4.4
"""[inch]"""


class Curve(NamedTuple):
    """A curve or points, in the units of the panel's axes; without a label it is not explained.

    With `low` it is a pale band from there up to `y`.
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    label: str = ""
    colour: str = BLUE
    style: str = "-"
    low: NDArray[np.float64] | None = None

    @classmethod
    def published(cls, x: ArrayLike, y: ArrayLike, label: str, style: str = "o") -> Curve:
        """Return points or a line that the thesis has.

        Examples
        --------
        >>> Curve.published([0.0], [26.0], "26 K").label
        'thesis: 26 K'
        """
        values = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        return cls(*values, f"thesis: {label}", _THESIS_COLOUR, style)


@dataclass(frozen=True, eq=False)
class Panel:
    """What one pair of axes shows.

    Parameters
    ----------
    title, across, up : str
        Above it, and of its axes with their units.
    curves : sequence of Curve
    marks : mapping of str to float
        Values that the thesis names, upright lines by what the legend calls them [unit of the
        axis].
    span : tuple of float, optional
        Ends of the horizontal axis [unit of the axis]; by default those of the curves.
    log_frequency : bool
        Whether the horizontal axis is one of frequency, logarithmic over `span`.
    least, most : float
        What the vertical axis spans at least, and at most down from its top [unit of the axis].
    from_zero : bool
        Whether the vertical axis begins at zero.
    note : str
        Said in the panel.
    """

    title: str
    across: str
    up: str
    curves: Sequence[Curve]
    marks: Mapping[str, float] = field(default_factory=dict)
    span: tuple[float, float] | None = None
    log_frequency: bool = False
    least: float = 0.0
    most: float = math.inf
    from_zero: bool = False
    note: str = ""


def plot_panels(grid: Sequence[Sequence[Panel]], *, title: str) -> Figure:
    """Draw rows of panels; those of a row, or a column, with the same label share their axis.

    Parameters
    ----------
    grid : sequence of sequence of Panel
        Rows of the same length.
    title : str

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> line = Curve(np.array([0.0, 1.0]), np.array([0.0, 665.0]), "665 Nm/rad")
    >>> figure = plot_panels([[Panel("stuck", "Angle [rad]", "Torque [Nm]", [line])]], title="")
    >>> figure.axes[0].get_ylabel()
    'Torque [Nm]'
    """
    columns = list(zip(*grid, strict=True))
    one_x = all(len({panel.across for panel in column}) == 1 for column in columns)
    one_y = all(len({panel.up for panel in row}) == 1 for row in grid)
    with styled():
        figure = new_figure(max(_LOWEST_HEIGHT, 1.4 + _ROW_HEIGHT * len(grid)), title)
        axes = figure.subplots(
            len(grid),
            len(columns),
            squeeze=False,
            sharex="col" if one_x else False,
            sharey="row" if one_y else False,
        )
        for row, panels in zip(axes, grid, strict=True):
            for place, panel in zip(row, panels, strict=True):
                _draw(place, panel)
            for place, panel in zip(row[: 1 if one_y else None], panels, strict=False):
                place.set_ylabel(panel.up)
            if one_y:
                _limit(row[0], panels)
        for i, (row, panels) in enumerate(zip(axes, grid, strict=True)):
            if i == len(grid) - 1 or not one_x:
                for place, panel in zip(row, panels, strict=True):
                    place.set_xlabel(panel.across)
        for column in axes.T:
            figure.align_ylabels(column)
        if any(place.get_legend_handles_labels()[0] for place in figure.axes):
            legend_below(figure, columns=3)
    return figure


def _draw(axes: Axes, panel: Panel) -> None:
    for x, y, label, colour, style, low in panel.curves:
        if low is not None:
            axes.fill_between(x, low, y, color=colour, alpha=0.2, linewidth=0.0, label=label)
            continue
        line = "-" in style or style == ":"
        shown = thinned(x, y) if line and np.all(np.diff(x) >= 0.0) else (x, y)
        axes.plot(
            *shown, style, color=colour, label=label or None, linewidth=1.1, zorder=2 if line else 3
        )
    for (label, value), style in zip(panel.marks.items(), cycle((":", "--", "-.")), strict=False):
        axes.axvline(
            value,
            color=_THESIS_COLOUR,
            linestyle=style,
            linewidth=1.2,
            zorder=1,
            label=f"thesis: {label}",
        )
    axes.text(0.99, 0.97, panel.note, transform=axes.transAxes, ha="right", va="top", color=GREY)
    axes.set_title(panel.title)
    if panel.log_frequency and panel.span:
        frequency_axis(axes, *panel.span)
    elif panel.span:
        axes.set_xlim(*panel.span)
    _limit(axes, [panel])


def _limit(axes: Axes, panels: Sequence[Panel]) -> None:
    """Span the vertical axis that the panels share."""
    curves = [curve for panel in panels for curve in panel.curves]
    lows = [curve.low for curve in curves if curve.low is not None]
    drawn = np.concatenate([np.empty(0), *(curve.y for curve in curves), *lows])
    drawn = drawn[np.isfinite(drawn)]
    if not drawn.size:
        return
    top = float(drawn.max())
    low = max(float(drawn.min()), top - panels[0].most)
    low, high = padded(low, top, panels[0].least)
    axes.set_ylim(min(0.0, low) if panels[0].from_zero else low, high)
