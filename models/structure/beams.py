"""The beams that carry the clamp, by their modes: what passes from the clamp to the plate.

Clamp and beams turn about the shaft's axis, so by symmetry one beam stands for both: held at
its anchor, rigidly or by springs, and following the rigid clamp at its root, where the deflection
is lever times theta and the slope is theta (Section 4.3, equations 4.6 and 4.7). Bernoulli beams
in Hermite finite elements with consistent mass: the anchor's force and moment are then exact
reactions rather than derivatives of a deflection.

The simulator integrates a lumped clamp, J_C on k_B. J_C "includes clamp, elastomer and beam"
(Chapter 4), so the rigid clamp's own inertia is smaller. It is chosen such that the first
torsional mode of beams and clamp has exactly the lumped model's sqrt(k_B / J_C) / (2 pi) and,
with the damping passed in, the lumped model's damping: the two agree where both apply, and the
beams add what the lumped model lacks, their bending modes from about 1 kHz upwards.

Anchors that yield put the bending modes where they were measured, but leave the beams less than
k_B, which (4.11) computes for rigid ones. k_B and J_C are what the motion is computed with and
the thesis's damping and torques go with, so they are kept: all stiffness and inertia of the
structure, anchors included, is taken as many times as k_B is of what the beams have on their
anchors. That alters no frequency, no shape and no share of the torque that an anchor gets, only by
how much all of it moves, and makes that agree with the lumped clamp.

Translations of the clamp, which a torque does not drive on a symmetric rig, are not here but in
`models.structure.beams_exact`; the sound of the beams themselves is in
`models.structure.beams_sound`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import eigh

from models.errors import ParameterError
from models.structure.beam_elements import HalfStructure, deflection_row, half_structure
from models.structure.beams_stiffness import (
    beam_length,
    bending_stiffness,
    mass_per_length,
    torsional_stiffness,
)
from models.structure.modal import ModalModel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from models.rig import Beams

__all__ = [
    "ACCELERATION",
    "ANCHOR_FORCE",
    "ANCHOR_MOMENT",
    "PULSE",
    "TORQUE",
    "beam_structure",
    "on_anchors",
    "rigid_clamp_inertia",
]

TORQUE, PULSE = 0, 1
"""Inputs of `beam_structure`."""

ACCELERATION, ANCHOR_FORCE, ANCHOR_MOMENT = 0, 1, 2
"""First outputs of `beam_structure`."""


def rigid_clamp_inertia(beams: Beams, support_stiffness: float, clamp_inertia: float) -> float:
    """Inertia of the clamp alone, the lumped one less the beams' share.

    Parameters
    ----------
    beams : Beams
    support_stiffness : float
        k_B [Nm/rad]
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
    >>> round(1 / rigid_clamp_inertia(steel, 2214.0, 1 / 1200))
    1688
    """
    inertia = _clamp_inertia(beams, support_stiffness, clamp_inertia)
    if inertia <= 0.0:
        raise ParameterError(
            f"beams of {beam_length(beams, support_stiffness):.3g} m, for {support_stiffness:.4g} "
            f"Nm/rad, have more inertia than the clamp's {clamp_inertia:.4g} kg m2 that is to "
            "include them; use a larger support stiffness or clamp inertia"
        )
    return inertia


def _clamp_inertia(beams: Beams, support_stiffness: float, clamp_inertia: float) -> float:
    """Inertia of the clamp alone, or 0 where the beams' is more than that of both [kg m2]."""
    omega2 = support_stiffness / clamp_inertia
    half = _half_structure(beams, support_stiffness)
    dynamic = 2 * (half.stiffness - omega2 * half.mass)
    condensed = dynamic[0, 0] - dynamic[0, 1:] @ np.linalg.solve(dynamic[1:, 1:], dynamic[1:, 0])
    inner = eigh(half.stiffness[1:, 1:], half.mass[1:, 1:], eigvals_only=True)
    return max(float(condensed / omega2), 0.0) if inner[0] > omega2 else 0.0


def on_anchors(beams: Beams, support_stiffness: float, clamp_inertia: float) -> Beams:
    """Return the beams on their anchors, or on rigid ones where theirs cannot be.

    Anchors that yield are heavier beams for the same k_B and first mode. Very long or very short
    ones would then have more inertia than the lumped model has in all.

    Parameters
    ----------
    beams : Beams
    support_stiffness : float
        k_B [Nm/rad].
    clamp_inertia : float
        J_C of the lumped model, beams included [kg m2].

    Returns
    -------
    Beams

    Examples
    --------
    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3, anchor_rotation=250.0)
    >>> [on_anchors(steel, k, 1 / 1200).anchor_rotation for k in (1000.0, 2214.0)]
    [inf, 250.0]
    """
    if _clamp_inertia(beams, support_stiffness, clamp_inertia) > 0.0:
        return beams
    return replace(beams, anchor_rotation=math.inf, anchor_translation=math.inf)


def beam_structure(
    beams: Beams,
    support_stiffness: float,
    clamp_inertia: float,
    damping_ratio: float,
    highest_frequency: float,
    stations: Sequence[float] = (),
) -> ModalModel:
    """Modes of clamp and beams, from the bushing's torque to accelerometer and anchors.

    Parameters
    ----------
    beams : Beams
    support_stiffness : float
        k_B [Nm/rad]; it sets the beams' length by (4.11), and the clamp feels it at rest.
    clamp_inertia : float
        J_C of the lumped model [kg m2]; where the beams on their anchors would have more, the
        anchors are rigid (`on_anchors`).
    damping_ratio : float
        Of the first torsional mode [-]; the others have that of `beams`.
    highest_frequency : float
        Modes above it act on the anchors by their static part alone [Hz].
    stations : sequence of float, optional
        Distances from the shaft's axis, on the clamp or the right beam, of which the
        acceleration is wanted as well [m].

    Returns
    -------
    ModalModel
        Inputs: `TORQUE` of the bushing on the clamp [Nm]; `PULSE`, a normal force by which the
        anchor of the right beam pushes the plate up and that of the left one pulls it down [N].
        The beams take the opposite force, beside their anchors.
        Outputs: `ACCELERATION` of the right beam at the accelerometer [m/s2];
        `ANCHOR_FORCE` [N] and `ANCHOR_MOMENT` [Nm] of the right anchor on the plate, the moment
        such that it works on the slope dw/dx. The left anchor passes the opposite force and
        the same moment. Then the acceleration of each station, up [m/s2].

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
    beams = on_anchors(beams, support_stiffness, clamp_inertia)
    length = beam_length(beams, support_stiffness)
    half = _half_structure(beams, support_stiffness)
    stiffness, mass = 2 * half.stiffness, 2 * half.mass
    mass[0, 0] += rigid_clamp_inertia(beams, support_stiffness, clamp_inertia)
    omega2, shapes = eigh(stiffness, mass)

    inputs = np.zeros((mass.shape[0], 2))
    inputs[0, TORQUE] = 1.0
    # Both beams, each working on its own deflection. The blow closes the joint: where the anchor
    # yields it is the beam's end that holds against it, so that a couple is left.
    struck = deflection_row(1.0 - beams.strike, length) - deflection_row(1.0, length)
    inputs[:, PULSE] = -2.0 * struck @ half.expansion
    reaction_stiffness, reaction_mass = -half.anchor_stiffness, -half.anchor_mass
    static = np.zeros((3 + len(stations), 2))
    static[1:3] = reaction_stiffness @ np.linalg.solve(stiffness, inputs)

    kept = np.sqrt(omega2) / (2 * np.pi) <= highest_frequency
    omega2, shapes = omega2[kept], shapes[:, kept]
    ratios = np.full(omega2.size, beams.damping_ratio)
    ratios[:1] = damping_ratio
    displacements = np.zeros((3 + len(stations), omega2.size))
    displacements[1:3] = reaction_stiffness @ shapes
    sensor = beams.lever + beams.accelerometer * length
    deflections = _deflection_rows(half, beams.lever, length, [sensor, *stations]) @ shapes
    accelerations = np.concatenate([deflections[:1], reaction_mass @ shapes, deflections[1:]])
    modal_inputs = shapes.T @ inputs
    return ModalModel(
        frequencies=np.sqrt(omega2) / (2 * np.pi),
        damping_ratios=ratios,
        inputs=modal_inputs,
        displacements=displacements,
        accelerations=accelerations,
        feedthrough=static - (displacements / omega2) @ modal_inputs,
    )


def _half_structure(beams: Beams, support_stiffness: float) -> HalfStructure:
    """One beam on its anchor, at the level of stiffness and mass that meets k_B at rest."""
    length = beam_length(beams, support_stiffness)
    level = support_stiffness / torsional_stiffness(beams, length)
    return half_structure(
        bending_stiffness=level * bending_stiffness(beams),
        mass_per_length=level * mass_per_length(beams),
        length=length,
        lever=beams.lever,
        anchor_translation=level * beams.anchor_translation,
        anchor_rotation=level * beams.anchor_rotation,
    )


def _deflection_rows(
    half: HalfStructure, lever: float, length: float, distances: Sequence[float]
) -> NDArray[np.float64]:
    """Rows that take the coordinates to the deflection at distances from the axis."""
    turning = np.zeros(half.expansion.shape[1])
    turning[0] = 1.0
    return np.array(
        [
            d * turning
            if d < lever
            else deflection_row(min((d - lever) / length, 1.0), length) @ half.expansion
            for d in distances
        ]
    )
