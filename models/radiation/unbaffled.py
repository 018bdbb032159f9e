"""Sound power of a plate that stands free, by which the baffled model is judged.

A plate that stands free has the opposite pressure behind it, and short-circuits about its edges
what a baffle keeps apart. The pressure jump across it is found from the plate's own velocity: over
wavenumbers jump = 2 rho_0 omega / k_z * velocity, but the velocity is known on the plate only, the
jump everywhere else. Functions that fall to zero at the edges as the jump does, sqrt(1 - x^2) times
Chebyshev polynomials, make that a small system of equations. It serves to judge the baffled model,
and bounds the sound power of a run from below: no time signal is made from it.

Steel plate of 0.9 x 0.6 m and 10 mm, critical frequency 1.2 kHz, as many dB too loud in a baffle,
per one-third octave, mean of four point forces:

    Hz                    63   125   250   500  1000
    simply supported      17    10     7     6     0
    free                  10    12     2    -1     0

Near the critical frequency the baffle costs less than a decibel, below 300 Hz 2 to 17 dB.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import solve
from scipy.special import eval_chebyu, jv, roots_chebyu

from models.radiation.rayleigh import AIR_DENSITY, SOUND_SPEED
from models.single_thread import single_thread

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from models.structure.plate import PlateModes
    from models.structure.plate_basis import Basis

__all__ = ["unbaffled_power"]

SPARE_FUNCTIONS = 6
"""Functions a side beyond one for each radian of k side / 2."""

INNER_STEPS, INNER_END = 60, 3.0
"""Nodes for each k up to 3 k, about the circle at which k_z vanishes."""

OUTER_STEP, OUTER_END = 0.7, 700.0
"""In units of 1 / side: the rest of the wavenumbers is smooth, and by then has fallen off."""


def unbaffled_power(
    modes: PlateModes, velocity: NDArray[np.complex128], frequency: float
) -> NDArray[np.float64]:
    """Sound power of one side of the plate, standing free.

    Parameters
    ----------
    modes : PlateModes
    velocity : ndarray, shape (n_modes, n_fields)
        Root mean square velocity of each mode [m/s], for one or several vibrations.
    frequency : float
        [Hz], up to a few times the critical frequency.

    Returns
    -------
    ndarray, shape (n_fields,)
        [W]; both sides together radiate twice as much.

    Notes
    -----
    B. Laulagnet, "Sound radiation by a simply supported unbaffled plate", J. Acoust. Soc. Am. 103
    (1998) 2451-2462, with sines for the jump.

    Examples
    --------
    >>> from models.structure.plate import plate_modes
    >>> from models.rig import Plate
    >>> from models.radiation.sound_power import radiated_power
    >>> steel = Plate(0.9, 0.6, 8e-3, 2.1e11, 7850.0, 0.3, 0.03, (0.0, 0.0))
    >>> modes = plate_modes(steel, 100.0)
    >>> first = np.array([[1.0 + 0.0j]])
    >>> baffled = radiated_power(modes, first[:, 0], 78.9)
    >>> (10 * np.log10(baffled / unbaffled_power(modes, first, 78.9))).round(1)
    array([14.7])
    """
    k = 2 * np.pi * frequency / SOUND_SPEED
    sides = (modes.plate.length, modes.plate.width)
    counts = [2 * (int(k * side / 4) + SPARE_FUNCTIONS // 2) for side in sides]
    along = _projected(modes.along, sides[0], counts[0]).T
    across = _projected(modes.across, sides[1], counts[1])
    known = np.stack([along @ modes.products.weighted(one) @ across for one in velocity.T], axis=2)
    real_s, real_v, real_weight = _disc(k, sides)
    nodes, weights = _axis(k, min(sides))
    k_z = np.add.outer(nodes**2, nodes**2 - k**2)  # a million: in place
    np.sqrt(np.maximum(k_z, 0.0, out=k_z), out=k_z)
    power = np.zeros(known.shape[2])
    with single_thread():
        of_x, of_y = (
            [(_pairs(real, side, n, p), _pairs(nodes, side, n, p)) for p in (0, 1)]
            for real, side, n in zip((real_s, real_v), sides, counts, strict=True)
        )
        lines = k_z @ (weights[:, None] * np.hstack([y for _, y in of_y]))
        for px, (x_real, x) in enumerate(of_x):
            reactive = np.hsplit((weights[:, None] * x).T @ lines, [of_y[0][1].shape[1]])
            for py, (y_real, _) in enumerate(of_y):
                right = known[px::2, py::2].reshape(-1, known.shape[2])
                resistive = np.einsum("sp,stq,st->pq", x_real, y_real, real_weight, optimize=True)
                rows, columns = (_all_pairs(n, p) for n, p in zip(counts, (px, py), strict=True))
                upper = (resistive - 1j * reactive[py]) / np.pi**2
                matrix = upper[rows[:, None, :, None], columns[None, :, None, :]]
                matrix = matrix.reshape(len(right), len(right))
                jump = solve(matrix, right, assume_a="sym")
                power += np.sum((right.conj() * jump).real, axis=0)
    return np.asarray(AIR_DENSITY * 2 * np.pi * frequency * power)


def _projected(basis: Basis, side: float, count: int) -> NDArray[np.float64]:
    """Integrals of the basis times the jump's functions, shape (n_basis, count)."""
    position, weight = roots_chebyu(8 * count + 200)
    functions = eval_chebyu(np.arange(count), position[:, None]) * weight[:, None] * (side / 2)
    return np.asarray(basis.values(position * side / 2).T @ functions)


def _pairs(
    wavenumber: NDArray[np.float64], side: float, count: int, parity: int
) -> NDArray[np.float64]:
    """Products of the transforms of two of the jump's functions, each two once.

    The transform of sqrt(1 - x^2) U_n(x) is pi (n + 1) J_{n+1}(k) / k, signs by (-1)^(n // 2).
    """
    n = np.arange(parity, count, 2)
    argument = np.maximum(wavenumber, 1e-9)[..., None] * (side / 2)
    signs = (-1.0) ** (n // 2)
    transforms = signs * np.pi * (n + 1) * jv(n + 1, argument) / argument * (side / 2)
    one, other = np.triu_indices(n.size)
    return np.asarray(transforms[..., one] * transforms[..., other])


def _all_pairs(count: int, parity: int) -> NDArray[np.intp]:
    """Where the product of any two functions stands in `_pairs`, shape (n, n)."""
    n = len(range(parity, count, 2))
    one, other = np.triu_indices(n)
    places = np.empty((n, n), dtype=np.intp)
    places[one, other] = places[other, one] = np.arange(one.size)
    return places


def _disc(
    k: float, sides: tuple[float, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Nodes k_x, k_y in a quarter of the disc, and weights with k_z in them."""
    count = 2 * (int(k * max(sides) / 4) + 10)
    s, weight = np.polynomial.legendre.leggauss(2 * count)
    s, weight = s[count:], weight[count:]
    v = (np.arange(count) + 0.5) * (np.pi / (2 * count))
    across = k * np.outer(np.sqrt(1 - s**2), np.sin(v))
    return k * s, across, k**3 * np.outer(weight * (1 - s**2), np.cos(v) ** 2) * v[0] * 2


def _axis(k: float, side: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Midpoints from 0 to where the transforms have fallen off, fine up to 3 k."""
    inner = int(INNER_STEPS * INNER_END)
    fine = INNER_END * k / inner
    outer = int(OUTER_END / OUTER_STEP)
    coarse = (OUTER_END / side - INNER_END * k) / outer
    nodes = np.concatenate(
        [(np.arange(inner) + 0.5) * fine, INNER_END * k + (np.arange(outer) + 0.5) * coarse]
    )
    return nodes, np.concatenate([np.full(inner, fine), np.full(outer, coarse)])
