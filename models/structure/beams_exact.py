"""Clamp, bushing and beams with continuously distributed mass: the transfer matrices of 3.1.1.

A beam carries deflection, slope, moment and shear from the clamp to its anchor by an exact matrix
in its four waves (`models.structure.beams_waves`), so there is no error of discretisation. This is
the reference that the finite elements of `models.structure.beams` are held against, and it has what
they leave out: the bushing's stiffness and the clamp's sideways motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.structure.beams_stiffness import bending_stiffness
from models.structure.beams_waves import (
    RootMotion,
    boundary_conditions,
    wave_frequency,
    wavenumber,
    waves_at,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from models.structure.beams_waves import ClampOnBeams

__all__ = [
    "BeamResponse",
    "forced_response",
    "mode_shape",
    "natural_frequencies",
]

_STEP = 0.05
"""Of wavenumber times length, in which sign changes are looked for."""

_MOST_ITERATIONS = 60


@dataclass(frozen=True, eq=False)
class BeamResponse:
    """What a unit of torque (turning) or of force (sideways) on the clamp does.

    Parameters
    ----------
    acceleration : ndarray, shape (n_positions, n_frequencies), complex
        Of points of the right beam [m/s2].
    anchor_force, anchor_moment : ndarray, shape (n_frequencies,), complex
        Of the right anchor on what it stands on [N] and [Nm], the moment working on the slope. The
        left one has the opposite force and the same moment where the clamp turns, the same force
        and the opposite moment where it moves sideways.
    """

    acceleration: NDArray[np.complex128]
    anchor_force: NDArray[np.complex128]
    anchor_moment: NDArray[np.complex128]


def natural_frequencies(
    structure: ClampOnBeams, highest_frequency: float, motion: RootMotion = RootMotion.TURNING
) -> NDArray[np.float64]:
    """Undamped natural frequencies up to a highest one.

    Parameters
    ----------
    structure : ClampOnBeams
    highest_frequency : float
        [Hz]
    motion : RootMotion, optional

    Returns
    -------
    ndarray, shape (n_modes,)
        [Hz], rising, to 1e-10 of themselves.

    Notes
    -----
    E. C. Pestel and F. A. Leckie, *Matrix Methods in Elastomechanics* (1963), chapter 4.

    Examples
    --------
    >>> from models.structure.beams_waves import ClampOnBeams
    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> rig = ClampOnBeams(steel, 0.123, 0.96, 1 / 1050, 6.13e5, 750.0)
    >>> natural_frequencies(rig, 4e3).round()
    array([ 250., 1152., 3030.])
    >>> natural_frequencies(rig, 4e3, RootMotion.SIDEWAYS).round()
    array([ 140., 1094., 2989.])
    """
    top = float(wavenumber(structure, highest_frequency).real) * structure.length
    grid = np.arange(_STEP, top + _STEP, _STEP)

    def determinant(wave: ArrayLike) -> NDArray[np.float64]:
        boundary = boundary_conditions(structure, wave_frequency(structure, wave), motion, 0.0).real
        return np.asarray(np.linalg.det(boundary))

    values = determinant(grid)
    (below,) = np.nonzero(np.signbit(values[1:]) != np.signbit(values[:-1]))
    roots = _roots(determinant, grid[below], grid[below + 1])
    frequencies = wave_frequency(structure, roots)
    return frequencies[frequencies <= highest_frequency]


def mode_shape(
    structure: ClampOnBeams,
    frequency: float,
    positions: ArrayLike,
    motion: RootMotion = RootMotion.TURNING,
) -> NDArray[np.float64]:
    """Deflection of the right beam in a mode.

    Parameters
    ----------
    structure : ClampOnBeams
    frequency : float
        One of the `natural_frequencies` [Hz].
    positions : array_like, shape (n,)
        As fractions of the length from the clamp.
    motion : RootMotion, optional

    Returns
    -------
    ndarray, shape (n,)
        [-], scaled such that the largest magnitude is 1 and the first value is not negative.

    Examples
    --------
    >>> from models.structure.beams_waves import ClampOnBeams
    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> rig = ClampOnBeams(steel, 0.123, 0.96, 1 / 1050, 6.13e5, 750.0)
    >>> mode_shape(rig, natural_frequencies(rig, 300.0)[0], [0.0, 0.25, 0.5]).round(2)
    array([0.79, 1.  , 0.71])
    """
    boundary = boundary_conditions(structure, np.array([frequency]), motion, 0.0).real[0]
    waves = np.linalg.svd(boundary)[2][-1]
    wave = wavenumber(structure, [frequency]) * structure.length
    shape = waves_at(wave, np.asarray(positions, dtype=np.float64)[:, None], 0).real
    deflection: NDArray[np.float64] = shape[:, 0] @ waves
    deflection = deflection / np.abs(deflection).max()
    return -deflection if deflection[0] < 0.0 else deflection


def forced_response(
    structure: ClampOnBeams,
    frequency: ArrayLike,
    positions: ArrayLike,
    *,
    motion: RootMotion = RootMotion.TURNING,
    loss_factor: float = 0.0,
) -> BeamResponse:
    """Response to a unit torque on the clamp, or a unit force if it moves sideways.

    Parameters
    ----------
    structure : ClampOnBeams
    frequency : array_like, shape (n_frequencies,)
        Above 0 [Hz].
    positions : array_like, shape (n_positions,)
        As fractions of the length from the clamp.
    motion : RootMotion, optional
        Turning or sideways.
    loss_factor : float, optional
        Of the beams; twice the damping ratio of their modes.

    Returns
    -------
    BeamResponse

    Examples
    --------
    Nearly at rest the two anchors balance the torque:

    >>> from models.structure.beams_waves import ClampOnBeams
    >>> from models.rig import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> rig = ClampOnBeams(steel, 0.123, 0.96, 1 / 1050)
    >>> slow = forced_response(rig, [0.1], [0.5])
    >>> round(float(2 * (slow.anchor_force * 0.1679 + slow.anchor_moment)[0].real), 5)
    1.0
    """
    frequency = np.asarray(frequency, dtype=np.float64)
    boundary = boundary_conditions(structure, frequency, motion, loss_factor, scaled=False)
    load = np.zeros((frequency.size, 4, 1))
    load[:, 1] = 1.0
    waves = np.linalg.solve(boundary, load)[..., 0]
    wave = wavenumber(structure, frequency, loss_factor) * structure.length
    where = np.asarray(positions, dtype=np.float64)[:, None]
    shapes = waves_at(wave[None, :], where, 0)
    deflection = np.einsum("pfw,fw->pf", shapes, waves)
    stiffness = bending_stiffness(structure.beams) * (1.0 + 1j * loss_factor)
    moment, shear = (np.einsum("fw,fw->f", waves_at(wave, 1.0, n), waves) for n in (2, 3))
    return BeamResponse(
        acceleration=-((2.0 * np.pi * frequency) ** 2) * deflection,
        anchor_force=stiffness / structure.length**3 * shear,
        anchor_moment=-stiffness / structure.length**2 * moment,
    )


def _roots(
    function: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Root between each `low` and `high`, all at once, by the Illinois form of regula falsi."""
    at_low, at_high = function(low), function(high)
    for _ in range(_MOST_ITERATIONS):
        middle = high - at_high * (high - low) / (at_high - at_low)
        at_middle = function(middle)
        kept = np.signbit(at_middle) == np.signbit(at_high)
        low, at_low = np.where(kept, low, high), np.where(kept, 0.5 * at_low, at_high)
        moved = np.abs(middle - high)
        high, at_high = middle, at_middle
        if np.all(moved <= 1e-13 * high):
            break
    return high
