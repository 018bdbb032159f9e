"""Search for the smallest change of each of several parameters that does what is wanted.

Whether a change does it may go to and fro, as stick does with the phase of the clamp. So all of
each range is tried first, coarsely; then the innermost bracket of a value that does it and one
that does not is halved. All parameters go in one call, which can share them out among cores.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
