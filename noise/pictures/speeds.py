"""Pictures of sweeps: torque against speed (Figure 5.3), and frequency against speed.

One column a support, or a fit: the mean torque as a line in the band between its extremes, above
the rate of the slips and the strongest line of the torque. What the thesis measured is black.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.condition import FIXED
from models.drawing import BLUE, GREEN, GREY, VERMILION, styled
from models.errors import ParameterError
from noise.pictures.axes import MODEL_COLOURS, legend_below, new_figure
from noise.pictures.measured import FIRST_MODE, FITS, LINES, MEAN_TORQUE, V_CRIT1, V_CRIT2
from noise.pictures.titles import support_words

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from noise.pictures.sweep import SweptTorque

__all__ = ["plot_sweep", "plot_torque_of_fits"]

_MEASURED = "black"
_SPEEDS = (1.0, 13.0)
"""Over which the mean torque was measured [rad/s]."""


def plot_sweep(
    sweeps: Mapping[str, SweptTorque], *, title: str, interference_mm: float | None = None
) -> Figure:
    """Draw torque and frequencies against speed, one column a support.

    Parameters
    ----------
    sweeps : mapping of str to SweptTorque
        By the name of the model, all over the same supports.
    title : str
    interference_mm : float, optional
        Fit whose measurements of the fluorocarbon are drawn as well [mm]; none by default.

    Returns
    -------
    matplotlib.figure.Figure

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from noise.pictures.sweep import sweep_torque
    >>> sweep = sweep_torque(load_material_rig("PDMS"), [1.0, 5.0], interference=0.254e-3,
    ...                      support_stiffness=[2214.0])
    >>> figure = plot_sweep({"PDMS": sweep}, title="PDMS, 0.254 mm")
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['Torque [Nm]', 'Frequency [Hz]']
    """
    supports = next(iter(sweeps.values())).support_stiffness
    with styled():
        figure = new_figure(8.4, title)
        axes = figure.subplots(2, len(supports), sharex=True, sharey="row", squeeze=False)
        for i, support in enumerate(supports):
            above, below = axes[:, i]
            above.set_title(support_words(support))
            if interference_mm is not None:
                _draw_measured(above, below, interference_mm, support)
            for j, (name, sweep) in enumerate(sweeps.items()):
                colour = _colour(name, j)
                _draw_torque(above, sweep, i, name, colour)
                below.plot(
                    sweep.speed, sweep.slip_frequency[i], "-", color=colour,
                    label=f"{name}: cycles a second",
                )  # fmt: skip
                below.plot(
                    sweep.speed, sweep.strongest_line[i], "x" if j else "+", color=colour,
                    markersize=6, label=f"{name}: strongest line",
                )  # fmt: skip
            below.set_xlabel("Speed of the shaft [rad/s]")
        axes[0, 0].set_ylabel("Torque [Nm]")
        axes[1, 0].set_ylabel("Frequency [Hz]")
        for row in axes[:, 0]:
            row.set_ylim(bottom=0.0)
        fastest = max(float(sweep.speed.max()) for sweep in sweeps.values())
        axes[1, 0].set_xlim(0.0, 1.03 * fastest)
        legend_below(figure, columns=3)
    return figure


def plot_torque_of_fits(
    sweeps: Mapping[str, Sequence[SweptTorque]], *, title: str, support_stiffness: float = FIXED
) -> Figure:
    """Draw torque against speed, one panel a fit (Figure 5.3).

    Parameters
    ----------
    sweeps : mapping of str to sequence of SweptTorque
        By the name of the model, one sweep for each of the thesis's three fits.
    title : str
    support_stiffness : float
        Which of the sweeps' supports is drawn [Nm/rad].

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        The sweeps have no such support.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from noise.pictures.sweep import sweep_torque
    >>> rig = load_material_rig("fluorocarbon-thesis")
    >>> sweeps = [sweep_torque(rig, [1.0, 5.0], interference=1e-3 * fit, support_stiffness=[FIXED])
    ...           for fit in FITS]
    >>> figure = plot_torque_of_fits({"constant torque": sweeps}, title="Figure 5.3")
    >>> [axes.get_title("left") for axes in figure.axes]
    ['(a) 0.178 mm', '(b) 0.279 mm', '(c) 0.381 mm']
    """
    with styled():
        figure = new_figure(5.2, title)
        axes = figure.subplots(1, len(FITS), sharex=True)
        for i, (panel, fit) in enumerate(zip(axes, FITS, strict=True)):
            panel.set_title(f"({'abc'[i]}) {fit:g} mm")
            _draw_measured(panel, None, fit, support_stiffness)
            for j, (name, of_fits) in enumerate(sweeps.items()):
                sweep = of_fits[i]
                if support_stiffness not in sweep.support_stiffness:
                    raise ParameterError(
                        f"support_stiffness = {support_stiffness:g} Nm/rad was not swept"
                    )
                where = sweep.support_stiffness.index(support_stiffness)
                _draw_torque(panel, sweep, where, name, _colour(name, j))
            panel.set_ylim(bottom=0.0)
            panel.set_xlim(0.0, None)
            panel.set_xlabel("Speed of the shaft [rad/s]")
        axes[0].set_ylabel("Torque [Nm]")
        legend_below(figure, columns=3)
    return figure


def _draw_torque(axes: Axes, sweep: SweptTorque, i: int, name: str, colour: str) -> None:
    axes.fill_between(
        sweep.speed, sweep.low[i], sweep.high[i], color=colour, alpha=0.2, linewidth=0,
        label=f"{name}: lowest to highest",
    )  # fmt: skip
    axes.plot(sweep.speed, sweep.mean[i], color=colour, label=f"{name}: mean torque")


def _draw_measured(
    torque: Axes, frequency: Axes | None, interference_mm: float, support: float
) -> None:
    torque.plot(
        _SPEEDS, 2 * [MEAN_TORQUE[interference_mm]], ":", color=_MEASURED, linewidth=1.8,
        label="thesis: mean torque",
    )  # fmt: skip
    place = interference_mm, support
    panels = [torque] if frequency is None else [torque, frequency]
    for table, style, name in ((V_CRIT1, "--", "stick"), (V_CRIT2, "-.", "oscillation")):
        for axes in panels:
            if place in table:
                axes.axvline(
                    table[place], color=_MEASURED, linestyle=style, linewidth=1.1,
                    label=f"measured: end of {name}",
                )  # fmt: skip
    if frequency is None:
        return
    if support in FIRST_MODE:
        frequency.axhline(
            FIRST_MODE[support], color=GREY, linestyle=":", linewidth=1.8,
            label="measured: first torsional mode",
        )  # fmt: skip
    for line in (line for line in LINES if line[:2] == place):
        frequency.plot(
            line.speed, line.frequency, "o",
            color=_MEASURED, markerfacecolor="none", markersize=8, label="measured: lines",
        )  # fmt: skip
        frequency.annotate(
            line.note, (line.speed, line.frequency), xytext=(-8, 0), textcoords="offset points",
            ha="right", va="center", fontsize=9.0,
        )  # fmt: skip


def _colour(name: str, i: int) -> str:
    return MODEL_COLOURS.get(name, (BLUE, VERMILION, GREEN)[i % 3])
