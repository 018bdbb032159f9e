"""Probability of each noise among parts within their tolerances, with intervals.

Thirty-two scramblings of one quasi-random sequence run side by side and are doubled in length
until every interval is as narrow as was asked for. How far the scramblings differ tells what a
sample is worth compared with chance alone (the design effect of survey sampling); intervals are
those of Clopper and Pearson, which cover at least what they state, at the effective number of
samples (E. L. Korn, B. I. Graubard, *Confidence intervals for proportions with small expected
number of positive counts*, Survey Methodology 24, 1998). Two cautions keep that honest where
doubling stops by what it saw: the design effect is taken at a bound that it seldom exceeds, and
never as more than one sample of chance to ten, nor as less than chance, which nets are not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import beta, chi2

from models.errors import ParameterError
from models.show import short_repr
from noise.screening.parts.estimate import Estimate
from noise.screening.parts.sampling import Distribution, parts, sobol_points

NOISES = ("creak", "squawk", "squeal", "none")

_SCRAMBLINGS = 32
_FIRST = 2
"""Samples of each scrambling before the first look."""

_BOUND = 0.1
"""How often the design effect exceeds what it is taken as."""

_LEAST_EFFECT = 0.1


@short_repr
@dataclass(frozen=True, eq=False)
class Probabilities:
    """How probable each label is, each with its own interval.

    Parameters
    ----------
    by_label : mapping of str to Estimate
    samples : int
        Parts that were looked at.
    confidence : float
        That an interval holds the true probability [-].
    reached : bool
        Whether all intervals are as narrow as was asked for.
    """

    by_label: Mapping[str, Estimate]
    samples: int
    confidence: float
    reached: bool

    @property
    def half_width(self) -> float:
        """Of the widest interval [-]."""
        return max(estimate.half_width for estimate in self.by_label.values())

    def any_but(self, label: str = "none") -> Estimate:
        """Probability of all labels but one: by default, that there is noise.

        Examples
        --------
        >>> silent = Estimate(0.75, 0.5, 1.0)
        >>> Probabilities({"none": silent}, 64, 0.95, reached=True).any_but()
        Estimate(value=0.25, low=0.0, high=0.5)
        """
        one = self.by_label[label]
        return Estimate(1.0 - one.value, 1.0 - one.high, 1.0 - one.low)


def label_probabilities(
    labels_of: Callable[[NDArray[np.float64]], ArrayLike],
    distributions: Mapping[str, Distribution],
    rng: np.random.Generator,
    *,
    labels: Sequence[str] = NOISES,
    half_width: float = 0.05,
    confidence: float = 0.95,
    most: int = 8192,
) -> Probabilities:
    """Estimate how probable each label is among parts that vary.

    Parameters
    ----------
    labels_of : callable
        Of parameters, shape (n, d), a row per part; returns n labels.
    distributions : mapping of str to Distribution, length d
    rng : numpy.random.Generator
        Of the scramblings.
    labels : sequence of str
        To be told of even if no part has them; others are told of once they occur.
    half_width : float
        Of each interval, at most [-].
    confidence : float
        Of each interval, from 0 to 1 [-].
    most : int
        Parts to look at, at most; from 64 on they double.

    Returns
    -------
    Probabilities

    Raises
    ------
    ParameterError
        If a value cannot be used, or the callable returns another number of labels than parts.

    Examples
    --------
    >>> from scipy.stats import norm
    >>> def creaks_when_soft(parts):
    ...     return np.where(parts[:, 0] < 0.95, "creak", "none")
    >>> found = label_probabilities(
    ...     creaks_when_soft, {"stiffness": norm(1.0, 0.05)}, np.random.default_rng(0)
    ... )
    >>> round(found.by_label["creak"].value, 2), found.samples, found.reached
    (0.16, 256, True)
    """
    if not (0.0 < half_width < 0.5 and 0.0 < confidence < 1.0):
        raise ParameterError(
            f"probabilities: half_width = {half_width:g} must lie between 0 and 0.5, "
            f"confidence = {confidence:g} between 0 and 1"
        )
    if most < _SCRAMBLINGS * _FIRST:
        raise ParameterError(
            f"probabilities: most = {most} must be {_SCRAMBLINGS * _FIRST} or more"
        )
    sequences = [sobol_points(len(distributions), rng) for _ in range(_SCRAMBLINGS)]
    seen = np.empty((_SCRAMBLINGS, 0), dtype=object)
    while True:
        new = max(seen.shape[1], _FIRST)
        points = np.concatenate([sequence.random(new) for sequence in sequences])
        found = np.asarray(labels_of(parts(distributions, points)), dtype=object)
        if found.shape != (len(points),):
            raise ParameterError(
                f"probabilities: {len(points)} parts got labels of shape {found.shape}"
            )
        seen = np.hstack([seen, found.reshape(_SCRAMBLINGS, new)])
        labels = (*dict.fromkeys([*labels, *sorted({str(label) for label in found})]),)
        estimates = {label: _estimate(seen == label, confidence) for label in labels}
        reached = all(estimate.half_width <= half_width for estimate in estimates.values())
        if reached or 2 * seen.size > most:
            return Probabilities(estimates, seen.size, confidence, reached)


def _estimate(hits: NDArray[np.bool_], confidence: float) -> Estimate:
    """Share of hits and its interval; `hits` has a row per scrambling."""
    share = float(hits.mean())
    samples = hits.size / _design_effect(hits)
    inside, outside = share * samples, (1.0 - share) * samples
    tail = 0.5 - 0.5 * confidence
    low = float(beta.ppf(tail, inside, outside + 1.0)) if inside > 0.0 else 0.0
    high = float(beta.ppf(1.0 - tail, inside + 1.0, outside)) if outside > 0.0 else 1.0
    return Estimate(share, low, high)


def _design_effect(hits: NDArray[np.bool_]) -> float:
    """Variance of the share between scramblings over that of as many samples of chance."""
    share = float(hits.mean())
    chance = share * (1.0 - share) / hits.shape[1]
    if chance == 0.0:
        return 1.0
    freedom = len(hits) - 1
    bound = float(hits.mean(axis=1).var(ddof=1)) * freedom / float(chi2.ppf(_BOUND, freedom))
    return float(min(max(bound / chance, _LEAST_EFFECT), 1.0))
