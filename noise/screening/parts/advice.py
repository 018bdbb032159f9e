"""Advice: the smallest change of each design variable that widens the margin or removes a noise.

Margins jump, so a slope at the nominal design misleads; what a change brings is simulated where it
is advised. One parameter is changed at a time: what two changes do together is not told.

Search for the smallest change of each of several parameters that does what is wanted.

Whether a change does it may go to and fro, as stick does with the phase of the clamp. So all of
each range is tried first, coarsely; then the innermost bracket of a value that does it and one
that does not is halved. All parameters go in one call, which can share them out among cores.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.errors import ParameterError

if TYPE_CHECKING:
    from noise.screening.parts.design_variable import DesignVariable

_TRIED = 8
"""Values on either side of the nominal one in the first call."""

_HALVINGS = 5
"""Of a bracket between two of them: to a 256th of the way to the end of the range."""


@dataclass(frozen=True)
class Found:
    """A value of one parameter.

    Parameters
    ----------
    value : float
        In the unit of the parameter, such as [-] of a factor.
    score : float
        What it scores [-].
    enough : bool
        Whether that is as wanted; otherwise it is the best of those tried.
    steady : bool
        Whether the next larger change that was tried scores as wanted, too.
    """

    value: float
    score: float
    enough: bool
    steady: bool


@dataclass(frozen=True)
class _Bracket:
    """Two values of one parameter, of which the outer one is enough and the inner one is not."""

    index: int
    inner: float
    outer: float
    score: float
    steady: bool

    @property
    def middle(self) -> float:
        return 0.5 * (self.inner + self.outer)

    def halved(self, score: float, wanted: float) -> _Bracket:
        if score >= wanted:
            return _Bracket(self.index, self.inner, self.middle, score, self.steady)
        return _Bracket(self.index, self.middle, self.outer, self.score, self.steady)


def smallest_changes(
    scores_of: Callable[[Sequence[tuple[int, float]]], NDArray[np.float64]],
    ranges: Sequence[tuple[float, float, float]],
    wanted: float,
) -> list[Found]:
    """Find the smallest change of each parameter that scores as wanted.

    Parameters
    ----------
    scores_of : callable
        Of n changes, each the index of a parameter and its value; returns n numbers.
    ranges : sequence of (float, float, float)
        The least value of each parameter, its nominal one and the largest, in its unit, such as
        [-] of a factor.
    wanted : float
        Least score that is enough.

    Returns
    -------
    list of Found
        One a parameter. If the nominal design is enough it is the nominal value, and if nothing
        is, the best of the values that were tried.

    Examples
    --------
    >>> def square(changes):
    ...     return np.array([value**2 for _, value in changes])
    >>> [found] = smallest_changes(square, [(-4.0, 1.0, 8.0)], 9.0)
    >>> round(found.value, 1), found.enough
    (3.0, True)
    """
    sides = [
        (index, np.linspace(nominal, end, _TRIED + 1))
        for index, (low, nominal, high) in enumerate(ranges)
        for end in (low, high)
    ]
    tried = [(index, float(value)) for index, values in sides for value in values]
    scores = scores_of(tried).reshape(len(sides), _TRIED + 1)
    brackets = [
        _bracket(index, values, row, wanted)
        for (index, values), row in zip(sides, scores, strict=True)
        if row[0] < wanted and (row >= wanted).any()
    ]
    for _ in range(_HALVINGS if brackets else 0):
        halved = scores_of([(bracket.index, bracket.middle) for bracket in brackets])
        brackets = [
            bracket.halved(float(score), wanted)
            for bracket, score in zip(brackets, halved, strict=True)
        ]
    found = []
    for index, (_, nominal, _) in enumerate(ranges):
        ends = [bracket for bracket in brackets if bracket.index == index]
        if ends:
            end = min(ends, key=lambda one: abs(one.outer - nominal))
            found.append(Found(end.outer, end.score, True, end.steady))
            continue
        seen = zip(tried, scores.flat, strict=True)
        own = [(float(score), value) for (i, value), score in seen if i == index]
        enough = own[0][0] >= wanted
        score, value = own[0] if enough else max(own, key=lambda one: one[0])
        found.append(Found(value, score, enough, enough))
    return found


def _bracket(
    index: int, values: NDArray[np.float64], scores: NDArray[np.float64], wanted: float
) -> _Bracket:
    """Innermost bracket on one side; `values` go outwards."""
    outer = int(np.argmax(scores >= wanted))
    beyond = min(outer + 1, len(values) - 1)
    return _Bracket(
        index,
        float(values[outer - 1]),
        float(values[outer]),
        float(scores[outer]),
        bool(scores[beyond] >= wanted),
    )


_SMALL = 0.02
"""Change, as a share of the nominal value, on either side over which a slope is taken."""


@dataclass(frozen=True)
class Advice:
    """One change and what it brings.

    Parameters
    ----------
    name : str
        Of the parameter.
    value : float
        To set it to, in the unit of the design variable, such as [-] of a factor.
    change : float
        From the nominal value, as a share of it [-].
    cost : float
        In the unit of the design variable's cost, any that all share [-].
    enough : bool
        Whether it brings what was asked for; otherwise it is what serves best within the range.
    steady : bool
        Whether a somewhat larger change brings it as well; otherwise it stands on an island.
    gain : float
        Margin gained by it, in the margin's unit, such as [rad/s]; NaN where no margin was asked
        for.
    slope : float
        Margin gained by small changes, over the change as a share of the nominal value; NaN where
        no margin was asked for, or where it is infinite close by.
    label : str
        Noise with the change; empty where none was asked for.
    """

    name: str
    value: float
    change: float
    cost: float
    enough: bool
    steady: bool
    gain: float = math.nan
    slope: float = math.nan
    label: str = ""


def increase_margin(
    margin_of: Callable[[NDArray[np.float64]], ArrayLike],
    variables: Sequence[DesignVariable],
    gain: float,
    *,
    budget: float = math.inf,
) -> tuple[Advice, ...]:
    """Find the smallest change of each parameter that widens a margin by `gain`.

    Parameters
    ----------
    margin_of : callable
        Of parameters, shape (n, d), a row per design; returns n margins, which may be infinite.
    variables : sequence of DesignVariable, length d
    gain : float
        By which the margin shall grow, above 0, in its unit, such as [rad/s].
    budget : float
        That no change may cost more than, in the unit of the costs [-].

    Returns
    -------
    tuple of Advice
        One a variable: those that bring enough first, the cheapest first; then the others, by what
        they bring.

    Raises
    ------
    ParameterError
        If a value cannot be used, or the margin is infinite as it is.

    Examples
    --------
    >>> from noise.screening.parts.design_variable import DesignVariable
    >>> variables = [DesignVariable("damping", 0.5, 2.0), DesignVariable("stiffness", 0.9, 1.1)]
    >>> best, other = increase_margin(lambda x: 4.0 * x[:, 0] - x[:, 1], variables, 1.0)
    >>> best.name, round(best.value, 2), round(best.gain, 1), best.enough
    ('damping', 1.25, 1.0, True)
    >>> other.name, round(other.value, 2), round(other.gain, 1), other.enough
    ('stiffness', 0.9, 0.1, False)
    """
    if not 0.0 < gain < math.inf:
        raise ParameterError(f"advice: gain = {gain:g} must be above 0 and finite")
    ranges = _ranges(variables, budget)
    small = [
        (index, min(max(nominal + side * _SMALL * abs(nominal), low), high))
        for index, (low, nominal, high) in enumerate(ranges)
        for side in (-1.0, 1.0)
    ]
    now, *around = _margins(margin_of, variables, [(0, variables[0].nominal), *small])
    if math.isinf(now):
        raise ParameterError("advice: the margin is infinite as it is; there is nothing to widen")

    def gains(changes: Sequence[tuple[int, float]]) -> NDArray[np.float64]:
        return np.asarray(_margins(margin_of, variables, changes) - now)

    advice = []
    for i, found in enumerate(smallest_changes(gains, ranges, gain)):
        slope = _slope(small[2 * i : 2 * i + 2], around[2 * i : 2 * i + 2], variables[i].nominal)
        advice.append(_advice(variables[i], found, gain=found.score, slope=slope))
    return tuple(sorted(advice, key=_order))


def remove_noise(
    label_of: Callable[[NDArray[np.float64]], ArrayLike],
    variables: Sequence[DesignVariable],
    noises: Collection[str],
    *,
    budget: float = math.inf,
) -> tuple[Advice, ...]:
    """Find the smallest change of each parameter that removes a noise.

    Parameters
    ----------
    label_of : callable
        Of parameters, shape (n, d), a row per design; returns n labels.
    variables : sequence of DesignVariable, length d
    noises : collection of str
        The labels that shall not be.
    budget : float
        That no change may cost more than, in the unit of the costs [-].

    Returns
    -------
    tuple of Advice
        As of `increase_margin`, with the label in place of a gain; a change of 0 if there is none
        of these noises as it is.

    Raises
    ------
    ParameterError
        If a value cannot be used.

    Examples
    --------
    >>> from noise.screening.parts.design_variable import DesignVariable
    >>> variables = [DesignVariable("damping", 0.5, 2.0)]
    >>> def label_of(designs):
    ...     return np.where(designs[:, 0] < 1.3, "creak", "none")
    >>> [found] = remove_noise(label_of, variables, {"creak"})
    >>> round(found.value, 2), found.label, found.enough
    (1.3, 'none', True)
    """
    if not noises:
        raise ParameterError("advice: no noise to end is named")

    def labels(changes: Sequence[tuple[int, float]]) -> NDArray[np.object_]:
        return _called(label_of, variables, changes, object)

    def quiet(changes: Sequence[tuple[int, float]]) -> NDArray[np.float64]:
        return np.array([0.0 if label in noises else 1.0 for label in labels(changes)])

    found = smallest_changes(quiet, _ranges(variables, budget), 1.0)
    after = labels([(index, one.value) for index, one in enumerate(found)])
    advice = [
        _advice(variable, one, label=str(label))
        for variable, one, label in zip(variables, found, after, strict=True)
    ]
    return tuple(sorted(advice, key=_order))


def _slope(changes: Sequence[tuple[int, float]], margins: Sequence[float], nominal: float) -> float:
    run = (changes[1][1] - changes[0][1]) / abs(nominal)
    if run == 0.0 or not all(map(math.isfinite, margins)):
        return math.nan
    return float((margins[1] - margins[0]) / run)


def _advice(variable: DesignVariable, found: Found, **brought: Any) -> Advice:
    return Advice(
        name=variable.name,
        value=found.value,
        change=found.value / variable.nominal - 1.0,
        cost=variable.price(found.value),
        enough=found.enough,
        steady=found.steady,
        **brought,
    )


def _order(advice: Advice) -> tuple[bool, float, float, str]:
    brought = 0.0 if advice.enough or math.isnan(advice.gain) else advice.gain
    return not advice.enough, -brought, advice.cost, advice.name


def _ranges(variables: Sequence[DesignVariable], budget: float) -> list[tuple[float, float, float]]:
    """Least, nominal and largest value of each variable."""
    if not variables:
        raise ParameterError("advice: there is no design variable")
    if not budget > 0.0:
        raise ParameterError(f"advice: budget = {budget:g} must be above 0")
    within = [variable.within(budget) for variable in variables]
    return [
        (low, variable.nominal, high)
        for variable, (low, high) in zip(variables, within, strict=True)
    ]


def _margins(
    margin_of: Callable[[NDArray[np.float64]], ArrayLike],
    variables: Sequence[DesignVariable],
    changes: Sequence[tuple[int, float]],
) -> NDArray[np.float64]:
    margins: NDArray[np.float64] = _called(margin_of, variables, changes, np.float64)
    if np.isnan(margins).any():
        raise ParameterError("advice: a margin is not a number")
    return margins


def _called(
    call: Callable[[NDArray[np.float64]], ArrayLike],
    variables: Sequence[DesignVariable],
    changes: Sequence[tuple[int, float]],
    kind: type,
) -> NDArray[Any]:
    """Results for designs with one variable changed each."""
    designs = np.tile([variable.nominal for variable in variables], (len(changes), 1))
    for design, (index, value) in zip(designs, changes, strict=True):
        design[index] = value
    found: NDArray[Any] = np.asarray(call(designs), dtype=kind)
    if found.shape != (len(designs),):
        raise ParameterError(f"advice: {len(designs)} designs got results of shape {found.shape}")
    return found
