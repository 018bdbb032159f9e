"""Display of modes: a table, and the magnitude of the responses that they make up."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.drawing import CURVES, GREY, axes_or_new, frequency_axis
from models.errors import ParameterError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from features.modal.modes import Modes

_POINTS = 2000
_MARGIN = 0.5
"""Of the lowest natural frequency: where the curve begins on axes that are new."""


def draw_modes(modes: Modes, ax: Axes | None = None) -> Axes:
    """Draw the responses that modes make up; parameters and errors are those of `Modes.plot`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from features.modal.modes import Modes
    >>> one, none = np.ones(1), np.zeros((1, 4))
    >>> mode = Modes(100 * one, 0.02 * one, 1j * one[None], none, one, 200.0)
    >>> draw_modes(mode, Figure().subplots()).get_xlabel()
    'Frequency [Hz]'
    """
    if not modes.frequency.size:
        raise ParameterError("there is no mode that could be drawn")
    low = _MARGIN * float(modes.frequency[0])
    frequency = np.geomspace(low, modes.highest, _POINTS)
    several = len(modes.residues) > 1
    with axes_or_new(ax) as axes:
        measured = axes.has_data()
        for number, response in enumerate(modes.response(frequency)):
            axes.plot(
                frequency, np.abs(response), "--",
                color=CURVES[(number + 1) % len(CURVES)],
                label=f"modes, response {number + 1}" if several else "modes",
            )  # fmt: skip
        for natural in modes.frequency:
            axes.axvline(float(natural), color=GREY, linestyle=":", linewidth=0.9, zorder=1)
        if not measured:
            axes.set_yscale("log")
            frequency_axis(axes, low, modes.highest)
            axes.set_xlabel("Frequency [Hz]")
            axes.set_ylabel("Magnitude [unit of the measured response]")
        axes.legend(loc="best")
    return axes
