"""Single slips as Section 6.3 draws them: over time, against speed, in the phase plane.

Figures 6.1 to 6.7, 6.9 and 6.10. One column a model, because three orbits over each other are none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from models.drawing import BLUE, GREY, VERMILION, styled
from noise.pictures.axes import MODEL_COLOURS, legend_below, new_figure
from noise.pictures.model_traces import SHOWN

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from noise.pictures.model_traces import Trace

__all__ = ["plot_damping", "plot_slip_histories", "plot_slip_orbits", "plot_torque_and_clamp"]


class _Quantity(NamedTuple):
    """What is drawn of a trace, and what its axis says."""

    label: str
    of: Callable[[Trace], NDArray[np.float64]]


_TORQUE = _Quantity("Torque [Nm]", lambda trace: trace.torque)
_DISPLACEMENT = _Quantity("Displacement [mrad]", lambda trace: 1e3 * trace.displacement)
_SLIDING_SPEED = _Quantity("Sliding speed [rad/s]", lambda trace: trace.sliding_speed)
_ACCELERATION = _Quantity("Acceleration [rad/s²]", lambda trace: trace.clamp_acceleration)

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
    shown = (_TORQUE, _DISPLACEMENT, _SLIDING_SPEED)
    with styled():
        figure, axes = _histories(traces, shown, 8.0, title, time_label)
        axes[0, 0].set_xlim(*(1e3 * traces[-1].time[[0, -1]]))
        if peak_speed is not None:
            for panel in axes[-1]:
                panel.axhline(
                    peak_speed, color="black", linestyle="--", linewidth=1.0,
                    label=f"thesis: largest {peak_speed:g} rad/s",
                )  # fmt: skip
            legend_below(figure, columns=1)
        figure.align_ylabels(axes[:, 0])
    return figure


def plot_torque_and_clamp(traces: Sequence[Trace], *, title: str) -> Figure:
    """Draw a settled torque and the clamp's acceleration over time, one column a model (6.9).

    Parameters
    ----------
    traces : sequence of Trace
        Runs of half a second or more, of which the middle is shown; models that do not give the
        clamp's speed are left out.
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
    known = [trace.middle(SHOWN) for trace in traces if trace.clamp_speed is not None]
    with styled():
        figure, axes = _histories(known, (_TORQUE, _ACCELERATION), 6.0, title, "Time [ms]")
        axes[0, 0].set_xlim(0.0, 1e3 * SHOWN)
    return figure


def _histories(
    traces: Sequence[Trace],
    quantities: Sequence[_Quantity],
    height: float,
    title: str,
    time_label: str,
) -> tuple[Figure, NDArray[np.object_]]:
    """Draw quantities over time, one row each, one column a model."""
    figure = new_figure(height, title)
    axes = figure.subplots(len(quantities), len(traces), sharex=True, sharey="row", squeeze=False)
    for column, trace in zip(axes.T, traces, strict=True):
        for panel, quantity in zip(column, quantities, strict=True):
            panel.plot(1e3 * trace.time, quantity.of(trace), color=MODEL_COLOURS[trace.name])
        column[0].set_title(trace.name)
        column[-1].set_xlabel(time_label)
    for panel, quantity in zip(axes[:, 0], quantities, strict=True):
        panel.set_ylabel(quantity.label)
    return figure, axes


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
    across, up = (_DISPLACEMENT, _SLIDING_SPEED) if phase_plane else (_SLIDING_SPEED, _TORQUE)
    with styled():
        figure = new_figure(5.0, title)
        axes = figure.subplots(1, len(traces), sharex=True, sharey=True, squeeze=False)[0]
        for panel, trace in zip(axes, traces, strict=True):
            at_rest = panel.axhline if phase_plane else panel.axvline
            at_rest(0.0, color=GREY, linestyle="--", linewidth=1.0)
            panel.plot(across.of(trace), up.of(trace), color=MODEL_COLOURS[trace.name])
            panel.set_title(trace.name)
            panel.set_xlabel(across.label)
        axes[0].set_ylabel(up.label)
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
                    _DISPLACEMENT.of(trace), _SLIDING_SPEED.of(trace), style, color=colour,
                    label=damping,
                )  # fmt: skip
            panel.axhline(0.0, color=GREY, linestyle=":", linewidth=1.5, label="stick")
            panel.set_title(name)
            panel.set_xlabel(_DISPLACEMENT.label)
        axes[0].set_ylabel(_SLIDING_SPEED.label)
        legend_below(figure, columns=4)
    return figure
