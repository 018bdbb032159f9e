"""Sound of beams and clamp, which the thesis holds responsible for squeal (6.2).

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

import numpy as np
from numpy.typing import NDArray
from scipy.signal import bilinear, lfilter

from models.bench import Beams, Microphone
from models.errors import ParameterError
from models.radiation.rayleigh import SOUND_SPEED, rayleigh_integral
from models.structure.beams import ACCELERATION, beam_length, beam_structure
from models.structure.modal import add_ringing

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
