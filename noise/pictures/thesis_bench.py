"""Panels of the thesis's bench: modes, static tests, calibrations, heat, radiation.

Figures 3.3, B1, C1, G3 and H1. Each function returns rows of panels.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft, rfftfreq

from models.condition import FIXED
from models.drawing import BLUE, GREEN, GREY, VERMILION
from models.radiation.rig_response import impulse_responses
from noise.pictures.panels import Curve, Panel
from noise.thesis.calibrations import (
    POTENTIOMETER,
    POTENTIOMETER_ANGLES,
    TORQUE_CELL,
    TORQUE_CELL_TORQUES,
    regression,
)
from noise.thesis.exact_beams import (
    ClampOnBeams,
    RootMotion,
    boundary_conditions,
    natural_frequencies,
    wavenumber,
    waves_at,
)
from noise.thesis.heat import RUBBER, STEEL, contact_area, heat_shares, temperature_rise
from noise.thesis.modes import clamp_on_beams, rigidly_anchored
from noise.thesis.runs import CALIBRATED, LONG, SHORT, rig_of
from noise.thesis.stiffness import LENGTHS

_HIGHEST_MODE = 4e3
"""Of the modes that are sought [Hz]."""

_NAMED_MODES = {
    LONG: ("thesis 140", "measured 250", "measured 900", ""),  # 3.1.1, 5.2.2
    SHORT: ("", "measured 310", "measured 1375", "thesis 2100"),
}
"""What the thesis says of the lowest modes, in rising order [Hz]; the lowest was not measured."""

_POWER, _RUN, _RISE = 30.0 * 10.0, 0.23, 26.0
"""Of the friction [W], length of the experiment [s], published rise at the surface [K]."""

_AUDIBLE, _RADIATION_RATE = 15e3, 96e3
"""Right end of the acoustic responses, and the rate of their computation [Hz]."""


def mode_shapes() -> list[list[Panel]]:
    """Lowest modes of clamp and beams over the distance from the shaft, by length (Figure 3.3).

    Examples
    --------
    >>> [panel.title for panel in mode_shapes()[0]]
    ['12.3 cm, sideways: 140 Hz (thesis 140)', '9.2 cm, sideways: 161 Hz']
    """
    columns = []
    for support, names in _NAMED_MODES.items():
        structure = clamp_on_beams(rigidly_anchored(), LENGTHS[support])
        modes = sorted(
            (float(frequency), motion)
            for motion in (RootMotion.TURNING, RootMotion.SIDEWAYS)
            for frequency in natural_frequencies(structure, _HIGHEST_MODE, motion)
        )
        panels = []
        for (frequency, motion), name in zip(modes, names, strict=False):
            title = f"{100 * structure.length:g} cm, {motion.value}: {frequency:.0f} Hz"
            place, shape = _shape(structure, frequency, motion)
            clamp = np.abs(place) <= 1e3 * structure.beams.lever
            curves = [
                Curve(place, 0.0 * shape, "at rest", GREY, "--"),
                Curve(place, shape, "beams", BLUE),
                Curve(place[clamp], shape[clamp], "clamp", VERMILION),
            ]
            title += f" ({name})" if name else ""
            panels.append(Panel(title, "Distance from the shaft [mm]", "Deflection [-]", curves))
        columns.append(panels)
    return [list(row) for row in zip(*columns, strict=True)]


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


def potentiometer_line() -> list[list[Panel]]:
    """Voltage over angle (Figure B1)."""
    angle = np.array(POTENTIOMETER_ANGLES)
    curves = [
        _fitted(angle, np.array(POTENTIOMETER), "V", "rad", BLUE),
        Curve.published(angle, -0.0007 + 0.101 * angle, "(B3), V = -0.0007 + 0.101 θ", "--"),
        Curve.published(angle, POTENTIOMETER, "Table B1, angles as meant"),
    ]
    return [[Panel("Radial potentiometer", "Angle [rad]", "Voltage [V]", curves)]]


def torque_cell_line() -> list[list[Panel]]:
    """Voltage over torque, either sign fitted alone (Figure C1)."""
    torque, voltage = np.array(TORQUE_CELL_TORQUES), np.array(TORQUE_CELL)
    fitted, printed = [], []
    for name, side, offset, colour in (
        ("(C5)", torque <= 0.0, 0.0, VERMILION),
        ("(C3)", torque >= 0.0, 0.4222, BLUE),
    ):
        fitted.append(_fitted(torque[side], voltage[side], "mV", "Nm", colour))
        label = f"{name}, V = {offset:.4f} + 12.19 T"
        printed.append(Curve.published(torque[side], offset + 12.19 * torque[side], label, "--"))
    curves = [*fitted, *printed, Curve.published(torque, voltage, "Table C1")]
    return [[Panel("Torque cell", "Torque [Nm]", "Voltage [mV]", curves)]]


def _fitted(
    x: NDArray[np.float64], y: NDArray[np.float64], unit: str, per: str, colour: str
) -> Curve:
    offset, slope, _ = regression(x.tolist(), y.tolist())
    ends = np.array([x.min(), x.max()])
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
    times = {0.05 * i: ("(G3), every 0.05 s", GREY) for i in range(1, 20)}
    times |= {1.0: ("(G3), after 1 s", VERMILION), _RUN: (f"(G3), after {_RUN:g} s", BLUE)}
    bodies = zip(("shaft", "bushing"), (STEEL, RUBBER), heat_shares(STEEL, RUBBER), strict=True)
    columns = []
    for (name, body, share), reach in zip(bodies, (8.0, 1.0), strict=True):
        depth = np.linspace(0.0, reach, 201)
        flux = share * _POWER / area
        curves = []
        for seconds, (label, colour) in times.items():
            rises = [temperature_rise(body, flux, seconds, 1e-3 * deep) for deep in depth]
            curves.append(Curve(depth, np.array(rises), label, colour))
        at_run = [curves.pop(), Curve.published([0.0], [_RISE], "26 K at the surface", "o")]
        if name == "bushing":  # printed 0.0004 mm, where it would be as warm as the surface
            at_run.append(Curve.published([0.4], [0.0], "as the room at 0.4 mm", "s"))
        columns.append(
            [
                Panel(
                    f"{letter} {name}, {share:.1%} of the heat",
                    "Depth [mm]",
                    "Temperature rise [K]",
                    shown,
                    span=(-0.02 * reach, reach),
                    from_zero=True,
                )
                for letter, shown in (("(a)", curves), ("(b)", at_run))
            ]
        )
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
        responses = {
            ("force on the clamp's edge", BLUE): rig.beams.lever * paths.torque_to_pressure,
            ("forces at the anchors", GREEN): paths.pulse_to_pressure,
        }
        curves = []
        for (label, colour), response in responses.items():
            frequency = rfftfreq(response.size, 1.0 / _RADIATION_RATE)
            shown = (frequency > 20.0) & (frequency <= _AUDIBLE)
            if response.any():
                level = 20.0 * np.log10(np.abs(rfft(response)[shown]))
                curves.append(Curve(frequency[shown], level, label, colour))
        up = "Pressure per force\n[dB re 1 Pa/N]"
        grid.append([Panel(title, "Frequency [Hz]", up, curves, span=(0.0, _AUDIBLE))])
    return grid
