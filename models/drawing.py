"""Drawing of curves: style, colours, frequency axes, and thinning of long curves.

A curve is thinned to the lowest and the highest point of each column, so that an hour costs no more
than a second and no peak is lost. An axis has a minimum span, so that rounding errors do not look
like a vibration.

Objects draw on the caller's axes in the caller's style, or on axes of a new pyplot figure, which a
notebook shows. Only `axes_or_new` uses pyplot, and matplotlib is imported at the first call.
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
"""Colours that are distinct for all readers (Okabe and Ito, Color universal design, 2008)."""

CURVES = (BLUE, VERMILION, GREEN, ORANGE, "#b5478a", GREY)
"""Colours of curves, in order of use."""


class Look(NamedTuple):
    """Name and unit on an axis, and colour, of a kind of channel."""

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
"""Axis label and colour by kind of channel."""

STYLE = Path(__file__).parent / "data" / "curves.mplstyle"
"""Style sheet of matplotlib for all pictures."""

_SIZE = (9.0, 3.8)
"""Size of a new figure [inch]."""

_COLUMNS = 1200
"""Columns of a thinned curve, which the eye can still resolve."""

_TICKS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1e3, 2e3, 5e3, 10e3, 15e3, 20e3, 50e3, 100e3, 200e3)
"""Ticks of a frequency axis [Hz]."""

_SMALLEST = 1e-60
"""Relative density that replaces zero."""


@contextmanager
def styled() -> Iterator[None]:
    """Use the style of this project within the block.

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
    """Yield `ax`, or by default the axes of a new styled pyplot figure.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> own = Figure().subplots()
    >>> with axes_or_new(own) as axes:
    ...     axes is own
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
    """Reduce a long curve to the lowest and the highest point of each column.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        Curve, each in its own [unit]; `x` rises.
    position : ndarray, shape (n,), optional
        Position of each point on the axis [-], if not proportional to `x`.
    columns : int

    Returns
    -------
    x, y : ndarray, shape (m,)
        In the same [unit], at most ``2 * columns + 2`` points.

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
    points = {0, x.size - 1}
    for start, stop in zip([0, *edges], [*edges, x.size], strict=True):
        if stop > start:
            points.add(int(start + y[start:stop].argmin()))
            points.add(int(start + y[start:stop].argmax()))
    chosen = np.array(sorted(points))
    return x[chosen], y[chosen]


def padded(low: float, high: float, least: float) -> tuple[float, float]:
    """Return limits of an axis slightly wider than `low` to `high`, with at least the span `least`.

    All in the [unit] of the axis.

    Examples
    --------
    >>> padded(0.0, 100.0, 1.0), padded(5.0, 5.0, 1.0)
    ((-4.0, 104.0), (4.46, 5.54))
    """
    middle, half = (low + high) / 2.0, max(high - low, least) / 2.0
    return middle - 1.08 * half, middle + 1.08 * half


def levels(density: NDArray[np.float64], reference: float) -> NDArray[np.float64]:
    """Return the levels of a density, shape (n,) [unit^2/Hz], in dB re (`reference` [unit])^2/Hz.

    Examples
    --------
    >>> levels(np.array([1.0, 0.01]), 1.0).tolist()
    [0.0, -20.0]
    """
    return np.asarray(10.0 * np.log10(np.maximum(density / reference**2, _SMALLEST)))


def frequency_axis(axes: Axes, low: float, high: float) -> None:
    """Set a logarithmic horizontal axis of frequency from `low` to `high` [Hz].

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
