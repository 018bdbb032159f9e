"""What the thesis's figures of the bench show: modes, static tests, calibrations, heat, radiation.

Figures 3.3, 5.25, 5.26, B1, C1, G3 and H1. Each function returns rows of panels.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import rfft, rfftfreq

from models.condition import FIXED
from models.drawing import BLUE, GREEN, GREY, VERMILION
from models.radiation.rig_response import impulse_responses
from noise.pictures.axes import MODEL_COLOURS
from noise.pictures.model_traces import model_traces
from noise.pictures.panels import Curve, Panel
from noise.pictures.titles import support_words
from noise.thesis.calibrations import (
    POTENTIOMETER,
    POTENTIOMETER_ANGLES,
    TORQUE_CELL,
    TORQUE_CELL_TORQUES,
    regression,
)
from noise.thesis.exact_beams import (
    RootMotion,
    boundary_conditions,
    natural_frequencies,
    wavenumber,
    waves_at,
)
from noise.thesis.heat import RUBBER, STEEL, contact_area, heat_shares, temperature_rise
from noise.thesis.modes import clamp_on_beams, rigidly_anchored
from noise.thesis.runs import CALIBRATED, LONG, SHORT, THESIS, Case, rig_of
from noise.thesis.stiffness import LENGTHS, MEASURED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from noise.thesis.exact_beams import ClampOnBeams
    from noise.thesis.heat import HalfSpace

__all__ = [
    "acoustic_responses", "mode_shapes", "potentiometer_line", "static_tests",
    "temperature_distribution", "torque_cell_line",
]  # fmt: skip

_N_MODES = 4
_HIGHEST_MODE = 4e3
"""Of the modes that are sought [Hz]."""

_MEASURED_MODES = {LONG: (None, 250.0, 900.0), SHORT: (None, 310.0, 1375.0)}
"""By support, in rising order [Hz] (5.2.2); the lowest was not."""

_PRINTED_MODES = {(LONG, 0): 140.0, (SHORT, 3): 2100.0}
"""Ends of the range that 3.1.1 computes [Hz]."""

_STATIC_SPEED, _STATIC_SECONDS = 0.05, 2.0
"""Of the shaft in a static test [rad/s], [s]."""

_SLIDES = 0.99
"""Share of the highest torque at which a contact that creeps is taken to slide [-]."""

_POWER, _RUN, _RISE = 30.0 * 10.0, 0.23, 26.0
"""Of the friction [W], length of the experiment [s], published rise at the surface [K]."""

_AUDIBLE = 15e3
"""Right end of the acoustic responses [Hz]."""

_RADIATION_RATE = 96e3
"""[Hz]"""


def mode_shapes() -> list[list[Panel]]:
    """Lowest modes of clamp and beams over the distance from the shaft, by length (Figure 3.3).

    Examples
    --------
    >>> [panel.title for panel in mode_shapes()[0]]
    ['12.3 cm, sideways: 140 Hz (thesis 140)', '9.2 cm, sideways: 161 Hz']
    """
    columns = [_shapes_on(support) for support in LENGTHS]
    return [list(row) for row in zip(*columns, strict=True)]


def _shapes_on(support: float) -> list[Panel]:
    structure = clamp_on_beams(rigidly_anchored(), LENGTHS[support])
    modes = sorted(
        (float(frequency), motion)
        for motion in (RootMotion.TURNING, RootMotion.SIDEWAYS)
        for frequency in natural_frequencies(structure, _HIGHEST_MODE, motion)
    )
    panels = []
    for i, (frequency, motion) in enumerate(modes[:_N_MODES]):
        title = f"{100 * structure.length:g} cm, {motion.value}: {frequency:.0f} Hz"
        if (support, i) in _PRINTED_MODES:
            title += f" (thesis {_PRINTED_MODES[support, i]:g})"
        elif i < len(_MEASURED_MODES[support]) and _MEASURED_MODES[support][i]:
            title += f" (measured {_MEASURED_MODES[support][i]:g})"
        place, shape = _shape(structure, frequency, motion)
        lever = 1e3 * structure.beams.lever
        clamp = np.abs(place) <= lever
        curves = [
            Curve(place, 0.0 * shape, "at rest", GREY, "--"),
            Curve(place, shape, "beams", BLUE),
            Curve(place[clamp], shape[clamp], "clamp", VERMILION),
        ]
        panels.append(Panel(title, "Distance from the shaft [mm]", "Deflection [-]", curves))
    return panels


def _shape(
    structure: ClampOnBeams, frequency: float, motion: RootMotion
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Place [mm] and deflection over its largest of both beams and the clamp between them."""
    conditions = boundary_conditions(structure, np.array([frequency]), motion, 0.0)[0].real
    amplitudes = np.linalg.svd(conditions)[2][-1]
    along = np.linspace(0.0, 1.0, 101)
    wave = wavenumber(structure, np.full(along.size, frequency)) * structure.length
    beam = waves_at(wave, along, 0).real @ amplitudes
    right = structure.beams.lever + structure.length * along
    other = -beam if motion is RootMotion.TURNING else beam
    place = 1e3 * np.concatenate([-right[::-1], right])
    deflection = np.concatenate([other[::-1], beam])
    return place, deflection / np.abs(deflection).max() * np.sign(beam[0])


def static_tests(interference_mm: float) -> list[list[Panel]]:
    """Torque over the shaft's angle until it slips or slides, by support (Figures 5.25 and 5.26).

    Parameters
    ----------
    interference_mm : float
        [mm]

    Returns
    -------
    list of list of Panel
        Of the thesis the regressions of Table 5.3, of which the points are lost.

    Examples
    --------
    >>> [panel.title for panel in static_tests(0.279)[0]]
    ['2214 Nm/rad', '3745 Nm/rad', 'clamp fixed']
    """
    elastomer = rig_of(THESIS).fit(1e-3 * interference_mm).elastomer_stiffness
    measured = {support: k_eff for support, (k_eff, _) in MEASURED[interference_mm].items()}
    measured[FIXED] = elastomer
    row = []
    for support, stiffness in measured.items():
        case = Case(_STATIC_SPEED, interference_mm, support)
        curves = []
        for trace in model_traces(case, _STATIC_SECONDS):
            slides = (
                trace.torque >= _SLIDES * trace.torque.max()
            )  # where it creeps, and never slips
            end = float(trace.time[slides.argmax()])
            held = trace.during(0.0, min([end, *trace.slips[:1]]))
            angle = 1e3 * case.speed * held.time
            curves.append(Curve(angle, held.torque, trace.name, MODEL_COLOURS[trace.name]))
        highest = max(float(curve.y.max()) for curve in curves)
        ends = np.array([0.0, highest])
        label = f"regression {stiffness:g} Nm/rad"
        curves.append(Curve.published(1e3 * ends / stiffness, ends, label, "--"))
        row.append(
            Panel(
                support_words(support), "Angle of the shaft [mrad]", "Torque [Nm]", curves,
                from_zero=True,
            )
        )  # fmt: skip
    return [row]


def potentiometer_line() -> list[list[Panel]]:
    """Voltage over angle (Figure B1)."""
    angle = np.array(POTENTIOMETER_ANGLES)
    curves = [
        _fitted(POTENTIOMETER_ANGLES, POTENTIOMETER, "V", "rad", BLUE),
        Curve.published(angle, -0.0007 + 0.101 * angle, "(B3), V = -0.0007 + 0.101 θ", "--"),
        Curve.published(angle, POTENTIOMETER, "Table B1, angles as meant"),
    ]
    return [[Panel("Radial potentiometer", "Angle [rad]", "Voltage [V]", curves)]]


def torque_cell_line() -> list[list[Panel]]:
    """Voltage over torque, either sign fitted alone (Figure C1)."""
    torque, voltage = np.array(TORQUE_CELL_TORQUES), np.array(TORQUE_CELL)
    curves = [
        _fitted(torque[side].tolist(), voltage[side].tolist(), "mV", "Nm", colour)
        for side, colour in ((torque <= 0.0, VERMILION), (torque >= 0.0, BLUE))
    ]
    for name, side, offset in (("(C5)", torque <= 0.0, 0.0), ("(C3)", torque >= 0.0, 0.4222)):
        label = f"{name}, V = {offset:.4f} + 12.19 T"
        curves.append(Curve.published(torque[side], offset + 12.19 * torque[side], label, "--"))
    curves.append(Curve.published(torque, voltage, "Table C1"))
    return [[Panel("Torque cell", "Torque [Nm]", "Voltage [mV]", curves)]]


def _fitted(x: Sequence[float], y: Sequence[float], unit: str, per: str, colour: str) -> Curve:
    offset, slope, _ = regression(x, y)
    ends = np.array([min(x), max(x)])
    label = f"fitted here: {offset:.2g} {unit} and {slope:.4g} {unit}/{per}"
    return Curve(ends, offset + slope * ends, label, colour)


def temperature_distribution() -> list[list[Panel]]:
    """Rise of temperature over depth in shaft and bushing, equation (G3) (Figure G3).

    Examples
    --------
    >>> steel, rubber = temperature_distribution()[1]
    >>> round(float(steel.curves[0].y[0]), 1), round(float(rubber.curves[0].y[0]), 1)
    (26.0, 26.0)
    """
    area = contact_area(_POWER, _RISE, _RUN)
    bodies = zip(("shaft", "bushing"), (STEEL, RUBBER), heat_shares(STEEL, RUBBER), strict=True)
    columns = []
    for (name, body, share), reach in zip(bodies, (8.0, 1.0), strict=True):
        depth = np.linspace(0.0, reach, 201)

        def curve(
            seconds: float, label: str = "", colour: str = GREY, style: str = "-",
            body: HalfSpace = body, flux: float = share * _POWER / area,
            depth: NDArray[np.float64] = depth,
        ) -> Curve:  # fmt: skip
            rises = [temperature_rise(body, flux, seconds, 1e-3 * deep) for deep in depth]
            return Curve(depth, np.array(rises), label, colour, style)

        growing = [curve(0.05 * i, "(G3), every 0.05 s") for i in range(1, 20)]
        growing.append(curve(1.0, "(G3), after 1 s", VERMILION))
        at_run = [curve(_RUN, f"(G3), after {_RUN:g} s", BLUE)]
        at_run.append(Curve.published([0.0], [_RISE], "26 K at the surface", "o"))
        if name == "bushing":  # printed 0.0004 mm, where it would be as warm as the surface
            at_run.append(Curve.published([0.4], [0.0], "as the room at 0.4 mm", "s"))
        columns.append(
            [
                Panel(
                    f"{letter} {name}, {share:.1%} of the heat", "Depth [mm]",
                    "Temperature rise [K]", curves, span=(-0.02 * reach, reach), from_zero=True,
                )
                for letter, curves in (("(a)", growing), ("(b)", at_run))
            ]
        )  # fmt: skip
    return [list(row) for row in zip(*columns, strict=True)]


def acoustic_responses() -> list[list[Panel]]:
    """Sound pressure per force on the clamp's edge, and at the anchors, by support (Figure H1).

    Examples
    --------
    >>> [len(row[0].curves) for row in acoustic_responses()]  # a fixed clamp has no anchors
    [2, 2, 1]
    """
    rig = rig_of(CALIBRATED)
    titles = {LONG: "(a) beams of 12.3 cm", SHORT: "(b) beams of 9.2 cm", FIXED: "(c) clamp fixed"}
    grid = []
    for support, title in titles.items():
        paths = impulse_responses(rig, 0.279e-3, support, _RADIATION_RATE)
        curves = [
            _level(rig.beams.lever * paths.torque_to_pressure, "force on the clamp's edge", BLUE)
        ]
        if paths.pulse_to_pressure.any():
            curves.append(_level(paths.pulse_to_pressure, "forces at the anchors", GREEN))
        panel = Panel(
            title, "Frequency [Hz]", "Pressure per force\n[dB re 1 Pa/N]", curves,
            span=(0.0, _AUDIBLE),
        )  # fmt: skip
        grid.append([panel])
    return grid


def _level(response: NDArray[np.float64], label: str, colour: str) -> Curve:
    frequency = rfftfreq(response.size, 1.0 / _RADIATION_RATE)
    shown = (frequency > 20.0) & (frequency <= _AUDIBLE)
    level = 20.0 * np.log10(np.abs(rfft(response)[shown]))
    return Curve(frequency[shown], level, label, colour)
