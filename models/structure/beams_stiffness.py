"""Torsional stiffness of clamp and beams, and the length of beams that (4.11) gives one.

The support stiffness k_B names the beams, as in Table 3.2: their length is that which has it
between rigid anchors, by equation (4.11). Anchors that yield leave less of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from models.errors import ParameterError
from models.plausible import BOUNDS

if TYPE_CHECKING:
    from models.rig import Beams

__all__ = ["beam_length", "bending_stiffness", "mass_per_length", "torsional_stiffness"]


def torsional_stiffness(beams: Beams, length: float) -> float:
    """Torsional stiffness of clamp and two beams, anchors included.

    From the flexibility C of a cantilever on its anchor's springs, for force and moment at its
    root: k = 2 r' inv(C) r with r = (lever, 1). Between rigid anchors that is equation (4.11).

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
    bending, turn = bending_stiffness(beams), 1.0 / beams.anchor_rotation
    coupling = -(length**2) / (2.0 * bending) - turn * length
    deflection = length**3 / (3.0 * bending) + turn * length**2 + 1.0 / beams.anchor_translation
    flexibility = np.array([[deflection, coupling], [coupling, length / bending + turn]])
    root = np.array([beams.lever, 1.0])
    return float(2.0 * root @ np.linalg.solve(flexibility, root))


def beam_length(beams: Beams, stiffness: float) -> float:
    """Beam length that has a torsional stiffness between rigid anchors, by equation (4.11).

    It is a cubic in the length with exactly one positive root, by Descartes' rule of signs.

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
        If no beam can have such a stiffness.

    Examples
    --------
    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> round(beam_length(steel, 2214.0), 4)
    0.1225
    """
    low, high = BOUNDS["support_stiffness_Nm_rad"].possible
    if not low <= stiffness <= high:
        raise ParameterError(
            f"support stiffness {stiffness:g} Nm/rad belongs to no beam; possible is {low:g} to "
            f"{high:g}"
        )
    bending, lever = bending_stiffness(beams), beams.lever
    cubic = [stiffness, -8.0 * bending, -24.0 * bending * lever, -24.0 * bending * lever**2]
    roots = np.roots(cubic)
    return float(roots.real[np.abs(roots.imag) <= 1e-9 * np.abs(roots)].max())


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
