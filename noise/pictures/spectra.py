"""Autospectra of the torque, one above the other, as Figures 5.14 to 5.18 compare them.

The torque has little above 2 kHz, and harmonics stand at equal distances on a linear axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.spectra import autospectrum
from noise.pictures.axes import (
    BLUE,
    GREY,
    VERMILION,
    legend_below,
    levels,
    new_figure,
    styled,
)
from noise.pictures.measured import FIRST_MODE, lines_at
from noise.pictures.window import oscillates
from noise.thesis.runs import CALIBRATED, RATE, THESIS, motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from noise.thesis.runs import Case

__all__ = ["SpectraColumn", "plot_spectra"]

_MODELS = {"constant torque": (THESIS, BLUE), "calibrated": (CALIBRATED, VERMILION)}
_HIGHEST = 2000.0
"""Right end of the frequency axis [Hz]."""

_LEVELS = (-80.0, 20.0)
"""Ends of the level axis [dB re (1 Nm)^2/Hz]."""


@dataclass(frozen=True)
class SpectraColumn:
    """Cases whose spectra stand above each other.

    Parameters
    ----------
    title : str
        What the cases have in common.
    cases : tuple of Case
    names : tuple of str
        What each of them differs by.
    """

    title: str
    cases: tuple[Case, ...]
    names: tuple[str, ...]


def plot_spectra(columns: Sequence[SpectraColumn], *, title: str) -> Figure:
    """Draw the torque's autospectra, once settled, of the two models.

    Parameters
    ----------
    columns : sequence of SpectraColumn
        Of the same number of cases each.
    title : str

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from noise.thesis.runs import Case
    >>> column = SpectraColumn("2214 Nm/rad", (Case(1.0), Case(2.5)), ("1 rad/s", "2.5 rad/s"))
    >>> [axes.get_title("left") for axes in plot_spectra([column], title="torque").axes]
    ['2214 Nm/rad, 1 rad/s', '2214 Nm/rad, 2.5 rad/s']
    """
    n = len(columns[0].cases)
    with styled():
        figure = new_figure(1.4 + 2.1 * n, title)
        axes = figure.subplots(n, len(columns), sharex=True, sharey=True, squeeze=False)
        for column, rows in zip(columns, axes.T, strict=True):
            for panel, case, name in zip(rows, column.cases, column.names, strict=True):
                panel.set_title(f"{column.title}, {name}")
                _draw(panel, case)
            rows[-1].set_xlabel("Frequency [Hz]")
        axes[0, 0].set_xlim(0.0, _HIGHEST)
        axes[0, 0].set_ylim(*_LEVELS)
        figure.supylabel("Torque [dB re (1 Nm)²/Hz]", fontsize=11.0)
        legend_below(figure, columns=4)
    return figure


def _draw(axes: Axes, case: Case) -> None:
    silent = []
    for model, (material, colour) in _MODELS.items():
        run = motion(material, case)
        torque = run.torque[run.torque.size // 4 :]
        spectrum = autospectrum(torque, RATE)
        shown = spectrum.frequency <= _HIGHEST
        level = levels(spectrum.density, 1.0)
        if not oscillates(torque):
            level = np.full_like(level, np.nan)
            silent.append(model)
        axes.plot(spectrum.frequency[shown], level[shown], color=colour, linewidth=1.0, label=model)
    if silent:
        axes.text(
            0.99, 0.97, f"steady sliding: {', '.join(silent)}", transform=axes.transAxes,
            ha="right", va="top", color=GREY, fontsize=10.0,
        )  # fmt: skip
    if case.support_stiffness in FIRST_MODE:
        axes.axvline(
            FIRST_MODE[case.support_stiffness], color=GREY, linestyle="--", linewidth=1.0,
            label="measured: first torsional mode",
        )  # fmt: skip
    lines = lines_at(case.interference_mm, case.support_stiffness, case.speed)
    if lines:
        low = [_LEVELS[0] + 6.0] * len(lines)
        axes.plot(lines, low, "^", color="black", label="measured: lines")
