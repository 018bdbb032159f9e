"""The pictures of the thesis that can be drawn: which figures there are, and what each shows.

Its Figures 5.3 and 5.14 to 5.18 are measurements, 6.1 to 6.10 simulations; here all are simulated
by the program that it lists, where that can, by its equations exactly, and by the calibrated
material. Where caption and text of a figure contradict each other the caption is followed: of 6.1
the text has 3745 Nm/rad, of 5.16(b) as well.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from models.condition import FIXED
from noise.pictures.comparison import plot_torque_and_clamp, plot_torque_and_spectrum
from noise.pictures.measured import FITS
from noise.pictures.model_traces import exact_trace, listing_trace, model_traces
from noise.pictures.slips import plot_damping, plot_slip_histories, plot_slip_orbits
from noise.pictures.spectra import SpectraColumn, plot_spectra
from noise.pictures.speeds import plot_sweep, plot_torque_of_fits
from noise.pictures.sweep import sweep_torque
from noise.pictures.titles import support_words
from noise.thesis.runs import (
    CALIBRATED,
    LONG,
    SHORT,
    THESIS,
    Case,
    listing_stick_share,
    rig_of,
)
from sim.analysis.critical_damping import critical_damping, largest_sticking
from sim.analysis.regime import LEAST_STICK

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
    for name, draw in _SPECTRA.items():
        yield name, draw()
    yield from _slips()


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
    yield (
        "figure-5.3",
        plot_torque_of_fits(
            sweeps, title="Figure 5.3: torque against speed, fluorocarbon, clamp fixed"
        ),
    )
    for i, fit in enumerate(FITS):
        yield (
            f"speeds-{fit:g}mm",
            plot_sweep(
                {name: of_fits[i] for name, of_fits in sweeps.items()},
                title=f"Torque and frequency against speed, fluorocarbon, {fit:g} mm",
                interference_mm=fit,
            ),
        )


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


_SPECTRA: dict[str, Callable[[], Figure]] = {
    "figure-5.14": lambda: plot_spectra(
        [_by_speed(0.279, LONG, (1.0, 2.5, 5.0, 7.5))],
        title="Figure 5.14: torque with increasing speed",
    ),
    "figure-5.15": lambda: plot_spectra(
        [_by_fit(LONG, "(a) "), _by_fit(FIXED, "(b) ")],
        title="Figure 5.15: torque with increasing interference",
    ),
    "figure-5.16": lambda: plot_spectra(
        [
            _by_speed(0.178, LONG, (1.0, 2.5, 4.0), "(a) "),
            _by_speed(0.178, FIXED, (1.0, 2.5, 4.0), "(b) "),
        ],
        title="Figure 5.16: torque with increasing speed",
    ),
    "figure-5.17": lambda: plot_spectra(
        [_by_speed(0.279, FIXED, (1.0, 2.5, 5.0, 7.5))],
        title="Figure 5.17: torque with increasing speed",
    ),
    "figure-5.18": lambda: plot_spectra(
        [_by_support(0.178, 2.5, "(a) "), _by_support(0.279, 7.5, "(b) ")],
        title="Figure 5.18: torque with increasing stiffness of the support",
    ),
}

N_PICTURES = 1 + len(FITS) + len(_SPECTRA) + 10
"""How many `thesis_pictures` yields."""


def _slips() -> Iterator[tuple[str, Figure]]:
    slow = model_traces(_SLOW, 1.0)
    about_a_slip = [_about_a_slip(trace, 0.014) for trace in slow]
    cycles = [_about_a_slip(trace, 0.05) for trace in slow]
    onset = [trace.during(0.0, 0.02) for trace in model_traces(_FAST)]
    decay = [trace.during(0.0, 0.1) for trace in model_traces(_FAST)]
    from_rest, settled = "Time from rest [ms]", "Time [ms]"
    yield (
        "figure-6.1",
        plot_slip_histories(
            about_a_slip, title=f"Figure 6.1: slips at {_SLOW}", time_label=settled, peak_speed=24.0
        ),
    )
    title = f"Figure 6.2: torque against sliding speed at {_SLOW}"
    yield "figure-6.2", plot_slip_orbits(cycles, title=title, phase_plane=False)
    title = f"Figure 6.3: phase plane at {_SLOW}"
    yield "figure-6.3", plot_slip_orbits(cycles, title=title, phase_plane=True)
    yield (
        "figure-6.4",
        plot_slip_histories(
            onset, title=f"Figure 6.4: from rest at {_FAST}", time_label=from_rest, peak_speed=18.0
        ),
    )
    title = f"Figure 6.5: torque against sliding speed at {_FAST}, from rest"
    yield "figure-6.5", plot_slip_orbits(decay, title=title, phase_plane=False)
    title = f"Figure 6.6: phase plane at {_FAST}, from rest"
    yield "figure-6.6", plot_slip_orbits(decay, title=title, phase_plane=True)
    yield (
        "figure-6.7",
        plot_slip_histories(
            [_about_a_slip(trace, 0.025) for trace in model_traces(_LARGE)],
            title=f"Figure 6.7: slips at {_LARGE}", time_label=settled, peak_speed=45.0,
        ),
    )  # fmt: skip
    title = f"Figure 6.8: torque over time and its autospectrum at {_SLOW}"
    yield "figure-6.8", plot_torque_and_spectrum(slow, title=title)
    title = f"Figure 6.9: torque and acceleration of the clamp at {_SLOW}"
    yield "figure-6.9", plot_torque_and_clamp(slow, title=title)
    yield "figure-6.10", _damping()


def _about_a_slip(trace: Trace, seconds: float) -> Trace:
    """Return a part of a settled run that begins shortly before a slip."""
    start = trace.settled_slip() - 0.1 * seconds
    return trace.during(start, start + seconds)


def _damping() -> Figure:
    case = Case(7.5, 0.279, SHORT)
    exact = critical_damping(
        rig_of(THESIS),
        case.speed,
        interference=case.interference,
        support_stiffness=case.support_stiffness,
        highest=_HIGHEST_DAMPING,
    )
    listing = largest_sticking(
        lambda damping: listing_stick_share(replace(case, damping=damping), 1.0) > LEAST_STICK,
        _HIGHEST_DAMPING,
        1e-5,
    )
    panels = {}
    for name, trace_of, critical in (
        ("listing", listing_trace, listing),
        ("equations, exact", exact_trace, exact),
    ):
        orbits = {}
        for words, damping in (
            ("0.05 Nm s/rad", 0.05),
            ("critical", critical),
            ("0.1 Nm s/rad", 0.1),
        ):
            trace = trace_of(replace(case, damping=damping))
            first = float(trace.slips[0])
            orbits[f"$c_E$: {words}"] = trace.during(first - 2e-4, first + 2e-3)
        panels[f"{name}: critical {critical:.4f} Nm s/rad"] = orbits
    return plot_damping(panels, title=f"Figure 6.10: phase plane by damping, {case}")
