"""Sound power of the plate, and the balance of the power that is supplied to it.

Radiated power follows from the plate's velocity spectrum over wavenumbers: only components slower
than k = omega / c travel away. Over that disc the integral is smooth once k_x = k s and
k_y = k sqrt(1 - s^2) sin(v) are its variables, so that Gauss's and the midpoint rule take it to
rounding with a few nodes a wavelength, where sums of pressure over a hemisphere need thousands of
Rayleigh integrals. All modes radiate together, cross terms included. What they radiate damps them
too; `radiation_loss` gives by how much, each mode for itself, which for a steel plate in air is a
small correction to its loss factor, and is left out of the responses unless asked for.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial.legendre import leggauss

from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED
from models.radiation.unbaffled import unbaffled_power
from models.single_thread import single_thread

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike, NDArray

    from models.structure.plate import PlateModes

__all__ = [
    "PowerFlow",
    "power_flow",
    "radiated_power",
    "radiation_efficiency",
    "radiation_loss",
    "with_radiation_damping",
]

SPARE_NODES = 12
"""Nodes of the wavenumber integral beyond one for each unit of its phase."""

MODES_AT_ONCE = 64
"""Transforms held in memory together."""


@dataclass(frozen=True, eq=False)
class PowerFlow:
    """Where the power goes at each frequency, for drives in root mean square.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        [Hz]
    supplied, dissipated, radiated : ndarray, shape (n,)
        By the drives, in the plate, and as sound of its upper side [W]. What is supplied is what is
        dissipated and, if the modes were given radiation damping, radiated.
    mean_square_velocity : ndarray, shape (n,)
        Over the plate [m2/s2].
    area : float
        Of the plate [m2].
    """

    frequency: NDArray[np.float64]
    supplied: NDArray[np.float64]
    dissipated: NDArray[np.float64]
    radiated: NDArray[np.float64]
    mean_square_velocity: NDArray[np.float64]
    area: float

    @property
    def radiation_efficiency(self) -> NDArray[np.float64]:
        """Radiated power over that of a rigid piston of equal mean square velocity in plane waves.

        [-], shape (n,).
        """
        plane = AIR_DENSITY * SOUND_SPEED * self.area * self.mean_square_velocity
        return np.asarray(self.radiated / plane)


def power_flow(
    modes: PlateModes,
    drives: NDArray[np.float64],
    spectrum: ArrayLike,
    frequency: ArrayLike,
    *,
    baffled: bool = True,
    radiation_damping: bool = False,
) -> PowerFlow:
    """Steady-state powers under harmonic drives.

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
    baffled : bool, optional
        Whether the plate is part of a rigid baffle; else it stands free, which takes a hundred
        times as long (`models.radiation.unbaffled`).
    radiation_damping : bool, optional
        Whether each mode also loses what it radiates alone at its own frequency. Dissipated and
        radiated power then add up to the supplied one, within 0.2 % over a wide band and 2 % in
        each third octave that holds a resonance; at a loss factor of 0.001, where half the power
        is radiated, 4 %. The rest is what modes radiate by each other and off their resonance.

    Returns
    -------
    PowerFlow

    Examples
    --------
    >>> from models.structure.plate import plate_modes
    >>> from models.rig import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> modes = plate_modes(steel, 16e3)
    >>> flow = power_flow(modes, modes.shape([0.1], [0.05]).T, [1.0], [3e3])
    >>> (10 * np.log10(flow.radiated / 1e-12)).round(1)  # dB re 1 pW, for 1 N
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
    damped = with_radiation_damping(modes) if radiation_damping else modes
    total = damped.damping_ratios[:, None]
    velocity = (
        1j * omega * forces / modes.mass / (natural**2 - omega**2 + 2j * total * natural * omega)
    )
    squares = np.sum(np.abs(velocity) ** 2, axis=0)
    resistance = 2 * modes.damping_ratios[:, None] * natural * modes.mass
    return PowerFlow(
        frequency,
        np.sum((forces.conj() * velocity).real, axis=(0, 1)),
        np.sum(resistance * squares, axis=0),
        np.array(
            [
                sum(radiated_power(modes, v, f) for v in fields)
                if baffled
                else unbaffled_power(modes, fields.T, f).sum()
                for fields, f in zip(velocity.transpose(2, 0, 1), frequency.tolist(), strict=True)
            ]
        ),
        np.sum(squares, axis=0) / 4,
        modes.plate.length * modes.plate.width,
    )


def radiation_efficiency(modes: PlateModes, frequency: ArrayLike) -> NDArray[np.float64]:
    """Radiation efficiency of each mode by itself, vibrating at given frequencies.

    Parameters
    ----------
    modes : PlateModes
    frequency : array_like, shape (n,)
        [Hz]

    Returns
    -------
    ndarray, shape (n_modes, n)
        [-]

    Notes
    -----
    C. E. Wallace, "Radiation resistance of a rectangular panel", J. Acoust. Soc. Am. 51 (1972)
    946-952, gives the limits for simply supported edges: 32 k^2 a b / pi^5 for mode (1, 1).

    Examples
    --------
    >>> from models.structure.plate import plate_modes
    >>> from models.rig import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> radiation_efficiency(plate_modes(steel, 500.0), [20.0, 5e3])[0].round(4)
    array([0.0076, 1.0024])
    """
    frequency = np.asarray(frequency, dtype=np.float64)
    efficiencies = np.zeros((modes.frequencies.size, frequency.size))
    for i in range(frequency.size):
        for first in range(0, modes.frequencies.size, MODES_AT_ONCE):
            some = slice(first, first + MODES_AT_ONCE)
            efficiencies[some, i] = _efficiencies(modes, some, 2 * np.pi * float(frequency[i]))
    return efficiencies


@lru_cache(maxsize=4)
def radiation_loss(modes: PlateModes) -> NDArray[np.float64]:
    """Loss factor of each mode by the sound of the upper side, at the mode's own frequency.

    Parameters
    ----------
    modes : PlateModes

    Returns
    -------
    ndarray, shape (n_modes,)
        rho_0 c sigma / (omega rho h) [-].

    Examples
    --------
    >>> from models.structure.plate import plate_modes
    >>> from models.rig import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> float(radiation_loss(plate_modes(steel, 2e3)).max().round(5))  # beside 0.03
    0.00151
    """
    omega = 2 * np.pi * modes.frequencies
    efficiencies = [
        _efficiencies(modes, slice(r, r + 1), float(omega[r])) for r in range(omega.size)
    ]
    plane = AIR_DENSITY * SOUND_SPEED / (omega * modes.plate.mass_per_area)
    loss = plane * np.concatenate(efficiencies)
    loss.flags.writeable = False  # shared by all that ask for it
    return loss


def with_radiation_damping(modes: PlateModes) -> PlateModes:
    """Modes that also lose what they radiate, for all that is computed from them."""
    return replace(modes, damping_ratios=modes.damping_ratios + radiation_loss(modes) / 2)


def radiated_power(modes: PlateModes, velocity: NDArray[np.complex128], frequency: float) -> float:
    """Sound power of the upper side.

    Parameters
    ----------
    modes : PlateModes
    velocity : ndarray, shape (n_modes,)
        Root mean square velocity of each mode [m/s].
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
    >>> from models.rig import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> first = np.array([1.0 + 0.0j])
    >>> round(radiated_power(plate_modes(steel, 100.0), first, 8e3) / (413.2 * 0.54 / 4), 2)
    1.0
    """
    k = 2 * np.pi * frequency / SOUND_SPEED
    power = 0.0
    with single_thread():
        products = modes.products.weighted(velocity)
        along, across, weights = _transforms(modes, k)
        for px, py in _parities():
            lines = along[:, px::2] @ products[px::2, py::2]
            field = (across[:, :, py::2] @ lines[:, :, None])[..., 0]
            power += float(np.sum(weights * np.abs(field) ** 2))
    return AIR_DENSITY * SOUND_SPEED * (k / np.pi) ** 2 * power


def _efficiencies(modes: PlateModes, some: slice, omega: float) -> NDArray[np.float64]:
    k = omega / SOUND_SPEED
    total = np.zeros(modes.frequencies[some].size)
    with single_thread():
        along, across, weights = _transforms(modes, k)
        for px, py in _parities():
            one_along, one_across = np.zeros_like(along), np.zeros_like(across)
            one_along[:, px::2], one_across[:, :, py::2] = along[:, px::2], across[:, :, py::2]
            field = modes.products.combine(one_along, one_across, some)
            total += np.einsum("st,str->r", weights, field**2)
    area = modes.plate.length * modes.plate.width
    return np.asarray((k / np.pi) ** 2 * total / (area / 4))


def _parities() -> Iterator[tuple[int, int]]:
    return ((px, py) for px in (0, 1) for py in (0, 1))


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
