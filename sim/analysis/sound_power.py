"""Sound power of the rig's plate during a simulated run, in one-third octaves.

The torque of the bushing, and the pulses of the anchors if there are any, become forces and moments
of the anchors on the plate, as for the sound at the microphone (`models.radiation.rig_response`).
Their cross-spectra, averaged over the run, drive the plate's modes. The power of a single line of
the torque beside a resonance of the plate may be 1 dB off. The sound of beams and clamp, the room,
measured responses, and effects on the path of sound are not included.

Radiated power follows from the plate's velocity spectrum over wavenumbers: only components below k
= omega / c radiate. The integral over that disc is smooth in the variables s and v, with k_x = k s
and k_y = k sqrt(1 - s^2) sin(v), so Gauss's and the midpoint rule are exact to rounding with a few
nodes per wavelength, whereas sums of pressure over a hemisphere need thousands of Rayleigh
integrals. All modes radiate together, cross terms included. Radiation damping, for a steel plate in
air less than a tenth of the loss factor, is left out.

The plate is part of a rigid baffle, as for the sound at the microphone. A free-standing plate has
an acoustic short circuit around its edges, and is quieter below its critical frequency. The excess
of the baffled plate [dB] for steel of 0.9 x 0.6 m and 10 mm (critical frequency 1.2 kHz), per
one-third octave, mean of four point forces (Laulagnet, J. Acoust. Soc. Am. 103 (1998) 2451-2462,
solved with Chebyshev functions for the pressure jump), is:

    Hz                    63   125   250   500  1000
    simply supported      17    10     7     6     0
    free                  10    12     2    -1     0

Bands are those of base ten (IEC 61260-1). The frequencies in each band are half the width of the
narrowest resonance apart, which integrates a resonance to half a percent.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.signal import csd
from threadpoolctl import threadpool_limits

from models.bench import HIGHEST_PLATE_FREQUENCY
from models.errors import ParameterError
from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED
from models.radiation.rig_response import anchor_drives, first_mode_damping
from models.rig import Rig
from models.structure.beams import ANCHOR_FORCE, ANCHOR_MOMENT, TORQUE, beam_length, beam_structure
from models.structure.plate import PlateModes, plate_modes
from sim.effects import EFFECTS
from sim.effects.effect import Effect, activated
from sim.motion import Motion
from sim.run import pulse_force

SHORTEST = 0.25
"""Shortest run, whose frequency resolution suffices for the band at 50 Hz [s]."""

SEGMENT = 1.0
"""Length of the segments whose spectra are averaged [s]."""

SPARE_NODES = 12
"""Nodes of the wavenumber integral in addition to one per unit of its phase."""

REFERENCE = 1e-12
"""Reference of sound power levels [W]."""

FEWEST = 8
"""Fewest frequencies in a band."""

BAND = 10**0.1
"""Ratio of the edges of a band."""

LOWEST, HIGHEST = 50.0, 10e3
"""Middles of the lowest and the highest band [Hz]."""


@dataclass(frozen=True, eq=False)
class BandPower:
    """Sound power per one-third octave.

    Parameters
    ----------
    centre : ndarray, shape (n_bands,)
        Exact middle of each band [Hz].
    radiated : ndarray, shape (n_bands,)
        Sound power of the plate's upper side [W].
    """

    centre: NDArray[np.float64]
    radiated: NDArray[np.float64]

    @property
    def level(self) -> NDArray[np.float64]:
        """Sound power level [dB re 1 pW], shape (n_bands,); minus infinity for no power."""
        with np.errstate(divide="ignore"):  # a band of no power
            return np.asarray(10 * np.log10(self.radiated / REFERENCE))


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
        If the motion is too short, or the bands reach beyond the plate's modes.

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
    centre, edges = _bands(modes)
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
    lines = np.sqrt(edges[:, 1:] * edges[:, :-1]).ravel()
    radiated = radiated_spectrum(modes, drives, _sets(frequency, spectra, lines), lines)
    width = np.diff(edges, axis=1)
    return BandPower(centre, np.sum(radiated.reshape(width.shape) * width, axis=1))


def _bands(modes: PlateModes) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the middles of the bands, and the edges of the lines in each, shape (n_bands, n)."""
    first, last = (round(10 * np.log10(middle / 1e3)) for middle in (LOWEST, HIGHEST))
    centre = 1e3 * 10 ** (np.arange(first, last + 1) / 10)
    if centre[-1] * np.sqrt(BAND) > modes.frequencies[-1] * BAND:
        raise ParameterError(
            f"bands to {HIGHEST:g} Hz reach beyond the plate's modes, which end at "
            f"{modes.frequencies[-1]:g} Hz; take a larger or thinner plate"
        )
    count = max(FEWEST, int(np.ceil(np.log(BAND) / modes.damping_ratios.min())))
    return centre, centre[:, None] * BAND ** (np.linspace(-0.5, 0.5, count + 1))


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


def radiated_spectrum(
    modes: PlateModes,
    drives: NDArray[np.float64],
    spectra: NDArray[np.complex128],
    frequency: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the sound power of the upper side under harmonic drives.

    Parameters
    ----------
    modes : PlateModes
    drives : ndarray, shape (n_modes, n_drives)
        As for `models.structure.plate.acceleration_model`.
    spectra : ndarray, shape (n_sets, n_drives, n)
        Force [N] or moment [Nm] of each drive, complex, root mean square. Drives of a set are
        coherent; sets are incoherent, so their powers add up.
    frequency : ndarray, shape (n,)
        [Hz]

    Returns
    -------
    ndarray, shape (n,)
        [W]

    Examples
    --------
    >>> from models.structure.plate import plate_modes
    >>> from models.bench import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> modes = plate_modes(steel, 16e3)
    >>> force = modes.shape([0.1], [0.05]).T
    >>> power = radiated_spectrum(modes, force, np.ones((1, 1, 1)), np.array([3e3]))
    >>> (10 * np.log10(power / 1e-12)).round(1)  # dB re 1 pW, for 1 N
    array([64.4])
    """
    forces = drives @ spectra  # (n_sets, n_modes, n)
    omega, natural = 2 * np.pi * frequency, 2 * np.pi * modes.frequencies[:, None]
    ratios = modes.damping_ratios[:, None]
    velocity = (
        1j * omega * forces / modes.mass / (natural**2 - omega**2 + 2j * ratios * natural * omega)
    )
    columns = velocity.transpose(2, 0, 1)
    # Small products: several threads take ten times as long as one.
    with threadpool_limits(limits=1, user_api="blas"):
        return np.array(
            [
                sum(radiated_power(modes, one, f) for one in fields)
                for fields, f in zip(columns, frequency.tolist(), strict=True)
            ]
        )


def radiated_power(modes: PlateModes, velocity: NDArray[np.complex128], frequency: float) -> float:
    """Return the sound power of the upper side at a frequency.

    Parameters
    ----------
    modes : PlateModes
    velocity : ndarray, shape (n_modes,)
        Root mean square velocity of each mode, complex [m/s].
    frequency : float
        [Hz]

    Returns
    -------
    float
        [W]

    Notes
    -----
    F. Fahy and P. Gardonio, *Sound and Structural Vibration*, 2nd ed., section 3.4.

    Examples
    --------
    Far above its critical frequency the first mode is a piston of mean square 1/4:

    >>> from models.structure.plate import plate_modes
    >>> from models.bench import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> first = np.array([1.0 + 0.0j])
    >>> round(radiated_power(plate_modes(steel, 100.0), first, 8e3) / (413.2 * 0.54 / 4), 2)
    1.0
    """
    k = 2 * np.pi * frequency / SOUND_SPEED
    power = 0.0
    products = np.zeros((modes.along.count, modes.across.count), dtype=np.complex128)
    products[modes.m - 1, modes.n - 1] = velocity
    along, across, weights = _transforms(modes, k)
    for px, py in ((0, 0), (0, 1), (1, 0), (1, 1)):  # parities never radiate together
        lines = along[:, px::2] @ products[px::2, py::2]
        field = (across[:, :, py::2] @ lines[:, :, None])[..., 0]
        power += float(np.sum(weights * np.abs(field) ** 2))
    return AIR_DENSITY * SOUND_SPEED * (k / np.pi) ** 2 * power


def _transforms(
    modes: PlateModes, k: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return transforms of the bases at a quarter of the disc's nodes, and their weights."""
    n_s = int(k * modes.plate.length / 4) + SPARE_NODES
    n_v = int(k * modes.plate.width / 4) + SPARE_NODES
    s, weight = _upper_gauss(8 * (n_s // 8 + 1))
    v = (np.arange(n_v) + 0.5) * (np.pi / (2 * n_v))
    k_y = k * np.outer(np.sqrt(1 - s**2), np.sin(v))
    weights = np.outer(weight, np.full(n_v, np.pi / (2 * n_v)))
    return modes.along.transform(k * s), modes.across.transform(k_y), weights


@lru_cache(maxsize=32)
def _upper_gauss(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the upper half of Gauss's rule with twice as many nodes."""
    nodes, weights = leggauss(2 * count)
    return nodes[count:], weights[count:]
