"""Clamp, bushing and beams with continuously distributed mass: the transfer matrices of 3.1.1.

A beam carries deflection, slope, moment and shear from the clamp to its anchor by its four waves,
exactly, so there is no error of discretisation. Two of the waves are scaled to be largest at either
end, or they would cancel: the cosh of the usual form exceeds 1e7 at 15 kHz. By the rig's symmetry
the clamp either turns about the shaft or moves sideways, and one beam stands for both. Thin beams
(Bernoulli): at 15 kHz a half-wave is still seven times the thickness.

This is the reference that the finite elements of `models.structure.beams` are held against, and it
has what they leave out: the bushing's stiffness and the clamp's sideways motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from models.bench import Beams


class RootMotion(Enum):
    """Motion of the clamp, and of the root of a beam with it: it turns or shifts."""

    TURNING = "turning"
    SIDEWAYS = "sideways"


@dataclass(frozen=True)
class ClampOnBeams:
    """A rigid clamp between two beams of one length, with the bushing in it.

    Parameters
    ----------
    beams : Beams
        With the stiffness of their anchors.
    length : float
        Of each, from anchor to clamp [m].
    clamp_mass, clamp_inertia : float
        Of the clamp alone [kg] and [kg m2].
    lateral_stiffness, torsional_stiffness : float, optional
        Of the bushing on the shaft [N/m] and [Nm/rad].
    """

    beams: Beams
    length: float
    clamp_mass: float
    clamp_inertia: float
    lateral_stiffness: float = 0.0
    torsional_stiffness: float = 0.0


def boundary_conditions(
    structure: ClampOnBeams,
    frequency: NDArray[np.float64],
    motion: RootMotion,
    loss_factor: float,
    *,
    scaled: bool = True,
) -> NDArray[np.complex128]:
    """Return the matrix of boundary conditions for the amplitudes of the waves.

    Parameters
    ----------
    structure : ClampOnBeams
    frequency : ndarray, shape (n,)
        [Hz]
    motion : RootMotion
    loss_factor : float
        Of the beams [-].
    scaled : bool, optional
        Whether the largest coefficient of each condition is made 1.

    Returns
    -------
    ndarray, shape (n, 4, 4), complex
        In rows: two at the clamp, of which the second balances the load on it [Nm or N], then
        deflection and slope at the anchor.

    Examples
    --------
    At a natural frequency the conditions can be met without a load; a clamp without mass that
    cannot turn is the end of a guided cantilever:

    >>> from models.bench import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> light = ClampOnBeams(steel, 0.123, 0.0, 0.0)
    >>> guided = wave_frequency(light, np.array([2.36502]))
    >>> conditions = boundary_conditions(light, guided, RootMotion.SIDEWAYS, 0.0)
    >>> bool(abs(np.linalg.det(conditions)[0]) < 1e-4)
    True
    """
    beams, length = structure.beams, structure.length
    wave = wavenumber(structure, frequency, loss_factor) * length
    stiffness = beams.bending_stiffness * (1.0 + 1j * loss_factor)
    omega2 = (2.0 * np.pi * frequency[:, None]) ** 2
    root = [waves_at(wave, 0.0, n) / length**n for n in range(4)]
    end = [waves_at(wave, 1.0, n) / length**n for n in range(4)]
    if motion is RootMotion.TURNING:
        dynamic = structure.torsional_stiffness - structure.clamp_inertia * omega2
        at_clamp = [
            root[0] - beams.lever * root[1],
            dynamic * root[1] + 2.0 * stiffness * (beams.lever * root[3] - root[2]),
        ]
    else:
        dynamic = structure.lateral_stiffness - structure.clamp_mass * omega2
        at_clamp = [root[1], dynamic * root[0] + 2.0 * stiffness * root[3]]
    at_anchor = [
        end[0] - stiffness / beams.anchor_translation * end[3],
        end[1] + stiffness / beams.anchor_rotation * end[2],
    ]
    rows = np.stack([*at_clamp, *at_anchor], axis=-2)
    if scaled:
        rows = rows / np.abs(rows).max(axis=-1, keepdims=True)
    return np.asarray(rows)


def waves_at(
    wave: NDArray[np.complex128], position: NDArray[np.float64] | float, derivative: int
) -> NDArray[np.complex128]:
    """Return the four waves, or one of their derivatives by the position.

    Parameters
    ----------
    wave : ndarray, shape (...), complex
        Wavenumber times length.
    position : float or ndarray, shape (...)
        From 0 at the clamp to 1 at the anchor [-]; broadcast with `wave`.
    derivative : int

    Returns
    -------
    ndarray, shape (..., 4), complex

    Examples
    --------
    >>> waves_at(np.array([np.pi + 0j]), 1.0, 0).real.round(3)
    array([[-1.   ,  0.   ,  0.043,  1.   ]])
    """
    forth, back = wave * position, wave * (1.0 - np.asarray(position))
    turned = forth + 0.5 * np.pi * derivative
    decay = (-1) ** derivative * np.exp(-forth)
    shapes = np.stack([np.cos(turned), np.sin(turned), decay, np.exp(-back)], axis=-1)
    return np.asarray(wave[..., None] ** derivative * shapes)


def wavenumber(
    structure: ClampOnBeams, frequency: ArrayLike, loss_factor: float = 0.0
) -> NDArray[np.complex128]:
    """Return the wavenumber of bending waves (rho S omega^2 / (E I))^(1/4).

    Parameters
    ----------
    structure : ClampOnBeams
    frequency : array_like, shape (...)
        [Hz]
    loss_factor : float, optional
        Of the beams [-].

    Returns
    -------
    ndarray, shape (...), complex
        [rad/m]

    Examples
    --------
    >>> from models.bench import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> wavenumber(ClampOnBeams(steel, 0.123, 0.96, 1 / 1050), [1000.0]).real.round(1)
    array([37.])
    """
    omega = 2.0 * np.pi * np.asarray(frequency, dtype=np.complex128)
    stiffness = structure.beams.bending_stiffness * (1.0 + 1j * loss_factor)
    return (structure.beams.mass_per_length * omega**2 / stiffness) ** 0.25


def wave_frequency(structure: ClampOnBeams, wave: ArrayLike) -> NDArray[np.float64]:
    """Return the frequency at which wavenumber times length has a value, without damping.

    Parameters
    ----------
    structure : ClampOnBeams
    wave : array_like, shape (...)

    Returns
    -------
    ndarray, shape (...)
        [Hz]

    Examples
    --------
    The first mode of a cantilever:

    >>> from models.bench import Beams
    >>> steel = Beams(25.4e-3, 3.175e-3, 0.0449, 2e11, 8000.0, 0.01, 0.3)
    >>> round(float(wave_frequency(ClampOnBeams(steel, 0.123, 0.0, 0.0), 1.8751)), 1)
    169.5
    """
    per_metre = np.asarray(wave, dtype=np.float64) / structure.length
    speed = math.sqrt(structure.beams.bending_stiffness / structure.beams.mass_per_length)
    return per_metre**2 * speed / (2.0 * np.pi)


_STEP = 0.05
"""Of wavenumber times length, in which sign changes are looked for."""


def natural_frequencies(
    structure: ClampOnBeams, highest_frequency: float, motion: RootMotion = RootMotion.TURNING
) -> NDArray[np.float64]:
    """Return the undamped natural frequencies up to a highest one.

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
    >>> from models.bench import Beams
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
        frequency = wave_frequency(structure, np.atleast_1d(wave))
        boundary = boundary_conditions(structure, frequency, motion, 0.0).real
        return np.asarray(np.linalg.det(boundary))

    changes = np.flatnonzero(np.diff(np.signbit(determinant(grid))))
    roots = [
        brentq(lambda wave: determinant(wave)[0], grid[i], grid[i + 1], rtol=1e-12) for i in changes
    ]
    frequencies = wave_frequency(structure, roots)
    return frequencies[frequencies <= highest_frequency]
