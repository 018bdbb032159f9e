"""Calibrations of Appendices B to E, fitted again from their tables.

Table B1 is misprinted: eight angles from pi/6 to pi stand beside eight voltages, of which the first
is that of 0 rad. With the angles from 0 on, the voltage at 5 pi / 6 missing, the regression is the
printed one; as printed it is not. The second regression of Table C1 repeats the slope of the first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from noise.thesis.row import Row, number

POTENTIOMETER = (0.0020, 0.0511, 0.0777, 0.1035, 0.1581, 0.2140, 0.2410, 0.3161)
"""Voltages of Table B1 [V]."""

_ANGLES_PRINTED = (1 / 6, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 5 / 6, 1.0)
_ANGLES_MEANT = (0.0, 1 / 6, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 1.0)
"""Over pi."""

TORQUE_CELL = (
    -483.0, -426.0, -361.0, -302.0, -240.0, -183.0, -120.0, -63.0, 0.0,
    63.0, 121.0, 184.0, 243.0, 306.0, 365.0, 428.0, 488.0,
)  # fmt: skip
"""Voltages of Table C1 [mV]."""

TORQUE_CELL_TORQUES = tuple(5.0 * step for step in range(-8, 9))
"""At which they were read [Nm]."""

_GRAVITY = 9.80665
_INCH = 0.0254
_REFERENCE_PRESSURE = 20e-6
_CALIBRATOR_LEVEL = 93.8
"""Of the sound calibrator (Appendix E) [dB]."""

_CALIBRATOR_VOLTAGE = 0.06
"""Amplitude that it gives [V]."""

_ACCELEROMETER = 12.55e-3
"""Sensitivity (Figure D1) [V/g]."""


def regression(x: Sequence[float], y: Sequence[float]) -> tuple[float, float, float]:
    """Fit a line: offset, slope and correlation coefficient, (B1) and (B2).

    Examples
    --------
    >>> [round(number, 3) for number in regression([0.0, 1.0, 2.0], [1.0, 3.0, 5.0])]
    [1.0, 2.0, 1.0]
    """
    slope, offset = np.polyfit(x, y, 1)
    return float(offset), float(slope), float(np.corrcoef(x, y)[0, 1])


def potentiometer() -> list[Row]:
    """Appendix B."""
    printed, meant = (
        regression([math.pi * angle for angle in angles], POTENTIOMETER)
        for angles in (_ANGLES_PRINTED, _ANGLES_MEANT)
    )
    return [
        Row(
            "potentiometer_offset", "(B3), Table B1", "V", number(-0.0007, "-0.0007"),
            exact=meant[0], as_printed=printed[0], tolerance=0.002, scale=0.3161, digits=1,
        ),
        Row(
            "potentiometer_slope", "(B3), Table B1", "V/rad", number(0.101),
            exact=meant[1], as_printed=printed[1],
        ),
        Row(
            "potentiometer_correlation", "(B4), Table B1", "1", number(0.9999),
            exact=meant[2], as_printed=printed[2], tolerance=1e-4,
        ),
        Row("potentiometer_gain", "Appendix B", "rad/V", number(9.9), exact=1.0 / meant[1]),
    ]  # fmt: skip


def torque_cell() -> Iterator[Row]:
    """Appendix C."""
    torque = np.array(TORQUE_CELL_TORQUES)
    up, down = torque >= 0.0, torque <= 0.0
    voltage = np.array(TORQUE_CELL)
    for name, side, equation, offset in (
        ("positive", up, "(C3)", "0.4222"),
        ("negative", down, "(C5)", "0.0000"),
    ):
        fitted = regression(torque[side].tolist(), voltage[side].tolist())
        where = f"{equation}, {name} torque, Table C1"
        yield Row(
            "torque_cell_offset", where, "mV", number(float(offset), offset),
            exact=fitted[0], scale=abs(fitted[0]), tolerance=1e-3,
        )  # fmt: skip
        yield Row(
            "torque_cell_slope", where, "mV/Nm", number(12.19), exact=fitted[1], tolerance=0.002
        )
        yield Row(
            "torque_cell_correlation", where, "1", number(0.9999),
            exact=fitted[2], tolerance=1e-4, digits=5,
        )  # fmt: skip
    slope = regression(torque[up].tolist(), voltage[up].tolist())[1]
    yield Row("torque_cell_gain", "Appendix C", "Nm/V", number(82.0), exact=1e3 / slope)


def transducers() -> list[Row]:
    """Accelerometer, microphone and Talysurf."""
    rms = _REFERENCE_PRESSURE * 10 ** (_CALIBRATOR_LEVEL / 20)
    amplitude = math.sqrt(2.0) * rms
    gain = _GRAVITY / _ACCELEROMETER
    return [
        Row("accelerometer_gain", "12.55 mV/g", "m/s2/V", number(781.4), exact=gain),
        Row(
            "accelerometer_gain", "Figure D1", "in/s2/V", number(30763.9841, "30763.9841"),
            exact=gain / _INCH, tolerance=1e-4, digits=6,
        ),
        Row("calibrator_pressure", "93.8 dB, rms", "Pa", number(0.979755), exact=rms),
        Row("calibrator_pressure", "93.8 dB, amplitude", "Pa", number(1.38), exact=amplitude),
        Row(
            "microphone_gain", "0.06 V at 93.8 dB", "Pa/V", number(23.088),
            exact=amplitude / _CALIBRATOR_VOLTAGE, tolerance=1e-3,
        ),
        Row(
            "talysurf_gain", "55.5 um/V at 5.55 mm", "rad/V", number(0.01),
            exact=55.5e-6 / 5.55e-3,
        ),
    ]  # fmt: skip
