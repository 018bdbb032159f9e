"""Stiffness of beams, bushing and both in series (4.3, 5.3), and the modes of the shaft (3.1).

Torsional modes of a uniform shaft (Appendix A) bound the rig's own resonances from two ends: a
shaft held at one end that carries an inertia at the other, and a free one. Both depend on the time
that a wave of shear takes along the shaft, and the first on one ratio of inertias, so that Table
3.1 has two unknowns for six numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from models.bushing import Sleeve
from models.errors import ParameterError
from models.structure.beams import torsional_stiffness
from noise.thesis.modes import rigidly_anchored
from noise.thesis.row import Values
from noise.thesis.runs import CALIBRATED, LONG, SHORT, THESIS, rig_of


def free_free_frequencies(transit_time: float, n_modes: int = 3) -> NDArray[np.float64]:
    """Natural frequencies of a free shaft, equation (A20), the rigid rotation left out.

    Parameters
    ----------
    transit_time : float
        l sqrt(rho / G): of a wave of shear from end to end [s].
    n_modes : int

    Returns
    -------
    ndarray, shape (n_modes,)
        [Hz]

    Raises
    ------
    ParameterError
        If the transit time is not positive.

    Examples
    --------
    >>> free_free_frequencies(1 / 16262).round()
    array([ 8131., 16262., 24393.])
    """
    _check(transit_time)
    return np.arange(1, n_modes + 1) / (2.0 * transit_time)


def fixed_free_frequencies(
    transit_time: float, ratio: float, n_modes: int = 3
) -> NDArray[np.float64]:
    """Natural frequencies of a shaft held at one end with an inertia at the other, (A14), (A15).

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

    Raises
    ------
    ParameterError
        If the transit time or the ratio is not positive.

    Examples
    --------
    >>> fixed_free_frequencies(1 / 16262, 0.4201).round()
    array([ 1569.,  8462., 16433.])
    """
    _check(transit_time)
    if not 0.0 < ratio < math.inf:
        raise ParameterError(f"shaft: ratio of inertias = {ratio:g} must be positive and finite")

    def unbalance(beta: float) -> float:
        return beta * math.sin(beta) - ratio * math.cos(beta)

    # Each branch of beta tan(beta) rises from zero to infinity, so it meets the ratio once.
    roots = [brentq(unbalance, n * math.pi, (n + 0.5) * math.pi) for n in range(n_modes)]
    return np.array(roots) / (2.0 * math.pi * transit_time)


def _check(transit_time: float) -> None:
    if not 0.0 < transit_time < math.inf:
        raise ParameterError(f"shaft: transit time = {transit_time:g} s must be positive")


LENGTHS = {LONG: 0.123, SHORT: 0.092}
"""Of the beams [m]."""

INTERFERENCES = (0.279, 0.381)
"""Of the static tests (Table 5.3) [mm]."""

_MEASURED = (464.0, 576.0, 587.0, 764.0)
"""k_EFF of each with both beams [Nm/rad]."""

_TRANSIT_TIME, _INERTIA_RATIO = 1 / 16262, 0.4201
"""Of the shaft: the two numbers that give the six of Table 3.1."""


def beams() -> Iterator[Values]:
    """Equations (4.11) and (4.12)."""
    beam = rigidly_anchored()
    yield {"exact": beam.width * beam.thickness**3 / 12}
    for length in LENGTHS.values():
        yield {"exact": torsional_stiffness(beam, length)}


def in_series(material: str, interference_mm: float, support: float) -> float:
    """Stiffness of a bushing and its support [Nm/rad]."""
    stiffness = rig_of(material).fit(1e-3 * interference_mm).elastomer_stiffness
    return 1.0 / (1.0 / support + 1.0 / stiffness)


def series() -> Iterator[Values]:
    """Sign in (3.1), which (5.2) and Table 5.4 have right; Tables 5.3 and 5.4."""
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
    """Table 3.1, from two numbers."""
    fixed = fixed_free_frequencies(_TRANSIT_TIME, _INERTIA_RATIO)
    for exact in (*fixed.tolist(), *free_free_frequencies(_TRANSIT_TIME).tolist()):
        yield {"exact": exact}


def _sleeve() -> Sleeve:
    sleeve = rig_of(THESIS).sleeve
    assert sleeve is not None  # the shipped bench states it
    return sleeve


def pressures() -> Iterator[Values]:
    """Pressure by Lame over that at 0.279 mm (Recommendation 2), as the mean torques go.

    With one coefficient of friction the torque goes with the pressure, which is linear in the
    interference, whatever size and modulus of the sleeve are assumed. Its wall and hardness are
    chosen for the torsional stiffness at 0.279 mm, which does not depend on the interference.
    """
    for interference in (0.178, 0.381):
        pressure, middle = (_sleeve().pressure(1e-3 * at) for at in (interference, 0.279))
        yield {"exact": pressure / middle}


def sleeves() -> Iterator[Values]:
    """Torsional stiffness of the sleeve that the pressure is of."""
    for _ in INTERFERENCES:
        yield {"exact": _sleeve().torsional_stiffness}
