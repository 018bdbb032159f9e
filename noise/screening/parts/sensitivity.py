"""Sobol' indices: which parameter's tolerance makes a margin scatter most, with intervals.

The first index of a parameter is the share of the output's variance that goes when the parameter
no longer scatters; the total one the share that stays when it alone scatters. What they differ by,
it does together with others. The estimators are those of `scipy.stats.sobol_indices`. Its bootstrap
takes Sobol' points for drawn by chance, of which the first few hundred in many dimensions are worth
less; so some dozen scramblings stand side by side here, and the bootstrap draws those (T. C.
Hesterberg, *What teachers should know about the bootstrap*, American Statistician 69, 2015, for the
width of intervals from a few dozen).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from models.errors import ParameterError
from noise.screening.parts.estimate import Estimate
from noise.screening.parts.sampling import Distribution, parts, sobol_points

_SCRAMBLINGS = 32

_DRAWS = 1000
"""Of the bootstrap."""


@dataclass(frozen=True)
class Sensitivity:
    """How far one parameter's scatter makes an output scatter.

    Parameters
    ----------
    name : str
        Of the parameter.
    first, total : Estimate
        Sobol' indices [-]; what is estimated may lie a little below 0 or above 1.
    """

    name: str
    first: Estimate
    total: Estimate


def sobol_indices(
    output: Callable[[NDArray[np.float64]], ArrayLike],
    distributions: Mapping[str, Distribution],
    rng: np.random.Generator,
    *,
    samples: int = 256,
    confidence: float = 0.95,
) -> tuple[Sensitivity, ...]:
    """Estimate first and total Sobol' indices, the largest total index first.

    Parameters
    ----------
    output : callable
        Of parameters, shape (n, d), a row a part; returns n finite numbers. It is called once,
        with ``samples * (d + 2)`` rows.
    distributions : mapping of str to Distribution, length d
    rng : numpy.random.Generator
        Of the samples and of the bootstrap.
    samples : int
        A power of two from 64 on; the more parameters and the rougher the output, the more.
    confidence : float
        Of each interval, from 0 to 1 [-].

    Returns
    -------
    tuple of Sensitivity
        All zero for an output that does not vary.

    Raises
    ------
    ParameterError
        If a value cannot be used, or the output is not finite.

    Examples
    --------
    Of a product of two factors that vary alike, each matters as much:

    >>> from scipy.stats import uniform
    >>> both = {name: uniform(0.9, 0.2) for name in ("stiffness", "friction")}
    >>> found = sobol_indices(lambda x: x[:, 0] * x[:, 1], both, np.random.default_rng(0))
    >>> sorted((index.name, round(index.total.value, 1)) for index in found)
    [('friction', 0.5), ('stiffness', 0.5)]
    """
    names = tuple(distributions)
    if samples < 2 * _SCRAMBLINGS or samples & (samples - 1) or not 0.0 < confidence < 1.0:
        raise ParameterError(
            f"Sobol' indices: samples = {samples} must be a power of two from "
            f"{2 * _SCRAMBLINGS} on, confidence = {confidence:g} lie between 0 and 1"
        )
    d = len(names)
    each = samples // _SCRAMBLINGS
    points = np.vstack([sobol_points(2 * d, rng).random(each) for _ in range(_SCRAMBLINGS)])
    a, b = points[:, :d], points[:, d:]
    mixed = [np.where(np.arange(d) == i, b, a) for i in range(d)]
    values = np.asarray(output(parts(distributions, np.vstack([a, b, *mixed]))), dtype=np.float64)
    if values.shape != (samples * (d + 2),) or not np.isfinite(values).all():
        raise ParameterError(
            f"Sobol' indices: the output must be {samples * (d + 2)} finite numbers, one a part"
        )
    scrambled = values.reshape(d + 2, _SCRAMBLINGS, each)
    chances = np.full(_SCRAMBLINGS, 1.0 / _SCRAMBLINGS)
    counts = rng.multinomial(_SCRAMBLINGS, chances, size=_DRAWS)
    value = _indices(scrambled)
    drawn = [_indices(np.repeat(scrambled, times, axis=1)) for times in counts]
    tail = _tail(confidence)
    low, high = np.quantile(drawn, [tail, 1.0 - tail], axis=0)
    found = [
        Sensitivity(
            name,
            *(Estimate(float(value[k, i]), float(low[k, i]), float(high[k, i])) for k in (0, 1)),
        )
        for i, name in enumerate(names)
    ]
    return tuple(sorted(found, key=lambda index: -index.total.value))


def _tail(confidence: float) -> float:
    """Where to cut the bootstrap's distribution, which few scramblings make too narrow."""
    freedom = _SCRAMBLINGS - 1
    cut = float(stats.t.ppf(0.5 + 0.5 * confidence, freedom)) * math.sqrt(_SCRAMBLINGS / freedom)
    return float(stats.norm.cdf(-cut))


def _indices(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """First and total indices, shape (2, d), of outputs f(A), f(B), f(AB_i) of some scramblings."""
    of_a, of_b, *mixed = values.reshape(len(values), 1, -1)
    found = stats.sobol_indices(
        func={"f_A": of_a, "f_B": of_b, "f_AB": np.array(mixed)}, n=of_a.size
    )
    return np.array([found.first_order, found.total_order]).reshape(2, -1)
