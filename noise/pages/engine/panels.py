"""Panels of a page: small pictures in one size, with their axes in the same place.

Each is an SVG of its own, so that a page lays them out as two columns on a projector and as one on
a telephone, and print stays sharp. No pyplot: a library must not touch the caller's figures,
settings or screen.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator

from models.drawing import frequency_axis

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["COLUMNS", "Panel", "as_svg", "new_panel", "panel_frequencies"]

COLUMNS = 500
"""Steps across a panel that the eye can tell apart."""

_SIZE = (5.2, 2.5)  # [inch]
_AXES = (0.19, 0.215, 0.785, 0.665)
_TICKS = (20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 10e3)  # [Hz]


@dataclass(frozen=True)
class Panel:
    """One picture: an SVG file's bytes, and in words what it shows."""

    svg: bytes
    alt: str


def new_panel(title: str, across: str, up: str) -> tuple[Figure, Axes]:
    """Begin a panel, to be called within `models.drawing.styled`.

    Parameters
    ----------
    title : str
    across, up : str
        What its axes show.

    Examples
    --------
    >>> figure, axes = new_panel("Torque", "Time [ms]", "Torque [Nm]")
    >>> axes.get_xlabel()
    'Time [ms]'
    """
    figure = Figure(figsize=_SIZE)
    axes = figure.add_axes(_AXES)
    axes.set_title(title, loc="left", fontweight="bold", color="#222222")
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    # At the same place in every panel, however wide the numbers are.
    axes.yaxis.set_label_coords(-0.19, 0.5)
    return figure, axes


def panel_frequencies(axes: Axes, low: float, high: float) -> None:
    """Make the horizontal axis one of frequency [Hz], with as many ticks as a panel has room for.

    Examples
    --------
    >>> _, axes = new_panel("Torque", "Frequency [Hz]", "dB")
    >>> panel_frequencies(axes, 20.0, 15e3)
    >>> axes.get_xscale()
    'log'
    """
    frequency_axis(axes, low, high)
    axes.xaxis.set_major_locator(FixedLocator([tick for tick in _TICKS if low <= tick <= high]))


def as_svg(figure: Figure) -> bytes:
    """Write a figure out, the same one as the same bytes.

    Examples
    --------
    >>> as_svg(Figure())[:5]
    b'<?xml'
    """
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    return buffer.getvalue()
