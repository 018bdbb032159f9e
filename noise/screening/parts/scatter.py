"""How the parameters of a design scatter from part to part, and samples of such parts.

Parameters scatter independently of each other. Samples are Sobol' points, scrambled: they fill
the space of the parameters more evenly than chance does, and stay unbiased, so that a few
scramblings side by side tell how far off the result may be (A. B. Owen, *Scrambled net variance
for integrals of smooth functions*, Annals of Statistics 25, 1997).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm, qmc

from models.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

__all__ = ["Scatter", "Shape", "names_of", "parts", "sobol_points"]

_SAFE = 6.0
"""Standard deviations that a relative normal distribution keeps from zero."""


class Shape(StrEnum):
    """Families of distributions."""

    NORMAL = "normal"
    TRUNCATED_NORMAL = "truncated-normal"
    UNIFORM = "uniform"
    LOGNORMAL = "lognormal"


@dataclass(frozen=True)
class Scatter:
    """How one parameter scatters about its nominal value.

    Parameters
    ----------
    name : str
    shape : Shape or str
    spread : float
        Half the width of a uniform distribution; of a normal one, before it is cut, the standard
        deviation; of a lognormal one the standard deviation over the mean.
    nominal : float
        Centre of the distribution, the median of a lognormal one. The default suits parameters
        that are given as factors.
    relative : bool
        Whether `spread` is a share of the nominal value or in its unit.
    cut : float
        Where a truncated normal distribution ends, in standard deviations on either side: what
        inspection lets through.

    Raises
    ------
    ParameterError
        If a value cannot be used, or if relative scatter reaches to zero, where a stiffness
        or a friction means nothing.

    Examples
    --------
    >>> fit = Scatter("interference", "truncated-normal", 0.01e-3, nominal=0.279e-3,
    ...                 relative=False, cut=2.0)
    >>> (1e3 * fit.quantile([0.0, 0.5, 1.0])).round(3)
    array([0.259, 0.279, 0.299])
    """

    name: str
    shape: Shape | str
    spread: float
    nominal: float = 1.0
    relative: bool = True
    cut: float = 3.0

    def __post_init__(self) -> None:
        where = f"scatter of {self.name}"
        shapes = ", ".join(Shape)
        if self.shape not in set(Shape):
            raise ParameterError(f"{where}: unknown shape {self.shape!r}; there are {shapes}")
        if not 0.0 <= self.spread < math.inf:
            raise ParameterError(f"{where}: spread = {self.spread:g} must be 0 or more")
        if not 0.0 < self.cut < math.inf:
            raise ParameterError(f"{where}: cut = {self.cut:g} must be above 0")
        if not math.isfinite(self.nominal) or (self.nominal == 0.0 and self.relative):
            raise ParameterError(
                f"{where}: nominal = {self.nominal:g} must be finite, and not 0 if it is relative"
            )
        if self.shape == Shape.LOGNORMAL and self.nominal <= 0.0:
            raise ParameterError(
                f"{where}: nominal = {self.nominal:g} of a lognormal distribution must be above 0"
            )
        if self.relative and self._reach() >= 1.0:
            raise ParameterError(
                f"{where}: a spread of {self.spread:g} reaches to zero; give less, or take "
                f"{Shape.LOGNORMAL}"
            )

    def quantile(self, probability: ArrayLike) -> NDArray[np.float64]:
        """Values that the parameter stays below with a probability.

        Parameters
        ----------
        probability : array_like
            From 0 to 1.

        Returns
        -------
        ndarray
            In the unit of `nominal`, shaped as `probability`.
        """
        u = np.asarray(probability, dtype=np.float64)
        if self.shape == Shape.LOGNORMAL:
            variation = self.spread if self.relative else self.spread / self.nominal
            sigma = math.sqrt(math.log1p(variation**2))
            return np.asarray(self.nominal * np.exp(sigma * norm.ppf(u)))
        if self.shape == Shape.UNIFORM:
            deviation = 2.0 * u - 1.0
        elif self.shape == Shape.NORMAL:
            deviation = norm.ppf(u)
        else:
            below = norm.cdf(-self.cut)
            deviation = np.clip(norm.ppf(below + u * (1.0 - 2.0 * below)), -self.cut, self.cut)
        scale = self.spread * abs(self.nominal) if self.relative else self.spread
        return np.asarray(self.nominal + scale * deviation)

    def _reach(self) -> float:
        """How far the distribution goes, in units of the nominal value, if it is relative."""
        ends = {Shape.NORMAL: _SAFE, Shape.TRUNCATED_NORMAL: self.cut, Shape.UNIFORM: 1.0}
        return self.spread * ends.get(Shape(self.shape), 0.0)


def parts(scatters: Sequence[Scatter], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Parameters of parts, from points of the unit cube.

    Parameters
    ----------
    scatters : sequence of Scatter, length d
    points : ndarray, shape (n, d)
        From 0 to 1.

    Returns
    -------
    ndarray, shape (n, d)
        A row a part, a column a parameter.

    Examples
    --------
    >>> width = Scatter("width", "uniform", 0.1)
    >>> parts([width, width], np.array([[0.0, 1.0]]))
    array([[0.9, 1.1]])
    """
    return np.column_stack([scatter.quantile(points[:, i]) for i, scatter in enumerate(scatters)])


def sobol_points(dimensions: int, rng: np.random.Generator) -> qmc.Sobol:
    """Start a sequence of scrambled Sobol' points; ``.random(n)`` goes on with it.

    Parameters
    ----------
    dimensions : int
    rng : numpy.random.Generator
        Of the scrambling.

    Examples
    --------
    >>> points = sobol_points(2, np.random.default_rng(0))
    >>> np.histogram(points.random(8)[:, 0], bins=8, range=(0.0, 1.0))[0]
    array([1, 1, 1, 1, 1, 1, 1, 1])
    """
    return qmc.Sobol(dimensions, scramble=True, seed=rng)


def names_of(scatters: Sequence[Scatter]) -> tuple[str, ...]:
    """Names of the parameters, after a look whether there are any and none is given twice."""
    names = tuple(scatter.name for scatter in scatters)
    twice = sorted({name for name in names if names.count(name) > 1})
    if not names:
        raise ParameterError("scatter: there must be at least one")
    if twice:
        raise ParameterError(f"scatter: {twice[0]} is given twice")
    return names
