"""How a design stands with the parts that are made of it, and what would make it stand better.

One answer joins what the other pages of this package compute: how probable each noise is among
parts at any speed of their use, how probably a part keeps clear of vibration over all of its use,
which tolerance matters most to that margin, what a change buys, and the risk number. Labels are
simulated. Margins are by stability where friction has a slope, a thousand of them in the time of
sixty labels; the few that an engineer acts on are worth simulating again.

A file that states no tolerances gets those of `ASSUMED`, and the answer says so.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from noise.screening.design.tolerances import Tolerance
from noise.screening.parts.advice import ending, widening
from noise.screening.parts.lever import Lever
from noise.screening.parts.population import outcomes
from noise.screening.parts.probability import NOISES, label_probabilities
from noise.screening.parts.scatter import Scatter, Shape
from noise.screening.parts.sensitivity import sobol_indices
from noise.screening.parts.variation import nominal_values, use_point
from noise.screening.ranking.risk import Candidate
from noise.screening.ranking.use_risk import use_risk

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from noise.screening.design.design import Design
    from noise.screening.parts.advice import Advice
    from noise.screening.parts.estimate import Estimate
    from noise.screening.parts.probability import Probabilities
    from noise.screening.parts.sensitivity import Sensitivity
    from noise.screening.parts.variation import UsePoint

__all__ = ["ASSUMED", "LEVERS", "Robustness", "robustness", "scatters_of"]

ASSUMED = (
    Tolerance("elastomer_stiffness", "relative", 0.05),
    Tolerance("damping", "relative", 0.1),
    Tolerance("critical_torque", "relative", 0.05),
    Tolerance("kinetic_torque", "relative", 0.05),
    Tolerance("support_stiffness", "relative", 0.03),
    Tolerance("interference", "relative", 0.03),
)
"""Tolerances where a design states none: orders of magnitude for moulded rubber, no source."""

LEVERS = (
    Lever("elastomer_stiffness", 0.7, 1.4),
    Lever("damping", 0.5, 2.0),
    Lever("critical_torque", 0.6, 1.4),
    Lever("kinetic_torque", 0.6, 1.4),
    Lever("support_stiffness", 0.6, 1.7),
    Lever("interference", 0.7, 1.3),
)
"""Factors on the nominal design within which advice is sought unless other levers are given."""

_WIDEST_NORMAL = 1.0 / 6.0
"""Relative standard deviation from which on a normal distribution is taken as lognormal."""

_QUIET = "none"


@dataclass(frozen=True, eq=False)
class Robustness:
    """How a design stands with the parts that are made of it.

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
    widening : tuple of Advice
        What each change buys of margin; empty where nothing vibrates.
    ending : tuple of Advice
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
    >>> found.clear.value, found.candidate.margin, "assumed" in found._repr_html_()
    (1.0, inf, True)
    """

    design: str
    point: UsePoint
    noises: Probabilities
    clear: Estimate
    margin: float
    sensitivities: tuple[Sensitivity, ...]
    widening: tuple[Advice, ...]
    ending: tuple[Advice, ...]
    risk: int
    assumed: bool

    @property
    def candidate(self) -> Candidate:
        """What the ranking needs to know of it."""
        return Candidate(self.design, self.risk, self.noises.any_but(_QUIET), self.margin)

    def _repr_html_(self) -> str:
        """Show what parts do, what matters, and what helps."""
        from noise.screening.tables.screening_display import robustness_html

        return robustness_html(self)


def robustness(
    design: Design,
    rng: np.random.Generator,
    *,
    half_width: float = 0.05,
    confidence: float = 0.95,
    samples: int = 128,
    gain: float = 1.0,
    levers: Sequence[Lever] = LEVERS,
    budget: float = math.inf,
    risk: int | None = None,
    workers: int = -1,
) -> Robustness:
    """Tell how a design stands with the parts that are made of it.

    Parameters
    ----------
    design : Design
    rng : numpy.random.Generator
        Of the parts.
    half_width, confidence : float
        Of the probabilities' intervals, and the confidence of all intervals.
    samples : int
        Of the Sobol' indices, a power of two from 64 on.
    gain : float
        Margin that advice shall bring [rad/s].
    levers : sequence of Lever
        What may be changed, as factors by the names of
        `noise.screening.design.tolerances.PARAMETERS`.
    budget : float
        That no change may cost more than, in the unit of the levers' costs.
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
    scatters = scatters_of(design, point)
    known = [scatter for scatter in scatters if scatter.name != "speed"]
    changed = [lever.name for lever in levers]

    def labels(names: Sequence[str]) -> Callable[[NDArray[np.float64]], NDArray[np.str_]]:
        return lambda factors: (
            outcomes(
                design, factors, names=names, point=point, critical="none", workers=workers
            ).labels
        )

    def margins(names: Sequence[str]) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
        return lambda factors: (
            outcomes(
                design, factors, names=names, point=point, labels=False, workers=workers
            ).margin
        )

    margin_of = margins([scatter.name for scatter in known])

    def finite(factors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where nothing vibrates any more, as if vibration ended where the shaft stands still."""
        found = margin_of(factors)
        return np.where(np.isinf(found), point.use[0], found)

    def clear(factors: NDArray[np.float64]) -> NDArray[np.str_]:
        return np.where(margin_of(factors) > 0.0, "clear", "vibrates")

    def probabilities(
        labels_of: Callable[[NDArray[np.float64]], NDArray[np.str_]],
        scatters: Sequence[Scatter],
        expected: Sequence[str],
    ) -> Probabilities:
        return label_probabilities(
            labels_of, scatters, rng, labels=expected, half_width=half_width, confidence=confidence
        )

    nominal = [[1.0] * len(levers)]
    margin = float(margins(changed)(np.array(nominal))[0])
    noise = str(labels(changed)(np.array(nominal))[0])
    return Robustness(
        design=design.name,
        point=point,
        noises=probabilities(labels([scatter.name for scatter in scatters]), scatters, NOISES),
        clear=probabilities(clear, known, ("clear", "vibrates")).by_label["clear"],
        margin=margin,
        sensitivities=sobol_indices(finite, known, rng, samples=samples, confidence=confidence),
        widening=widening(margins(changed), levers, gain, budget=budget)
        if math.isfinite(margin)
        else (),
        ending=ending(labels(changed), levers, set(NOISES) - {_QUIET}, budget=budget)
        if noise != _QUIET
        else (),
        risk=use_risk(design, workers=workers) if risk is None else risk,
        assumed=not design.tolerances,
    )


def scatters_of(design: Design, point: UsePoint) -> tuple[Scatter, ...]:
    """How factors on a design's parameters scatter; all speeds of use alike if it states no other.

    A normal distribution so wide that it would reach to zero is taken as lognormal.

    Parameters
    ----------
    design : Design
    point : UsePoint

    Returns
    -------
    tuple of Scatter

    Examples
    --------
    >>> from noise.screening.design.design import load_design
    >>> design = load_design("fluorocarbon")
    >>> [(one.name, one.spread) for one in scatters_of(design, use_point(design))][-1]
    ('speed', 0.96...)
    """
    nominal = nominal_values(design, point)
    scatters = [
        _scatter(tolerance.name, *tolerance.factors(nominal[tolerance.name]))
        for tolerance in design.tolerances or ASSUMED
    ]
    if all(scatter.name != "speed" for scatter in scatters):
        low, high = point.use
        scatters.append(_scatter("speed", "uniform", low / point.speed, high / point.speed))
    return tuple(scatters)


def _scatter(name: str, kind: str, first: float, second: float) -> Scatter:
    if kind == "uniform":
        middle, half = 0.5 * (first + second), 0.5 * (second - first)
        return Scatter(name, Shape.UNIFORM, half, nominal=middle, relative=False)
    shape = Shape.NORMAL if second < _WIDEST_NORMAL else Shape.LOGNORMAL
    return Scatter(name, shape, second, nominal=first)
