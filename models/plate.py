"""The baseplate: its modes, how points and moments drive them, the sound that they radiate.

Thin plate (Kirchhoff) with simply supported edges in a rigid baffle. These edges are the only
ones with modes in closed form, so that thousands of frequencies cost nothing and can be checked;
at the plate's hundreds of modes the edges matter little but for the lowest few. The loss factor
acts as viscous damping of each mode, half of it being the damping ratio, which keeps responses
causal. Left out: the air's load on the plate, its sides and rear, and the sound that goes round
an edge without baffle, which weakens the lowest modes of a free-standing plate.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import lfilter

from models.modal import ModalModel, acceleration_section, ringing_samples
from models.rayleigh import rayleigh_integral

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from models.rig import Microphone, Plate

__all__ = [
    "PlateModes",
    "acceleration_model",
    "plate_modes",
    "pressure_response",
]

GRID_STEP = 3e-3
"""Largest surface element: a seventh of the wavelength in air at 16 kHz [m]."""

MODES_AT_ONCE = 32
"""Shapes held in memory together, 15 MB for a plate of half a square metre."""


@dataclass(frozen=True, eq=False)
class PlateModes:
    """Modes of a simply supported plate, by rising frequency.

    Parameters
    ----------
    plate : Plate
    m, n : ndarray, shape (n_modes,), int
        Half-waves along the length and the width.
    frequencies, damping_ratios : ndarray, shape (n_modes,)
        [Hz] and 1.
    mass : float
        Modal mass [kg], the same for all with shapes of unit amplitude.
    """

    plate: Plate
    m: NDArray[np.int64]
    n: NDArray[np.int64]
    frequencies: NDArray[np.float64]
    damping_ratios: NDArray[np.float64]
    mass: float

    def shape(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Give the normal displacement of each mode, of unit amplitude.

        Parameters
        ----------
        x, y : array_like, broadcast to a shape (...)
            Position from the plate's middle [m].

        Returns
        -------
        ndarray, shape (..., n_modes)
        """
        along, across = self._arguments(x, y)
        return np.sin(along) * np.sin(across)

    def slope(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Give the derivative of `shape` along x [1/m], on which a moment about y works.

        Parameters and returns are those of `shape`.
        """
        along, across = self._arguments(x, y)
        wavenumber = self.m.astype(np.float64) * (np.pi / self.plate.length)
        slope: NDArray[np.float64] = wavenumber * np.cos(along) * np.sin(across)
        return slope

    def _arguments(
        self, x: ArrayLike, y: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        along = np.asarray(x, dtype=np.float64)[..., None] / self.plate.length + 0.5
        across = np.asarray(y, dtype=np.float64)[..., None] / self.plate.width + 0.5
        return self.m * np.pi * along, self.n * np.pi * across


@lru_cache(maxsize=8)
def plate_modes(plate: Plate, highest_frequency: float) -> PlateModes:
    """All modes of a simply supported plate up to a frequency.

    Parameters
    ----------
    plate : Plate
    highest_frequency : float
        [Hz]

    Returns
    -------
    PlateModes

    Notes
    -----
    f = pi/2 sqrt(D / (rho h)) ((m/a)^2 + (n/b)^2); A. W. Leissa, *Vibration of Plates*,
    NASA SP-160 (1969), section 4.1.

    Examples
    --------
    >>> from models.rig import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> modes = plate_modes(steel, 16e3)
    >>> modes.frequencies[:3].round(1), modes.frequencies.size
    (array([ 78.9, 151.8, 242.8]), 323)
    """
    bending = (
        plate.youngs_modulus * plate.thickness**2 / (12 * (1 - plate.poisson_ratio**2))
    ) / plate.density
    scale = np.pi / 2 * np.sqrt(bending)
    largest = np.sqrt(highest_frequency / scale)
    m, n = np.meshgrid(
        np.arange(1, int(largest * plate.length) + 1), np.arange(1, int(largest * plate.width) + 1)
    )
    frequencies = scale * ((m / plate.length) ** 2 + (n / plate.width) ** 2)
    kept = frequencies <= highest_frequency
    m, n, frequencies = m[kept], n[kept], frequencies[kept]
    order = np.argsort(frequencies, kind="stable")
    return PlateModes(
        plate=plate,
        m=m[order],
        n=n[order],
        frequencies=frequencies[order],
        damping_ratios=np.full(order.size, plate.loss_factor / 2),
        mass=plate.density * plate.thickness * plate.length * plate.width / 4,
    )


def acceleration_model(
    modes: PlateModes, drives: NDArray[np.float64], x: ArrayLike, y: ArrayLike
) -> ModalModel:
    """Build the modal model from drives to the normal acceleration of points.

    Parameters
    ----------
    modes : PlateModes
    drives : ndarray, shape (n_modes, n_drives)
        Work of a unit of each drive on the modes: `PlateModes.shape` at the point of a force,
        `PlateModes.slope` at that of a moment, and sums of such.
    x, y : array_like, shape (n_points,)
        [m]

    Returns
    -------
    ModalModel
        With a drive an input and a point an output [m/s2 per N or Nm].

    Examples
    --------
    >>> from models.rig import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> modes = plate_modes(steel, 16e3)
    >>> moment = modes.slope([0.1], [0.05]).T
    >>> acceleration_model(modes, moment, [0.15], [0.05]).frequency_response([1e3]).shape
    (1, 1, 1)
    """
    points = modes.shape(x, y)
    return ModalModel(
        frequencies=modes.frequencies,
        damping_ratios=modes.damping_ratios,
        inputs=drives / modes.mass,
        displacements=np.zeros_like(points),
        accelerations=points,
        feedthrough=np.zeros((points.shape[0], drives.shape[1])),
    )


def pressure_response(
    modes: PlateModes,
    drives: NDArray[np.float64],
    microphone: Microphone,
    rate: float,
    n_samples: int,
) -> NDArray[np.float64]:
    """Sound pressure at the microphone after a unit sample of each drive.

    Parameters
    ----------
    modes : PlateModes
        All of them below half of `rate`.
    drives : ndarray, shape (n_modes, n_drives)
        As for `acceleration_model`.
    microphone : Microphone
        Above the plate by more than a few elements of 3 mm.
    rate : float
        Sampling rate [Hz].
    n_samples : int

    Returns
    -------
    ndarray, shape (n_drives, n_samples)
        [Pa per N or Nm]; the sound's travel is in it.

    Examples
    --------
    >>> from models.rig import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> modes = plate_modes(steel, 500.0)
    >>> from models.rig import Microphone
    >>> force = modes.shape([0.1], [0.05]).T
    >>> heard = pressure_response(modes, force, Microphone((0.2, 0.1, 1.0)), 48e3, 4800)
    >>> bool(np.any(heard[0, :138])), bool(np.any(heard[0, 138:]))
    (False, True)
    """
    taps, delay = _mode_taps(modes, microphone, rate)
    response = np.zeros((drives.shape[1], n_samples))
    for r in range(modes.frequencies.size):
        frequency, ratio = float(modes.frequencies[r]), float(modes.damping_ratios[r])
        ringing = taps.shape[0] + ringing_samples(frequency, ratio, rate, n_samples)
        end = min(delay + ringing, n_samples)
        excitation = np.zeros(ringing)
        excitation[: taps.shape[0]] = taps[:, r] / modes.mass
        heard = lfilter(*acceleration_section(frequency, ratio, rate), excitation)
        response[:, delay:end] += np.outer(drives[r], heard[: end - delay])
    return response


@lru_cache(maxsize=8)
def _mode_taps(
    modes: PlateModes, microphone: Microphone, rate: float
) -> tuple[NDArray[np.float64], int]:
    """Rayleigh's filters of all modes, shape (n_taps, n_modes), and their common delay."""
    plate = modes.plate
    x, y = _middles(plate.length), _middles(plate.width)
    grid = np.meshgrid(x, y, indexing="ij")
    area = plate.length * plate.width / (x.size * y.size)
    integral = rayleigh_integral(grid[0].ravel(), grid[1].ravel(), area, microphone.position, rate)
    along = np.sin(np.outer(x / plate.length + 0.5, np.pi * modes.m))
    across = np.sin(np.outer(y / plate.width + 0.5, np.pi * modes.n))
    parts = []
    for first in range(0, modes.m.size, MODES_AT_ONCE):
        some = slice(first, first + MODES_AT_ONCE)
        shapes = along[:, None, some] * across[None, :, some]
        parts.append(integral.taps(shapes.reshape(x.size * y.size, -1)))
    return np.concatenate(parts, axis=1), integral.delay


def _middles(length: float) -> NDArray[np.float64]:
    n = int(np.ceil(length / GRID_STEP))
    middles: NDArray[np.float64] = (np.arange(n, dtype=np.float64) + 0.5) * (
        length / n
    ) - length / 2
    return middles
