"""Calibrations of Appendices B to E, fitted again from their tables; converter and lengths of runs.

Table B1 is misprinted: eight angles from pi/6 to pi stand beside eight voltages, of which the first
is that of 0 rad. With the angles from 0 on, the voltage at 5 pi / 6 missing, the regression is the
printed one; as printed it is not. The second regression of Table C1 repeats the slope of the first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from noise.thesis.listing import STEP
from noise.thesis.row import Values

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


def potentiometer() -> Iterator[Values]:
    """Offset, slope and correlation of Appendix B, as meant and as printed, and the gain."""
    printed, meant = (
        regression([math.pi * angle for angle in angles], POTENTIOMETER)
        for angles in (_ANGLES_PRINTED, _ANGLES_MEANT)
    )
    for right, wrong in zip(meant, printed, strict=True):
        yield {"exact": right, "as_printed": wrong}
    yield {"exact": 1.0 / meant[1]}


def torque_cell() -> Iterator[Values]:
    """Regressions of Appendix C for positive and negative torque, and the gain."""
    torque, voltage = np.array(TORQUE_CELL_TORQUES), np.array(TORQUE_CELL)
    slopes = []
    for side in (torque >= 0.0, torque <= 0.0):
        offset, slope, correlation = regression(torque[side].tolist(), voltage[side].tolist())
        slopes.append(slope)
        yield {"exact": offset, "scale": abs(offset)}
        yield {"exact": slope}
        yield {"exact": correlation}
    yield {"exact": 1e3 / slopes[0]}


def transducers() -> Iterator[Values]:
    """Accelerometer in two units, calibrator rms and amplitude, microphone, Talysurf."""
    rms = _REFERENCE_PRESSURE * 10 ** (_CALIBRATOR_LEVEL / 20)
    amplitude = math.sqrt(2.0) * rms
    gain = _GRAVITY / _ACCELEROMETER
    pressures = rms, amplitude, amplitude / _CALIBRATOR_VOLTAGE
    for exact in (gain, gain / _INCH, *pressures, 55.5e-6 / 5.55e-3):
        yield {"exact": exact}


def converter() -> Iterator[Values]:
    """One bit of a 12-bit converter over +-1.25 V (3.1.2) [mV]."""
    yield {"exact": 1e3 * 2.5 / 2**12}


def lengths() -> Iterator[Values]:
    """Time step and lengths of the listing (6.3), highest frequency, travel, surface speed."""
    for steps in (1, 4096, 40960):
        yield {"listing": 1e3 * steps * STEP}
    for exact in (0.5 * 30.0, 2.3, 45.0 * 1.5):
        yield {"exact": exact}


def misprints() -> Iterator[Values]:
    """Constants of Williams, Landel and Ferry (1955); band and mode of the film as in 5.2.3."""
    for exact in (8.86, 101.6, 250.0, 1500.0, 250.0):
        yield {"exact": exact}
