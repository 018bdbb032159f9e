"""Pictures of the thesis that can be drawn: which figures there are, and what each shows.

Its Figures 5.3 and 5.14 to 5.18 are measurements, 6.1 to 6.10 simulations; here all are simulated
by the program that it lists, where that can, by its equations exactly, and by the calibrated
material. Where caption and text of a figure contradict each other the caption is followed: of 6.1
the text has 3745 Nm/rad, of 5.16(b) as well.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from models.condition import FIXED
from noise.pictures.measured import FITS
from noise.pictures.model_traces import exact_trace, listing_trace, model_traces
from noise.pictures.slips import (
    plot_damping,
    plot_slip_histories,
    plot_slip_orbits,
    plot_torque_and_clamp,
)
from noise.pictures.spectra import SpectraColumn, plot_spectra, plot_torque_and_spectrum
from noise.pictures.speeds import plot_sweep, plot_torque_of_fits
from noise.pictures.sweep import sweep_torque
from noise.pictures.titles import support_words
from noise.thesis.runs import (
    CALIBRATED,
    LONG,
    SHORT,
    THESIS,
    Case,
    listing_sudden_share,
    rig_of,
)
from sim.analysis.critical_damping import critical_damping, largest_sticking
from sim.analysis.slips import LEAST_SUDDEN

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from matplotlib.figure import Figure

    from noise.pictures.model_traces import Trace

__all__ = ["N_PICTURES", "thesis_pictures"]

_SWEPT = np.arange(0.5, 13.01, 0.5)
"""Speeds of the sweeps [rad/s]."""

_SUPPORTS = (LONG, SHORT, FIXED)
_SLOW = Case(1.0, 0.279, LONG)
_FAST = Case(10.0, 0.279, LONG)
_LARGE = Case(1.0, 0.381, SHORT)
_DAMPED = Case(7.5, 0.279, SHORT)
_HIGHEST_DAMPING = 0.1
"""At which nothing sticks in Figure 6.10 [Nm s/rad]."""


def thesis_pictures() -> Iterator[tuple[str, Figure]]:
    """Draw the thesis's pictures, one after the other.

    Yields
    ------
    name : str
        Such as ``"figure-5.14"``; sweeps of a fit, on all supports, are ``"speeds-0.279mm"``.
    figure : matplotlib.figure.Figure
    """
    yield from _sweeps()
    for number, (what, columns) in _SPECTRA.items():
        title = f"Figure {number}: torque with increasing {what}"
        yield f"figure-{number}", plot_spectra(columns, title=title)
    for number, title, draw in _slips():
        yield f"figure-{number}", draw(title=f"Figure {number}: {title}")


def _sweeps() -> Iterator[tuple[str, Figure]]:
    sweeps = {
        name: [
            sweep_torque(
                rig_of(material), _SWEPT, interference=1e-3 * fit, support_stiffness=_SUPPORTS
            )
            for fit in FITS
        ]
        for name, material in (("constant torque", THESIS), ("calibrated", CALIBRATED))
    }
    title = "Figure 5.3: torque against speed, fluorocarbon, clamp fixed"
    yield "figure-5.3", plot_torque_of_fits(sweeps, title=title)
    for i, fit in enumerate(FITS):
        of_fit = {name: of_fits[i] for name, of_fits in sweeps.items()}
        title = f"Torque and frequency against speed, fluorocarbon, {fit:g} mm"
        yield f"speeds-{fit:g}mm", plot_sweep(of_fit, title=title, interference_mm=fit)


def _by_speed(
    fit: float, support: float, speeds: tuple[float, ...], mark: str = ""
) -> SpectraColumn:
    cases = tuple(Case(speed, fit, support) for speed in speeds)
    title = f"{mark}{fit:g} mm, {support_words(support)}"
    return SpectraColumn(title, cases, tuple(f"{speed:g} rad/s" for speed in speeds))


def _by_fit(support: float, mark: str) -> SpectraColumn:
    cases = tuple(Case(1.0, fit, support) for fit in FITS)
    title = f"{mark}1 rad/s, {support_words(support)}"
    return SpectraColumn(title, cases, tuple(f"{fit:g} mm" for fit in FITS))


def _by_support(fit: float, speed: float, mark: str) -> SpectraColumn:
    cases = tuple(Case(speed, fit, support) for support in _SUPPORTS)
    title = f"{mark}{fit:g} mm, {speed:g} rad/s"
    return SpectraColumn(title, cases, tuple(map(support_words, _SUPPORTS)))


_SPECTRA = {
    "5.14": ("speed", [_by_speed(0.279, LONG, (1.0, 2.5, 5.0, 7.5))]),
    "5.15": ("interference", [_by_fit(LONG, "(a) "), _by_fit(FIXED, "(b) ")]),
    "5.16": (
        "speed",
        [
            _by_speed(0.178, LONG, (1.0, 2.5, 4.0), "(a) "),
            _by_speed(0.178, FIXED, (1.0, 2.5, 4.0), "(b) "),
        ],
    ),
    "5.17": ("speed", [_by_speed(0.279, FIXED, (1.0, 2.5, 5.0, 7.5))]),
    "5.18": (
        "stiffness of the support",
        [_by_support(0.178, 2.5, "(a) "), _by_support(0.279, 7.5, "(b) ")],
    ),
}
"""Figures of spectra: what increases, and the columns."""

N_PICTURES = 1 + len(FITS) + len(_SPECTRA) + 10
"""How many `thesis_pictures` yields."""


def _slips() -> Iterator[tuple[str, str, Callable[..., Figure]]]:
    """Yield the number of a figure, its title and what draws it with a title."""
    slow, fast = model_traces(_SLOW, 1.0), model_traces(_FAST)
    cycles = [_about_a_slip(trace, 0.05) for trace in slow]
    decay = [trace.during(0.0, 0.1) for trace in fast]
    histories = partial(plot_slip_histories, time_label="Time [ms]")
    against_speed = partial(plot_slip_orbits, phase_plane=False)
    phase_plane = partial(plot_slip_orbits, phase_plane=True)
    part = [_about_a_slip(trace, 0.014) for trace in slow]
    yield "6.1", f"slips at {_SLOW}", partial(histories, part, peak_speed=24.0)
    yield "6.2", f"torque against sliding speed at {_SLOW}", partial(against_speed, cycles)
    yield "6.3", f"phase plane at {_SLOW}", partial(phase_plane, cycles)
    part = [trace.during(0.0, 0.02) for trace in fast]
    onset = partial(histories, part, peak_speed=18.0, time_label="Time from rest [ms]")
    yield "6.4", f"from rest at {_FAST}", onset
    title = f"torque against sliding speed at {_FAST}, from rest"
    yield "6.5", title, partial(against_speed, decay)
    yield "6.6", f"phase plane at {_FAST}, from rest", partial(phase_plane, decay)
    part = [_about_a_slip(trace, 0.025) for trace in model_traces(_LARGE)]
    yield "6.7", f"slips at {_LARGE}", partial(histories, part, peak_speed=45.0)
    title = f"torque over time and its autospectrum at {_SLOW}"
    yield "6.8", title, partial(plot_torque_and_spectrum, slow)
    title = f"torque and acceleration of the clamp at {_SLOW}"
    yield "6.9", title, partial(plot_torque_and_clamp, slow)
    yield "6.10", f"phase plane by damping, {_DAMPED}", partial(plot_damping, _damping())


def _about_a_slip(trace: Trace, seconds: float) -> Trace:
    """Return a part of a settled run that begins shortly before a slip."""
    start = trace.settled_slip() - 0.1 * seconds
    return trace.during(start, start + seconds)


def _damping() -> dict[str, dict[str, Trace]]:
    """Run both models below, at and above their critical damping."""
    case = _DAMPED
    exact = critical_damping(
        rig_of(THESIS),
        case.speed,
        interference=case.interference,
        support_stiffness=case.support_stiffness,
        highest=_HIGHEST_DAMPING,
    )
    listing = largest_sticking(
        lambda damping: listing_sudden_share(replace(case, damping=damping), 1.0) > LEAST_SUDDEN,
        _HIGHEST_DAMPING,
        1e-5,
    )
    panels = {}
    for name, trace_of, critical in (
        ("listing", listing_trace, listing),
        ("equations, exact", exact_trace, exact),
    ):
        orbits = {}
        dampings = {"0.05 Nm s/rad": 0.05, "critical": critical, "0.1 Nm s/rad": 0.1}
        for words, damping in dampings.items():
            trace = trace_of(replace(case, damping=damping))
            first = float(trace.slips[0])
            orbits[f"$c_E$: {words}"] = trace.during(first - 2e-4, first + 2e-3)
        panels[f"{name}: critical {critical:.4f} Nm s/rad"] = orbits
    return panels
