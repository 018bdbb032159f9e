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

The sound of beams and clamp is added if the rig asks for it (`models.radiation.beam_sound`). Only
direct sound is modelled, and the plate does not act back on the beams.
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from models.bench import HIGHEST_PLATE_FREQUENCY, Beams, Microphone, Plate
from models.errors import ParameterError
from models.radiation.beam_sound import beams_pressure
from models.radiation.impulse_responses import ImpulseResponses, convolve
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
from models.structure.plate import (
    PlateModes,
    acceleration_model,
    plate_modes,
    pressure_response,
)
from models.transfer_functions.measured import with_measured

HIGHEST_BEAM_FREQUENCY = 40e3
"""Highest beam mode [Hz], so that the response below 20 kHz is complete."""

BAND = 0.45
"""Share of the sampling rate up to which modes are included, below the Nyquist frequency."""

FADE = 0.1
"""Last share of the responses, over which they are faded out."""


def impulse_responses(
    rig: Rig,
    interference: float,
    support_stiffness: float,
    rate: float,
    seconds: float = 0.7,
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
