"""Pictures of the thesis that can be drawn: which figures there are, and what each shows.

Its Figures 5.1 to 5.26 and H1 are measurements, 3.3, 6.1 to 6.10 and G3 computed, B1 and C1 fitted
to its tables; here all are computed: by the program that it lists, where that can, by its equations
exactly, and by the calibrated material. The measured curves are lost; what tables and text say of
them is drawn in black. Recordings are of the materials as they are shipped, everything else is of
their constant version. Drawings, formulas and photographs (3.1, 3.2, 3.4 to 3.6, 4.1 to 4.3, 5.10
to 5.12, A1, A2, G1, G2) and the certificate D1 are left out. Where caption and text of a figure
contradict each other the caption is followed: of 6.1 the text has 3745 Nm/rad, of 5.16(b) as well.

A further figure is a further entry of `FIGURES`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

from matplotlib.figure import Figure

from models.condition import FIXED
from noise.pictures.figure import KINDS, support_words
from noise.pictures.panels import plot_panels
from noise.pictures.thesis_bench import (
    acoustic_responses,
    mode_shapes,
    potentiometer_line,
    temperature_distribution,
    torque_cell_line,
)
from noise.pictures.thesis_panels import (
    FRICTION_TYPES,
    Grid,
    by_damping,
    channels,
    friction_types,
    histories,
    orbits,
    spectra,
    spectra_by_support,
    static_tests,
    sweeps_of,
    torque_and_spectrum,
    torque_of_fits,
    torque_over_speed,
)
from noise.pictures.thesis_runs import (
    CLAMP,
    DISPLACEMENT,
    FITS,
    SHOWN,
    SLIDING,
    SUPPORTS,
    TORQUE,
    Trace,
    traces,
)
from noise.thesis.runs import (
    CALIBRATED,
    LONG,
    SHORT,
    Case,
)

SLOW, FAST = Case(1.0, 0.279, LONG), Case(10.0, 0.279, LONG)
LARGE, DAMPED = Case(1.0, 0.381, SHORT), Case(7.5, 0.279, SHORT)
"""Cases of Chapter 6."""

_RUBBER = Case(10.0, 0.127, LONG)
_PDMS = Case(0.25, 0.381, LONG)
_NEW, _FILM, _CLEANED = "natural-rubber", "natural-rubber-film", "natural-rubber-film-removed"
_FILM_MODES = {f"{mode:g} Hz": mode for mode in (900.0, 4500.0, 6000.0)}
"""Of the acceleration beside the first torsional one (5.2.3) [Hz]."""

Column = tuple[str, list[tuple[str, Case]]]

_TYPES = [(f"{name}, {case}", case) for name, case in FRICTION_TYPES.items()]


def _at_speeds(mark: str, fit: float, support: float, *speeds: float) -> Column:
    cases = [(f"{speed:g} rad/s", Case(speed, fit, support)) for speed in speeds]
    return f"{mark}{fit:g} mm, {support_words(support)}", cases


def _at_fits(mark: str, support: float) -> Column:
    cases = [(f"{fit:g} mm", Case(1.0, fit, support)) for fit in FITS]
    return f"{mark}1 rad/s, {support_words(support)}", cases


def _at_supports(mark: str, fit: float, speed: float) -> Column:
    cases = [(support_words(one), Case(speed, fit, one)) for one in SUPPORTS]
    return f"{mark}{fit:g} mm, {speed:g} rad/s", cases


def _about_slips(case: Case, shown: float, seconds: float = 0.5) -> list[Trace]:
    return [trace.about_a_slip(shown) for trace in traces(case, seconds)]


def _onset(shown: float) -> list[Trace]:
    return [trace.during(0.0, shown) for trace in traces(FAST)]


class ThesisFigure(NamedTuple):
    """A figure of the thesis: its name, what it says, and the panels that it shows."""

    name: str
    title: str
    panels: Callable[[], Grid]

    def picture(self) -> Figure:
        """Compute what it shows, and draw it."""
        return plot_panels(self.panels(), title=self.title)


def _figure(number: str, title: str, panels: Callable[..., Grid], *given: object) -> ThesisFigure:
    return ThesisFigure(f"figure-{number}", f"Figure {number}: {title}", partial(panels, *given))


def _recording(number: str, what: str, material: str, case: Case, *more: object) -> ThesisFigure:
    title = f"{what}, {case}\nsimulated and recorded, {material}"
    return _figure(number, title, channels, material, case, *more)


FIGURES = (
    _figure(
        "3.3",
        "modes of beams, clamp and bushing, on the assumptions of 3.1.1\n"
        "mass and inertia of the clamp, which the thesis does not give, chosen for 140 and 250 Hz",
        mode_shapes,
    ),
    _figure("5.1", "four types of friction, simulated and recorded in two models", friction_types),
    _figure(
        "5.2", "frequency content of the types of Figure 5.1",
        spectra, ("stick-slip", _TYPES[:2]), ("oscillations", _TYPES[2:]),
    ),
    _figure("5.3", "torque against speed, fluorocarbon, clamp fixed", torque_of_fits),
    *(
        ThesisFigure(
            f"speeds-{fit:g}mm",
            f"Torque and frequency against speed, fluorocarbon, {fit:g} mm",
            partial(sweeps_of, fit),
        )
        for fit in FITS
    ),
    _figure(
        "5.4", f"PDMS slides steadily, {_PDMS}\nsimulated and recorded",
        partial(channels, with_spectra=False), "PDMS", _PDMS, ("torque", "acceleration"),
    ),
    *(
        _figure(
            number, f"torque against speed, PDMS, {fit:g} mm, simulated",
            partial(torque_over_speed, rise=3.0, slowest=0.25),
            "PDMS", fit, {LONG: 17.0, FIXED: 17.0},
        )
        for number, fit in (("5.5", 0.254), ("5.6", 0.381))
    ),
    _recording("5.7", "natural rubber, new", _NEW, _RUBBER),
    _recording(
        "5.8", "natural rubber, new", _NEW, _RUBBER.at(5.0),
        ("torque",), {"noise to 1250 Hz": 1250.0},
    ),
    _recording(
        "5.9", "natural rubber on its transfer film", _FILM, _RUBBER.at(2.5),
        ("torque", "acceleration"), _FILM_MODES,
    ),
    _figure(
        "5.13", "torque against speed, natural rubber, film removed, 0.127 mm, simulated",
        torque_over_speed, _CLEANED, _RUBBER.interference_mm, {LONG: 19.75, SHORT: 10.0},
    ),
    _figure(
        "5.14", "torque with increasing speed",
        spectra, _at_speeds("", 0.279, LONG, 1.0, 2.5, 5.0, 7.5),
    ),
    _figure(
        "5.15", "torque with increasing interference",
        spectra, _at_fits("(a) ", LONG), _at_fits("(b) ", FIXED),
    ),
    _figure(
        "5.16", "torque with increasing speed", spectra,
        *(_at_speeds(m, 0.178, k, 1.0, 2.5, 4.0) for m, k in (("(a) ", LONG), ("(b) ", FIXED))),
    ),
    _figure(
        "5.17", "torque with increasing speed",
        spectra, _at_speeds("", 0.279, FIXED, 1.0, 2.5, 5.0, 7.5),
    ),
    _figure(
        "5.18", "torque with increasing stiffness of the support",
        spectra, _at_supports("(a) ", 0.178, 2.5), _at_supports("(b) ", 0.279, 7.5),
    ),
    _recording("5.19", "natural rubber, film removed", _CLEANED, _RUBBER),
    _figure(
        "5.20", "natural rubber, film removed, torque at 10 rad/s, 0.127 mm, simulated",
        spectra_by_support, _CLEANED, _RUBBER.speed, _RUBBER.interference_mm,
    ),
    *(
        _recording(number, noise, CALIBRATED, case, tuple(KINDS))
        for number, noise, case in (
            ("5.21", "creak", Case(1.0, 0.381, LONG)),
            ("5.22", "squawk", Case(5.0, 0.279, LONG)),
            ("5.23", "squawk", Case(5.0, 0.279, SHORT)),
            ("5.24", "squeal", Case(10.0, 0.279, SHORT)),
        )
    ),
    *(
        _figure(
            number, f"torque in a slow turn until it slips or slides, {fit:g} mm, simulated",
            static_tests, fit,
        )
        for number, fit in (("5.25", 0.279), ("5.26", 0.381))
    ),
    _figure(
        "6.1", f"slips at {SLOW}",
        lambda: histories(_about_slips(SLOW, 0.014, 1.0), peak_speed=24.0),
    ),
    _figure(
        "6.2", f"torque against sliding speed at {SLOW}",
        lambda: orbits(_about_slips(SLOW, 0.05, 1.0), SLIDING, TORQUE),
    ),
    _figure(
        "6.3", f"phase plane at {SLOW}",
        lambda: orbits(_about_slips(SLOW, 0.05, 1.0), DISPLACEMENT, SLIDING),
    ),
    _figure(
        "6.4", f"from rest at {FAST}",
        lambda: histories(_onset(0.02), across="Time from rest [ms]", peak_speed=18.0),
    ),
    _figure(
        "6.5", f"torque against sliding speed at {FAST}, from rest",
        lambda: orbits(_onset(0.1), SLIDING, TORQUE),
    ),
    _figure(
        "6.6", f"phase plane at {FAST}, from rest",
        lambda: orbits(_onset(0.1), DISPLACEMENT, SLIDING),
    ),
    _figure(
        "6.7", f"slips at {LARGE}", lambda: histories(_about_slips(LARGE, 0.025), peak_speed=45.0)
    ),
    _figure(
        "6.8", f"torque over time and its autospectrum at {SLOW}", torque_and_spectrum, SLOW
    ),
    _figure(
        "6.9", f"torque and acceleration of the clamp at {SLOW}",
        lambda: histories([one.settled(SHOWN) for one in traces(SLOW, 1.0)], (TORQUE, CLAMP)),
    ),
    _figure("6.10", f"phase plane by damping, {DAMPED}", by_damping, DAMPED),
    _figure("B1", "calibration of the potentiometer", potentiometer_line),
    _figure("C1", "calibration of the torque cell", torque_cell_line),
    _figure(
        "G3",
        "temperature rise at 30 Nm and 10 rad/s, equation (G3)\n"
        "contact of 7.69 cm², which the thesis does not give, chosen for its 26 K",
        temperature_distribution,
    ),
    _figure(
        "H1", "acoustic response of the modelled rig; where the hammer struck is not known",
        acoustic_responses,
    ),
)  # fmt: skip
"""All of them, in the thesis's order."""


def thesis_pictures() -> Iterator[tuple[str, Figure]]:
    """Draw the thesis's pictures, one after the other.

    Yields
    ------
    name : str
        Such as ``"figure-5.14"``; sweeps of a fit, on all supports, are ``"speeds-0.279mm"``.
    figure : matplotlib.figure.Figure
    """
    for figure in FIGURES:
        yield figure.name, figure.picture()
