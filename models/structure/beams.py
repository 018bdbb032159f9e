"""Clamp and beams of the rig: support stiffness, and modes from the bushing's torque to the plate.

Clamp and beams turn about the shaft's axis, so by symmetry one beam stands for both. It is held at
its anchor, rigidly or by springs, and follows the rigid clamp at its root, where the deflection is
lever times theta and the slope is theta (Section 4.3, equations 4.6 and 4.7). The model is a
Bernoulli beam of Hermite finite elements with consistent mass: force and moment of the anchor,
stiffness times displacements plus mass times accelerations, are then as accurate as the motion.

The support stiffness k_B identifies the beams, as in Table 3.2: their length is the one that gives
k_B between rigid anchors, by equation (4.11). The simulator integrates a lumped clamp, J_C on k_B.
J_C "includes clamp, elastomer and beam" (Chapter 4), so the inertia of the rigid clamp is smaller.
It is chosen such that the first torsional mode of beams and clamp has exactly the lumped model's
sqrt(k_B / J_C) / (2 pi) and, with the damping of the lumped model, the two agree where both apply.
The beams add what the lumped model lacks: their bending modes from about 1 kHz upwards.

Compliant anchors shift the bending modes to the measured frequencies, but leave the beams a lower
stiffness than k_B, which (4.11) computes for rigid ones. k_B and J_C stay, since the motion is
computed with them and the thesis's damping and torques belong to them. Therefore all stiffness and
inertia of the structure, anchors included, is scaled by k_B over the stiffness of the beams on
their anchors. The scaling changes no frequency, no mode shape and no share of the torque at an
anchor, but only the amplitude, which then agrees with the lumped clamp.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from models.bench import Beams
from models.condition import CONDITION
from models.errors import ParameterError
from models.structure.modal import ModalModel


def torsional_stiffness(beams: Beams, length: float) -> float:
    """Return the torsional stiffness of clamp and two beams on their anchors.

    With the flexibility C of a cantilever on its anchor's springs, for force and moment at its
    root, k = 2 r' inv(C) r, where r = (lever, 1). For rigid anchors that is equation (4.11).

    Parameters
    ----------
    beams : Beams
    length : float
        Length of each beam from the anchor to the clamp [m].

    Returns
    -------
    float
        [Nm/rad]

    Examples
    --------
    The thesis rounds the first one to 2214; compliant anchors reduce it:

    >>> from dataclasses import replace
    >>> from models.bench import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> [round(torsional_stiffness(steel, length), 1) for length in (0.123, 0.092)]
    [2198.6, 3745.1]
    >>> round(torsional_stiffness(replace(steel, anchor_rotation=500.0), 0.123), 1)
    1745.6
    """
    bending, turn = beams.bending_stiffness, 1.0 / beams.anchor_rotation
    coupling = -(length**2) / (2.0 * bending) - turn * length
    deflection = length**3 / (3.0 * bending) + turn * length**2 + 1.0 / beams.anchor_translation
    flexibility = np.array([[deflection, coupling], [coupling, length / bending + turn]])
    root = np.array([beams.lever, 1.0])
    return float(2.0 * root @ np.linalg.solve(flexibility, root))


def beam_length(beams: Beams, stiffness: float) -> float:
    """Return the beam length for a torsional stiffness between rigid anchors (4.11).

    The equation is a cubic with exactly one positive root, by Descartes' rule of signs.

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
        If no beam can have this stiffness.

    Examples
    --------
    >>> from models.bench import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> round(beam_length(steel, 2214.0), 4)
    0.1225
    """
    bounds = CONDITION["support_stiffness"]
    if not bounds.possible(stiffness):
        raise ParameterError(
            f"support stiffness {stiffness:g} Nm/rad belongs to no beam; possible is "
            f"{bounds.low:g} to {bounds.high:g}"
        )
    bending, lever = beams.bending_stiffness, beams.lever
    cubic = [stiffness, -8.0 * bending, -24.0 * bending * lever, -24.0 * bending * lever**2]
    roots = np.roots(cubic)
    return float(roots.real[np.abs(roots.imag) <= 1e-9 * np.abs(roots)].max())


N_ELEMENTS = 24
"""Elements of a beam; the error is 0.3 % in the ninth frequency, which is 35 kHz for 12.3 cm."""

_RIGID = 1e4
"""Stiffness of an anchor over that of its element from which it counts as rigid, to 1e-5 of the
beam's stiffness; a larger number would cost accuracy of the eigenvalues."""


class _Half(NamedTuple):
    """One beam in the coordinates theta, then deflection and slope of each free node.

    `stiffness` and `mass`, shape (n, n), include the springs of the anchor. `expansion`, shape
    (2 n_nodes, n), gives deflection and slope of every node from the clamp to the anchor.
    `anchor_stiffness` and `anchor_mass`, shape (2, n), give force and moment of the anchor on the
    beam from displacements and accelerations.
    """

    stiffness: NDArray[np.float64]
    mass: NDArray[np.float64]
    expansion: NDArray[np.float64]
    anchor_stiffness: NDArray[np.float64]
    anchor_mass: NDArray[np.float64]


def _half_structure(beams: Beams, support_stiffness: float) -> _Half:
    """Return one beam on its anchor, scaled in stiffness and mass to k_B at rest.

    M. Petyt, *Introduction to Finite Element Vibration Analysis*, chapter 3: the beam element with
    deflection and slope at its nodes.
    """
    length = beam_length(beams, support_stiffness)
    level = support_stiffness / torsional_stiffness(beams, length)
    h = length / N_ELEMENTS
    element_stiffness = (level * beams.bending_stiffness / h**3) * np.array(
        [
            [12, 6 * h, -12, 6 * h],
            [6 * h, 4 * h**2, -6 * h, 2 * h**2],
            [-12, -6 * h, 12, -6 * h],
            [6 * h, 2 * h**2, -6 * h, 4 * h**2],
        ]
    )
    element_mass = (level * beams.mass_per_length * h / 420) * np.array(
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
    springs = level * np.array([beams.anchor_translation, beams.anchor_rotation])
    yielding = np.flatnonzero(springs < _RIGID * np.diag(element_stiffness)[2:])
    free = np.array([*range(2, size - 2), *(size - 2 + yielding)])
    expansion = np.zeros((size, 1 + free.size))
    expansion[:2, 0] = beams.lever, 1.0
    expansion[free, 1 + np.arange(free.size)] = 1.0
    anchored = stiffness.copy()
    anchored[size - 2 + yielding, size - 2 + yielding] += springs[yielding]
    return _Half(
        stiffness=expansion.T @ anchored @ expansion,
        mass=expansion.T @ mass @ expansion,
        expansion=expansion,
        anchor_stiffness=stiffness[-2:] @ expansion,
        anchor_mass=mass[-2:] @ expansion,
    )


def deflection_row(fraction: float, length: float) -> NDArray[np.float64]:
    """Return the row that maps all nodes' deflections and slopes to the deflection at a point.

    Parameters
    ----------
    fraction : float
        Place of the point, as a fraction of the length from the clamp.
    length : float
        [m]

    Returns
    -------
    ndarray, shape (2 n_nodes,)
        [-] for deflections and [m] for slopes.

    Examples
    --------
    Half an element from the clamp:

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


TORQUE, PULSE = 0, 1
"""Inputs of `beam_structure`."""

ACCELERATION, ANCHOR_FORCE, ANCHOR_MOMENT = 0, 1, 2
"""First outputs of `beam_structure`."""


def rigid_clamp_inertia(beams: Beams, support_stiffness: float, clamp_inertia: float) -> float:
    """Return the inertia of the clamp without the beams.

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
        [kg m2]; with it the first torsional mode of clamp and beams is sqrt(k_B / J_C) / (2 pi).
        0 where the inertia of the beams exceeds J_C.

    Examples
    --------
    >>> from models.bench import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> round(1 / rigid_clamp_inertia(steel, 2214.0, 1 / 1200))
    1688
    """
    omega2 = support_stiffness / clamp_inertia
    half = _half_structure(beams, support_stiffness)
    dynamic = 2 * (half.stiffness - omega2 * half.mass)
    condensed = dynamic[0, 0] - dynamic[0, 1:] @ np.linalg.solve(dynamic[1:, 1:], dynamic[1:, 0])
    inner = eigh(half.stiffness[1:, 1:], half.mass[1:, 1:], eigvals_only=True)
    return max(float(condensed / omega2), 0.0) if inner[0] > omega2 else 0.0


def on_anchors(beams: Beams, support_stiffness: float, clamp_inertia: float) -> Beams:
    """Return the beams, with rigid anchors where compliant ones are impossible.

    Compliant anchors need heavier beams for the same k_B and first mode. Very long or very short
    beams would then have more inertia than the lumped model.

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
    >>> from models.bench import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3, anchor_rotation=250.0)
    >>> [on_anchors(steel, k, 1 / 1200).anchor_rotation for k in (1000.0, 2214.0)]
    [inf, 250.0]
    """
    if rigid_clamp_inertia(beams, support_stiffness, clamp_inertia) > 0.0:
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
    """Return the modal model of clamp and beams, from torque to accelerometer and anchors.

    Parameters
    ----------
    beams : Beams
    support_stiffness : float
        k_B [Nm/rad]; it determines the beams' length by (4.11).
    clamp_inertia : float
        J_C of the lumped model [kg m2]; where the beams would have more, the anchors are rigid
        (`on_anchors`).
    damping_ratio : float
        Damping ratio of the first torsional mode [-]; the others have that of `beams`.
    highest_frequency : float
        Modes above it contribute to the anchors' forces statically only [Hz].
    stations : sequence of float, optional
        Further outputs: accelerations at distances from the shaft's axis, on the clamp or the right
        beam [m].

    Returns
    -------
    ModalModel
        Inputs: `TORQUE` of the bushing on the clamp [Nm]; `PULSE`, a normal force with which the
        anchor of the right beam pushes the plate up and that of the left one pulls it down [N];
        the opposite force acts on the beams beside their anchors.
        Outputs: `ACCELERATION` of the right beam at the accelerometer [m/s2];
        `ANCHOR_FORCE` [N] and `ANCHOR_MOMENT` [Nm] of the right anchor on the plate, the moment
        positive along the slope dw/dx. The left anchor has the opposite force and the same moment.
        Then the upward acceleration of each station [m/s2].

    Raises
    ------
    ParameterError
        If no beams lighter than the clamp have this stiffness.

    Examples
    --------
    At rest the two anchors balance the torque:

    >>> from models.bench import Beams
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
    inertia = rigid_clamp_inertia(beams, support_stiffness, clamp_inertia)
    if inertia == 0.0:
        raise ParameterError(
            f"beams of {length:.3g} m, for {support_stiffness:.4g} Nm/rad, have more inertia than "
            f"the clamp's {clamp_inertia:.4g} kg m2 that is to include them; use a larger support "
            "stiffness or clamp inertia"
        )
    mass[0, 0] += inertia
    omega2, shapes = eigh(stiffness, mass)

    inputs = np.zeros((mass.shape[0], 2))
    inputs[0, TORQUE] = 1.0
    # Both beams, each working on its own deflection. The impact closes the joint: where the anchor
    # is compliant, the beam's end reacts, which leaves a couple.
    impact = deflection_row(1.0 - beams.strike, length) - deflection_row(1.0, length)
    inputs[:, PULSE] = -2.0 * impact @ half.expansion
    reaction_stiffness, reaction_mass = -half.anchor_stiffness, -half.anchor_mass
    static = np.zeros((3 + len(stations), 2))
    static[1:3] = reaction_stiffness @ np.linalg.solve(stiffness, inputs)

    dynamic = np.sqrt(omega2) / (2 * np.pi) <= highest_frequency
    omega2, shapes = omega2[dynamic], shapes[:, dynamic]
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


def _deflection_rows(
    half: _Half, lever: float, length: float, distances: Sequence[float]
) -> NDArray[np.float64]:
    """Return the rows that map the coordinates to the deflection at distances from the axis."""
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
