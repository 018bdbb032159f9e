"""One beam between a rigid, turning clamp and its anchor, in Hermite finite elements.

Consistent mass matrices, so that the reaction at the anchor, stiffness times displacements plus
mass times accelerations, is as accurate as the motion itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["N_ELEMENTS", "HalfStructure", "deflection_row", "half_structure"]

N_ELEMENTS = 24
"""Of a beam: 0.3 % in the frequency of its ninth mode, which is at 35 kHz for 12.3 cm."""

_RIGID = 1e4
"""An anchor so many times as stiff as the element beside it is rigid to 1e-5 of the beam's own
stiffness; a larger number would cost the eigenvalues their digits."""


@dataclass(frozen=True, eq=False)
class HalfStructure:
    """A beam on the coordinates theta, then deflection and slope of each inner node.

    Deflection and slope at the anchor follow where the anchor is not rigid.

    Parameters
    ----------
    stiffness, mass : ndarray, shape (n, n)
        Of this one beam with the springs of its anchor [SI units of the coordinates].
    expansion : ndarray, shape (2 n_nodes, n)
        To deflection [m] and slope of every node from the clamp to the anchor.
    anchor_stiffness, anchor_mass : ndarray, shape (2, n)
        Force [N] and moment [Nm] that the anchor must exert on the beam, by displacements and
        accelerations.
    """

    stiffness: NDArray[np.float64]
    mass: NDArray[np.float64]
    expansion: NDArray[np.float64]
    anchor_stiffness: NDArray[np.float64]
    anchor_mass: NDArray[np.float64]


def half_structure(
    *,
    bending_stiffness: float,
    mass_per_length: float,
    length: float,
    lever: float,
    anchor_translation: float = math.inf,
    anchor_rotation: float = math.inf,
) -> HalfStructure:
    """Assemble the beam.

    Parameters
    ----------
    bending_stiffness : float
        E I [N m2]
    mass_per_length : float
        [kg/m]
    length, lever : float
        Of the beam, and from the axis of rotation to its root [m].
    anchor_translation, anchor_rotation : float, optional
        Stiffness of the anchor against deflection [N/m] and slope [Nm/rad].

    Returns
    -------
    HalfStructure

    Notes
    -----
    M. Petyt, *Introduction to Finite Element Vibration Analysis*, chapter 3: the beam element
    with deflection and slope at its nodes.

    Examples
    --------
    Turning the clamp by 1 rad with the beam's other coordinates free takes half of (4.11):

    >>> half = half_structure(
    ...     bending_stiffness=13.549, mass_per_length=0.645, length=0.123, lever=0.0449
    ... )
    >>> round(2 / float(np.linalg.inv(half.stiffness)[0, 0]), 1)
    2198.6
    """
    h = length / N_ELEMENTS
    element_stiffness = (bending_stiffness / h**3) * np.array(
        [
            [12, 6 * h, -12, 6 * h],
            [6 * h, 4 * h**2, -6 * h, 2 * h**2],
            [-12, -6 * h, 12, -6 * h],
            [6 * h, 2 * h**2, -6 * h, 4 * h**2],
        ]
    )
    element_mass = (mass_per_length * h / 420) * np.array(
        [
            [156, 22 * h, 54, -13 * h],
            [22 * h, 4 * h**2, 13 * h, -3 * h**2],
            [54, 13 * h, 156, -22 * h],
            [-13 * h, -3 * h**2, -22 * h, 4 * h**2],
        ]
    )
    size = 2 * (N_ELEMENTS + 1)
    stiffness, mass = np.zeros((size, size)), np.zeros((size, size))
    for element in range(N_ELEMENTS):
        nodes = slice(2 * element, 2 * element + 4)
        stiffness[nodes, nodes] += element_stiffness
        mass[nodes, nodes] += element_mass
    springs = np.array([anchor_translation, anchor_rotation])
    yielding = np.flatnonzero(springs < _RIGID * np.diag(element_stiffness)[2:])
    free = np.array([*range(2, size - 2), *(size - 2 + yielding)])
    expansion = np.zeros((size, 1 + free.size))
    expansion[:2, 0] = lever, 1.0
    expansion[free, 1 + np.arange(free.size)] = 1.0
    held = stiffness.copy()
    held[size - 2 + yielding, size - 2 + yielding] += springs[yielding]
    return HalfStructure(
        stiffness=expansion.T @ held @ expansion,
        mass=expansion.T @ mass @ expansion,
        expansion=expansion,
        anchor_stiffness=stiffness[-2:] @ expansion,
        anchor_mass=mass[-2:] @ expansion,
    )


def deflection_row(fraction: float, length: float) -> NDArray[np.float64]:
    """Row that takes all nodes' deflections and slopes to the deflection at one point.

    Parameters
    ----------
    fraction : float
        Where the point is, as a fraction of the length from the clamp.
    length : float
        [m]

    Returns
    -------
    ndarray, shape (2 n_nodes,)
        [-] for deflections and [m] for slopes.

    Examples
    --------
    Half an element from the clamp, where its first node moves by 1 m:

    >>> row = deflection_row(0.5 / N_ELEMENTS, 0.24)
    >>> row[:4].round(5)
    array([ 0.5    ,  0.00125,  0.5    , -0.00125])
    """
    element = min(int(fraction * N_ELEMENTS), N_ELEMENTS - 1)
    s = fraction * N_ELEMENTS - element
    h = length / N_ELEMENTS
    row = np.zeros(2 * (N_ELEMENTS + 1))
    row[2 * element : 2 * element + 4] = (
        1 - 3 * s**2 + 2 * s**3,
        h * s * (1 - s) ** 2,
        3 * s**2 - 2 * s**3,
        h * s**2 * (s - 1),
    )
    return row
