"""Sound power of the rig's plate during a simulated run, in one-third octaves.

The torque of the bushing, and the pulses of the anchors if there are any, become forces and moments
of the anchors on the plate, as for the sound at the microphone (`models.radiation.rig_response`).
Their cross-spectra, averaged over the run, drive the plate's modes, and
`models.radiation.sound_power` gives the power of its upper side in a rigid baffle, the model of the
microphone's sound too. A free-standing plate is quieter below its critical frequency, by 2 to 17 dB
in a band. The power of a single line of the torque beside a resonance of the plate may be 1 dB off.
The sound of beams and clamp, the room, measured responses, and effects on the path of sound are not
included.
"""

import math
from collections.abc import Mapping
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.signal import csd

from models.bench import HIGHEST_PLATE_FREQUENCY
from models.errors import ParameterError
from models.radiation.rig_response import anchor_drives, first_mode_damping
from models.radiation.sound_power import LOWEST, BandPower, third_octave_power
from models.rig import Rig
from models.structure.beams import ANCHOR_FORCE, ANCHOR_MOMENT, TORQUE, beam_length, beam_structure
from models.structure.plate import plate_modes
from sim.effects import EFFECTS
from sim.effects.effect import Effect, activated
from sim.motion import Motion
from sim.run import pulse_force

SHORTEST = 0.25
"""Shortest run, whose frequency resolution suffices for the band at 50 Hz [s]."""

SEGMENT = 1.0
"""Length of the segments whose spectra are averaged [s]."""


def motion_sound_power(
    rig: Rig,
    motion: Motion,
    *,
    interference: float,
    support_stiffness: float,
    library: Mapping[str, Effect] | None = None,
) -> BandPower:
    """Return the sound power that the rig's plate radiates during a motion.

    Parameters
    ----------
    rig : Rig
        Simulated rig.
    motion : Motion
        Motion of 0.25 s or more; a transient is part of the mean.
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]; ``math.inf`` for the clamp bolted to the baseplate.
    library : mapping of str to Effect, optional
        Effects by name; by default `sim.effects.EFFECTS`.

    Returns
    -------
    BandPower
        Mean over the run in bands from 50 Hz to 10 kHz.

    Raises
    ------
    ParameterError
        If the motion is too short.

    Examples
    --------
    >>> from models.rig_file import load_material_rig
    >>> from sim.run import simulate
    >>> rig, fit = load_material_rig("fluorocarbon"), 0.279e-3
    >>> run = simulate(rig, 10.0, interference=fit, support_stiffness=3745.0, seconds=0.3)
    >>> power = motion_sound_power(rig, run.motion, interference=fit, support_stiffness=3745.0)
    >>> float(power.centre[power.level.argmax()].round())
    1000.0
    """
    if motion.torque.size < SHORTEST * motion.rate:
        raise ParameterError(
            f"sound power: the run lasts {motion.torque.size / motion.rate:g} s; it must last "
            f"{SHORTEST:g} s or more for the band at {LOWEST:g} Hz"
        )
    pulses = pulse_force(motion, activated(rig.effects, library or EFFECTS))
    frequency, inputs = _cross_spectra(np.stack([motion.torque, pulses]), motion.rate)
    modes = plate_modes(rig.plate, HIGHEST_PLATE_FREQUENCY)
    transfer = np.zeros((2, 2, frequency.size), dtype=np.complex128)
    if math.isinf(support_stiffness):
        x, y = rig.plate.clamp_position
        drives = modes.slope([x], [y]).T
        transfer = transfer[:1]
        transfer[0, 0] = 1.0
    else:
        arm = rig.beams.lever + beam_length(rig.beams, support_stiffness)
        drives = anchor_drives(modes, arm)
        beams = beam_structure(
            rig.beams,
            support_stiffness,
            rig.clamp_inertia,
            first_mode_damping(rig, interference, support_stiffness),
            HIGHEST_PLATE_FREQUENCY,
        )
        transfer[:, 0] = beams.frequency_response(frequency)[[ANCHOR_FORCE, ANCHOR_MOMENT], TORQUE]
        transfer[0, 1] = 1.0  # the anchor passes a pulse on to the plate
    spectra = np.einsum("iaf,abf,jbf->ijf", transfer, inputs, transfer.conj(), optimize=True)

    return third_octave_power(modes, drives, partial(_sets, frequency, spectra))


def _cross_spectra(
    signals: NDArray[np.float64], rate: float
) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
    """Return frequencies [Hz] and cross-spectral densities of signals, shape (n, n, n_freqs)."""
    length = min(signals.shape[1], round(SEGMENT * rate))
    frequency, density = csd(signals[None], signals[:, None], rate, nperseg=length)
    return frequency, density


def _sets(
    frequency: NDArray[np.float64], spectra: NDArray[np.complex128], middle: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Return uncorrelated sets of drives with the mean cross-spectra of cells about frequencies.

    The power of a line of the torque lies in its cell, however narrow the line is.
    """
    half = math.sqrt(middle[1] / middle[0])
    edges = np.append(middle / half, middle[-1] * half)
    below = cumulative_trapezoid(spectra, frequency, initial=0)
    mean = np.array([[np.diff(np.interp(edges, frequency, one)) for one in row] for row in below])
    power, vectors = np.linalg.eigh(np.moveaxis(mean / np.diff(edges), -1, 0))
    sets = np.sqrt(np.maximum(power, 0.0))[:, None] * vectors  # (n, n_drives, n_sets)
    return np.moveaxis(sets, (0, 1, 2), (2, 1, 0))
