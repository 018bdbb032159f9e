"""Torque over time beside its autospectrum, and over the acceleration of the clamp.

The simulated halves of Figures 6.8 and 6.9, whose measured halves are lost.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from features.kernels.spectra import autospectrum
from noise.pictures.axes import MODEL_COLOURS, levels, new_figure, styled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from noise.pictures.model_traces import Trace

__all__ = ["plot_torque_and_clamp", "plot_torque_and_spectrum"]

_SHOWN = 0.08
"""Length of the time histories [s]."""

_HIGHEST = 2000.0
"""Right end of the frequency axis [Hz]."""

_LEVELS = (-80.0, 10.0)
"""Ends of the level axis [dB re (1 Nm)^2/Hz]."""


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
            colour = MODEL_COLOURS[trace.name]
            middle = 0.5 * float(trace.time[-1])
            shown = trace.during(middle, middle + _SHOWN)
            left.plot(1e3 * shown.time, shown.torque, color=colour)
            left.set_title(trace.name)
            left.set_ylabel("Torque [Nm]")
            settled = trace.torque[trace.torque.size // 4 :]
            spectrum = autospectrum(settled, 1.0 / float(trace.time[1] - trace.time[0]))
            below = spectrum.frequency <= _HIGHEST
            right.plot(
                spectrum.frequency[below], levels(spectrum.density[below], 1.0),
                color=colour, linewidth=1.0,
            )  # fmt: skip
            right.set_title(f"bins of {spectrum.spacing:.3g} Hz")
            right.set_ylabel("dB re (1 Nm)²/Hz")
        axes[-1, 0].set_xlabel("Time [ms]")
        axes[-1, 1].set_xlabel("Frequency [Hz]")
        axes[0, 0].set_xlim(0.0, 1e3 * _SHOWN)
        axes[0, 1].set_xlim(0.0, _HIGHEST)
        axes[0, 1].set_ylim(*_LEVELS)
    return figure


def plot_torque_and_clamp(traces: Sequence[Trace], *, title: str) -> Figure:
    """Draw a settled torque and the clamp's acceleration over time, one column a model (6.9).

    Parameters
    ----------
    traces : sequence of Trace
        As `plot_torque_and_spectrum` takes them; models that do not give the clamp's speed are
        left out.
    title : str

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from noise.pictures.model_traces import model_traces
    >>> from noise.thesis.runs import Case
    >>> figure = plot_torque_and_clamp(model_traces(Case(1.0)), title="1 rad/s")
    >>> [axes.get_title("left") for axes in figure.axes[:2]]
    ['equations, exact', 'calibrated']
    """
    known = [trace for trace in traces if trace.clamp_speed is not None]
    with styled():
        figure = new_figure(6.0, title)
        axes = figure.subplots(2, len(known), sharex=True, sharey="row", squeeze=False)
        for (above, below), trace in zip(axes.T, known, strict=True):
            middle = 0.5 * float(trace.time[-1])
            shown = trace.during(middle, middle + _SHOWN)
            colour, time = MODEL_COLOURS[trace.name], 1e3 * shown.time
            above.plot(time, shown.torque, color=colour)
            above.set_title(trace.name)
            if shown.clamp_speed is not None:
                below.plot(time, np.gradient(shown.clamp_speed, shown.time), color=colour)
            below.set_xlabel("Time [ms]")
        axes[0, 0].set_ylabel("Torque [Nm]")
        axes[1, 0].set_ylabel("Acceleration [rad/s²]")
        axes[0, 0].set_xlim(0.0, 1e3 * _SHOWN)
    return figure
