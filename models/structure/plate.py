"""The baseplate: its modes, how points and moments drive them, the sound that they radiate.

Thin plate (Kirchhoff) in a rigid baffle. Simply supported edges, the default, have modes in closed
form, so that they cost nothing and can be checked; free and clamped ones and mixtures are solved by
Ritz. Edges hardly change the plate's mean mobility, but much of what it radiates: between 200 and
500 Hz free edges make the shipped plate's radiation efficiency 6 to 13 dB lower, above its critical
frequency of 1.2 kHz not at all. The loss factor acts as viscous damping of each mode, half of it
being the damping ratio, which keeps responses causal. Left out: the air's load on the plate
(`models.radiation.sound_power` has its resistance), its sides and rear, and the sound that goes
round an edge without baffle, which weakens the lowest modes of a free-standing plate
(`models.radiation.unbaffled` computes by how much).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np

from models.radiation.rayleigh import rectangle_integral
from models.short_repr import short_repr
from models.structure.modal import ModalModel, add_ringing
from models.structure.plate_basis import (
    Basis,
    LegendreBasis,
    Products,
    SineBasis,
    SingleProducts,
    SumsOfProducts,
)
from models.structure.plate_ritz import ritz_modes
from models.structure.plate_supported import supported_modes

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from models.rig import Microphone, Plate

__all__ = [
    "PlateModes",
    "acceleration_model",
    "plate_modes",
    "pressure_response",
]

MODES_AT_ONCE = 32
"""Shapes held in memory together, 15 MB for a plate of half a square metre."""

SUSPENSION = 5.0
"""Frequency of rigid-body motions: free edges still lie on something soft [Hz]."""


@short_repr
@dataclass(frozen=True, eq=False)
class PlateModes:
    """Modes of a plate by rising frequency, whatever its edges.

    Parameters
    ----------
    plate : Plate
    frequencies, damping_ratios : ndarray, shape (n_modes,)
        [Hz] and 1. Rigid-body motions, which free edges allow, come first, at 5 Hz.
    along, across : Basis
        Functions of x and of y.
    products : Products
        How the shapes are made of their products.
    """

    plate: Plate
    frequencies: NDArray[np.float64]
    damping_ratios: NDArray[np.float64]
    along: Basis
    across: Basis
    products: Products

    @property
    def mass(self) -> float:
        """Modal mass [kg], the same for all: shapes have the mean square of a product of sines."""
        return self.plate.mass_per_area * self.plate.length * self.plate.width / 4

    def shape(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Give the normal displacement of each mode, on which a point force works.

        Parameters
        ----------
        x, y : array_like, broadcast to a shape (...)
            Position from the plate's middle [m].

        Returns
        -------
        ndarray, shape (..., n_modes)
            [1/sqrt(kg)]
        """
        return self._at(x, y, 0, 0)

    def slope(
        self, x: ArrayLike, y: ArrayLike, direction: Literal["x", "y"] = "x"
    ) -> NDArray[np.float64]:
        """Give the derivative of `shape` along x or y [1/m], on which a moment works.

        The moment is one about the other axis that lifts the side of larger x or y. Parameters
        and returns are those of `shape`.
        """
        return self._at(x, y, 1, 0) if direction == "x" else self._at(x, y, 0, 1)

    def on_grid(
        self, x: NDArray[np.float64], y: NDArray[np.float64], some: slice
    ) -> NDArray[np.float64]:
        """Give `shape` of some modes on all pairs of x and y, shape (n_x, n_y, n_some)."""
        return self.products.combine(self.along.values(x), self.across.values(y)[None], some)

    def _at(self, x: ArrayLike, y: ArrayLike, dx: int, dy: int) -> NDArray[np.float64]:
        where = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        along = self.along.values(where[0].ravel(), dx)
        across = self.across.values(where[1].ravel(), dy)[:, None]
        values = self.products.combine(along, across, slice(None))[:, 0]
        return values.reshape(*where[0].shape, -1)


@lru_cache(maxsize=8)
def plate_modes(plate: Plate, highest_frequency: float) -> PlateModes:
    """All modes of a plate up to a frequency.

    Parameters
    ----------
    plate : Plate
    highest_frequency : float
        [Hz]

    Returns
    -------
    PlateModes

    Examples
    --------
    >>> from models.rig import Plate
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> modes = plate_modes(steel, 16e3)
    >>> modes.frequencies[:3].round(1), modes.frequencies.size
    (array([ 78.9, 151.8, 242.8]), 323)
    >>> free = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0), edges="free")
    >>> plate_modes(free, 1e3).frequencies[:5].round(1)
    array([ 5. ,  5. ,  5. , 49.4, 52.7])
    """
    sides, stiffness = (plate.length, plate.width), plate.stiffness_per_mass
    if set(plate.sides) == {"simply_supported"}:
        frequencies, m, n = supported_modes(sides, stiffness, highest_frequency)
        along: Basis = SineBasis(plate.length, int(m.max(initial=1)))
        across: Basis = SineBasis(plate.width, int(n.max(initial=1)))
        products: Products = SingleProducts(m - 1, n - 1)
    else:
        solved = ritz_modes(sides, plate.sides, plate.poisson_ratio, stiffness, highest_frequency)
        frequencies = np.where(solved.frequencies == 0.0, SUSPENSION, solved.frequencies)
        _, n_along, n_across = solved.coefficients.shape
        along = LegendreBasis(plate.length, n_along - 1)
        across = LegendreBasis(plate.width, n_across - 1)
        products = SumsOfProducts(solved.coefficients / 2)
    ratios = _damping_ratios(plate, frequencies)
    return PlateModes(plate, frequencies, ratios, along, across, products)


def _damping_ratios(plate: Plate, frequencies: NDArray[np.float64]) -> NDArray[np.float64]:
    """Half the loss factor, which between two entries of its table is a power of the frequency."""
    if len(plate.loss_table) == 1:
        return np.full(frequencies.size, plate.loss_table[0][1] / 2)
    given, loss = np.log(plate.loss_table).T
    return np.asarray(np.exp(np.interp(np.log(frequencies), given, loss)) / 2)


def acceleration_model(
    modes: PlateModes, drives: NDArray[np.float64], x: ArrayLike, y: ArrayLike
) -> ModalModel:
    """Build the modal model from drives to the normal acceleration of points.

    Parameters
    ----------
    modes : PlateModes
    drives : ndarray, shape (n_modes, n_drives)
        Work of a unit of each drive on the modes [1/sqrt(kg) for a force]: `PlateModes.shape` at
        the point of a force, `PlateModes.slope` at that of a moment, and sums of such.
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
        Further ones cost a call each; the modes are shared.
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
    response = np.zeros((drives.shape[1], n_samples))
    for position, weight in microphone.images(modes.plate):
        taps, delay = _mode_taps(modes, position, rate)
        if delay < n_samples:
            add_ringing(
                response, modes.frequencies, modes.damping_ratios, drives,
                weight * taps / modes.mass, delay, rate,
            )  # fmt: skip
    return response


@lru_cache(maxsize=8)
def _mode_taps(
    modes: PlateModes, position: tuple[float, float, float], rate: float
) -> tuple[NDArray[np.float64], int]:
    """Rayleigh's filters of all modes, shape (n_taps, n_modes), and their common delay."""
    x, y, integral = rectangle_integral(modes.plate.length, modes.plate.width, position, rate)
    parts = []
    for first in range(0, modes.frequencies.size, MODES_AT_ONCE):
        shapes = modes.on_grid(x, y, slice(first, first + MODES_AT_ONCE))
        parts.append(integral.taps(shapes.reshape(x.size * y.size, -1)))
    return np.concatenate(parts, axis=1), integral.delay
