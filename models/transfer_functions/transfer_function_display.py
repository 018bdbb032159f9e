"""How a response function shows itself: what it spans, and its magnitude over frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.drawing import BLUE, GREY, axes_or_new, frequency_axis
from models.html_table import html_table
from models.transfer_functions.transfer_function import LEAST_COHERENCE, trusted_band

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from models.transfer_functions.transfer_function import Frf

__all__ = ["draw_frf", "frf_html"]


def frf_html(frf: Frf) -> str:
    """Return a response function as a table.

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import Frf
    >>> "2 lines" in frf_html(Frf(np.array([1.0, 2.0]), np.array([1j, 2j]), None, "N", "Pa"))
    True
    """
    f, size = frf.frequency, np.abs(frf.response)
    low, high = trusted_band(frf)
    peak = int(size.argmax())
    unit = f"{frf.output_unit} per {frf.input_unit}"
    rows = [
        ["frequency", f"{f[0]:.5g} to {f[-1]:.5g} Hz, {f.size} lines"],
        ["largest magnitude", f"{size[peak]:.4g} {unit} at {f[peak]:.5g} Hz"],
        ["coherence", "not known" if frf.coherence is None else _coherence(frf.coherence)],
        ["usable", f"{low:.5g} to {high:.5g} Hz" if high else "nowhere"],
    ]
    return html_table(f"{frf.name}: {unit}", rows)


def draw_frf(frf: Frf, ax: Axes | None = None) -> Axes:
    """Draw the magnitude over frequency; parameters are those of `Frf.plot`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from models.transfer_functions.transfer_function import Frf
    >>> frf = Frf(np.array([1.0, 2.0]), np.array([1j, 2j]), None, "N", "Pa")
    >>> draw_frf(frf, Figure().subplots()).get_xlabel()
    'Frequency [Hz]'
    """
    shown = frf.frequency > 0.0
    f, size = frf.frequency[shown], np.abs(frf.response[shown])
    with axes_or_new(ax) as axes:
        name = frf.name
        if frf.coherence is not None:
            axes.plot(f, size, color=GREY, alpha=0.5, linewidth=0.8)
            size = np.where(frf.coherence[shown] >= LEAST_COHERENCE, size, np.nan)
            name += f", coherence of {LEAST_COHERENCE:g} or more"
        axes.plot(f, size, color=BLUE, label=name)
        axes.set_yscale("log")
        frequency_axis(axes, float(f[0]), float(f[-1]))
        axes.set_xlabel("Frequency [Hz]")
        axes.set_ylabel(f"Magnitude [{frf.output_unit} per {frf.input_unit}]")
        axes.legend(loc="best")
    return axes


def _coherence(values: NDArray[np.float64]) -> str:
    return f"median {np.median(values):.3f}, lowest {values.min():.3f}"
