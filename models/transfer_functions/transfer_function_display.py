"""Display of a transfer function: a table of what it spans, and its magnitude over frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.drawing import BLUE, GREY, axes_or_new, frequency_axis
from models.html_table import html_table
from models.transfer_functions.coherence import LEAST_COHERENCE, trusted_band

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from models.transfer_functions.transfer_function import TransferFunction

__all__ = ["draw_transfer_function", "transfer_function_html"]


def transfer_function_html(transfer: TransferFunction) -> str:
    """Return a transfer function as a table.

    Examples
    --------
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> f = np.array([1.0, 2.0])
    >>> "2 lines" in transfer_function_html(TransferFunction(f, 1j * f, None, "N", "Pa"))
    True
    """
    f, size = transfer.frequencies, np.abs(transfer.response)
    low, high = trusted_band(transfer)
    peak = int(size.argmax())
    rows = [
        ["frequency", f"{f[0]:.5g} to {f[-1]:.5g} Hz, {f.size} lines"],
        ["largest magnitude", f"{size[peak]:.4g} {transfer.unit} at {f[peak]:.5g} Hz"],
        ["coherence", _coherence(transfer.coherence)],
        ["usable", f"{low:.5g} to {high:.5g} Hz" if high else "nowhere"],
    ]
    return html_table(f"{transfer.name}: {transfer.unit}", rows)


def draw_transfer_function(transfer: TransferFunction, ax: Axes | None = None) -> Axes:
    """Draw the magnitude over frequency; parameters are those of `TransferFunction.plot`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from models.transfer_functions.transfer_function import TransferFunction
    >>> transfer = TransferFunction(np.array([1.0, 2.0]), np.array([1j, 2j]), None, "N", "Pa")
    >>> draw_transfer_function(transfer, Figure().subplots()).get_xlabel()
    'Frequency [Hz]'
    """
    shown = transfer.frequencies > 0.0
    f, size = transfer.frequencies[shown], np.abs(transfer.response[shown])
    with axes_or_new(ax) as axes:
        name = transfer.name
        if transfer.coherence is not None:
            axes.plot(f, size, color=GREY, alpha=0.5, linewidth=0.8)
            size = np.where(transfer.coherence[shown] >= LEAST_COHERENCE, size, np.nan)
            name += f", coherence of {LEAST_COHERENCE:g} or more"
        axes.plot(f, size, color=BLUE, label=name)
        axes.set_yscale("log")
        frequency_axis(axes, float(f[0]), float(f[-1]))
        axes.set_xlabel("Frequency [Hz]")
        axes.set_ylabel(f"Magnitude [{transfer.unit}]")
        axes.legend(loc="best")
    return axes


def _coherence(values: NDArray[np.float64] | None) -> str:
    if values is None:
        return "not known"
    return f"median {np.median(values):.3f}, lowest {values.min():.3f}"
