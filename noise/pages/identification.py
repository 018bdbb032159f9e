"""The report of an identification: the numbers, the law, and each step as a picture."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from models.condition import Condition
from models.drawing import BLUE, GREY, ORANGE, VERMILION, styled
from noise.base.files import atomic
from noise.identification.law_candidates import CANDIDATES
from noise.identification.outcome import Forecast, Identification, Number, Seen, as_json
from noise.identification.quantities import QUANTITIES
from noise.pages.figures import Panel, as_svg, new_panel
from noise.pages.page import page_html, write_page

if TYPE_CHECKING:
    from noise.identification.ring_down import RingDown
    from noise.identification.static_test import StaticTest
    from noise.identification.table_number import TableNumber


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


_WORDS = {candidate.name: candidate.words for candidate in CANDIDATES}


def write_identification(folder: Path, found: Identification) -> None:
    """Write ``rig.toml``, ``identification.json`` and ``report.html``, all whole or none.

    Parameters
    ----------
    folder : Path
        Made where it is not there; older files of these names are replaced.
    found : Identification

    Raises
    ------
    ParameterError
        A file cannot be written.
    """
    data = json.dumps(as_json(found), indent=2, ensure_ascii=False, allow_nan=False)
    html = _html(found)
    with atomic(folder / "rig.toml") as rig, atomic(folder / "identification.json") as path:
        rig.write_text(found.rig_toml, encoding="utf-8")
        # Names of files may hold what no UTF-8 can.
        path.write_bytes(f"{data}\n".encode("utf-8", "backslashreplace"))
        write_page(folder / "report.html", html)


def _html(found: Identification) -> str:
    slipping = [one for one in found.seen if one.levels.slips]
    return page_html(
        "identification.html.j2",
        {},
        {},
        title=_title(found),
        answer=_answer(found),
        numbers=[_row(number) for number in found.numbers],
        levels=level_panels(found) if slipping else (),
        static=[
            (one.name, ", ".join(Condition(None, one.interference, one.support_stiffness).words),
             static_panels(one))
            for one in found.static
        ],
        measured=[_measured(*one) for one in found.measured],
        law_picture=(law_panel(found),) if found.laws else (),
        laws=[
            [
                one.law.replace("_", " "), _WORDS[one.law], f"{100.0 * one.missed:.1f}",
                f"{one.held_out:.2f}", f"{one.trained:.2f}",
            ]
            for one in found.laws
        ],
        recordings=[
            (one.measured.name, _condition(one), recording_panels(one)) for one in slipping
        ],
        rig_toml=found.rig_toml,
        lists=[
            ("Assumed", found.assumed),
            ("Not found", found.not_found),
            ("To know", found.notes),
            ("Left out", [f"{name}: {reason}" for name, reason in found.refused]),
        ],
        held_out=found.held_out,
        margin=f"{100.0 * (found.margin - 1.0):.0f}",
        seconds=f"{found.seconds:.0f}",
    )  # fmt: skip


def _title(found: Identification) -> str:
    sources = [
        f"{n} {what}"
        for n, what in (
            (len(found.seen), "recordings"), (len(found.static), "static tests"),
            (len(found.measured), "measured numbers"),
        )
        if n
    ]  # fmt: skip
    listed = " and ".join(filter(None, (", ".join(sources[:-1]), sources[-1])))
    return f"The rig, identified from {listed}"


def _measured(number: TableNumber, found: float) -> list[str]:
    unit = QUANTITIES[number.item].unit
    at = f"{number}".partition(" at ")[2]
    if QUANTITIES[number.item].at_a_speed:
        at += f", {number.speeds[0]:g} rad/s"
    told = "does not tell" if math.isnan(found) else f"{found:.4g} {unit}"
    return [number.item.replace("_", " "), at, f"{number.value:.4g} {unit}", told]


def _answer(found: Identification) -> list[str]:
    stiffness = [
        f"At {1e3 * (one.interference or 0.0):g} mm the elastomer has "
        f"{one.value:.4g} Nm/rad ({one.low:.4g} to {one.high:.4g})."
        for one in found.numbers
        if one.name == "elastomer_stiffness"
    ]
    if not found.laws:
        return [f"Law of friction as it was known: {found.law.replace('_', ' ')}.", *stiffness]
    chosen = next(score for score in found.laws if score.law == found.law)
    return [
        f"Law of friction: {found.law.replace('_', ' ')} ({_WORDS[found.law]}); within a cycle it "
        f"misses {100.0 * chosen.missed:.1f} % of the oscillation, and over a run it leaves "
        f"{chosen.held_out:.2f} floors on recordings that its fit has not seen.",
        *stiffness,
    ]


def _row(one: Number) -> list[str]:
    at = []
    if one.interference is not None:
        at.append(f"{1e3 * one.interference:g} mm")
    if one.support_stiffness is not None:
        fixed = one.support_stiffness == float("inf")
        at.append("clamp fixed" if fixed else f"{one.support_stiffness:g} Nm/rad")
    return [
        one.name.replace("_", " "), ", ".join(at), f"{one.value:.4g} {one.unit}".rstrip(),
        f"{one.low:.4g} to {one.high:.4g}", str(one.n_recordings or "all"),
    ]  # fmt: skip


def _condition(one: Seen) -> str:
    condition = one.measured.condition
    return ", ".join(replace(condition, speed=float(f"{condition.speed:.3g}")).words)
