"""A static test as pictures: torque over angle with its slope, and the ring-down with its decay."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from models.drawing import BLUE, GREY, VERMILION, styled
from noise.pages.engine.panels import Panel, as_svg, new_panel

if TYPE_CHECKING:
    from noise.identification.ring_down import RingDown
    from noise.identification.static_test import StaticTest

__all__ = ["static_panels"]


def static_panels(test: StaticTest) -> tuple[Panel, ...]:
    """Draw torque over angle, and the ring-down where there is one.

    Parameters
    ----------
    test : StaticTest

    Returns
    -------
    tuple of Panel
    """
    with styled():
        ring = test.ring_down
        return (
            _slope(test),
            *(() if test.elastic else (_parting(test),)),
            *(() if ring is None else (_decay(ring),)),
        )


def _slope(test: StaticTest) -> Panel:
    slope = f"{test.effective_stiffness:.4g} Nm/rad"
    told = (
        "loading and unloading are one line"
        if test.elastic
        else f"loading and unloading part by {100.0 * test.parting:.1f} % of the angle"
    )
    figure, axes = new_panel("Torque over the shaft's angle, slowly", "Angle [mrad]", "Torque [Nm]")
    axes.plot(1e3 * test.angle, test.torque, color=GREY, ls="none", marker=".", ms=2)
    axes.plot(1e3 * test.fitted_angle, test.torque, color=BLUE, lw=1.0, label="regression")
    middle = float(np.median(test.angle - test.torque / test.effective_stiffness))
    ends = np.array([test.torque.min(), test.torque.max()])
    axes.plot(
        1e3 * (middle + ends / test.effective_stiffness), ends, color=VERMILION, ls="--",
        label=f"k_EFF = {slope}",
    )  # fmt: skip
    axes.legend(loc="upper left", fontsize=8)
    return Panel(
        as_svg(figure), f"Torque over angle: {slope} (+-{100 * test.error:.1f} %), {told}."
    )


def _parting(test: StaticTest) -> Panel:
    beyond = test.torque / test.held_stiffness
    figure, axes = new_panel(
        "What yields beside elastomer and beams", "Torque [Nm]", "Angle beyond theirs [mrad]"
    )
    axes.plot(
        test.torque, 1e3 * (test.angle - beyond), color=GREY, ls="none", marker=".", ms=2,
        label="recorded",
    )  # fmt: skip
    axes.plot(test.torque, 1e3 * (test.fitted_angle - beyond), color=BLUE, lw=1.0, label="contact")
    axes.legend(loc="upper left", fontsize=8)
    return Panel(
        as_svg(figure),
        f"Angle beyond that of elastomer and beams; without what yields the slope is "
        f"{test.held_stiffness:.4g} Nm/rad (+-{100.0 * test.held_error:.1f} %).",
    )


def _decay(ring: RingDown) -> Panel:
    time = 1e3 * ring.time
    envelope = float(np.abs(ring.fitted).max()) * np.exp(-ring.decay * ring.time)
    figure, axes = new_panel("After the shaft is held: ring-down", "Time [ms]", "Torque [Nm]")
    axes.plot(time, ring.torque, color=GREY, label="recorded")
    axes.plot(time, ring.fitted, color=BLUE, lw=1.0, label="fitted")
    for side in (1.0, -1.0):
        axes.plot(time, side * envelope, color=VERMILION, ls="--", lw=1.0)
    axes.legend(loc="upper right", fontsize=8)
    ratio = ring.decay / (2.0 * math.pi * ring.frequency)
    return Panel(
        as_svg(figure),
        f"Ring-down at {ring.frequency:.0f} Hz, damping ratio {100.0 * ratio:.2f} %.",
    )
