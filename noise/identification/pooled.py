"""Numbers of single recordings put together: a mean of logarithms, and how sure it is.

A rig is never quite the same twice, so that what one recording says for certain is wrong of the
next by some per cent. How much, all groups of recordings tell together: what they differ by within
a group, and beside it, as a few degrees of freedom, what bushings usually differ by.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["LEVEL", "NORMAL", "USUAL_SCATTER", "Pooled", "pool"]

Key = TypeVar("Key")

LEVEL = 0.9
"""Of the intervals."""

NORMAL = 1.645
"""Of a normal distribution, so many standard deviations on either side hold that."""

USUAL_SCATTER = 0.02
"""Relative standard deviation of a bushing's numbers from run to run, as `Scatter` has it."""

_DEGREES = 4.0
"""So many differences the usual scatter counts as."""


@dataclass(frozen=True)
class Pooled:
    """A number with its 90 % interval.

    Parameters
    ----------
    value, low, high : float
        [unit of what was pooled]
    n : int
        Recordings it comes from.
    """

    value: float
    low: float
    high: float
    n: int


def pool(
    groups: Mapping[Key, Sequence[tuple[float, float]]],
    *,
    usual: float = USUAL_SCATTER,
    shared: float = 0.0,
) -> dict[Key, Pooled]:
    """Put together positive numbers of single recordings.

    Parameters
    ----------
    groups : mapping of hashable to sequence of (float, float)
        Of one kind of number: for each group its values and their relative standard errors.
    usual : float
        Relative scatter from run to run that is expected [-].
    shared : float
        Relative standard error that all values have in common [-].

    Returns
    -------
    dict of hashable to Pooled

    Examples
    --------
    >>> found = pool({"a": [(100.0, 0.01), (104.0, 0.01)], "b": [(50.0, 0.01)]})
    >>> round(found["a"].value, 1), found["b"].low < 50.0 < found["b"].high
    (102.0, True)
    """
    from scipy.stats import t as student

    squares, degrees = _DEGREES * usual**2, _DEGREES
    centres: dict[Key, tuple[float, float, int]] = {}
    for key, values in groups.items():
        x = np.log([value for value, _ in values])
        error = np.minimum([e for _, e in values], 1.0)
        weight = 1.0 / (usual**2 + error**2)
        centre = float(np.sum(weight * x) / np.sum(weight))
        squares += float(np.sum(weight * (x - centre) ** 2) / np.mean(weight))
        degrees += x.size - 1
        centres[key] = (centre, float(np.sum(weight) ** 2 / np.sum(weight**2)), x.size)
    spread = math.sqrt(squares / degrees)
    times = float(student.ppf(0.5 + 0.5 * LEVEL, degrees))
    found = {}
    for key, (centre, effective, n) in centres.items():
        half = times * math.hypot(spread / math.sqrt(effective), shared)
        found[key] = Pooled(math.exp(centre), math.exp(centre - half), math.exp(centre + half), n)
    return found
