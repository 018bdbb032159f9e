"""Pictures of the thesis that can be drawn: which figures there are, and what each shows.

Its Figures 5.1 to 5.26 and H1 are measurements, 3.3, 6.1 to 6.10 and G3 computed, B1 and C1 fitted
to its tables; here all are computed: by the program that it lists, where that can, by its equations
exactly, and by the calibrated material. Drawings, formulas and photographs (3.1, 3.2, 3.4 to 3.6,
4.1 to 4.3, 5.10 to 5.12, A1, A2, G1, G2) and the certificate D1 are left out. Where caption and
text of a figure contradict each other the caption is followed: of 6.1 the text has 3745 Nm/rad, of
5.16(b) as well.

A further figure is a further entry of `FIGURES`.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from models.condition import FIXED
from noise.pictures import thesis_cases as runs
from noise.pictures.channel_kinds import KINDS
from noise.pictures.measured import FITS
from noise.pictures.panels import plot_panels
from noise.pictures.slips import (
    plot_damping,
    plot_slip_histories,
    plot_slip_orbits,
    plot_torque_and_clamp,
)
from noise.pictures.spectra import plot_spectra, plot_torque_and_spectrum
from noise.pictures.speeds import plot_sweep, plot_torque_of_fits
from noise.pictures.thesis_bench import (
    acoustic_responses,
    mode_shapes,
    potentiometer_line,
    static_tests,
    temperature_distribution,
    torque_cell_line,
)
from noise.pictures.thesis_recordings import (
    channels,
    friction_types,
    spectra_by_support,
    steady_sliding,
    torque_over_speed,
)
from noise.thesis.runs import CALIBRATED, LONG, SHORT, Case

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from matplotlib.figure import Figure

__all__ = ["FIGURES", "ThesisFigure", "thesis_pictures"]


class ThesisFigure(NamedTuple):
    """A figure of the thesis: what it is called and says, what it shows, and what draws that."""

    name: str
    title: str
    data: Callable[[], object]
    draw: Callable[..., Figure]

    def picture(self) -> Figure:
        """Compute what it shows, and draw it."""
        return self.draw(self.data(), title=self.title)


def _figure(
    number: str, title: str, data: Callable[[], object], draw: Callable[..., Figure] = plot_panels
) -> ThesisFigure:
    return ThesisFigure(f"figure-{number}", f"Figure {number}: {title}", data, draw)


def _spectra_figure(number: str) -> ThesisFigure:
    what, columns = runs.SPECTRA[number]
    return _figure(number, f"torque with increasing {what}", lambda: columns, plot_spectra)


def _speeds_figure(fit: float) -> ThesisFigure:
    title = f"Torque and frequency against speed, fluorocarbon, {fit:g} mm"
    draw = partial(plot_sweep, interference_mm=fit)
    return ThesisFigure(f"speeds-{fit:g}mm", title, partial(runs.sweeps_of, fit), draw)


def _channels_figure(
    number: str, title: str, material: str, case: Case,
    marks: Mapping[str, float] | None = None, names: tuple[str, ...] = ("torque",),
) -> ThesisFigure:  # fmt: skip
    words = f"{title}, {case}\nsimulated and recorded, {material}"
    return _figure(number, words, partial(channels, material, case, names, marks))


_PDMS_SLOW = Case(0.25, 0.381, LONG)
_PDMS_SPEEDS = {LONG: 17.0, FIXED: 17.0}
_RUBBER = Case(10.0, 0.127, LONG)
_RUBBER_SPEEDS = {LONG: 19.75, SHORT: 10.0}
"""Highest speeds of the thesis [rad/s]."""

_NEW, _FILM, _CLEANED = "natural-rubber", "natural-rubber-film", "natural-rubber-film-removed"
_FILM_MODES = {f"{mode:g} Hz": mode for mode in (900.0, 4500.0, 6000.0)}
"""Of the acceleration beside the first torsional one (5.2.3) [Hz]."""

_SLOW, _FAST = runs.SLOW, runs.FAST
_CYCLES, _DECAY = partial(runs.slips, _SLOW, 0.05, 1.0), partial(runs.onset, 0.1)
_SETTLED = partial(runs.traces, _SLOW, 1.0)

_histories = partial(plot_slip_histories, time_label="Time [ms]")
_against_speed = partial(plot_slip_orbits, phase_plane=False)
_phase_plane = partial(plot_slip_orbits, phase_plane=True)

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
        lambda: runs.FRICTION_SPECTRA, plot_spectra,
    ),
    _figure(
        "5.3", "torque against speed, fluorocarbon, clamp fixed", runs.sweeps, plot_torque_of_fits
    ),
    *map(_speeds_figure, FITS),
    _figure(
        "5.4", f"PDMS slides steadily, {_PDMS_SLOW}\nsimulated and recorded",
        partial(steady_sliding, "PDMS", _PDMS_SLOW),
    ),
    *(
        _figure(
            number, f"torque against speed, PDMS, {fit:g} mm, simulated",
            partial(torque_over_speed, "PDMS", fit, _PDMS_SPEEDS, rise=3.0, slowest=0.25),
        )
        for number, fit in (("5.5", 0.254), ("5.6", 0.381))
    ),
    _channels_figure("5.7", "natural rubber, new", _NEW, _RUBBER),
    _channels_figure(
        "5.8", "natural rubber, new", _NEW, _RUBBER.at(5.0), {"noise to 1250 Hz": 1250.0}
    ),
    _channels_figure(
        "5.9", "natural rubber on its transfer film", _FILM, _RUBBER.at(2.5), _FILM_MODES,
        ("torque", "acceleration"),
    ),
    _figure(
        "5.13", "torque against speed, natural rubber, film removed, 0.127 mm, simulated",
        partial(torque_over_speed, _CLEANED, _RUBBER.interference_mm, _RUBBER_SPEEDS),
    ),
    *map(_spectra_figure, runs.SPECTRA),
    _channels_figure("5.19", "natural rubber, film removed", _CLEANED, _RUBBER),
    _figure(
        "5.20", "natural rubber, film removed, torque at 10 rad/s, 0.127 mm, simulated",
        partial(spectra_by_support, _CLEANED, _RUBBER.speed, _RUBBER.interference_mm),
    ),
    *(
        _channels_figure(number, noise, CALIBRATED, case, {}, tuple(KINDS))
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
            partial(static_tests, fit),
        )
        for number, fit in (("5.25", 0.279), ("5.26", 0.381))
    ),
    _figure(
        "6.1", f"slips at {_SLOW}", partial(runs.slips, _SLOW, 0.014, 1.0),
        partial(_histories, peak_speed=24.0),
    ),
    _figure("6.2", f"torque against sliding speed at {_SLOW}", _CYCLES, _against_speed),
    _figure("6.3", f"phase plane at {_SLOW}", _CYCLES, _phase_plane),
    _figure(
        "6.4", f"from rest at {_FAST}", partial(runs.onset, 0.02),
        partial(_histories, peak_speed=18.0, time_label="Time from rest [ms]"),
    ),
    _figure("6.5", f"torque against sliding speed at {_FAST}, from rest", _DECAY, _against_speed),
    _figure("6.6", f"phase plane at {_FAST}, from rest", _DECAY, _phase_plane),
    _figure(
        "6.7", f"slips at {runs.LARGE}", partial(runs.slips, runs.LARGE, 0.025),
        partial(_histories, peak_speed=45.0),
    ),
    _figure(
        "6.8", f"torque over time and its autospectrum at {_SLOW}",
        _SETTLED, plot_torque_and_spectrum,
    ),
    _figure(
        "6.9", f"torque and acceleration of the clamp at {_SLOW}",
        _SETTLED, plot_torque_and_clamp,
    ),
    _figure("6.10", f"phase plane by damping, {runs.DAMPED}", runs.damping, plot_damping),
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
