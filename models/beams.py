"""The beams that carry the clamp: their stiffness, and what passes from the clamp to the plate.

Clamp and beams turn about the shaft's axis, so by symmetry one beam stands for both: fixed at
its anchor, which is taken as rigid, and following the rigid clamp at its root, where the
deflection is lever times theta and the slope is theta (Section 4.3, equations 4.6 and 4.7).
Bernoulli beams in Hermite finite elements with consistent mass: the anchor's force and moment
are then exact reactions rather than derivatives of a deflection.

The simulator integrates a lumped clamp, J_C on k_B. J_C "includes clamp, elastomer and beam"
(Chapter 4), so the rigid clamp's own inertia is smaller. It is chosen such that the first
torsional mode of beams and clamp has exactly the lumped model's sqrt(k_B / J_C) / (2 pi) and,
with the damping passed in, the lumped model's damping: the two agree where both apply, and the
beams add what the lumped model lacks, their bending modes from about 1 kHz upwards.

A beam as a radiator of its own is not here, nor are translations of the clamp, which a torque
does not drive on a symmetric rig.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import eigh

from models.beam_elements import HalfStructure, deflection_row, half_structure
from models.errors import ParameterError
from models.modal import ModalModel

if TYPE_CHECKING:
    from models.rig import Beams

__all__ = [
    "ACCELERATION",
    "ANCHOR_FORCE",
    "ANCHOR_MOMENT",
    "PULSE",
    "TORQUE",
    "beam_length",
    "beam_structure",
    "rigid_clamp_inertia",
    "torsional_stiffness",
]

TORQUE, PULSE = 0, 1
"""Inputs of `beam_structure`."""

ACCELERATION, ANCHOR_FORCE, ANCHOR_MOMENT = 0, 1, 2
"""Outputs of `beam_structure`."""


def torsional_stiffness(beams: Beams, length: float) -> float:
    """Torsional stiffness k_B of clamp and two beams, equation (4.11).

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
    The thesis rounds the first one to 2214:

    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> [round(torsional_stiffness(steel, length), 1) for length in (0.123, 0.092)]
    [2198.6, 3745.1]
    """
    lever = beams.lever
    return 24 * _bending_stiffness(beams) / length**2 * (lever**2 / length + lever + length / 3)


def beam_length(beams: Beams, stiffness: float) -> float:
    """Beam length at which the beams have a given torsional stiffness.

    Equation (4.11) is a cubic in the length with exactly one positive root, by Descartes' rule
    of signs; the other two are no larger in modulus.

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
        If the stiffness is not positive and finite.

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
    scale = 24 * _bending_stiffness(beams) / stiffness
    lever = beams.lever
    roots = np.roots([1.0, -scale / 3, -scale * lever, -scale * lever**2])
    return float(roots.real.max())


def rigid_clamp_inertia(beams: Beams, length: float, clamp_inertia: float) -> float:
    """Inertia of the clamp alone, the lumped one less the beams' share.

    Parameters
    ----------
    beams : Beams
    length : float
        [m]
    clamp_inertia : float
        J_C of the lumped model, beams included [kg m2].

    Returns
    -------
    float
        [kg m2]; clamp and beams then have their first torsional mode at
        sqrt(k_B / J_C) / (2 pi).

    Raises
    ------
    ParameterError
        If the beams alone have more inertia than J_C.

    Examples
    --------
    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> round(1 / rigid_clamp_inertia(steel, 0.123, 1 / 1200))
    1692
    """
    omega2 = torsional_stiffness(beams, length) / clamp_inertia
    half = _half_structure(beams, length)
    dynamic = 2 * (half.stiffness - omega2 * half.mass)
    condensed = dynamic[0, 0] - dynamic[0, 1:] @ np.linalg.solve(dynamic[1:, 1:], dynamic[1:, 0])
    inertia = float(condensed / omega2)
    inner = eigh(half.stiffness[1:, 1:], half.mass[1:, 1:], eigvals_only=True)
    if inertia <= 0 or inner[0] <= omega2:
        raise ParameterError(
            f"beams of {length:.3g} m, for {torsional_stiffness(beams, length):.4g} Nm/rad, have "
            f"more inertia than the clamp's {clamp_inertia:.4g} kg m2 that is to include them; "
            f"use a larger support stiffness or clamp inertia"
        )
    return inertia


def beam_structure(
    beams: Beams,
    support_stiffness: float,
    clamp_inertia: float,
    damping_ratio: float,
    highest_frequency: float,
) -> ModalModel:
    """Modes of clamp and beams, from the bushing's torque to accelerometer and anchors.

    Parameters
    ----------
    beams : Beams
    support_stiffness : float
        k_B [Nm/rad]; it sets the beams' length.
    clamp_inertia : float
        J_C of the lumped model [kg m2].
    damping_ratio : float
        Of the first torsional mode; the others have that of `beams`.
    highest_frequency : float
        Modes above it act on the anchors by their static part alone [Hz].

    Returns
    -------
    ModalModel
        Inputs: `TORQUE` of the bushing on the clamp [Nm]; `PULSE`, a normal force by which the
        anchor of the right beam pushes the plate up and that of the left one pulls it down [N].
        The beams take the opposite force, one element from their anchors.
        Outputs: `ACCELERATION` of the right beam at the accelerometer [m/s2];
        `ANCHOR_FORCE` [N] and `ANCHOR_MOMENT` [Nm] of the right anchor on the plate, the moment
        such that it works on the slope dw/dx. The left anchor passes the opposite force and
        the same moment.

    Raises
    ------
    ParameterError
        If no beams of positive length, or none lighter than the clamp, have this stiffness.

    Examples
    --------
    At rest the two anchors balance the torque:

    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> model = beam_structure(steel, 2214.0, 1 / 1200, 0.02, 40e3)
    >>> _, force, moment = model.frequency_response([0.0])[:, TORQUE, 0].real
    >>> arm = steel.lever + beam_length(steel, 2214.0)
    >>> round(float(2 * (force * arm + moment)), 6)
    1.0
    >>> model.frequencies[:3].round().astype(int).tolist()
    [259, 1197, 3085]
    """
    length = beam_length(beams, support_stiffness)
    half = _half_structure(beams, length)
    stiffness, mass = 2 * half.stiffness, 2 * half.mass
    mass[0, 0] += rigid_clamp_inertia(beams, length, clamp_inertia)
    omega2, shapes = eigh(stiffness, mass)

    inputs = np.zeros((mass.shape[0], 2))
    inputs[0, TORQUE] = 1.0
    inputs[-2, PULSE] = -2.0  # both beams, each working on its own deflection
    reaction_stiffness, reaction_mass = -half.anchor_stiffness, -half.anchor_mass
    static = np.zeros((3, 2))
    static[1:] = reaction_stiffness @ np.linalg.solve(stiffness, inputs)

    kept = np.sqrt(omega2) / (2 * np.pi) <= highest_frequency
    omega2, shapes = omega2[kept], shapes[:, kept]
    ratios = np.full(omega2.size, beams.damping_ratio)
    ratios[:1] = damping_ratio
    none = np.zeros((1, omega2.size))
    displacements = np.concatenate([none, reaction_stiffness @ shapes])
    sensor = deflection_row(beams.accelerometer, length) @ half.expansion
    accelerations = np.concatenate([(sensor @ shapes)[None], reaction_mass @ shapes])
    modal_inputs = shapes.T @ inputs
    return ModalModel(
        frequencies=np.sqrt(omega2) / (2 * np.pi),
        damping_ratios=ratios,
        inputs=modal_inputs,
        displacements=displacements,
        accelerations=accelerations,
        feedthrough=static - (displacements / omega2) @ modal_inputs,
    )


def _half_structure(beams: Beams, length: float) -> HalfStructure:
    return half_structure(
        bending_stiffness=_bending_stiffness(beams),
        mass_per_length=beams.density * beams.width * beams.thickness,
        length=length,
        lever=beams.lever,
    )


def _bending_stiffness(beams: Beams) -> float:
    return beams.youngs_modulus * beams.width * beams.thickness**3 / 12
