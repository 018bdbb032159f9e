"""The functions that make up the mode shapes of a rectangle, and their products.

A shape is a sum of products, one function of x times one of y. Simply supported plates need one
product of sines a mode; other edges a sum over Legendre polynomials, which follow both waves and
edge layers with some three functions a wavelength and do not care what the edges are. Both know
their values, their derivatives and their Fourier transforms, so that whatever radiates sound works
on either. Functions alternate between even and odd about the middle, beginning with an even one:
parts of unlike parity never radiate together, which saves three quarters of the integration.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.polynomial.legendre import legder, leggauss, legvander

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["Basis", "LegendreBasis", "Products", "SineBasis", "SingleProducts", "SumsOfProducts"]

SPARE_NODES = 24
"""Nodes beyond half the degree and the wavenumber, for transforms exact to rounding."""


class Basis(Protocol):
    """Functions along one side of the plate, even and odd ones in turn."""

    def values(self, x: ArrayLike, derivative: int = 0) -> NDArray[np.float64]:
        """Values at x [m] from the middle, or first derivatives [1/m], shape (..., n)."""

    def transform(self, wavenumber: NDArray[np.float64]) -> NDArray[np.float64]:
        """Integral of even ones times cos(k x), odd ones times sin(k x) [m]; shape (..., n)."""


class Products(Protocol):
    """How the products of two bases make up the mode shapes."""

    def combine(
        self, along: NDArray[np.float64], across: NDArray[np.float64], some: slice
    ) -> NDArray[np.float64]:
        """Values of some modes from those of the bases.

        Parameters
        ----------
        along : ndarray, shape (n, n_along)
            Values of the functions along the plate [-].
        across : ndarray, shape (n or 1, m, n_across)
            Values of those across it [-].
            For each of the n positions along the plate m positions across it.
        some : slice
            Of the modes.

        Returns
        -------
        ndarray, shape (n, m, n_some)
            [-]
        """

    def weighted(self, amplitudes: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Amplitude of each product, shape (n_along, n_across), from those of the modes."""


@dataclass(frozen=True)
class SineBasis:
    """sin(m pi (x / length + 1/2)), m = 1 ... `count`.

    Examples
    --------
    >>> SineBasis(0.9, 2).values([0.0, -0.225]).round(6)
    array([[1.      , 0.      ], [0.707107, 1.      ]])
    """

    length: float
    count: int

    def values(self, x: ArrayLike, derivative: int = 0) -> NDArray[np.float64]:
        """Values [-], or first derivatives [1/m], shape (..., n)."""
        half_turns = np.arange(1, self.count + 1) * np.pi
        argument = half_turns * (np.asarray(x, dtype=np.float64)[..., None] / self.length + 0.5)
        values = half_turns / self.length * np.cos(argument) if derivative else np.sin(argument)
        return np.asarray(values, dtype=np.float64)

    def transform(self, wavenumber: NDArray[np.float64]) -> NDArray[np.float64]:
        """Cosine or sine transforms [m], shape (..., n), at wavenumbers [rad/m]."""
        m = np.arange(1, self.count + 1)
        even = m % 2 == 1
        sign = np.where(m % 4 < 2, 1.0, -1.0)  # sin(m pi/2) of even ones, cos(m pi/2) of odd ones
        half = wavenumber[..., None] * (self.length / (2 * np.pi))
        near, far = np.sinc(m / 2 - half), np.sinc(m / 2 + half)
        return np.asarray(sign * self.length / 2 * np.where(even, near + far, near - far))


@dataclass(frozen=True)
class LegendreBasis:
    """Legendre polynomials of 2 x / length, degrees 0 ... `degree`.

    Examples
    --------
    >>> LegendreBasis(0.9, 2).values([0.0, 0.45])
    array([[ 1. ,  0. , -0.5], [ 1. ,  1. ,  1. ]])
    """

    length: float
    degree: int

    def values(self, x: ArrayLike, derivative: int = 0) -> NDArray[np.float64]:
        """Values [-], or first derivatives [1/m], shape (..., n)."""
        position = np.asarray(x, dtype=np.float64) * (2 / self.length)
        values = legvander(position, self.degree)
        if derivative:
            values = values[..., :-1] @ legder(np.eye(self.degree + 1)) * (2 / self.length)
        return np.asarray(values, dtype=np.float64)

    def transform(self, wavenumber: NDArray[np.float64]) -> NDArray[np.float64]:
        """Cosine or sine transforms [m], shape (..., n).

        They are spherical Bessel functions, by quadrature.
        """
        argument = wavenumber * (self.length / 2)
        nodes = int(self.degree + np.max(argument, initial=0.0)) + 2 * SPARE_NODES
        position, weighted = _weighted_legendre(16 * (nodes // 16 + 1), self.degree)
        phase = argument[..., None] * position
        transforms = np.empty((*argument.shape, self.degree + 1))
        transforms[..., ::2] = np.cos(phase) @ weighted[:, ::2]
        transforms[..., 1::2] = np.sin(phase) @ weighted[:, 1::2]
        return transforms * self.length


@lru_cache(maxsize=32)
def _weighted_legendre(nodes: int, degree: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    position, weight = leggauss(nodes)
    upper = slice(nodes // 2, None)
    return position[upper], weight[upper, None] * legvander(position[upper], degree)


@dataclass(frozen=True, eq=False)
class SingleProducts:
    """Each mode one product: shape (n_modes,) the function along and that across, from 0."""

    along: NDArray[np.int64]
    across: NDArray[np.int64]

    def combine(
        self, along: NDArray[np.float64], across: NDArray[np.float64], some: slice
    ) -> NDArray[np.float64]:
        """Values of some modes [-], shape (n, m, n_some)."""
        return along[:, None, self.along[some]] * across[..., self.across[some]]

    def weighted(self, amplitudes: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Amplitude of each product."""
        products = np.zeros((self.along.max() + 1, self.across.max() + 1), dtype=np.complex128)
        products[self.along, self.across] = amplitudes
        return products


@dataclass(frozen=True, eq=False)
class SumsOfProducts:
    """Each mode a sum of all products: coefficients, shape (n_modes, n_along, n_across)."""

    coefficients: NDArray[np.float64]

    def combine(
        self, along: NDArray[np.float64], across: NDArray[np.float64], some: slice
    ) -> NDArray[np.float64]:
        """Values of some modes [-], shape (n, m, n_some)."""
        lines = np.tensordot(along, self.coefficients[some], axes=(1, 1))
        return np.asarray(across @ lines.swapaxes(1, 2))

    def weighted(self, amplitudes: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Amplitude of each product."""
        return np.asarray(np.tensordot(amplitudes, self.coefficients, axes=1))
