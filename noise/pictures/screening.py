"""The map of a screened design as a picture: labels over speed and interference, a panel a support.

Colours are those of the conditions map. A white line is where steady sliding loses its stability, a
dark one where stick ends, so that what stability alone would have told stands beside what
simulation found. Below the labels is how loud they are. With one fit, or few, a row is a fit.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from noise.labels.looks import LABEL_COLOURS
from noise.pictures.axes import new_figure, styled
from noise.pictures.speeds import support_words
from sim.regime import Regime

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from noise.screening.mapping import DesignMap

__all__ = ["plot_screen"]

_LABELS = ("none", "squeal", "squawk", "creak")
_FEW_ROWS = 8
_LEVELS = 40.0, 100.0
"""Of the colours of levels [dB]."""

_QUIET = "#eef2f5"


def plot_screen(found: DesignMap, *, temperature: int = 0) -> Figure:
    """Draw the map of a design.

    Parameters
    ----------
    found : DesignMap
    temperature : int
        Which of the map's temperatures.

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
    grid = found.grid
    n = len(grid.support_stiffness)
    speed, fit = np.array(grid.speed), 1e3 * np.array(grid.interference)
    few = fit.size <= _FEW_ROWS
    rows = np.arange(fit.size, dtype=np.float64) if few else fit
    moving = "swinging" if grid.frequency else "at constant speed"
    title = f"{found.design}, {found.environment}, {grid.temperature[temperature]:g} °C, {moving}"
    codes = np.select([found.label[temperature] == label for label in _LABELS], range(len(_LABELS)))
    with styled():
        figure = new_figure(7.6 if not few else 3.4 + 0.5 * fit.size, title)
        axes = figure.subplots(2, n, sharex=True, sharey=True, squeeze=False)
        images = []
        for k in range(n):
            above, below = axes[:, k]
            above.set_title(support_words(grid.support_stiffness[k]))
            colours = ListedColormap([LABEL_COLOURS[label] for label in _LABELS])
            across, up = _edges(speed), _edges(rows)
            above.pcolormesh(across, up, codes[k], cmap=colours, vmin=-0.5, vmax=3.5)
            below.set_facecolor(_QUIET)
            level = np.where(
                found.label[temperature, k] == "none", np.nan, found.level[temperature, k]
            )
            images.append(
                below.pcolormesh(
                    across, up, level, cmap="magma_r", vmin=_LEVELS[0], vmax=_LEVELS[1]
                )
            )
            for panel in (above, below):
                panel.grid(visible=False)
            sticks = found.regime[temperature, k] == Regime.STICK_SLIP.value
            _outline(above, speed, rows, np.where(sticks, 1.0, -1.0), "#222222", few=few)
            growth = found.growth[temperature, k]
            if np.isfinite(growth).all():
                _outline(above, speed, rows, growth, "white", few=few)
            below.set_xlabel("Peak speed [rad/s]" if grid.frequency else "Speed [rad/s]")
        for panel in axes[:, 0]:
            panel.set_ylabel("Interference [mm]")
            if few:
                panel.set_yticks(rows, [f"{value:.3g}" for value in fit])
        bar = figure.colorbar(images[0], ax=axes[1, :].tolist(), pad=0.01, aspect=12)
        bar.set_label("L_AFmax [dB]")
        figure.legend(
            handles=[
                *(
                    Patch(facecolor=LABEL_COLOURS[label], edgecolor="#444444", label=label)
                    for label in _LABELS[::-1]
                ),
                Line2D([], [], color="#222222", label="stick ends"),
                *_stability_handle(found),
            ],
            loc="outside lower center",
            ncols=6,
        )
    return figure


def _stability_handle(found: DesignMap) -> list[Line2D]:
    """Key of the white line, where there is one: a swing has no steady sliding."""
    if not np.isfinite(found.growth).all():
        return []
    return [Line2D([], [], color="#999999", linewidth=2.2, label="sliding turns stable (white)")]


def _edges(centres: NDArray[np.float64]) -> NDArray[np.float64]:
    """Edges of the places that points stand in the middle of."""
    if centres.size == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    between = 0.5 * (centres[1:] + centres[:-1])
    first, last = 1.5 * centres[0] - 0.5 * centres[1], 1.5 * centres[-1] - 0.5 * centres[-2]
    return np.concatenate([[first], between, [last]])


def _outline(
    axes: Axes,
    speed: NDArray[np.float64],
    rows: NDArray[np.float64],
    values: NDArray[np.float64],
    colour: str,
    *,
    few: bool,
) -> None:
    """Draw where values pass through zero; a stroke in each row where these are few."""
    if not few:
        if speed.size > 1 and values.min() < 0.0 < values.max():
            axes.contour(speed, rows, values, levels=[0.0], colors=[colour], linewidths=1.6)
        return
    for row, along in zip(rows, values, strict=True):
        for i in np.flatnonzero(np.signbit(along[:-1]) != np.signbit(along[1:])):
            share = along[i] / (along[i] - along[i + 1])
            where = speed[i] + (share if math.isfinite(share) else 0.5) * (speed[i + 1] - speed[i])
            axes.plot([where, where], [row - 0.45, row + 0.45], "-", color=colour, linewidth=1.6)
