"""Single slips as Section 6.3 draws them: over time, against speed, in the phase plane.

Figures 6.1 to 6.7 and 6.10. One column a model, because three orbits over each other are none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from noise.pictures.axes import (
    BLUE,
    GREY,
    MODEL_COLOURS,
    VERMILION,
    legend_below,
    new_figure,
    styled,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure

    from noise.pictures.model_traces import Trace

__all__ = ["plot_damping", "plot_slip_histories", "plot_slip_orbits"]

_DAMPINGS = ((BLUE, "-"), ("black", "--"), (VERMILION, "-"))


def plot_slip_histories(
    traces: Sequence[Trace], *, title: str, time_label: str, peak_speed: float | None = None
) -> Figure:
    """Draw torque, displacement and sliding speed over time, one column a model.

    Parameters
    ----------
    traces : sequence of Trace
        What is to be shown of each model.
    title, time_label : str
    peak_speed : float, optional
        Largest sliding speed that the thesis names, drawn as a line [rad/s].

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    Figures 6.1, 6.4 and 6.7.

    Examples
    --------
    >>> from noise.pictures.model_traces import model_traces
    >>> from noise.thesis.runs import Case
    >>> figure = plot_slip_histories(model_traces(Case(10.0), 0.02), title="from rest",
    ...                              time_label="Time [ms]")
    >>> [axes.get_title("left") for axes in figure.axes[:3]]
    ['listing', 'equations, exact', 'calibrated']
    """
    with styled():
        figure = new_figure(8.0, title)
        axes = figure.subplots(3, len(traces), sharex=True, sharey="row", squeeze=False)
        for column, trace in zip(axes.T, traces, strict=True):
            colour, time = MODEL_COLOURS[trace.name], 1e3 * trace.time
            column[0].plot(time, trace.torque, color=colour)
            column[1].plot(time, 1e3 * trace.displacement, color=colour)
            column[2].plot(time, trace.sliding_speed, color=colour)
            column[0].set_title(trace.name)
            column[2].set_xlabel(time_label)
            column[2].set_xlim(time[0], time[-1])
            if peak_speed is not None:
                column[2].axhline(
                    peak_speed, color="black", linestyle="--", linewidth=1.0,
                    label=f"thesis: largest {peak_speed:g} rad/s",
                )  # fmt: skip
        names = ("Torque [Nm]", "Displacement [mrad]", "Sliding speed [rad/s]")
        for row, name in zip(axes[:, 0], names, strict=True):
            row.set_ylabel(name)
        if peak_speed is not None:
            legend_below(figure, columns=1)
        figure.align_ylabels(axes[:, 0])
    return figure


def plot_slip_orbits(traces: Sequence[Trace], *, title: str, phase_plane: bool) -> Figure:
    """Draw orbits, one panel a model.

    Parameters
    ----------
    traces : sequence of Trace
        What is to be shown of each model.
    title : str
    phase_plane : bool
        Whether sliding speed is drawn against displacement (Figures 6.3 and 6.6), or the torque
        against sliding speed (Figures 6.2 and 6.5).

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from noise.pictures.model_traces import exact_trace
    >>> from noise.thesis.runs import Case
    >>> figure = plot_slip_orbits([exact_trace(Case(1.0), 0.02)], title="", phase_plane=True)
    >>> figure.axes[0].get_xlabel()
    'Displacement [mrad]'
    """
    with styled():
        figure = new_figure(5.0, title)
        axes = figure.subplots(1, len(traces), sharex=True, sharey=True, squeeze=False)[0]
        for panel, trace in zip(axes, traces, strict=True):
            if phase_plane:
                x, y = 1e3 * trace.displacement, trace.sliding_speed
                panel.set_xlabel("Displacement [mrad]")
                panel.axhline(0.0, color=GREY, linestyle="--", linewidth=1.0)
            else:
                x, y = trace.sliding_speed, trace.torque
                panel.set_xlabel("Sliding speed [rad/s]")
                panel.axvline(0.0, color=GREY, linestyle="--", linewidth=1.0)
            panel.plot(x, y, color=MODEL_COLOURS[trace.name])
            panel.set_title(trace.name)
        axes[0].set_ylabel("Sliding speed [rad/s]" if phase_plane else "Torque [Nm]")
    return figure


def plot_damping(panels: Mapping[str, Mapping[str, Trace]], *, title: str) -> Figure:
    """Draw phase planes of three dampings over each other (Figure 6.10).

    Parameters
    ----------
    panels : mapping of str to mapping of str to Trace
        By the title of the panel and the name of the damping, what is to be shown; the names are
        those of the first panel.
    title : str

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from noise.pictures.model_traces import exact_trace
    >>> from noise.thesis.runs import Case
    >>> traces = {f"{c:g}": exact_trace(Case(7.5, damping=c), 0.01) for c in (0.05, 0.08, 0.1)}
    >>> len(plot_damping({"exact": traces}, title="").axes[0].lines)
    4
    """
    with styled():
        figure = new_figure(6.2, title)
        axes = figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0]
        for panel, (name, traces) in zip(axes, panels.items(), strict=True):
            for (damping, trace), (colour, style) in zip(traces.items(), _DAMPINGS, strict=True):
                panel.plot(
                    1e3 * trace.displacement, trace.sliding_speed, style, color=colour,
                    label=damping,
                )  # fmt: skip
            panel.axhline(0.0, color=GREY, linestyle=":", linewidth=1.5, label="stick")
            panel.set_title(name)
            panel.set_xlabel("Displacement [mrad]")
        axes[0].set_ylabel("Sliding speed [rad/s]")
        legend_below(figure, columns=4)
    return figure
