"""Sound power of the plate under steady drives, in one-third octaves.

Radiated power follows from the plate's velocity spectrum over wavenumbers: only components slower
than k = omega / c travel away. Over that disc the integral is smooth once k_x = k s and
k_y = k sqrt(1 - s^2) sin(v) are its variables, so that Gauss's and the midpoint rule take it to
rounding with a few nodes a wavelength, where sums of pressure over a hemisphere need thousands of
Rayleigh integrals. All modes radiate together, cross terms included. What they radiate damps them
too, which for a steel plate in air is less than a tenth of its loss factor, and is left out.

The plate is part of a rigid baffle, as for the sound at the microphone. One that stands free
short-circuits about its edges what the baffle keeps apart, and is quieter below its critical
frequency. By that the baffle is too loud [dB], for a steel plate of 0.9 x 0.6 m and 10 mm (critical
frequency 1.2 kHz), per one-third octave, mean of four point forces (Laulagnet, J. Acoust. Soc. Am.
103 (1998) 2451-2462, solved with Chebyshev functions for the pressure jump):

    Hz                    63   125   250   500  1000
    simply supported      17    10     7     6     0
    free                  10    12     2    -1     0

Bands are those of base ten (IEC 61260-1). In each one the frequencies computed lie close enough for
the narrowest resonance: half its width apart, which sums a resonance to half a percent.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike, NDArray
from threadpoolctl import threadpool_limits

from models.errors import ParameterError
from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED
from models.show import short_repr
from models.structure.plate import PlateModes

SPARE_NODES = 12
"""Nodes of the wavenumber integral beyond one for each unit of its phase."""

REFERENCE = 1e-12
"""Of sound power levels [W]."""

FEWEST = 8
"""Frequencies in a band."""

BAND = 10**0.1
"""Upper over lower edge of a band."""


@short_repr
@dataclass(frozen=True, eq=False)
class BandPower:
    """Power per one-third octave.

    Parameters
    ----------
    centre : ndarray, shape (n_bands,)
        Exact middle of each band [Hz].
    radiated : ndarray, shape (n_bands,)
        As sound of the plate's upper side [W].
    """

    centre: NDArray[np.float64]
    radiated: NDArray[np.float64]

    @property
    def level(self) -> NDArray[np.float64]:
        """Sound power level [dB re 1 pW], shape (n_bands,); minus infinity for no power."""
        with np.errstate(divide="ignore"):  # a band of no power
            return np.asarray(10 * np.log10(self.radiated / REFERENCE))


def radiated_spectrum(
    modes: PlateModes, drives: NDArray[np.float64], spectrum: ArrayLike, frequency: ArrayLike
) -> NDArray[np.float64]:
    """Sound power of the upper side under harmonic drives.

    Parameters
    ----------
    modes : PlateModes
    drives : ndarray, shape (n_modes, n_drives)
        As for `models.structure.plate.acceleration_model`.
    spectrum : array_like, shape (n_drives,), (n_drives, n) or (n_sets, n_drives, n)
        Force [N] or moment [Nm] of each drive, complex, root mean square; all act together. Sets
        know nothing of each other's phase, so that their powers add up.
    frequency : array_like, shape (n,)
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
    >>> power = radiated_spectrum(modes, modes.shape([0.1], [0.05]).T, [1.0], [3e3])
    >>> (10 * np.log10(power / 1e-12)).round(1)  # dB re 1 pW, for 1 N
    array([64.4])
    """
    frequency = np.asarray(frequency, dtype=np.float64)
    given = np.asarray(spectrum, dtype=np.complex128)
    sets = np.broadcast_to(
        given[:, None] if given.ndim == 1 else given,
        (len(given) if given.ndim == 3 else 1, drives.shape[1], frequency.size),
    )
    forces = drives @ sets  # (n_sets, n_modes, n)
    omega, natural = 2 * np.pi * frequency, 2 * np.pi * modes.frequencies[:, None]
    ratios = modes.damping_ratios[:, None]
    velocity = (
        1j * omega * forces / modes.mass / (natural**2 - omega**2 + 2j * ratios * natural * omega)
    )
    columns = velocity.transpose(2, 0, 1)
    # Small products: threads that wait for each other take ten times as long as one.
    with threadpool_limits(limits=1, user_api="blas"):
        return np.array(
            [
                sum(radiated_power(modes, one, f) for one in fields)
                for fields, f in zip(columns, frequency.tolist(), strict=True)
            ]
        )


def radiated_power(modes: PlateModes, velocity: NDArray[np.complex128], frequency: float) -> float:
    """Sound power of the upper side.

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
    """Give transforms of the bases at a quarter of the disc's nodes, and the nodes' weights."""
    n_s = int(k * modes.plate.length / 4) + SPARE_NODES
    n_v = int(k * modes.plate.width / 4) + SPARE_NODES
    s, weight = _upper_gauss(8 * (n_s // 8 + 1))
    v = (np.arange(n_v) + 0.5) * (np.pi / (2 * n_v))
    k_y = k * np.outer(np.sqrt(1 - s**2), np.sin(v))
    weights = np.outer(weight, np.full(n_v, np.pi / (2 * n_v)))
    return modes.along.transform(k * s), modes.across.transform(k_y), weights


@lru_cache(maxsize=32)
def _upper_gauss(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Upper half of Gauss's rule with twice as many nodes."""
    nodes, weights = leggauss(2 * count)
    return nodes[count:], weights[count:]


def third_octave_power(
    modes: PlateModes,
    drives: NDArray[np.float64],
    density: Callable[[NDArray[np.float64]], NDArray[np.complex128]] | None = None,
    *,
    low: float = 50.0,
    high: float = 10e3,
) -> BandPower:
    """Sound power of the plate under steady drives, band by band.

    Parameters
    ----------
    modes : PlateModes
    drives : ndarray, shape (n_modes, n_drives)
        As for `models.structure.plate.acceleration_model`.
    density : callable, optional
        Takes frequencies, shape (n,), each a fixed ratio above the last, to the complex spectra of
        all drives, shape (n_drives, n), whose squared magnitude is a power spectral density
        [N2/Hz or (Nm)2/Hz]; phases between drives count. Or to several such sets that know nothing
        of each other's phase, shape (n_sets, n_drives, n). Default: all drives in phase at 1 N2/Hz.
    low, high : float, optional
        Middles of the lowest and the highest band [Hz].

    Returns
    -------
    BandPower

    Raises
    ------
    ParameterError
        If the bands reach beyond the modes, or are none.

    Examples
    --------
    >>> from models.structure.plate import plate_modes
    >>> from models.bench import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> modes = plate_modes(steel, 4e3)
    >>> bands = third_octave_power(modes, modes.shape([0.1], [0.05]).T, low=500.0, high=2e3)
    >>> bands.centre.round(), bands.level.round(1)
    (array([ 501.,  631.,  794., 1000., 1259., 1585., 1995.]), array([...]))
    """
    first, last = (round(10 * np.log10(middle / 1e3)) for middle in (low, high))
    centre = 1e3 * 10 ** (np.arange(first, last + 1) / 10)
    if not centre.size:
        raise ParameterError(f"bands from {low:g} to {high:g} Hz: low must not be above high")
    if centre[-1] * np.sqrt(BAND) > modes.frequencies[-1] * BAND:
        raise ParameterError(
            f"bands to {high:g} Hz reach beyond the plate's modes, which end at "
            f"{modes.frequencies[-1]:g} Hz; compute more modes or choose a lower high"
        )
    count = max(FEWEST, int(np.ceil(np.log(BAND) / modes.damping_ratios.min())))
    edges = centre[:, None] * BAND ** (np.linspace(-0.5, 0.5, count + 1))
    frequency = np.sqrt(edges[:, 1:] * edges[:, :-1]).ravel()
    spectra = np.ones((drives.shape[1], frequency.size)) if density is None else density(frequency)
    radiated = radiated_spectrum(modes, drives, spectra, frequency)
    width = np.diff(edges, axis=1)
    return BandPower(centre, np.sum(radiated.reshape(width.shape) * width, axis=1))
