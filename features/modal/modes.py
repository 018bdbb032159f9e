"""Modes of a structure, and the residues of poles fitted to its responses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.errors import ParameterError
from models.show import short_repr

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame


_POINTS = 2000
_MARGIN = 0.5
"""Start of a curve on new axes, over the lowest natural frequency."""


class Pole(NamedTuple):
    """Pole of response functions.

    Parameters
    ----------
    frequency : float
        Undamped natural frequency [Hz].
    damping_ratio : float
        Fraction of critical damping [-].
    orders : int
        Number of orders in which the pole is stable.
    """

    frequency: float
    damping_ratio: float
    orders: int


class Responses(NamedTuple):
    """Measured response functions with weights.

    Parameters
    ----------
    f : ndarray, shape (n,)
        [Hz], rising, above 0.
    h : ndarray, shape (n_responses, n), complex
        In any [unit].
    weight : ndarray, shape (n_responses, n)
        Weight of each line [-].
    """

    f: NDArray[np.float64]
    h: NDArray[np.complex128]
    weight: NDArray[np.float64]

    def at(self, lines: slice | NDArray[np.bool_]) -> Responses:
        """Return the responses at some lines."""
        return Responses(self.f[lines], self.h[:, lines], self.weight[:, lines])


@short_repr
@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of one or several response functions of a structure.

    H(omega) = sum_r [R_r / (i omega - s_r) + conj(R_r) / (i omega - conj(s_r))] + residuals,
    with the poles s_r = 2 pi f_r (-zeta_r + i sqrt(1 - zeta_r^2)).

    Parameters
    ----------
    frequency : ndarray, shape (n_modes,)
        Undamped natural frequencies [Hz], rising.
    damping_ratio : ndarray, shape (n_modes,)
        Fractions of critical damping.
    residues : ndarray, shape (n_responses, n_modes), complex
        R_r [unit of the response times rad/s].
    residuals : ndarray, shape (n_responses, 4)
        Real factors of 1/(i omega)^2, 1, i omega and (i omega)^2, relative to the highest omega:
        the contribution of modes outside the band.
    orders : ndarray, shape (n_modes,)
        Number of orders in which each pole is stable [-].
    highest : float
        Upper end of the band [Hz].

    Examples
    --------
    >>> one = np.ones(1)
    >>> none = np.zeros((1, 4))
    >>> mode = Modes(100 * one, 0.02 * one, 1j * one[None], none, one.astype(int), 200.0)
    >>> mode.poles.round(1)
    array([-12.6+628.2j])
    """

    frequency: NDArray[np.float64]
    damping_ratio: NDArray[np.float64]
    residues: NDArray[np.complex128]
    residuals: NDArray[np.float64]
    orders: NDArray[np.intp]
    highest: float

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Poles s_r [rad/s], shape (n_modes,)."""
        return _poles(self.frequency, self.damping_ratio)

    def response(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Return the response functions at frequencies.

        Parameters
        ----------
        frequency : array_like, shape (n,)
            [Hz]

        Returns
        -------
        ndarray, shape (n_responses, n), complex
            In the unit of the responses.
        """
        basis = modal_basis(self.poles, np.asarray(frequency, dtype=np.float64), self.highest)
        coefficients = np.hstack([self.residues.real, self.residues.imag, self.residuals])
        return np.asarray(coefficients @ basis)

    def without_window(self, rate: float) -> Modes:
        """Return the modes without the effect of an exponential window.

        Parameters
        ----------
        rate : float
            Rate that the window adds to the decay of each pole [1/s].

        Returns
        -------
        Modes
            Modes that still decay.

        Examples
        --------
        >>> one, none = np.ones(1), np.zeros((1, 4))
        >>> mode = Modes(100 * one, 0.02 * one, 1j * one[None], none, one.astype(int), 200.0)
        >>> mode.without_window(2 * np.pi).damping_ratio.round(3)
        array([0.01])
        """
        poles = self.poles + rate
        decay = poles.real < 0.0
        natural = np.abs(poles[decay])
        return replace(
            self.only(decay),
            frequency=natural / (2 * np.pi),
            damping_ratio=-poles.real[decay] / natural,
        )

    def only(self, some: slice | NDArray[np.bool_]) -> Modes:
        """Return some of the modes."""
        return replace(
            self,
            frequency=self.frequency[some],
            damping_ratio=self.damping_ratio[some],
            residues=self.residues[:, some],
            orders=self.orders[some],
        )

    def to_pandas(self) -> DataFrame:
        """Return a pandas data frame with one row per mode.

        Returns
        -------
        pandas.DataFrame
            Columns ``frequency_hz``, ``damping_ratio`` and ``orders``.

        Raises
        ------
        ParameterError
            pandas is not installed.
        """
        from models.show import data_frame

        columns = ("frequency_hz", "damping_ratio", "orders")
        values = zip(self.frequency, self.damping_ratio, self.orders, strict=True)
        return data_frame(columns, [dict(zip(columns, of, strict=True)) for of in values])

    def plot(self, ax: Axes | None = None) -> Axes:
        """Plot the magnitudes of the modes' responses, and their natural frequencies.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw into, such as those of the measured response; by default a new figure.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ParameterError
            There is no mode.

        Examples
        --------
        >>> from matplotlib.figure import Figure
        >>> one = np.ones(1)
        >>> mode = Modes(100 * one, 0.02 * one, 1j * one[None], np.zeros((1, 4)), one, 200.0)
        >>> axes = mode.plot(Figure().subplots())
        >>> axes.get_xlabel(), len(axes.lines)
        ('Frequency [Hz]', 2)
        """
        from models.drawing import CURVES, GREY, axes_or_new, frequency_axis

        if not self.frequency.size:
            raise ParameterError("there is no mode to plot")
        low = _MARGIN * float(self.frequency[0])
        frequency = np.geomspace(low, self.highest, _POINTS)
        several = len(self.residues) > 1
        with axes_or_new(ax) as axes:
            measured = axes.has_data()
            for number, response in enumerate(self.response(frequency)):
                axes.plot(
                    frequency, np.abs(response), "--",
                    color=CURVES[(number + 1) % len(CURVES)],
                    label=f"modes, response {number + 1}" if several else "modes",
                )  # fmt: skip
            for natural in self.frequency:
                axes.axvline(float(natural), color=GREY, linestyle=":", linewidth=0.9, zorder=1)
            if not measured:
                axes.set_yscale("log")
                frequency_axis(axes, low, self.highest)
                axes.set_xlabel("Frequency [Hz]")
                axes.set_ylabel("Magnitude [unit of the measured response]")
            axes.legend(loc="best")
        return axes


def modes_of_poles(poles: list[Pole], measured: Responses) -> Modes:
    """Return the modes of poles, with residues and residuals by linear least squares.

    Parameters
    ----------
    poles : list of Pole
    measured : Responses

    Returns
    -------
    Modes

    Examples
    --------
    >>> f = np.arange(50.0, 151.0)
    >>> H = 1 / (100.0**2 - f**2 + 2j * 0.02 * 100.0 * f) / (2 * np.pi) ** 2
    >>> modes = modes_of_poles([Pole(100.0, 0.02, 1)], Responses(f, H[None], np.ones((1, 101))))
    >>> bool(np.allclose(modes.response(f), H))
    True
    """
    frequency, ratio, orders = np.array(poles).reshape(-1, 3).T
    highest, n = float(measured.f[-1]), frequency.size
    basis = modal_basis(_poles(frequency, ratio), measured.f, highest)
    lines = zip(measured.h, measured.weight, strict=True)
    factors = np.array([least_squares(basis * w, one * w) for one, w in lines])
    residues = factors[:, :n] + 1j * factors[:, n : 2 * n]
    return Modes(frequency, ratio, residues, factors[:, 2 * n :], orders.astype(np.intp), highest)


def modal_basis(
    poles: NDArray[np.complex128], f: NDArray[np.float64], highest: float
) -> NDArray[np.complex128]:
    """Return the responses of unit residues, real and imaginary, and unit residuals.

    Parameters
    ----------
    poles : ndarray, shape (n_modes,), complex
        [rad/s]
    f : ndarray, shape (n,)
        [Hz]
    highest : float
        Reference frequency of the residuals [Hz].

    Returns
    -------
    ndarray, shape (2 n_modes + 4, n), complex
        [s] for residues, [-] for residuals.

    Examples
    --------
    >>> modal_basis(np.array([-1.0 + 10j]), np.array([1.0, 2.0]), 2.0).shape
    (6, 2)
    """
    s = 2j * np.pi * f
    here = 1 / (s - poles[:, None])
    there = 1 / (s - poles.conj()[:, None])
    x = s / (2 * np.pi * highest)
    return np.vstack([here + there, 1j * (here - there), x**-2, np.ones_like(x), x, x**2])


def least_squares(
    basis: NDArray[np.complex128], target: NDArray[np.complex128]
) -> NDArray[np.float64]:
    """Return real factors of the rows of `basis` that sum to `target`, by normal equations.

    Parameters
    ----------
    basis : ndarray, shape (n_rows, n), complex
        In any unit.
    target : ndarray, shape (n,) or (n_targets, n), complex
        In any unit.

    Returns
    -------
    ndarray, shape (n_rows,) or (n_targets, n_rows)
        [unit of target over that of basis]

    Examples
    --------
    >>> least_squares(np.array([[1.0, 1j], [0.0, 1j]]), np.array([2.0, 5j])).round(6)
    array([2., 3.])
    """
    parts = real_and_imaginary(basis)
    scale = np.sqrt(np.maximum(np.sum(parts**2, axis=1), np.finfo(float).tiny))
    parts /= scale[:, None]
    factors = np.linalg.lstsq(parts @ parts.T, parts @ real_and_imaginary(target).T, rcond=1e-13)[0]
    return np.asarray(factors.T / scale)


def real_and_imaginary(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return real and imaginary parts concatenated along the last axis.

    Parameters
    ----------
    values : ndarray, shape (..., n), complex
        In any [unit].

    Returns
    -------
    ndarray, shape (..., 2 n)
        In the unit of the values [unit].

    Examples
    --------
    >>> real_and_imaginary(np.array([1 + 2j]))
    array([1., 2.])
    """
    return np.concatenate([values.real, values.imag], axis=-1)


def _poles(
    frequency: NDArray[np.float64], damping_ratio: NDArray[np.float64]
) -> NDArray[np.complex128]:
    return np.asarray(2 * np.pi * frequency * (-damping_ratio + 1j * np.sqrt(1 - damping_ratio**2)))
