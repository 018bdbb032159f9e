"""Modes of a thin rectangular plate with free, simply supported and clamped edges, by Ritz.

Along each side the trial functions are polynomials whose second derivatives are Legendre
polynomials. Their bending energies are orthogonal, so high degrees stay well conditioned where
powers or products of boundary polynomials fail at twenty; and their span is that of all
polynomials that hold the edges, so convergence is exponential but for the weak singularities of
corners. Sides with like edges split into even and odd functions, a quarter of the unknowns at a
time. Stiffness plus a multiple of mass is what gets factorised: a free plate has no stiffness
against its rigid-body motions.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import legder, leggauss, legvander
from numpy.typing import NDArray
from scipy.linalg import cholesky, eigh, null_space, solve_triangular
from threadpoolctl import threadpool_limits

RESTRAINED = {"free": 0, "simply_supported": 1, "clamped": 2}
"""How many of deflection and slope each edge holds."""

SPARE_DEGREES = 14
"""Polynomial degrees beyond half the side times the highest bending wavenumber."""

RIGID = 1e-8
"""Squared circular frequencies below this part of a plate's typical one are rigid-body motions."""


@dataclass(frozen=True, eq=False)
class RitzModes:
    """Modes by rising frequency, shapes of unit mean square.

    Parameters
    ----------
    frequencies : ndarray, shape (n_modes,)
        [Hz], 0 for rigid-body motions.
    coefficients : ndarray, shape (n_modes, n_along, n_across)
        [-], of Legendre polynomials in 2 x / length and 2 y / width.
    """

    frequencies: NDArray[np.float64]
    coefficients: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Functions:
    """Trial functions of one side, as Legendre coefficients, and integrals of their products."""

    legendre: NDArray[np.float64]
    products: dict[tuple[int, int], NDArray[np.float64]]


def ritz_modes(
    sides: tuple[float, float],
    edges: tuple[str, str, str, str],
    poisson_ratio: float,
    stiffness_per_mass: float,
    highest_frequency: float,
    spare_degrees: int = SPARE_DEGREES,
) -> RitzModes:
    """All modes up to a frequency.

    Parameters
    ----------
    sides : tuple of 2 floats
        Length and width [m].
    edges : tuple of 4 texts
        At the smallest x, largest x, smallest y, largest y; each a key of `RESTRAINED`.
    poisson_ratio : float
        [-]
    stiffness_per_mass : float
        D / (rho h), bending stiffness over mass per area [m4/s2].
    highest_frequency : float
        [Hz]
    spare_degrees : int, optional
        With 14 all of 300 modes are converged to 1e-8, and to 3e-6 where a clamped edge meets a
        free one, whose corner is singular.

    Returns
    -------
    RitzModes

    Notes
    -----
    Strain energy D/2 * integral of w_xx^2 + w_yy^2 + 2 nu w_xx w_yy + 2 (1 - nu) w_xy^2;
    A. W. Leissa, "The free vibration of rectangular plates", J. Sound Vib. 31 (1973) 257-293.

    Examples
    --------
    A square cantilever of unit side, in terms of omega:

    >>> modes = ritz_modes((1.0, 1.0), ("clamped", "free", "free", "free"), 0.3, 1.0, 5.0)
    >>> (2 * np.pi * modes.frequencies[:3]).round(3)
    array([ 3.471,  8.507, 21.285])
    """
    wavenumber = np.sqrt(2 * np.pi * highest_frequency / np.sqrt(stiffness_per_mass))
    along, across = (
        _side(edges[2 * i : 2 * i + 2], int(wavenumber * sides[i] / 2) + spare_degrees)
        for i in (0, 1)
    )
    typical = stiffness_per_mass / (sides[0] * sides[1]) ** 2
    highest = 2 * np.pi * highest_frequency
    # Some hundred rows: threads that wait for each other take ten times as long as one.
    with threadpool_limits(limits=1, user_api="blas"):
        solved = [
            _block(x, y, sides, poisson_ratio, stiffness_per_mass, typical, highest)
            for x in along
            for y in across
        ]
    squares = np.concatenate([square for square, _ in solved])
    order = np.argsort(squares, kind="stable")
    squares = np.where(squares < RIGID * typical, 0.0, squares)
    return RitzModes(
        np.sqrt(squares[order]) / (2 * np.pi),
        np.concatenate([coefficients for _, coefficients in solved])[order],
    )


def _block(
    x: _Functions,
    y: _Functions,
    sides: tuple[float, float],
    poisson_ratio: float,
    stiffness_per_mass: float,
    shift: float,
    highest: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Squared circular frequencies and coefficients of the modes of one parity."""
    p, q = 2 / sides[0], 2 / sides[1]
    mass = np.kron(x.products[0, 0], y.products[0, 0])
    coupling = np.kron(x.products[2, 0], y.products[0, 2])
    stiffness = stiffness_per_mass * (
        p**4 * np.kron(x.products[2, 2], y.products[0, 0])
        + q**4 * np.kron(x.products[0, 0], y.products[2, 2])
        + (p * q) ** 2 * poisson_ratio * (coupling + coupling.T)
        + (p * q) ** 2 * 2 * (1 - poisson_ratio) * np.kron(x.products[1, 1], y.products[1, 1])
    )
    factor = cholesky(stiffness + shift * mass, lower=True)
    half = solve_triangular(factor, mass, lower=True)
    inverse, vectors = eigh(
        solve_triangular(factor, half.T, lower=True),
        subset_by_value=(1 / (highest**2 + shift), np.inf),
        driver="evr",
    )
    vectors = solve_triangular(factor, vectors, lower=True, trans="T")
    # mean square 1 over the square of side 2: integral 4; the mass of a vector is its eigenvalue
    shapes = (vectors * (2 / np.sqrt(inverse))).T.reshape(-1, len(x.legendre), len(y.legendre))
    return 1 / inverse - shift, x.legendre.T @ shapes @ y.legendre


def _side(edges: tuple[str, ...], degree: int) -> list[_Functions]:
    """Trial functions between two edges; even and odd ones apart where the edges are alike."""
    # The first four bend at most linearly and alone move at the edges.
    highest = degree + 1
    legendre = np.zeros((degree + 1, highest + 1))
    legendre[[0, 1, 2, 3], [0, 1, 2, 3]] = 1.0, 1.0, 1 / 3, 1 / 15
    for i in range(2, degree - 1):  # integrated twice, P_i is made of its neighbours
        norm = np.sqrt(i + 0.5) / (2 * i + 1)
        legendre[i + 2, i + 2] = norm / (2 * i + 3)
        legendre[i + 2, i] = -norm * (1 / (2 * i + 3) + 1 / (2 * i - 1))
        legendre[i + 2, i - 2] = norm / (2 * i - 1)
    signs = (-1.0) ** np.arange(4)
    at_right = np.array([[1.0, 1.0, 1.0, 1.0], [0.0, 1.0, 3.0, 6.0]])
    at_left = np.stack([signs * at_right[0], -signs * at_right[1]])
    scale = np.array([1.0, 1.0, 1 / 3, 1 / 15])
    held = scale * np.concatenate(
        [at_left[: RESTRAINED[edges[0]]], at_right[: RESTRAINED[edges[1]]]]
    )
    parities = (0, 1) if edges[0] == edges[1] else (None,)
    return [_functions(legendre, held, parity) for parity in parities]


def _functions(
    legendre: NDArray[np.float64], held: NDArray[np.float64], parity: int | None
) -> _Functions:
    step = slice(parity, None, None if parity is None else 2)
    low = legendre[:4][step]
    restraints = held[:, step]
    if restraints.size:
        low = null_space(restraints, rcond=1e-9).T @ low
    chosen = np.concatenate([low, legendre[4:][step]])
    size = legendre.shape[1]
    position, weight = leggauss(size)
    vandermonde = legvander(position, size - 1)
    values = [vandermonde @ chosen.T]
    values += [vandermonde[:, : size - order] @ legder(chosen.T, order) for order in (1, 2)]
    return _Functions(
        chosen,
        {
            (i, j): (values[i] * weight[:, None]).T @ values[j]
            for i, j in ((0, 0), (1, 1), (2, 2), (2, 0), (0, 2))
        },
    )
