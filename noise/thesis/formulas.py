"""Numbers of the thesis that follow from a formula: calibrations, stiffness in series, the shaft.

Calibrations of Appendices B to E are fitted again from their tables. Table B1 is misprinted: eight
angles from pi/6 to pi stand beside eight voltages, of which the first is that of 0 rad. With the
angles from 0 on, the voltage at 5 pi / 6 missing, the regression is the printed one; as printed it
is not. The second regression of Table C1 repeats the slope of the first.

Torsional modes of a uniform shaft (Appendix A) bound the rig's own resonances from two ends: a
shaft held at one end that carries an inertia at the other, and a free one. Both depend on the time
that a wave of shear takes along the shaft, and the first on one ratio of inertias, so that Table
3.1 has two unknowns for six numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from models.bushing import Sleeve
from models.recording import REFERENCE_PRESSURE
from noise.thesis.row import Values
from noise.thesis.runs import CALIBRATED, LONG, QUANTITIES, SHORT, THESIS, Case, rig_of

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
"""Torques of `TORQUE_CELL` [Nm]."""

_GRAVITY = 9.80665
_INCH = 0.0254
_CALIBRATOR_LEVEL = 93.8
"""Of the sound calibrator (Appendix E) [dB]."""

_CALIBRATOR_VOLTAGE = 0.06
"""Amplitude that it gives [V]."""

_ACCELEROMETER = 12.55e-3
"""Sensitivity (Figure D1) [V/g]."""


def regression(x: Sequence[float], y: Sequence[float]) -> tuple[float, float, float]:
    """Return offset, slope and correlation coefficient of a fitted line, (B1) and (B2).

    Examples
    --------
    >>> [round(number, 3) for number in regression([0.0, 1.0, 2.0], [1.0, 3.0, 5.0])]
    [1.0, 2.0, 1.0]
    """
    slope, offset = np.polyfit(x, y, 1)
    return float(offset), float(slope), float(np.corrcoef(x, y)[0, 1])


def potentiometer() -> Iterator[Values]:
    """Yield offset, slope and correlation of Appendix B, as meant and as printed, and the gain."""
    printed, meant = (
        regression([math.pi * angle for angle in angles], POTENTIOMETER)
        for angles in (_ANGLES_PRINTED, _ANGLES_MEANT)
    )
    for right, wrong in zip(meant, printed, strict=True):
        yield {"exact": right, "as_printed": wrong}
    yield {"exact": 1.0 / meant[1]}


def torque_cell() -> Iterator[Values]:
    """Yield the regressions of Appendix C for positive and negative torque, and the gain."""
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
    """Yield gains of accelerometer (two units), calibrator, microphone and Talysurf."""
    rms = REFERENCE_PRESSURE * 10 ** (_CALIBRATOR_LEVEL / 20)
    amplitude = math.sqrt(2.0) * rms
    gain = _GRAVITY / _ACCELEROMETER
    pressures = rms, amplitude, amplitude / _CALIBRATOR_VOLTAGE
    for exact in (gain, gain / _INCH, *pressures, 55.5e-6 / 5.55e-3):
        yield {"exact": exact}


def free_free_frequencies(transit_time: float, n_modes: int = 3) -> NDArray[np.float64]:
    """Return the natural frequencies of a free shaft without rigid rotation, equation (A20).

    Parameters
    ----------
    transit_time : float
        l sqrt(rho / G): of a wave of shear from end to end [s].
    n_modes : int

    Returns
    -------
    ndarray, shape (n_modes,)
        [Hz]

    Examples
    --------
    >>> free_free_frequencies(1 / 16262).round()
    array([ 8131., 16262., 24393.])
    """
    return np.arange(1, n_modes + 1) / (2.0 * transit_time)


def fixed_free_frequencies(
    transit_time: float, ratio: float, n_modes: int = 3
) -> NDArray[np.float64]:
    """Return the natural frequencies of a shaft fixed at one end, an inertia at the other (A14).

    Parameters
    ----------
    transit_time : float
        l sqrt(rho / G) [s].
    ratio : float
        Inertia of the shaft over that at its end [-].
    n_modes : int

    Returns
    -------
    ndarray, shape (n_modes,)
        [Hz]

    Examples
    --------
    >>> fixed_free_frequencies(1 / 16262, 0.4201).round()
    array([ 1569.,  8462., 16433.])
    """

    def unbalance(beta: float) -> float:
        return beta * math.sin(beta) - ratio * math.cos(beta)

    # Each branch of beta tan(beta) rises from zero to infinity, so it meets the ratio once.
    roots = [brentq(unbalance, n * math.pi, (n + 0.5) * math.pi) for n in range(n_modes)]
    return np.array(roots) / (2.0 * math.pi * transit_time)


LENGTHS = {LONG: 0.123, SHORT: 0.092}
"""Of the beams [m]."""

INTERFERENCES = (0.279, 0.381)
"""Of the static tests (Table 5.3) [mm]."""

_MEASURED = (464.0, 576.0, 587.0, 764.0)
"""k_EFF of each with both beams [Nm/rad]."""

_TRANSIT_TIME, _INERTIA_RATIO = 1 / 16262, 0.4201
"""Of the shaft: the two numbers that give the six of Table 3.1."""


def in_series(material: str, interference_mm: float, support: float) -> float:
    """Return the stiffness of a bushing and its support in series [Nm/rad]."""
    stiffness = rig_of(material).fit(1e-3 * interference_mm).elastomer_stiffness
    return 1.0 / (1.0 / support + 1.0 / stiffness)


def series() -> Iterator[Values]:
    """Yield the sign in (3.1), which (5.2) and Table 5.4 have right; Tables 5.3 and 5.4."""
    yield {"exact": 1.0}
    theory = []
    for interference in INTERFERENCES:
        for support in LENGTHS:
            exact, calibrated = (in_series(m, interference, support) for m in (THESIS, CALIBRATED))
            theory.append(exact)
            yield {"exact": exact, "calibrated": calibrated, "scale": exact}
    for exact, measured in zip(theory, _MEASURED, strict=True):
        yield {"exact": 100.0 * abs(exact - measured) / exact}


def shaft() -> Iterator[Values]:
    """Yield Table 3.1 from two numbers."""
    fixed = fixed_free_frequencies(_TRANSIT_TIME, _INERTIA_RATIO)
    for exact in (*fixed.tolist(), *free_free_frequencies(_TRANSIT_TIME).tolist()):
        yield {"exact": exact}


def _sleeve() -> Sleeve:
    sleeve = rig_of(THESIS).sleeve
    assert sleeve is not None  # the shipped bench states it
    return sleeve


def pressures() -> Iterator[Values]:
    """Yield the pressure by Lame over that at 0.279 mm (Recommendation 2), as the mean torques go.

    With one coefficient of friction the torque goes with the pressure, which is linear in the
    interference, whatever size and modulus of the sleeve are assumed. Its wall and hardness are
    chosen for the torsional stiffness at 0.279 mm, which does not depend on the interference.
    """
    for interference in (0.178, 0.381):
        pressure, middle = (_sleeve().pressure(1e-3 * at) for at in (interference, 0.279))
        yield {"exact": pressure / middle}


def sleeves() -> Iterator[Values]:
    """Yield the torsional stiffness of the sleeve."""
    for _ in INTERFERENCES:
        yield {"exact": _sleeve().torsional_stiffness}


def squeal() -> Iterator[Values]:
    """Yield the mode behind the 6570 Hz of the squeal, most likely rad/s read as Hz."""
    fit = rig_of(THESIS).fit(0.279e-3)
    mode = math.sqrt(fit.elastomer_stiffness / rig_of(THESIS).elastomer_inertia) / (2.0 * math.pi)
    line = QUANTITIES["strongest_line"](CALIBRATED, Case(10.0, 0.279, SHORT))
    yield {"exact": mode, "calibrated": line}
