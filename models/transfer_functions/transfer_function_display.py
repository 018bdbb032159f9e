"""Display of a transfer function: a table of what it spans, and its magnitude over frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.drawing import BLUE, GREY, axes_or_new, frequency_axis
from models.transfer_functions.coherence import LEAST_COHERENCE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from models.transfer_functions.transfer_function import TransferFunction


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
