"""Map of a screened design: which noise is where, in the colours of recorded conditions.

Dark lines are where stick begins and ends as the speed rises, white ones where steady sliding turns
unstable and stable, so that what stability alone would have told stands beside what simulation
found: a noise on the stable side of a white line is one that stick or a running vibration drives.
Below the labels is how loud they are. A row is a fit. A panel in which nothing is heard says so.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from models.drawing import axes_or_new, styled
from noise.base.labels import LABEL_LOOKS, PERSISTS
from noise.pictures.figure import new_figure, support_words
from sim.analysis.regime import Regime

if TYPE_CHECKING:
    from noise.screening.mapping import DesignMap

_SIMULATED = ("none", PERSISTS, "squeal", "squawk", "creak")
_NAMED_ROWS = 8
"""Fits that have their number beside them."""

_LEVELS = 40.0, 100.0
"""Of the colours of levels [dB]."""

_QUIET = "#eef2f5"

_FITS = "Interference [mm]"

_HATCHED: dict[str, Any] = {"fill": False, "linewidth": 0.0, "hatch": "///"}
_DARK: dict[str, Any] = {"color": "#222222", "linewidth": 1.6}
_WHITE: dict[str, Any] = {
    "color": "white",
    "linewidth": 1.6,
    "path_effects": [withStroke(linewidth=3.0, foreground="#555555")],
}
_DASHED: dict[str, Any] = {"linestyle": (0, (3, 1.5))}
LINES: dict[str, dict[str, Any]] = {
    "stick begins": _DARK | _DASHED,
    "stick ends": _DARK,
    "sliding turns unstable": _WHITE | _DASHED,
    "sliding turns stable": _WHITE,
}
"""What happens at a line as the speed rises, and its look in map and key; the white ones have an
edge to be seen by on white."""


def boundary_lines(
    mapped: DesignMap, *, support: int = 0, temperature: int = 0
) -> list[tuple[str, int, float]]:
    """Return the boundary lines of a map: event with rising speed, row, speed.

    Parameters
    ----------
    mapped : DesignMap
    support, temperature : int
        Which of the map's.

    Returns
    -------
    list of (str, int, float)
        One of `LINES`, the number of the fit, and the speed, between the two points of the map that
        differ [rad/s]. Where the shaft swings there is no steady sliding to be stable.

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> one = screen(["PDMS"], Use(speed=(1.0, 5.0), support_stiffness=(2214.0,)))
    >>> boundary_lines(one.maps[0])
    []
    """
    speed, growth = np.array(mapped.grid.speed), mapped.growth[temperature, support]
    sticks = mapped.regime[temperature, support] == Regime.STICK_SLIP.value
    kinds = [(("stick begins", "stick ends"), np.where(sticks, 1.0, -1.0))]
    if np.isfinite(growth).all():
        kinds.append((("sliding turns unstable", "sliding turns stable"), growth))
    return [
        (names[int(along[i] > 0.0)], row, float(np.interp(0.0, *_rising(along, speed, i))))
        for names, values in kinds
        for row, along in enumerate(values)
        for i in np.flatnonzero((along[:-1] > 0.0) != (along[1:] > 0.0)).tolist()
    ]


def _rising(
    along: NDArray[np.float64], speed: NDArray[np.float64], i: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    order = np.argsort(along[i : i + 2])
    return along[i : i + 2][order], speed[i : i + 2][order]


def plot_screen(mapped: DesignMap) -> Figure:
    """Draw the map of a design at its first temperature.

    Parameters
    ----------
    mapped : DesignMap

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from noise.screening.design import Use
    >>> from noise.screening.screen import screen
    >>> one = screen(["PDMS"], Use(speed=(1.0, 5.0), support_stiffness=(2214.0,)))
    >>> [axes.get_title("left") for axes in plot_screen(one.maps[0]).axes[:1]]
    ['2214 Nm/rad']
    """
    grid = mapped.grid
    n = len(grid.support_stiffness)
    speed, rows = _places(mapped)
    moving = "swinging" if grid.frequency else "at constant speed"
    title = f"{mapped.design}, {mapped.environment}, {grid.temperature[0]:g} °C, {moving}"
    with styled():
        figure = new_figure(min(7.6, 3.4 + 0.5 * rows.size), title)
        axes = figure.subplots(2, n, sharex=True, sharey=True, squeeze=False)
        images = []
        for k in range(n):
            above, below = axes[:, k]
            above.set_title(support_words(grid.support_stiffness[k]))
            _draw_labels(above, mapped, 0, k)
            below.set_facecolor(_QUIET)
            level = np.where(mapped.label[0, k] == "none", np.nan, mapped.level[0, k])
            _say_quiet(below, mapped, 0, k)
            images.append(
                below.pcolormesh(
                    _edges(speed),
                    _edges(rows),
                    level,
                    cmap="magma_r",
                    vmin=_LEVELS[0],
                    vmax=_LEVELS[1],
                )
            )
            below.grid(visible=False)
            below.set_xlabel(_speed_words(mapped))
        for panel in axes[:, 0]:
            _name_fits(panel, mapped)
        figure.supylabel(_FITS)
        bar = figure.colorbar(images[0], ax=axes[1, :].tolist(), pad=0.01, aspect=12)
        bar.set_label("Level [dB(A)]")
        figure.legend(
            handles=_handles(*axes[0]),
            loc="outside lower center",
            ncols=8,
            columnspacing=1.3,
        )
    return figure


def plot_map(
    mapped: DesignMap, ax: Axes | None = None, *, support: int = 0, temperature: int = 0
) -> Axes:
    """Draw the noise map of a design for one support on axes.

    Parameters
    ----------
    mapped : DesignMap
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.
    support, temperature : int
        Which of the map's.

    Returns
    -------
    matplotlib.axes.Axes
    """
    grid = mapped.grid
    where = support_words(grid.support_stiffness[support])
    with axes_or_new(ax) as axes:
        _draw_labels(axes, mapped, temperature, support)
        axes.set_xlabel(_speed_words(mapped))
        _name_fits(axes, mapped)
        axes.set_ylabel(_FITS)
        axes.set_title(
            f"{mapped.design}, {mapped.environment}, {grid.temperature[temperature]:g} °C, {where}"
        )
        axes.legend(handles=_handles(axes), fontsize="small")
    return axes


def _places(mapped: DesignMap) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the positions of the points: speeds [rad/s] and rows of fits."""
    return np.array(mapped.grid.speed), np.arange(len(mapped.grid.interference), dtype=np.float64)


def _draw_labels(axes: Axes, mapped: DesignMap, temperature: int, support: int) -> None:
    speed, rows = _places(mapped)
    label = mapped.label[temperature, support]
    codes = np.select([label == name for name in _SIMULATED], range(len(_SIMULATED)))
    colours = ListedColormap([LABEL_LOOKS[name].colour for name in _SIMULATED])
    axes.pcolormesh(_edges(speed), _edges(rows), codes, cmap=colours, vmin=-0.5, vmax=4.5)
    # By rectangles of the cells: a contour would cut off the corners of a field.
    x, y = _edges(speed), _edges(rows)
    for row, column in np.argwhere(label == PERSISTS).tolist():
        size = float(x[column + 1] - x[column]), float(y[row + 1] - y[row])
        axes.add_patch(Rectangle((x[column], y[row]), *size, **_HATCHED))
    axes.grid(visible=False)
    _say_quiet(axes, mapped, temperature, support)
    for name, row, where in boundary_lines(mapped, support=support, temperature=temperature):
        axes.plot([where, where], [row - 0.5, row + 0.5], label=name, **LINES[name])


def _speed_words(mapped: DesignMap) -> str:
    return "Peak speed [rad/s]" if mapped.grid.frequency else "Speed [rad/s]"


def _name_fits(axes: Axes, mapped: DesignMap) -> None:
    fits = mapped.grid.interference
    rows = range(0, len(fits), math.ceil(len(fits) / _NAMED_ROWS))
    axes.set_yticks(list(rows), [f"{1e3 * fits[i]:.3g}" for i in rows])


def _say_quiet(axes: Axes, mapped: DesignMap, temperature: int, support: int) -> None:
    if (mapped.label[temperature, support] == "none").all():
        axes.text(0.5, 0.5, "none", transform=axes.transAxes, ha="center", va="center")


def _handles(*panels: Axes) -> list[Patch | Line2D]:
    """Return the legend handles, with the lines that the panels have."""
    drawn = {line.get_label() for panel in panels for line in panel.get_lines()}
    return [
        *(
            Patch(
                facecolor=LABEL_LOOKS[label].colour,
                edgecolor="#444444",
                label=label,
                hatch="///" if label == PERSISTS else None,
            )
            for label in _SIMULATED[::-1]
        ),
        *(Line2D([], [], **look, label=name) for name, look in LINES.items() if name in drawn),
    ]


def _edges(centres: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return cell edges around centres."""
    if centres.size == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    between = 0.5 * (centres[1:] + centres[:-1])
    first, last = 1.5 * centres[0] - 0.5 * centres[1], 1.5 * centres[-1] - 0.5 * centres[-2]
    return np.concatenate([[first], between, [last]])
