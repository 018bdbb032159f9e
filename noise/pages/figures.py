"""Figures of a page: panels of lines.

Each panel is an SVG of its own, so that a page lays them out as two columns on a projector and as
one on a telephone, and print stays sharp. No pyplot: a library must not touch the caller's figures,
settings or screen.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator
from numpy.typing import NDArray

from features.kernels.slips import torque_slips
from models.drawing import frequency_axis

COLUMNS = 500
"""Steps across a panel that the eye can tell apart."""

_SIZE = (5.2, 2.5)  # [inch]
_AXES = (0.19, 0.215, 0.765, 0.665)
_TICKS = (20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 10e3)  # [Hz]


@dataclass(frozen=True)
class Panel:
    """SVG picture with alternative text."""

    svg: bytes
    alt: str


def as_svg(figure: Figure) -> bytes:
    """Return a figure as reproducible SVG bytes.

    Examples
    --------
    >>> as_svg(Figure())[:5]
    b'<?xml'
    """
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    return buffer.getvalue()


@dataclass(frozen=True, eq=False)
class Line:
    """Curve of a panel.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        In the units of the axes [-].
    colour, label : str
    width : float
        [point]
    style : str or tuple
        Of matplotlib.
    """

    x: NDArray[np.floating[Any]]
    y: NDArray[np.floating[Any]]
    colour: str
    label: str = ""
    width: float = 1.5
    style: str | tuple[float, tuple[float, float]] = "-"


Ends = tuple[float, float]


def lines_panel(
    title: str,
    across: str,
    up: str,
    lines: Sequence[Line],
    alt: str,
    *,
    across_ends: Ends | None = None,
    up_ends: Ends | None = None,
    frequencies: Ends | None = None,
    legend: str = "",
    room: Ends = (0.0, 0.0),
) -> Panel:
    """Draw lines within `models.drawing.styled`.

    Parameters
    ----------
    title, across, up : str
    lines : sequence of Line
    alt : str
        What the panel shows, in words.
    across_ends, up_ends : tuple of float, optional
        Ends of the axes, in their units [-]; by default what the lines need.
    frequencies : tuple of float, optional
        Ends of the horizontal axis where it is one of frequency [Hz].
    legend : str
        Where it stands; none by default.
    room : tuple of float
        For it below and above the lines, as a share of what they span [-].

    Examples
    --------
    >>> line = Line(np.arange(2.0), np.ones(2), "#222222")
    >>> lines_panel("Torque", "Time [ms]", "Torque [Nm]", [line], "1 Nm throughout.").alt
    '1 Nm throughout.'
    """
    figure = Figure(figsize=_SIZE)
    axes = figure.add_axes(_AXES)
    axes.set_title(title, loc="left", fontweight="bold", color="#222222")
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    # At the same place in every panel, however wide the numbers are.
    axes.yaxis.set_label_coords(-0.19, 0.5)
    for one in lines:
        axes.plot(
            one.x, one.y, color=one.colour, label=one.label or None, lw=one.width, ls=one.style
        )
    low, high = up_ends or axes.get_ylim()
    axes.set_ylim(low - room[0] * (high - low), high + room[1] * (high - low))
    if across_ends is not None:
        axes.set_xlim(*across_ends)
    if frequencies is not None:
        frequency_axis(axes, *frequencies)
        ticks = [tick for tick in _TICKS if frequencies[0] <= tick <= frequencies[1]]
        axes.xaxis.set_major_locator(FixedLocator(ticks))
    if legend:
        axes.legend(loc=legend, fontsize=8)  # type: ignore[call-overload]
    return Panel(as_svg(figure), alt)


LEAD = 0.25
"""Of a window about a slip, before it [-]."""


def cycle_window(torque: NDArray[np.float64], rate: float, length: float) -> tuple[float, bool]:
    """Return the interval in which a torque is shown.

    Parameters
    ----------
    torque : ndarray, shape (n_samples,)
        [N m]
    rate, length : float
        [Hz], [s]

    Returns
    -------
    start : float
        Such that the slip nearest to the middle lies a quarter of `length` behind it [s].
    aligned : bool
        False where there is no slip, and the middle is taken.

    Examples
    --------
    >>> t = np.arange(30000) / 30e3
    >>> start, aligned = cycle_window(8.0 + 2.7 * ((100.0 * t) % 1.0), 30e3, 0.04)
    >>> aligned, round(1e3 * (start + 0.01) % 10.0) % 10
    (True, 0)
    """
    duration = torque.size / rate
    times = torque_slips(torque, rate).times
    inside = times[(times >= LEAD * length) & (times <= duration - (1.0 - LEAD) * length)]
    if not inside.size:
        return max(0.0, 0.5 * (duration - length)), False
    slip = inside[np.abs(inside - 0.5 * duration).argmin()]
    return float(slip) - LEAD * length, True
