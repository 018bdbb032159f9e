"""Autospectra of the torque, one above the other, as Figures 5.14 to 5.18 and 6.8 show them.

The torque has little above 2 kHz, and harmonics stand at equal distances on a linear axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.spectra import autospectrum
from models.drawing import BLUE, GREY, VERMILION, levels, styled
from noise.pictures.axes import MODEL_COLOURS, legend_below, new_figure
from noise.pictures.measured import FIRST_MODE, lines_at
from noise.pictures.model_traces import SHOWN
from noise.pictures.window import oscillates
from noise.thesis.runs import CALIBRATED, RATE, THESIS, motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from noise.pictures.model_traces import Trace
    from noise.thesis.runs import Case

__all__ = ["SpectraColumn", "plot_spectra", "plot_torque_and_spectrum"]

_MODELS = {"constant torque": (THESIS, BLUE), "calibrated": (CALIBRATED, VERMILION)}
_HIGHEST = 2000.0
"""Right end of the frequency axis [Hz]."""

_LEVELS, _LEVELS_OF_ONE = (-80.0, 20.0), (-80.0, 10.0)
"""Ends of the level axis of many cases, and of one [dB re (1 Nm)^2/Hz]."""


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


def plot_torque_and_spectrum(traces: Sequence[Trace], *, title: str) -> Figure:
    """Draw a settled torque over time, and its autospectrum; one row a model (Figure 6.8).

    Parameters
    ----------
    traces : sequence of Trace
        Runs of half a second or more, of which the middle is shown.
    title : str

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from noise.pictures.model_traces import exact_trace
    >>> from noise.thesis.runs import Case
    >>> figure = plot_torque_and_spectrum([exact_trace(Case(1.0))], title="1 rad/s")
    >>> [axes.get_xlabel() for axes in figure.axes]
    ['Time [ms]', 'Frequency [Hz]']
    """
    with styled():
        figure = new_figure(2.6 * len(traces) + 0.6, title)
        axes = figure.subplots(len(traces), 2, sharex="col", sharey="col", squeeze=False)
        for (left, right), trace in zip(axes, traces, strict=True):
            colour, shown = MODEL_COLOURS[trace.name], trace.middle(SHOWN)
            left.plot(1e3 * shown.time, shown.torque, color=colour)
            left.set_title(trace.name)
            left.set_ylabel("Torque [Nm]")
            rate = 1.0 / float(trace.time[1] - trace.time[0])
            frequency, level, spacing = _settled_spectrum(trace.torque, rate)
            right.plot(frequency, level, color=colour, linewidth=1.0)
            right.set_title(f"bins of {spacing:.3g} Hz")
            right.set_ylabel("dB re (1 Nm)²/Hz")
        axes[-1, 0].set_xlabel("Time [ms]")
        axes[-1, 1].set_xlabel("Frequency [Hz]")
        axes[0, 0].set_xlim(0.0, 1e3 * SHOWN)
        axes[0, 1].set_xlim(0.0, _HIGHEST)
        axes[0, 1].set_ylim(*_LEVELS_OF_ONE)
    return figure


def _settled_spectrum(
    torque: NDArray[np.float64], rate: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Frequencies [Hz], levels [dB re (1 Nm)^2/Hz] and their spacing, of all but the onset."""
    spectrum = autospectrum(torque[torque.size // 4 :], rate)
    below = spectrum.frequency <= _HIGHEST
    return spectrum.frequency[below], levels(spectrum.density[below], 1.0), spectrum.spacing


def _draw(axes: Axes, case: Case) -> None:
    silent = []
    for model, (material, colour) in _MODELS.items():
        torque = motion(material, case).torque
        frequency, level, _ = _settled_spectrum(torque, RATE)
        if not oscillates(torque[torque.size // 4 :]):
            level = np.full_like(level, np.nan)
            silent.append(model)
        axes.plot(frequency, level, color=colour, linewidth=1.0, label=model)
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
