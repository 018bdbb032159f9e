"""Robustness of a design: what its tolerances do, and which change would help.

One answer joins what the other modules of this package compute: how probable each noise is among
parts at any speed of their use, how probably a part keeps clear of vibration over all of its use,
which tolerance matters most to that margin, what a change buys, and the risk number. Labels are
simulated. Margins are by stability where friction has a slope, a thousand of them in the time of
sixty labels; the few that an engineer acts on are worth simulating again.

A file that states no tolerances gets those of `ASSUMED`, and the answer says so.

Sobol' indices: which parameter's tolerance makes a margin scatter most, with intervals.

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
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats
from scipy.stats import uniform

from models.errors import ParameterError
from models.show import short_repr
from noise.screening.design.design import Design
from noise.screening.design.tolerances import Tolerance
from noise.screening.parts.advice import Advice, increase_margin, remove_noise
from noise.screening.parts.design_variable import DesignVariable
from noise.screening.parts.estimate import Estimate
from noise.screening.parts.population import outcomes
from noise.screening.parts.probability import NOISES, Probabilities, label_probabilities
from noise.screening.parts.sampling import Distribution, parts, sobol_points
from noise.screening.parts.variation import UsePoint, nominal_values, use_point
from noise.screening.ranking.use_risk import use_risk

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
        Of parameters, shape (n, d), a row per part; returns n finite numbers. It is called once,
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


ASSUMED = (
    Tolerance("elastomer_stiffness", "relative", 0.05),
    Tolerance("damping", "relative", 0.1),
    Tolerance("critical_torque", "relative", 0.05),
    Tolerance("kinetic_torque", "relative", 0.05),
    Tolerance("support_stiffness", "relative", 0.03),
    Tolerance("interference", "relative", 0.03),
)
"""Tolerances where a design states none: orders of magnitude for moulded rubber, no source."""

DESIGN_VARIABLES = (
    DesignVariable("elastomer_stiffness", 0.7, 1.4),
    DesignVariable("damping", 0.5, 2.0),
    DesignVariable("critical_torque", 0.6, 1.4),
    DesignVariable("kinetic_torque", 0.6, 1.4),
    DesignVariable("support_stiffness", 0.6, 1.7),
    DesignVariable("interference", 0.7, 1.3),
)
"""Factors on the nominal design within which advice is sought unless other variables are given."""

_QUIET = "none"


@short_repr
@dataclass(frozen=True, eq=False)
class Robustness:
    """What a design's tolerances do, and which change would help.

    Parameters
    ----------
    design : str
    point : UsePoint
        Fit, support and temperature of the parts, which scatter about it, and the speeds of use.
    noises : Probabilities
        Of each noise, of a part at a speed of its use, all speeds alike.
    clear : Estimate
        Probability that a part does not vibrate at any speed of its use.
    margin : float
        Of the nominal design [rad/s]; ``inf`` where nothing vibrates.
    sensitivities : tuple of Sensitivity
        Of the margin, what matters most first.
    margin_advice : tuple of Advice
        What each change buys of margin; empty where nothing vibrates.
    noise_advice : tuple of Advice
        Which change ends the noise in the middle of the use; empty where there is none.
    risk : int
        From 1 to 10.
    assumed : bool
        Whether the tolerances are `ASSUMED` rather than the design's own.

    Examples
    --------
    >>> from noise.screening.design.design import load_design
    >>> design = load_design("PDMS")
    >>> found = robustness(design, np.random.default_rng(0), half_width=0.1, samples=64)
    >>> found.clear.value, found.margin, found.assumed
    (1.0, inf, True)
    """

    design: str
    point: UsePoint
    noises: Probabilities
    clear: Estimate
    margin: float
    sensitivities: tuple[Sensitivity, ...]
    margin_advice: tuple[Advice, ...]
    noise_advice: tuple[Advice, ...]
    risk: int
    assumed: bool


def robustness(
    design: Design,
    rng: np.random.Generator,
    *,
    half_width: float = 0.05,
    confidence: float = 0.95,
    samples: int = 128,
    gain: float = 1.0,
    variables: Sequence[DesignVariable] = DESIGN_VARIABLES,
    budget: float = math.inf,
    risk: int | None = None,
    workers: int = -1,
) -> Robustness:
    """Compute what a design's tolerances do, and which change would help.

    Parameters
    ----------
    design : Design
    rng : numpy.random.Generator
        Of the parts.
    half_width, confidence : float
        Of the probabilities' intervals, and the confidence of all intervals [-].
    samples : int
        Of the Sobol' indices, a power of two from 64 on.
    gain : float
        Margin that advice shall bring [rad/s].
    variables : sequence of DesignVariable
        What may be changed, as factors by the names of
        `noise.screening.design.tolerances.PARAMETERS`.
    budget : float
        That no change may cost more than, in the unit of the variables' costs [-].
    risk : int, optional
        The design's risk number, where it is known already.
    workers : int
        Threads; -1 is one a core.

    Returns
    -------
    Robustness

    Raises
    ------
    ParameterError
        If a value cannot be used, or a part cannot be simulated.

    Examples
    --------
    >>> from noise.screening.design.design import load_design
    >>> design = load_design("PDMS")
    >>> found = robustness(design, np.random.default_rng(0), half_width=0.1, samples=64)
    >>> found.noises.by_label["none"].value, found.margin, found.risk, found.assumed
    (1.0, inf, 1, True)
    """
    point = use_point(design)
    vary = factor_distributions(design, point)
    of_a_part = {name: one for name, one in vary.items() if name != "speed"}
    changed = [variable.name for variable in variables]
    run = partial(outcomes, design, point=point, workers=workers)

    def labels(names: Iterable[str], factors: NDArray[np.float64]) -> NDArray[np.str_]:
        return run(factors, names=tuple(names), critical="none").labels

    def margins(names: Iterable[str], factors: NDArray[np.float64]) -> NDArray[np.float64]:
        return run(factors, names=tuple(names), labels=False).margin

    def finite(factors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where nothing vibrates any more, as if vibration ended where the shaft stands still."""
        found = margins(of_a_part, factors)
        return np.where(np.isinf(found), point.use[0], found)

    def clear(factors: NDArray[np.float64]) -> NDArray[np.str_]:
        return np.where(margins(of_a_part, factors) > 0.0, "clear", "vibrates")

    estimate = partial(label_probabilities, rng=rng, half_width=half_width, confidence=confidence)
    nominal = np.ones((1, len(variables)))
    margin = float(margins(changed, nominal)[0])
    noise = str(labels(changed, nominal)[0])
    return Robustness(
        design=design.name,
        point=point,
        noises=estimate(partial(labels, vary), vary, labels=NOISES),
        clear=estimate(clear, of_a_part, labels=("clear", "vibrates")).by_label["clear"],
        margin=margin,
        sensitivities=sobol_indices(finite, of_a_part, rng, samples=samples, confidence=confidence),
        margin_advice=increase_margin(partial(margins, changed), variables, gain, budget=budget)
        if math.isfinite(margin)
        else (),
        noise_advice=remove_noise(
            partial(labels, changed), variables, set(NOISES) - {_QUIET}, budget=budget
        )
        if noise != _QUIET
        else (),
        risk=use_risk(design, workers=workers) if risk is None else risk,
        assumed=not design.tolerances,
    )


def factor_distributions(design: Design, point: UsePoint) -> dict[str, Distribution]:
    """Distributions of the factors on a design's parameters, from its tolerances or `ASSUMED`.

    All speeds of use are alike if no tolerance of the speed is stated.

    Parameters
    ----------
    design : Design
    point : UsePoint

    Returns
    -------
    dict of str to Distribution

    Examples
    --------
    >>> from noise.screening.design.design import load_design
    >>> design = load_design("fluorocarbon")
    >>> factor_distributions(design, use_point(design))["speed"].ppf([0.0, 1.0]).round(2)
    array([0.04, 1.96])
    """
    nominal = nominal_values(design, point)
    found = {
        tolerance.name: tolerance.factor(nominal[tolerance.name])
        for tolerance in design.tolerances or ASSUMED
    }
    if "speed" not in found:
        low, high = (limit / point.speed for limit in point.use)
        found["speed"] = uniform(low, high - low)
    return found
