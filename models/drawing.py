"""Drawing of curves: style, colours, frequency axes, and the thinning of long curves.

A curve is thinned to what the paper can show, the lowest and the highest point of each column, so
that an hour costs no more than a second and no peak is lost. An axis spans no less than what a
reader would call a change, or else rounding errors would look like a vibration.

Objects draw themselves on axes that they are given, in the caller's style, or on those of a new
figure of pyplot, which is what a notebook shows; nothing else here touches pyplot, and nothing that
draws is imported before it is called.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


BLUE, VERMILION, GREEN, ORANGE, GREY = "#0072b2", "#d55e00", "#008060", "#e69f00", "#666666"
"""Told apart by every eye (Okabe and Ito, Color universal design, 2008)."""

CURVES = (BLUE, VERMILION, GREEN, ORANGE, "#b5478a", GREY)
"""Colours of curves, in the order in which they are taken."""


class Look(NamedTuple):
    """Of a kind of channel: its name and unit on an axis, and its colour."""

    name: str
    unit: str
    colour: str


CHANNEL_LOOKS = {
    "torque": Look("Torque", "Nm", BLUE),
    "acceleration": Look("Acceleration", "m/s²", GREEN),
    "pressure": Look("Sound pressure", "Pa", "#222222"),
    "angle": Look("Angle of the shaft", "rad", GREY),
    "speed": Look("Speed of the shaft", "rad/s", VERMILION),
    "force": Look("Force", "N", ORANGE),
}
"""By kind of channel."""

STYLE = Path(__file__).parent / "data" / "curves.mplstyle"
"""Settings of matplotlib, beside its defaults, under which pictures are made and written."""

_SIZE = (9.0, 3.8)
"""Of a new figure [inch]."""

_COLUMNS = 1200
"""Steps across a picture that the eye can tell apart."""

_TICKS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1e3, 2e3, 5e3, 10e3, 15e3, 20e3, 50e3, 100e3, 200e3)
"""Of a frequency axis [Hz]."""

_SMALLEST = 1e-60  # stands for a density of zero


@contextmanager
def styled() -> Iterator[None]:
    """Make figures in the style of this project, leaving the caller's as it is.

    Examples
    --------
    >>> import matplotlib
    >>> with styled():
    ...     matplotlib.rcParams["axes.spines.top"]
    False
    """
    import matplotlib.style

    with matplotlib.style.context(["default", STYLE]):
        yield


@contextmanager
def axes_or_new(ax: Axes | None) -> Iterator[Axes]:
    """Give axes to draw on: those given, or else those of a new figure of pyplot, styled.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> given = Figure().subplots()
    >>> with axes_or_new(given) as axes:
    ...     axes is given
    True
    """
    if ax is not None:
        yield ax
        return
    import matplotlib.pyplot as plt

    with styled():
        yield plt.subplots(figsize=_SIZE, layout="constrained")[1]


def thinned(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    *,
    position: NDArray[np.float64] | None = None,
    columns: int = _COLUMNS,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Keep the lowest and the highest point of each column, where it is too narrow to show more.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        A curve, each in its own [unit]; `x` rises.
    position : ndarray, shape (n,), optional
        Where on the axis each point is drawn, if not in proportion to `x` [-].
    columns : int

    Returns
    -------
    x, y : ndarray, shape (m,)
        In the same [unit], of no more than ``2 * columns + 2`` points.

    Examples
    --------
    >>> x, y = thinned(np.arange(1e6), np.sin(np.arange(1e6)))
    >>> x.size < 2500, bool(y.max() > 0.9999)
    (True, True)
    """
    if x.size <= 2 * columns:
        return x, y
    place = x if position is None else position
    edges = np.searchsorted(place, np.linspace(place[0], place[-1], columns + 1)[1:-1])
    kept = {0, x.size - 1}
    for start, stop in zip([0, *edges], [*edges, x.size], strict=True):
        if stop > start:
            kept.add(int(start + y[start:stop].argmin()))
            kept.add(int(start + y[start:stop].argmax()))
    chosen = np.array(sorted(kept))
    return x[chosen], y[chosen]


def padded(low: float, high: float, least: float) -> tuple[float, float]:
    """Return limits of an axis somewhat wider than from `low` to `high`, and wider than `least`.

    All in the [unit] of the axis.

    Examples
    --------
    >>> padded(0.0, 100.0, 1.0), padded(5.0, 5.0, 1.0)
    ((-4.0, 104.0), (4.46, 5.54))
    """
    middle, half = (low + high) / 2.0, max(high - low, least) / 2.0
    return middle - 1.08 * half, middle + 1.08 * half


def levels(density: NDArray[np.float64], reference: float) -> NDArray[np.float64]:
    """Levels of a spectral density [unit^2/Hz] in dB re (`reference` [unit])^2/Hz, in its shape.

    Examples
    --------
    >>> levels(np.array([1.0, 0.01]), 1.0).tolist()
    [0.0, -20.0]
    """
    return np.asarray(10.0 * np.log10(np.maximum(density / reference**2, _SMALLEST)))


def frequency_axis(axes: Axes, low: float, high: float) -> None:
    """Make the horizontal axis one of frequency, logarithmic from `low` to `high` [Hz].

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> axes = Figure().subplots()
    >>> frequency_axis(axes, 100.0, 1000.0)
    >>> axes.get_xticks().tolist()
    [100.0, 200.0, 500.0, 1000.0]
    """
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    axes.set_xscale("log")
    axes.set_xlim(low, high)
    shown = [tick for tick in _TICKS if low <= tick <= high]
    axes.xaxis.set_major_locator(FixedLocator(shown))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(_frequency))


def _frequency(hertz: float, _: object) -> str:
    return f"{hertz / 1e3:g}k" if hertz >= 1e3 else f"{hertz:g}"
