"""Robustness of a design: what its tolerances do, and which change would help.

One answer joins what the other modules of this package compute: how probable each noise is among
parts at any speed of their use, how probably a part keeps clear of vibration over all of its use,
which tolerance matters most to that margin, what a change buys, and the risk number. Labels are
simulated. Margins are by stability where friction has a slope, a thousand of them in the time of
sixty labels; the few that an engineer acts on are worth simulating again.

A file that states no tolerances gets those of `ASSUMED`, and the answer says so.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.stats import uniform

from models.show import short_repr
from noise.screening.design.design import Design
from noise.screening.design.tolerances import Tolerance
from noise.screening.parts.advice import Advice, increase_margin, remove_noise
from noise.screening.parts.design_variable import DesignVariable
from noise.screening.parts.estimate import Estimate
from noise.screening.parts.population import outcomes
from noise.screening.parts.probability import NOISES, Probabilities, label_probabilities
from noise.screening.parts.sampling import Distribution
from noise.screening.parts.sensitivity import Sensitivity, sobol_indices
from noise.screening.parts.variation import UsePoint, nominal_values, use_point
from noise.screening.ranking.use_risk import use_risk

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
