"""Clamp and beams: stiffness, modes from the bushing's torque to the plate, and their own sound.

Clamp and beams turn about the shaft's axis, so by symmetry one beam stands for both: held at
its anchor, rigidly or by springs, and following the rigid clamp at its root, where the deflection
is lever times theta and the slope is theta (Section 4.3, equations 4.6 and 4.7). Bernoulli beams
in Hermite finite elements with consistent mass: the anchor's force and moment, stiffness times
displacements plus mass times accelerations, are then as accurate as the motion itself.

The support stiffness k_B names the beams, as in Table 3.2: their length is that which has it
between rigid anchors, by equation (4.11). The simulator integrates a lumped clamp, J_C on k_B. J_C
"includes clamp, elastomer and beam" (Chapter 4), so the rigid clamp's own inertia is smaller. It is
chosen such that the first torsional mode of beams and clamp has exactly the lumped model's
sqrt(k_B / J_C) / (2 pi) and, with the damping passed in, the lumped model's damping: the two agree
where both apply, and the beams add what the lumped model lacks, their bending modes from about 1
kHz upwards.

Anchors that yield put the bending modes where they were measured, but leave the beams less than
k_B, which (4.11) computes for rigid ones. k_B and J_C are what the motion is computed with and
the thesis's damping and torques go with, so they stay: all stiffness and inertia of the
structure, anchors included, is taken as many times as k_B is of what the beams have on their
anchors. That alters no frequency, no shape and no share of the torque that an anchor gets, only by
how much all of it moves, and makes that agree with the lumped clamp.

The thesis holds the beams' own sound responsible for squeal (6.2). A strip without a baffle pushes
the air on one side while it draws on the other, so it is a row of dipoles. Far below ka = 1 (a half
of its width) an element of length dx exerts on the air the force of the mass that it displaces and
carries along, sigma dx times its acceleration, and

    p = sigma dx cos(theta) / (4 pi r) * (da/dt / c + a / r),

with sigma = rho (pi b^2 / 4 + b h) for width b and height h. Far above, each face is a piston that
knows nothing of the other: p = rho b dx cos(theta) a / (2 pi r) in front of it. So with
omega_c = 2 b rho c / sigma the sound is that of the strip in a baffle, times a high pass

    H = (s + c / r) (s + g) / (s^2 + 2 zeta omega_0 s + omega_0^2),  g = omega_0^2 / omega_c,

of which omega_0 = 0.774 omega_c and zeta = 0.575 are fitted to the exact solution of a thin strip
(elliptic cylinder, Mathieu functions): on axis it errs by 1.1 dB at most up to ka = 4, 17 kHz for
an inch. Off axis cos(theta) is the dipole's and too wide for the piston. The clamp is a square bar
along the beams' line as far as their roots, its width assumed. Left out: sound that the plate
reflects or hides, the interface, and translations of the clamp, which a torque does not drive on a
symmetric rig.

On the shipped rig beams add 3 dB to a squeal, where they are within 4 dB of the plate, and less
than 1 to a squawk. In a creak their sound comes from the reaction of the blows in the anchors'
joints, and goes with the square of where it strikes: a fifth of a thickness from the end, as
shipped, the plate is 15 dB ahead above 2 kHz at 2214 Nm/rad and 17 dB at 3745, as 6.2 has it; at a
24th of the length from the anchor the beams would be the louder.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.signal import bilinear, lfilter

from models.bench import Beams, Microphone
from models.condition import CONDITION
from models.errors import ParameterError
from models.radiation.rayleigh import SOUND_SPEED, rayleigh_integral
from models.structure.modal import ModalModel, add_ringing


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
    >>> from models.bench import Beams
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
    bending, lever = bending_stiffness(beams), beams.lever
    cubic = [stiffness, -8.0 * bending, -24.0 * bending * lever, -24.0 * bending * lever**2]
    roots = np.roots(cubic)
    return float(roots.real[np.abs(roots.imag) <= 1e-9 * np.abs(roots)].max())


def bending_stiffness(beams: Beams) -> float:
    """Bending stiffness E I of one beam [N m2], (4.12).

    Examples
    --------
    >>> from models.bench import Beams
    >>> round(bending_stiffness(Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)), 3)
    13.549
    """
    return beams.youngs_modulus * beams.width * beams.thickness**3 / 12


def mass_per_length(beams: Beams) -> float:
    """Mass of one beam per length [kg/m].

    Examples
    --------
    >>> from models.bench import Beams
    >>> round(mass_per_length(Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)), 4)
    0.6452
    """
    return beams.density * beams.width * beams.thickness


N_ELEMENTS = 24
"""Of a beam: 0.3 % in the frequency of its ninth mode, which is at 35 kHz for 12.3 cm."""

_RIGID = 1e4
"""An anchor so many times as stiff as the element beside it is rigid to 1e-5 of the beam's own
stiffness; a larger number would cost the eigenvalues their digits."""


class _Half(NamedTuple):
    """One beam on the coordinates theta, then deflection and slope of each inner node.

    `stiffness` and `mass`, shape (n, n), are with the springs of its anchor; `expansion`, shape
    (2 n_nodes, n), leads to deflection and slope of every node from the clamp to the anchor, which
    follow there where it is not rigid; `anchor_stiffness` and `anchor_mass`, shape (2, n), to force
    and moment that the anchor must exert on the beam, by displacements and accelerations.
    """

    stiffness: NDArray[np.float64]
    mass: NDArray[np.float64]
    expansion: NDArray[np.float64]
    anchor_stiffness: NDArray[np.float64]
    anchor_mass: NDArray[np.float64]


def _half_structure(beams: Beams, support_stiffness: float) -> _Half:
    """One beam on its anchor, at the level of stiffness and mass that meets k_B at rest.

    M. Petyt, *Introduction to Finite Element Vibration Analysis*, chapter 3: the beam element with
    deflection and slope at its nodes.
    """
    length = beam_length(beams, support_stiffness)
    level = support_stiffness / torsional_stiffness(beams, length)
    h = length / N_ELEMENTS
    element_stiffness = (level * bending_stiffness(beams) / h**3) * np.array(
        [
            [12, 6 * h, -12, 6 * h],
            [6 * h, 4 * h**2, -6 * h, 2 * h**2],
            [-12, -6 * h, 12, -6 * h],
            [6 * h, 2 * h**2, -6 * h, 4 * h**2],
        ]
    )
    element_mass = (level * mass_per_length(beams) * h / 420) * np.array(
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
    held = stiffness.copy()
    held[size - 2 + yielding, size - 2 + yielding] += springs[yielding]
    return _Half(
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
    >>> from models.bench import Beams
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
    >>> from models.bench import Beams
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


def _deflection_rows(
    half: _Half, lever: float, length: float, distances: Sequence[float]
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


ELEMENT = 3e-3
"""Longest element: a seventh of the wavelength in air at 16 kHz [m]."""

_TURNOVER, _DAMPING = 0.774, 0.575
"""omega_0 / omega_c and zeta of the high pass, fitted to the exact strip from ka = 0.03 to 4.2."""


def beams_pressure(
    beams: Beams,
    support_stiffness: float,
    clamp_inertia: float,
    damping_ratio: float,
    clamp_position: tuple[float, float],
    microphone: Microphone,
    rate: float,
    n_samples: int,
    highest_frequency: float,
) -> NDArray[np.float64]:
    """Sound pressure of beams and clamp at the microphone after a unit sample of each input.

    Parameters
    ----------
    beams, support_stiffness, clamp_inertia, damping_ratio, highest_frequency
        As for `models.structure.beams.beam_structure`.
    clamp_position : tuple of 2 floats
        Middle of the clamp over the plate [m]; the beams lie along x.
    microphone : Microphone
    rate : float
        Sampling rate [Hz].
    n_samples : int

    Returns
    -------
    ndarray, shape (2, n_samples)
        To `TORQUE` [Pa per Nm] and `PULSE` [Pa per N]; the sound's travel is in it.

    Raises
    ------
    ParameterError
        If the microphone touches a beam or the clamp.

    Notes
    -----
    F. Fahy and P. Gardonio, *Sound and Structural Vibration*, 2nd ed., sections 3.4 and 3.5; P. M.
    Morse and K. U. Ingard, *Theoretical Acoustics*, section 7.1, for the dipole.

    Examples
    --------
    >>> from models.bench import Beams, Microphone
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> heard = beams_pressure(
    ...     steel, 2214.0, 1 / 1200, 0.02, (0.0, 0.1), Microphone((0.2, 0.1, 0.5)), 48e3, 4800, 2e4
    ... )
    >>> heard.shape, bool(np.any(heard[0, :59])), bool(np.any(heard[0, 59:]))
    ((2, 4800), False, True)
    """
    lever = beams.lever
    length = beam_length(beams, support_stiffness)
    clamp, beam = _middles(0.0, lever), _middles(lever, lever + length)
    model = beam_structure(
        beams, support_stiffness, clamp_inertia, damping_ratio, highest_frequency, [*clamp, *beam]
    )
    shapes = model.accelerations[ACCELERATION + 3 :]
    pressure = np.zeros((model.inputs.shape[1], n_samples))
    for where, spacing, moved, width, height in (
        (clamp, lever / clamp.size, shapes[: clamp.size], beams.clamp_width, beams.clamp_width),
        (beam, length / beam.size, shapes[clamp.size :], beams.width, beams.thickness),
    ):
        x = np.concatenate([where, -where])
        across = np.array([*clamp_position, beams.height]) - microphone.position
        distance = np.sqrt((x + across[0]) ** 2 + across[1] ** 2 + across[2] ** 2)
        if distance.min() < width:
            raise ParameterError(
                f"microphone at {distance.min():.3g} m from the beams or the clamp; "
                f"it must be at least {width:g} m away"
            )
        area = width * spacing * -across[2] / distance
        far, near, poles = strip_section(width, height, rate)
        for zeros, weight in ((far, area), (near, area * SOUND_SPEED / distance)):
            integral = rayleigh_integral(
                x + clamp_position[0],
                np.full(x.size, clamp_position[1]),
                weight,
                (*microphone.position[:2], across[2]),
                rate,
            )
            taps = integral.taps(np.concatenate([moved, -moved]))
            heard = np.zeros_like(pressure)
            add_ringing(heard, model, model.inputs, taps, integral.delay, rate)
            pressure += lfilter(zeros, poles, heard)
    return pressure


def strip_section(
    width: float, height: float, rate: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Digital filter from the sound of a strip in a baffle to that of one without.

    Parameters
    ----------
    width, height : float
        Of its cross-section [m]; it moves along its height.
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    far, near : ndarray, shape (3,)
        Numerators: of the sound that falls as 1 / r [-], and of that which falls as 1 / r^2 and is
        to be weighted with c / r [s].
    denominator : ndarray, shape (3,)
        [-]

    Examples
    --------
    >>> far, _, poles = strip_section(25.4e-3, 3.175e-3, 96e3)
    >>> turn = np.exp(2j * np.pi * np.array([250.0, 15e3]) / 96e3)
    >>> (20 * np.log10(np.abs(np.polyval(far, turn) / np.polyval(poles, turn)))).round(1)
    array([-25.5,   0.3])
    """
    carried = math.pi * width**2 / 4.0 + width * height
    corner = 2.0 * width * SOUND_SPEED / carried
    turnover = _TURNOVER * corner
    rise = turnover**2 / corner
    poles = [1.0, 2.0 * _DAMPING * turnover, turnover**2]
    far, denominator = bilinear([1.0, rise, 0.0], poles, fs=rate)
    near, _ = bilinear([1.0, rise], poles, fs=rate)
    return np.asarray(far), np.asarray(near), np.asarray(denominator)


def _middles(low: float, high: float) -> NDArray[np.float64]:
    n = math.ceil((high - low) / ELEMENT)
    return np.asarray(low + (np.arange(n) + 0.5) * (high - low) / n)
