"""Impulse responses of a rig: from torque and pulse to accelerometer and microphone.

A chain of linear parts is combined into four impulse responses: clamp and beams transmit the torque
to their anchors (`models.structure.beams`), the anchors excite the plate, and the plate radiates
(`models.structure.plate`). A second input is the pulse of a micro-impact in the joint of beam and
anchor, which slips may excite: the torque has almost nothing above 2 kHz, but a creak extends to
15 kHz. The pulse pushes the plate under the anchors, up on one side and down on the other, and its
reaction bends the beams there, which the accelerometer measures; while it closes the joint, the
beams transmit nothing else to the plate. With the clamp bolted to the plate there is neither beam
nor joint: the torque is a moment on the plate, the pulse has no effect, and the acceleration is
that of the plate at the clamp's edge.

The sound of beams and clamp, which the thesis holds responsible for squeal (6.2), is added if the
rig asks for it. Only direct sound is modelled, and the plate does not act back on the beams.

A strip without a baffle pushes the air on one side and draws on the other, so it is a row of
dipoles. Far below ka = 1 (a is half of its width) an element of length dx exerts on the air the
force of the mass that it displaces and carries along, sigma dx times its acceleration, and

    p = sigma dx cos(theta) / (4 pi r) * (da/dt / c + a / r),

with sigma = rho (pi b^2 / 4 + b h) for width b and height h. Far above, each face is an independent
piston: p = rho b dx cos(theta) a / (2 pi r) in front of it. So with omega_c = 2 b rho c / sigma the
sound is that of the strip in a baffle, times a high pass

    H = (s + c / r) (s + g) / (s^2 + 2 zeta omega_0 s + omega_0^2),  g = omega_0^2 / omega_c,

where omega_0 = 0.774 omega_c and zeta = 0.575 are fitted to the exact solution of a thin strip
(elliptic cylinder, Mathieu functions). The error on axis is at most 1.1 dB up to ka = 4, 17 kHz for
an inch; off axis cos(theta) is that of the dipole and too wide for the piston. The clamp is a
square bar along the beams' line up to their roots, of an assumed width. Not included: sound that
the plate reflects or hides, the interface, and translations of the clamp, which a torque does not
drive on a symmetric rig.

On the shipped rig the beams add 3 dB to a squeal, where they are within 4 dB of the plate, and less
than 1 dB to a squawk. In a creak their sound comes from the reaction of the impacts in the anchors'
joints, and grows with the square of the distance from the end at which it acts: at a fifth of a
thickness, as shipped, the plate is 15 dB louder above 2 kHz at 2214 Nm/rad and 17 dB at 3745, which
agrees with 6.2; at a 24th of the length the beams would be louder.
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.signal import bilinear, lfilter

from models.bench import HIGHEST_PLATE_FREQUENCY, Beams, Microphone, Plate
from models.errors import ParameterError
from models.radiation.impulse_responses import ImpulseResponses, convolve
from models.radiation.rayleigh import SOUND_SPEED, rayleigh_integral
from models.rig import Rig, damping_at
from models.structure.beams import (
    ACCELERATION,
    ANCHOR_FORCE,
    ANCHOR_MOMENT,
    PULSE,
    TORQUE,
    beam_length,
    beam_structure,
)
from models.structure.modal import add_ringing
from models.structure.plate import PlateModes, acceleration_model, plate_modes, pressure_response
from models.transfer_functions.measured import with_measured

HIGHEST_BEAM_FREQUENCY = 40e3
"""Highest beam mode [Hz], so that the response below 20 kHz is complete."""

BAND = 0.45
"""Share of the sampling rate up to which modes are included, below the Nyquist frequency."""

FADE = 0.1
"""Last share of the responses, over which they are faded out."""

ELEMENT = 3e-3
"""Longest element: a seventh of the wavelength in air at 16 kHz [m]."""

_TURNOVER, _DAMPING = 0.774, 0.575
"""omega_0 / omega_c and zeta of the high pass, fitted to the exact strip from ka = 0.03 to 4.2."""


def impulse_responses(
    rig: Rig, interference: float, support_stiffness: float, rate: float, seconds: float = 0.7
) -> ImpulseResponses:
    """Return the impulse responses of a rig at one operating condition.

    The first torsional mode has the damping of the beams in the lumped model,
    (1 - share) c_E / (2 sqrt(k_B J_C)). Results are cached as far as the interference does not
    change them. A measured response with this support replaces the modelled one of the torque.

    Parameters
    ----------
    rig : Rig
    interference : float
        [m]
    support_stiffness : float
        k_B [Nm/rad], or `models.condition.FIXED`.
    rate : float
        Sampling rate of torque, pulse and outputs [Hz]. 96 kHz includes all modes; lower rates
        omit those above 0.45 of the rate and are less accurate above a quarter of it.
    seconds : float, optional
        Length of the responses [s], which are faded out at their end.

    Returns
    -------
    ImpulseResponses

    Raises
    ------
    ParameterError
        If no beams of this stiffness fit between clamp and plate, or a measured response is not
        causal.

    Examples
    --------
    >>> from models.rig import Fit, LawSpec
    >>> rig = Rig(
    ...     name="bench", material="fluorocarbon",
    ...     elastomer_inertia=1 / 65000, clamp_inertia=1 / 1200,
    ...     fits=(Fit(2.79e-4, 665.0, 10.7, 8.0, {2214.0: 0.105, 3745.0: 0.085}),),
    ...     friction=LawSpec("coulomb"), elastomer_damping_share=0.5, effects=(),
    ...     beams=Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3),
    ...     plate=Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.08, 0.05)),
    ...     microphone=Microphone((0.1, 0.05, 0.7)),
    ... )
    >>> chain = impulse_responses(rig, 2.79e-4, 2214.0, 48e3, seconds=0.2)
    >>> chain.torque_to_pressure.shape
    (9600,)
    """
    n_samples = round(seconds * rate)
    if math.isinf(support_stiffness):
        bolted = _bolted_response(rig.beams.lever, rig.plate, rig.microphone, rate, n_samples)
        return with_measured(bolted, rig.measured, support_stiffness)
    modelled = _beam_response(
        rig.beams,
        rig.plate,
        rig.microphone,
        support_stiffness,
        rig.clamp_inertia,
        first_mode_damping(rig, interference, support_stiffness),
        rate,
        n_samples,
    )
    return with_measured(modelled, rig.measured, support_stiffness)


def first_mode_damping(rig: Rig, interference: float, support_stiffness: float) -> float:
    """Return the damping ratio of the first torsional mode of clamp and beams [-].

    Parameters
    ----------
    rig : Rig
    interference : float
        [m]
    support_stiffness : float
        k_B [Nm/rad], finite.
    """
    damping = (1 - rig.elastomer_damping_share) * damping_at(
        rig.fit(interference), support_stiffness
    )
    return damping / (2 * math.sqrt(support_stiffness * rig.clamp_inertia))


def anchor_drives(modes: PlateModes, arm: float) -> NDArray[np.float64]:
    """Return the drives of the plate by the anchors' force and moment, acting antisymmetrically.

    Parameters
    ----------
    modes : PlateModes
    arm : float
        Distance of the anchors from the shaft's axis [m].

    Returns
    -------
    ndarray, shape (n_modes, 2)
        Modal force for a unit of force and of moment [1/sqrt(kg)] and [1/(m sqrt(kg))].
    """
    x, y = modes.plate.clamp_position
    return np.stack(
        [
            modes.shape(x + arm, y) - modes.shape(x - arm, y),
            modes.slope(x + arm, y) + modes.slope(x - arm, y),
        ],
        axis=1,
    )


def anchor_arm(beams: Beams, plate: Plate, support_stiffness: float) -> float:
    """Return the distance of the anchors from the shaft's axis [m].

    Parameters
    ----------
    beams : Beams
    plate : Plate
    support_stiffness : float
        k_B [Nm/rad], finite.

    Raises
    ------
    ParameterError
        If an anchor is off the plate.
    """
    arm = beams.lever + beam_length(beams, support_stiffness)
    left, right = plate.clamp_position[0] - arm, plate.clamp_position[0] + arm
    if max(-left, right) >= plate.length / 2:
        raise ParameterError(
            f"support stiffness {support_stiffness:g} Nm/rad puts the beams' anchors at x = "
            f"{left:.3g} and {right:.3g} m, off the plate of {plate.length:g} m; "
            f"use a larger stiffness"
        )
    return arm


@lru_cache(maxsize=16)
def _beam_response(
    beams: Beams,
    plate: Plate,
    microphone: Microphone,
    support_stiffness: float,
    clamp_inertia: float,
    damping_ratio: float,
    rate: float,
    n_samples: int,
) -> ImpulseResponses:
    arm = anchor_arm(beams, plate, support_stiffness)
    highest = min(HIGHEST_BEAM_FREQUENCY, BAND * rate)
    model = beam_structure(beams, support_stiffness, clamp_inertia, damping_ratio, highest)
    structure = model.impulse_response(rate, n_samples)
    force, moment = _anchors_to_pressure(plate, microphone, arm, rate, n_samples)
    pressure = np.stack(
        [
            convolve(structure[ANCHOR_FORCE, TORQUE], force)
            + convolve(structure[ANCHOR_MOMENT, TORQUE], moment),
            force,
        ]
    )
    if beams.radiating:
        pressure += beams_pressure(
            beams, support_stiffness, clamp_inertia, damping_ratio, plate.clamp_position,
            microphone, rate, n_samples, highest,
        )  # fmt: skip
    return _faded(
        rate,
        structure[ACCELERATION, TORQUE],
        pressure[TORQUE],
        structure[ACCELERATION, PULSE],
        pressure[PULSE],
    )


@lru_cache(maxsize=16)
def _anchors_to_pressure(
    plate: Plate, microphone: Microphone, arm: float, rate: float, n_samples: int
) -> NDArray[np.float64]:
    """Return the pressure responses to the anchors' force and moment."""
    modes = _modes(plate, rate)
    return pressure_response(modes, anchor_drives(modes, arm), microphone, rate, n_samples)


@lru_cache(maxsize=4)
def _bolted_response(
    lever: float, plate: Plate, microphone: Microphone, rate: float, n_samples: int
) -> ImpulseResponses:
    modes = _modes(plate, rate)
    x, y = plate.clamp_position
    moment = modes.slope([x], [y]).T
    none = np.zeros(n_samples)
    return _faded(
        rate,
        acceleration_model(modes, moment, [x + lever], [y]).impulse_response(rate, n_samples)[0, 0],
        pressure_response(modes, moment, microphone, rate, n_samples)[0],
        none,
        none,
    )


def _modes(plate: Plate, rate: float) -> PlateModes:
    return plate_modes(plate, min(HIGHEST_PLATE_FREQUENCY, BAND * rate))


def _faded(rate: float, *responses: NDArray[np.float64]) -> ImpulseResponses:
    n_samples = responses[0].size
    end = round(FADE * n_samples)
    window = np.ones(n_samples)
    window[n_samples - end :] = 0.5 + 0.5 * np.cos(np.pi * (np.arange(end) + 1) / end)
    faded = [window * impulse_response for impulse_response in responses]
    for impulse_response in faded:
        impulse_response.flags.writeable = False  # shared by the cache
    return ImpulseResponses(rate, *faded)


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
    """Return the impulse responses from each input to the sound pressure of beams and clamp.

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
        For `TORQUE` [Pa per Nm] and `PULSE` [Pa per N]; the travel time is included.

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
    >>> response = beams_pressure(
    ...     steel, 2214.0, 1 / 1200, 0.02, (0.0, 0.1), Microphone((0.2, 0.1, 0.5)), 48e3, 4800, 2e4
    ... )
    >>> response.shape, bool(np.any(response[0, :59])), bool(np.any(response[0, 59:]))
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
            baffled = np.zeros_like(pressure)
            add_ringing(baffled, model, model.inputs, taps, integral.delay, rate)
            pressure += lfilter(zeros, poles, baffled)
    return pressure


def strip_section(
    width: float, height: float, rate: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the digital filter from the sound of a baffled strip to that of an unbaffled one.

    Parameters
    ----------
    width, height : float
        Cross-section [m]; the strip moves along its height.
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    far, near : ndarray, shape (3,)
        Numerators of the sound that falls as 1 / r [-], and of the sound that falls as 1 / r^2,
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
