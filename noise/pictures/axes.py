"""Figures of several panels: their common width, title, legend and colours of models."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from models.drawing import BLUE, GREEN, VERMILION
from noise.base.progress import readable

if TYPE_CHECKING:
    from matplotlib.artist import Artist

__all__ = ["MODEL_COLOURS", "WIDTH", "legend_below", "new_figure"]

MODEL_COLOURS = {
    "listing": GREEN,
    "equations, exact": BLUE,
    "constant torque": BLUE,
    "calibrated": VERMILION,
}
"""Of what the thesis's models are called in its pictures."""

WIDTH = 12.0
"""Of a picture [inch]."""


def new_figure(height: float, title: str) -> Figure:
    """Return an empty figure of the common width, `height` inches high, with its title.

    The title may be the name of a file, which can hold anything: no formula is made of it.

    Examples
    --------
    >>> new_figure(4.0, "5 rad/s").get_size_inches().tolist()
    [12.0, 4.0]
    """
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    figure.suptitle(
        readable(title), fontsize=13.0, fontweight="bold", color="#222222", parse_math=False
    )
    return figure


def legend_below(figure: Figure, *, columns: int) -> None:
    """Put one legend for all panels under them; what several of them show is named once."""
    named: dict[str, Artist] = {}
    for axes in figure.axes:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            named.setdefault(label, handle)
    figure.legend(
        list(named.values()), list(named), loc="outside lower center", ncols=columns,
        columnspacing=1.5,
    )  # fmt: skip
