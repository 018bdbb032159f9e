"""Display of a run: a table of what moved and sounded, and its torques over time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from models.drawing import BLUE, ORANGE, axes_or_new, thinned
from models.errors import ParameterError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from sim.motion import Motion
    from sim.run import Run

_SHOWN = 0.1
"""A run is drawn from so long before its end [s]: slips can still be told apart."""


Curve = tuple["NDArray[np.float64]", str, str, float]
"""Values, colour, label (empty for none) and line width."""


def torque_curves(motion: Motion, part: slice) -> list[Curve]:
    """Return the torques of a part of a motion, the more important one later and so on top.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.1)
    >>> [label for _, _, label, _ in torque_curves(run.motion, slice(0, 10))]
    ['contact', 'elastomer']
    """
    return [
        (motion.friction_torque[part], ORANGE, "contact", 0.9),
        (motion.torque[part], BLUE, "elastomer", 1.3),
    ]


def draw_torques(
    run: Run, ax: Axes | None = None, *, start: float | None = None, end: float | None = None
) -> Axes:
    """Draw the torques over time; parameters and errors are those of `Run.plot`.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> run = simulate(load_material_rig("PDMS"), 5.0, seconds=0.1)
    >>> draw_torques(run, Figure().subplots(), start=0.02).get_ylabel()
    'Torque [Nm]'
    """
    motion = run.motion
    lasting = motion.torque.size / motion.rate
    end = lasting if end is None else end
    start = max(0.0, end - _SHOWN) if start is None else start
    part = slice(math.ceil(max(0.0, start) * motion.rate), round(end * motion.rate))
    if not motion.torque[part].size:
        raise ParameterError(
            f"start = {start:g} s and end = {end:g} s hold nothing of a run of {lasting:g} s"
        )
    time = np.arange(motion.torque.size)[part] / motion.rate
    with axes_or_new(ax) as axes:
        for values, colour, label, width in torque_curves(motion, part):
            axes.plot(*thinned(time, values), color=colour, linewidth=width, label=label)
        axes.set_xlabel("Time [s]")
        axes.set_ylabel("Torque [Nm]")
        axes.set_title(", ".join(run.recording.condition.words), loc="left")
        axes.legend(loc="best")
    return axes
