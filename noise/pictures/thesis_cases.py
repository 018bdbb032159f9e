"""Which conditions and models the thesis's simulated figures show: sweeps, spectra, single slips.

Figures 5.2, 5.3, 5.14 to 5.18 and 6.1 to 6.10. Several show parts of the same runs, which are kept.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from models.condition import FIXED
from noise.pictures.measured import FITS
from noise.pictures.model_traces import exact_trace, listing_trace, model_traces
from noise.pictures.spectra import SpectraColumn
from noise.pictures.sweep import sweep_torque
from noise.pictures.thesis_recordings import FRICTION_TYPES
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
    from noise.pictures.model_traces import Trace
    from noise.pictures.sweep import SweptTorque

__all__ = [
    "DAMPED", "FAST", "FRICTION_SPECTRA", "LARGE", "SLOW", "SPECTRA", "damping", "onset", "slips",
    "sweeps", "sweeps_of", "traces",
]  # fmt: skip

_SWEPT = tuple(float(speed) for speed in np.arange(0.5, 13.01, 0.5))
"""Speeds of the sweeps [rad/s]."""

_MODELS = {"constant torque": THESIS, "calibrated": CALIBRATED}
_SUPPORTS = (LONG, SHORT, FIXED)

SLOW, FAST = Case(1.0, 0.279, LONG), Case(10.0, 0.279, LONG)
LARGE, DAMPED = Case(1.0, 0.381, SHORT), Case(7.5, 0.279, SHORT)
"""Cases of Chapter 6."""

_HIGHEST_DAMPING = 0.1
"""At which nothing sticks in Figure 6.10 [Nm s/rad]."""


@cache
def _sweep(material: str, fit: float, speeds: tuple[float, ...]) -> SweptTorque:
    return sweep_torque(
        rig_of(material), speeds, interference=1e-3 * fit, support_stiffness=_SUPPORTS
    )


def sweeps_of(fit: float) -> dict[str, SweptTorque]:
    """Sweep both models over speeds and supports at a fit [mm]."""
    return {name: _sweep(material, fit, _SWEPT) for name, material in _MODELS.items()}


def sweeps() -> dict[str, list[SweptTorque]]:
    """Sweep both models likewise, at every fit."""
    return {
        name: [_sweep(material, fit, _SWEPT) for fit in FITS] for name, material in _MODELS.items()
    }


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


SPECTRA = {
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

_TYPES = list(FRICTION_TYPES.items())
FRICTION_SPECTRA = [  # of Figure 5.2
    SpectraColumn(
        name, tuple(case for _, case in pair), tuple(f"{words}, {case}" for words, case in pair)
    )
    for name, pair in (("stick-slip", _TYPES[:2]), ("oscillations", _TYPES[2:]))
]


@cache
def traces(case: Case, seconds: float = 0.5) -> tuple[Trace, ...]:
    """Run a case in all models for some time [s]."""
    return model_traces(case, seconds)


def slips(case: Case, shown: float, seconds: float = 0.5) -> list[Trace]:
    """Run a case in all models for some time [s]; return the part `shown` about a slip [s]."""
    return [_about_a_slip(trace, shown) for trace in traces(case, seconds)]


def onset(shown: float) -> list[Trace]:
    """Run the fast case in all models; return how it begins [s]."""
    return [trace.during(0.0, shown) for trace in traces(FAST)]


def _about_a_slip(trace: Trace, seconds: float) -> Trace:
    """Return a part of a settled run that begins shortly before a slip."""
    start = trace.settled_slip() - 0.1 * seconds
    return trace.during(start, start + seconds)


def damping() -> dict[str, dict[str, Trace]]:
    """Run both models below, at and above their critical damping."""
    case = DAMPED
    exact = critical_damping(
        rig_of(THESIS),
        case.speed,
        interference=case.interference,
        support_stiffness=case.support_stiffness,
        highest=_HIGHEST_DAMPING,
    )
    listing = largest_sticking(
        lambda c_e: listing_sudden_share(replace(case, damping=c_e), 1.0) > LEAST_SUDDEN,
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
        for words, c_e in dampings.items():
            trace = trace_of(replace(case, damping=c_e))
            first = float(trace.slips[0])
            orbits[f"$c_E$: {words}"] = trace.during(first - 2e-4, first + 2e-3)
        panels[f"{name}: critical {critical:.4f} Nm s/rad"] = orbits
    return panels
