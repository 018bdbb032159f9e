"""Each step of an identification as a picture: torque over angle, ring-down, levels, laws."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.drawing import BLUE, GREY, ORANGE, VERMILION, styled
from noise.pages.engine.panels import Panel, as_svg, new_panel

if TYPE_CHECKING:
    from noise.identification.outcome import Forecast, Identification, Number, Seen

__all__ = ["law_panel", "level_panels", "recording_panels"]

_SHOWN = 0.03
"""Of a recording around a slip [s]."""

_AROUND_SLIP = 6e-3
_MARKERS = "osD^v"


def recording_panels(one: Seen) -> tuple[Panel, ...]:
    """Draw what one recording said: the rise in stick, a slip, and what the law foretells.

    Parameters
    ----------
    one : Seen

    Returns
    -------
    tuple of Panel
    """
    with styled():
        panels = (_static(one), _ringing(one))
        return panels if one.forecast is None else (*panels, _forecast(one.forecast))


def _static(one: Seen) -> Panel:
    """Torque over the shaft's angle, with the rise by the effective stiffness."""
    spectrum, fit = one.fit.spectrum, one.fit
    begin, end = _window(one, _SHOWN)
    angle = np.cumsum(spectrum.shaft_speed[begin:end]) / spectrum.rate
    angle -= angle[0]
    torque = spectrum.torque[begin:end]
    stuck = fit.phases.stuck[begin:end]
    bushing = fit.bushing
    compliance = 1.0 / bushing.elastomer_stiffness + 1.0 / bushing.support_stiffness
    figure, axes = new_panel("Torque over the shaft's angle", "Angle [mrad]", "Torque [Nm]")
    axes.plot(1e3 * angle, torque, color=GREY, label="slips")
    axes.plot(1e3 * angle, np.where(stuck, torque, np.nan), color=BLUE, lw=2.0, label="sticks")
    first = int(np.argmin(torque))
    rise = torque[first] + (angle - angle[first]) / compliance
    inside = (rise <= torque.max()) & (angle >= angle[first])
    axes.plot(
        1e3 * angle[inside], rise[inside], color=VERMILION, ls="--",
        label=f"rise by k_EFF = {1.0 / compliance:.4g} Nm/rad",
    )  # fmt: skip
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.55 * (high - low))  # room for the legend
    axes.legend(loc="upper left", fontsize=8)
    return Panel(
        as_svg(figure),
        f"Torque over angle: rises by {1.0 / compliance:.4g} Nm/rad while the contact sticks.",
    )


def _ringing(one: Seen) -> Panel:
    """Torque in the contact and in the cell around a slip."""
    spectrum, contact = one.fit.spectrum, one.fit.contact
    begin, end = _window(one, _AROUND_SLIP)
    time = 1e3 * np.arange(end - begin) / spectrum.rate
    figure, axes = new_panel("Around a slip: what rings, and how it decays", "Time [ms]", "Nm")
    axes.plot(time, spectrum.torque[begin:end], color=BLUE, label="torque cell")
    axes.plot(time, contact.torque[begin:end], color=ORANGE, lw=1.0, label="in the contact")
    for level in (one.values["critical_torque"], one.values["kinetic_torque"]):
        axes.axhline(level, color=GREY, ls=":", lw=1.0)
    axes.legend(loc="lower left", fontsize=8)
    modes = ", ".join(f"{f:.0f} Hz" for f in one.fit.bushing.natural_frequencies())
    return Panel(
        as_svg(figure),
        f"Torques around a slip; modes while it slides at {modes}, damping "
        f"{one.values['damping']:.3g} Nm s/rad.",
    )


def _forecast(forecast: Forecast) -> Panel:
    """Torque of an excerpt, and what the law foretells of it from its first sample on."""
    time = 1e3 * np.arange(forecast.recorded.size) / forecast.rate
    missed = float(np.std(forecast.foretold - forecast.recorded) / np.std(forecast.recorded))
    figure, axes = new_panel("What the law foretells of a cycle", "Time [ms]", "Torque [Nm]")
    axes.plot(time, forecast.recorded, color=GREY, lw=2.5, label="recorded")
    axes.plot(time, forecast.foretold, color=VERMILION, lw=1.0, label="foretold")
    low, high = axes.get_ylim()
    axes.set_ylim(low - 0.25 * (high - low), high)  # room for the legend
    axes.legend(loc="lower right", fontsize=8, ncols=2)
    return Panel(as_svg(figure), f"Recorded and foretold torque; {100.0 * missed:.1f} % is missed.")


def _window(one: Seen, seconds: float) -> tuple[int, int]:
    """Return first and last sample around the slip nearest to the middle."""
    sliding, rate = one.fit.phases.sliding, one.fit.spectrum.rate
    n = min(round(seconds * rate), sliding.size)
    begins = np.flatnonzero(np.diff(sliding.astype(np.int8)) == 1)
    middle = sliding.size // 2
    slip = int(begins[np.argmin(np.abs(begins - middle))]) if begins.size else middle
    begin = min(max(slip - n // 3, 0), sliding.size - n)
    return begin, begin + n


def level_panels(found: Identification) -> tuple[Panel, ...]:
    """Draw torques and stiffness by recording with the pooled values and their intervals.

    Parameters
    ----------
    found : Identification

    Returns
    -------
    tuple of Panel
    """
    with styled():
        return (
            _levels(found, "Torque levels", "Torque", "Nm", ("critical_torque", "kinetic_torque")),
            _levels(
                found, "Elastomer's stiffness", "Stiffness", "Nm/rad", ("elastomer_stiffness",)
            ),
        )


def _levels(found: Identification, title: str, up: str, unit: str, names: tuple[str, ...]) -> Panel:
    figure, axes = new_panel(title, "Speed of the shaft [rad/s]", f"{up} [{unit}]")
    words = []
    colours = (VERMILION, BLUE)
    for name, colour in zip(names, colours, strict=False):
        for k, number in enumerate(n for n in found.numbers if n.name == name):
            own = [one for one in found.seen if _belongs(one, number)]
            speeds = [one.measured.condition.speed for one in own]
            label = f"{name.split('_')[0]}, {1e3 * (number.interference or 0.0):g} mm"
            axes.plot(
                speeds, [one.values[name] for one in own], color=colour, ls="none",
                marker=_MARKERS[k % len(_MARKERS)], ms=5, label=label,
            )  # fmt: skip
            axes.axhspan(number.low, number.high, color=colour, alpha=0.18, lw=0)
            words.append(f"{label}: {number.value:.4g} {unit}")
    axes.set_ylim(0.0, 1.12 * axes.get_ylim()[1])
    axes.legend(loc="lower right", fontsize=8)
    return Panel(as_svg(figure), f"{title}: {'; '.join(words)}.")


def _belongs(one: Seen, number: Number) -> bool:
    return bool(one.levels.slips) and one.measured.condition.interference == number.interference


def law_panel(found: Identification) -> Panel:
    """Draw what each law leaves.

    Parameters
    ----------
    found : Identification

    Returns
    -------
    Panel
    """
    with styled():
        figure, axes = new_panel(
            "What each law misses within a cycle", "Share of the oscillation [%]", ""
        )
        laws = list(reversed(found.laws))
        for row, score in enumerate(laws):
            colour = BLUE if score.law == found.law else GREY
            axes.barh(row, 100.0 * score.missed, color=colour, height=0.6)
        axes.set_yticks(range(len(laws)), [score.law.replace("_", " ") for score in laws])
        axes.tick_params(axis="y", labelsize=8)
        return Panel(
            as_svg(figure),
            "Share of the oscillation that a law does not foretell: "
            + ", ".join(f"{s.law} {100.0 * s.missed:.1f} %" for s in found.laws),
        )
