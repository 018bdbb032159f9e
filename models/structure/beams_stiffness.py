"""Torsional stiffness of clamp and beams, and the length of beams that have a given one.

The support stiffness k_B is what an experiment states, the length follows. Anchors that yield are
part of k_B, so that it stays the stiffness which the clamp feels at rest.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.rig import Beams

__all__ = ["beam_length", "bending_stiffness", "mass_per_length", "torsional_stiffness"]


def torsional_stiffness(beams: Beams, length: float) -> float:
    """Torsional stiffness k_B of clamp and two beams, equation (4.11), anchors included.

    Parameters
    ----------
    beams : Beams
    length : float
        Of each beam, from the anchor to the clamp [m].

    Returns
    -------
    float
        [Nm/rad]

    Examples
    --------
    The thesis rounds the first one to 2214; anchors that yield make it less:

    >>> from dataclasses import replace
    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> [round(torsional_stiffness(steel, length), 1) for length in (0.123, 0.092)]
    [2198.6, 3745.1]
    >>> round(torsional_stiffness(replace(steel, anchor_rotation=500.0), 0.123), 1)
    1745.6
    """
    numerator, denominator = _stiffness_polynomials(beams)
    return float(np.polyval(numerator, length) / np.polyval(denominator, length))


def beam_length(beams: Beams, stiffness: float) -> float:
    """Beam length at which the beams have a given torsional stiffness.

    With rigid anchors equation (4.11) is a cubic in the length with exactly one positive root, by
    Descartes' rule of signs. Anchors that yield make it a quartic and bound the stiffness; where
    two lengths have it, the longer one is meant, as beams much shorter than their anchors are
    stiff turn as one rigid body.

    Parameters
    ----------
    beams : Beams
    stiffness : float
        [Nm/rad]

    Returns
    -------
    float
        [m]

    Raises
    ------
    ParameterError
        If the stiffness is not positive and finite, or larger than the anchors allow.

    Examples
    --------
    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> round(beam_length(steel, 2214.0), 4)
    0.1225
    """
    if not 0 < stiffness < math.inf:
        raise ParameterError(
            f"support stiffness {stiffness:g} Nm/rad belongs to no beam; "
            f"give a positive, finite one"
        )
    numerator, denominator = _stiffness_polynomials(beams)
    roots = np.roots(np.polysub(denominator, numerator / stiffness))
    lengths = roots.real[(np.abs(roots.imag) <= 1e-9 * np.abs(roots)) & (roots.real > 0.0)]
    if lengths.size == 0:
        raise ParameterError(
            f"support stiffness {stiffness:g} Nm/rad is more than the anchors allow "
            f"({beams.anchor_rotation:g} Nm/rad, {beams.anchor_translation:g} N/m); "
            f"use a smaller one or stiffer anchors"
        )
    return float(lengths.max())


def bending_stiffness(beams: Beams) -> float:
    """Bending stiffness E I of one beam [N m2], (4.12).

    Examples
    --------
    >>> from models.rig import Beams
    >>> round(bending_stiffness(Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)), 3)
    13.549
    """
    return beams.youngs_modulus * beams.width * beams.thickness**3 / 12


def mass_per_length(beams: Beams) -> float:
    """Mass of one beam per length [kg/m].

    Examples
    --------
    >>> from models.rig import Beams
    >>> round(mass_per_length(Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)), 4)
    0.6452
    """
    return beams.density * beams.width * beams.thickness


def _stiffness_polynomials(beams: Beams) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """k_B as a quotient of polynomials in the length, highest power first.

    From the flexibility C of a cantilever on its anchor's springs, for force and moment at its
    root: k_B = 2 r' inv(C) r with r = (lever, 1). A rigid anchor leaves out a common factor.
    """
    stiffness, lever = bending_stiffness(beams), beams.lever
    push, turn = 1.0 / beams.anchor_translation, 1.0 / beams.anchor_rotation
    deflection = np.array([1.0 / (3.0 * stiffness), turn, 0.0, push])
    coupling = np.array([1.0 / (2.0 * stiffness), turn, 0.0])
    slope = np.array([1.0 / stiffness, turn])
    numerator = 2.0 * np.polyadd(np.polyadd(lever**2 * slope, 2.0 * lever * coupling), deflection)
    denominator: NDArray[np.float64] = np.polysub(
        np.polymul(deflection, slope), np.polymul(coupling, coupling)
    )
    if push == turn == 0.0:
        return numerator[:-1], denominator[:-1]
    return numerator, denominator
