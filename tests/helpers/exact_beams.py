"""Exact forced response of clamp and beams: what the modes are held against."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.structure.beams import bending_stiffness
from noise.thesis.exact_beams import RootMotion, boundary_conditions, wavenumber, waves_at

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from noise.thesis.exact_beams import ClampOnBeams


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
