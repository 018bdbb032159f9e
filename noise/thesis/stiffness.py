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

from models.errors import ParameterError
from models.structure.beams import torsional_stiffness
from noise.thesis.modes import rigidly_anchored
from noise.thesis.row import Row, number
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

MEASURED = {
    0.279: {LONG: (464.0, 9.3), SHORT: (576.0, 2.0)},
    0.381: {LONG: (587.0, 15.4), SHORT: (764.0, 4.0)},
}
"""k_EFF by interference [mm] and k_B (Table 5.3) [Nm/rad]; error in Table 5.4 [%]."""

STATIC_TOLERANCE = 0.16
"""5.3 claims two to fifteen percent for the static tests."""

_TRANSIT_TIME, _INERTIA_RATIO = 1 / 16262, 0.4201
"""Of the shaft: the two numbers that give the six of Table 3.1."""


def beams() -> Iterator[Row]:
    """Equations (4.11) and (4.12)."""
    beam = rigidly_anchored()
    yield Row(
        "second_moment_of_area", "beam of 25.4 x 3.175 mm", "m4", number(6.7746e-11),
        exact=beam.width * beam.thickness**3 / 12, tolerance=1e-4, digits=5,
    )  # fmt: skip
    for printed, length in LENGTHS.items():
        yield Row(
            "support_stiffness", f"(4.11), {100 * length:g} cm", "Nm/rad", number(printed),
            exact=torsional_stiffness(beam, length), tolerance=0.001, digits=5,
        )  # fmt: skip


def series() -> Iterator[Row]:
    """Tables 5.3 and 5.4, and the sign in (3.1)."""
    yield Row(
        "series_sign", "(3.1), of 1/k_E; (5.2) has plus, which Table 5.4 follows", "1",
        number(-1.0, "-"), exact=1.0, meant=number(1.0), digits=1,
    )  # fmt: skip
    errors = []
    for interference, by_support in MEASURED.items():
        for k_b, (measured, error) in by_support.items():
            theory, shipped = (
                1.0 / (1.0 / k_b + 1.0 / rig_of(m).fit(1e-3 * interference).elastomer_stiffness)
                for m in (THESIS, CALIBRATED)
            )
            where = f"{interference:g} mm, {k_b:g} Nm/rad"
            yield Row(
                "effective_stiffness", f"{where}, static", "Nm/rad",
                number(measured), exact=theory, calibrated=shipped, measured=True,
                tolerance=STATIC_TOLERANCE, scale=theory,
            )  # fmt: skip
            off = 100.0 * abs(theory - measured) / theory
            errors.append((where, number(error), off))
    for where, printed, off in errors:
        yield Row("effective_stiffness_error", where, "%", printed, exact=off, tolerance=0.02)


def shaft() -> Iterator[Row]:
    """Table 3.1, from two numbers."""
    for ends, printed, computed in (
        (
            "fixed-free", (1568.0, 8462.0, 16433.0),
            fixed_free_frequencies(_TRANSIT_TIME, _INERTIA_RATIO),
        ),
        ("free-free", (8131.0, 16262.0, 24393.0), free_free_frequencies(_TRANSIT_TIME)),
    ):  # fmt: skip
        for mode, (frequency, exact) in enumerate(zip(printed, computed, strict=True), start=1):
            yield Row(
                "shaft_torsion", f"{ends}, mode {mode}", "Hz", number(frequency),
                exact=float(exact), tolerance=0.001, digits=5, in_sample=True,
            )  # fmt: skip
