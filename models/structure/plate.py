"""Baseplate: its modes, their excitation by forces and moments, and their sound.

The model is a thin plate (Kirchhoff) in a rigid baffle with simply supported edges, so modes have a
closed form. The edges hardly change the plate's mean mobility, but much of its radiation: with free
edges the shipped plate's radiation efficiency would be 6 to 13 dB lower between 200 and 500 Hz, and
the same above its critical frequency of 1.2 kHz. The loss factor acts as viscous damping of each
mode, with half of it as damping ratio, so responses are causal. Not included: the air's load on the
plate, its sides and rear, and the sound around an edge without baffle, which weakens the lowest
modes of a free-standing plate.

A mode shape is a product of sines along x and y. They are alternately even and odd about the
middle: parts of different parity do not radiate together, which saves three quarters of the
integration of power.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.bench import Microphone, Plate
from models.radiation.rayleigh import element_middles, rayleigh_integral
from models.structure.modal import ModalModel, add_ringing


@dataclass(frozen=True)
class SineBasis:
    """Sine basis sin(m pi (x / length + 1/2)), m = 1 ... `count`, alternately even and odd.

    Examples
    --------
    >>> SineBasis(0.9, 2).values([0.0, -0.225]).round(6)
    array([[1.      , 0.      ], [0.707107, 1.      ]])
    """

    length: float
    count: int

    def values(self, x: ArrayLike, derivative: int = 0) -> NDArray[np.float64]:
        """Return the values [-], or first derivatives [1/m], shape (..., n)."""
        half_turns = np.arange(1, self.count + 1) * np.pi
        argument = half_turns * (np.asarray(x, dtype=np.float64)[..., None] / self.length + 0.5)
        values = half_turns / self.length * np.cos(argument) if derivative else np.sin(argument)
        return np.asarray(values, dtype=np.float64)

    def transform(self, wavenumber: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the cosine or sine transforms [m], shape (..., n), at wavenumbers [rad/m]."""
        m = np.arange(1, self.count + 1)
        even = m % 2 == 1
        sign = np.where(m % 4 < 2, 1.0, -1.0)  # sin(m pi/2) of even ones, cos(m pi/2) of odd ones
        half = wavenumber[..., None] * (self.length / (2 * np.pi))
        near, far = np.sinc(m / 2 - half), np.sinc(m / 2 + half)
        return np.asarray(sign * self.length / 2 * np.where(even, near + far, near - far))


MODES_AT_ONCE = 32
"""Mode shapes in memory at a time, 15 MB for a plate of half a square metre."""


@dataclass(frozen=True, eq=False)
class PlateModes:
    """Modes of a plate by rising frequency.

    Parameters
    ----------
    plate : Plate
    frequencies, damping_ratios : ndarray, shape (n_modes,)
        [Hz] and 1.
    along, across : SineBasis
        Functions of x and of y.
    m, n : ndarray of int, shape (n_modes,)
        Half-waves of each mode along length and width.
    """

    plate: Plate
    frequencies: NDArray[np.float64]
    damping_ratios: NDArray[np.float64]
    along: SineBasis
    across: SineBasis
    m: NDArray[np.int64]
    n: NDArray[np.int64]

    @property
    def mass(self) -> float:
        """Modal mass [kg], equal for all modes."""
        return self.plate.mass_per_area * self.plate.length * self.plate.width / 4

    def shape(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Return the normal displacement of each mode, on which a point force works.

        Parameters
        ----------
        x, y : array_like, broadcast to a shape (...)
            Position from the plate's middle [m].

        Returns
        -------
        ndarray, shape (..., n_modes)
            [1/sqrt(kg)]
        """
        return self._at(x, y, 0)

    def slope(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Return the derivative of `shape` along x [1/m], on which a moment works.

        The moment is about y and lifts the side of larger x. Parameters and returns are those of
        `shape`.
        """
        return self._at(x, y, 1)

    def on_grid(
        self, x: NDArray[np.float64], y: NDArray[np.float64], some: slice
    ) -> NDArray[np.float64]:
        """Return `shape` of some modes on all pairs of x and y, shape (n_x, n_y, n_some)."""
        along = self.along.values(x)[:, self.m[some] - 1]
        return along[:, None] * self.across.values(y)[None][..., self.n[some] - 1]

    def _at(self, x: ArrayLike, y: ArrayLike, derivative: int) -> NDArray[np.float64]:
        where = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        along = self.along.values(where[0].ravel(), derivative)[:, self.m - 1]
        values = along * self.across.values(where[1].ravel())[:, self.n - 1]
        return np.asarray(values.reshape(*where[0].shape, -1))


@lru_cache(maxsize=8)
def plate_modes(plate: Plate, highest_frequency: float) -> PlateModes:
    """Return the modes of a plate up to a frequency.

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
    >>> from models.bench import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> modes = plate_modes(steel, 16e3)
    >>> modes.frequencies[:3].round(1), modes.frequencies.size
    (array([ 78.9, 151.8, 242.8]), 323)
    """
    sides, scale = (plate.length, plate.width), np.pi / 2 * np.sqrt(plate.stiffness_per_mass)
    largest = np.sqrt(highest_frequency / scale)
    m, n = np.meshgrid(*(np.arange(1, int(largest * side) + 1) for side in sides))
    frequencies = scale * ((m / sides[0]) ** 2 + (n / sides[1]) ** 2)
    below = frequencies <= highest_frequency
    m, n, frequencies = m[below], n[below], frequencies[below]
    order = np.argsort(frequencies, kind="stable")
    frequencies, m, n = frequencies[order], m[order], n[order]
    along, across = (
        SineBasis(side, int(count.max(initial=1)))
        for side, count in zip(sides, (m, n), strict=True)
    )
    damping_ratios = np.full(frequencies.size, plate.loss_factor / 2)
    return PlateModes(plate, frequencies, damping_ratios, along, across, m, n)


def acceleration_model(
    modes: PlateModes, drives: NDArray[np.float64], x: ArrayLike, y: ArrayLike
) -> ModalModel:
    """Return the modal model from drives to the normal acceleration of points.

    Parameters
    ----------
    modes : PlateModes
    drives : ndarray, shape (n_modes, n_drives)
        Work of a unit of each drive on the modes [1/sqrt(kg) for a force]: `PlateModes.shape` at
        the point of a force, `PlateModes.slope` at that of a moment, and sums of these.
    x, y : array_like, shape (n_points,)
        [m]

    Returns
    -------
    ModalModel
        With one input per drive and one output per point [m/s2 per N or Nm].

    Examples
    --------
    >>> from models.bench import Plate
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
    """Return the impulse responses from each drive to the sound pressure at the microphone.

    Parameters
    ----------
    modes : PlateModes
        Modes below half of `rate`.
    drives : ndarray, shape (n_modes, n_drives)
        As for `acceleration_model`.
    microphone : Microphone
    rate : float
        Sampling rate [Hz].
    n_samples : int

    Returns
    -------
    ndarray, shape (n_drives, n_samples)
        [Pa per N or Nm]; the travel time is included.

    Examples
    --------
    >>> from models.bench import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> modes = plate_modes(steel, 500.0)
    >>> from models.bench import Microphone
    >>> force = modes.shape([0.1], [0.05]).T
    >>> response = pressure_response(modes, force, Microphone((0.2, 0.1, 1.0)), 48e3, 4800)
    >>> bool(np.any(response[0, :138])), bool(np.any(response[0, 138:]))
    (False, True)
    """
    response = np.zeros((drives.shape[1], n_samples))
    taps, delay = _mode_taps(modes, microphone.position, rate)
    if delay < n_samples:
        add_ringing(response, modes, drives, taps / modes.mass, delay, rate)
    return response


@lru_cache(maxsize=8)
def _mode_taps(
    modes: PlateModes, position: tuple[float, float, float], rate: float
) -> tuple[NDArray[np.float64], int]:
    """Return Rayleigh's filters of all modes, shape (n_taps, n_modes), and their common delay."""
    length, width = modes.plate.length, modes.plate.width
    x, y = element_middles(length), element_middles(width)
    grid = np.meshgrid(x, y, indexing="ij")
    area = length * width / (x.size * y.size)
    integral = rayleigh_integral(grid[0].ravel(), grid[1].ravel(), area, position, rate)
    parts = []
    for first in range(0, modes.frequencies.size, MODES_AT_ONCE):
        shapes = modes.on_grid(x, y, slice(first, first + MODES_AT_ONCE))
        parts.append(integral.taps(shapes.reshape(x.size * y.size, -1)))
    return np.concatenate(parts, axis=1), integral.delay
