"""The friction torque rebuilt from recordings and simulations, over what it may depend on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.drawing import styled
from noise.pages.diagnosis.figures import CURVES, draw
from noise.pages.engine.panels import Panel, as_svg, new_panel

if TYPE_CHECKING:
    from collections.abc import Mapping

    from noise.diagnosis.evidence.friction_curves import FrictionCurves

__all__ = ["contact_panels"]

_OVER = {
    "sliding_speed": ("Friction torque while it slips", "Sliding speed [rad/s]", 1.0),
    "time_stuck": ("Friction torque as a slip begins", "Time stuck before [ms]", 1e3),
    "time": ("Friction torque as a slip begins", "Time [s]", 1.0),
    "angle": ("Friction torque as a slip begins", "Angle turned [rad]", 1.0),
}
"""Title, what is across, and its scale."""


def contact_panels(contacts: Mapping[str, FrictionCurves]) -> tuple[Panel, ...]:
    """Draw the friction torque with its 90 % interval.

    Parameters
    ----------
    contacts : mapping of str to FrictionCurves
        By ``measured``, ``before`` and ``after``.

    Returns
    -------
    tuple of Panel
        None where the measured one is not known.

    Examples
    --------
    >>> contact_panels({})
    ()
    """
    if "measured" not in contacts:
        return ()
    with styled():
        return tuple(_panel(name, contacts) for name in _OVER)


def _panel(over: str, contacts: Mapping[str, FrictionCurves]) -> Panel:
    title, across, scale = _OVER[over]
    figure, axes = new_panel(title, across, "Torque [Nm]")
    words = []
    for name, friction_curves in contacts.items():
        torque_curve, curve = getattr(friction_curves, over), CURVES[name]
        if not torque_curve.x.size:
            continue
        x = scale * torque_curve.x
        axes.fill_between(
            x, torque_curve.low, torque_curve.high, color=curve.colour, alpha=0.18, linewidth=0
        )
        draw(axes, name, x, torque_curve.torque, marker="o")
        words.append(
            f"{curve.label} {torque_curve.torque.min():.3g} to {torque_curve.torque.max():.3g} Nm"
        )
    return Panel(as_svg(figure), f"{title}, over {across.lower()}: {'; '.join(words)}.")
