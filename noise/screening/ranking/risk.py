"""Risk number of a design, from 1 to 10 as the field grades stick-slip, and the ranking by it.

Taken from the field: stick-slip of a pair of materials is graded from 1 to 10, 10 being worst
(VDA 230-206), and specifications read the grade in three bands: 1 to 3 no risk, 4 and 5 at risk
under conditions, 6 to 10 at risk. The grade grows with the acceleration of the blows, with how
many there are on the way, and with static over kinetic friction. That test is of flat specimens,
one of them on a leaf spring, and its arithmetic is not used here.

Our own is all of the arithmetic: a grade for each of the three between the anchors below, which
are round numbers and not measured against any test; and their weighted geometric mean, half of it
acceleration, so that a contact that does not vibrate stays free of risk whatever its friction. The
number is good for comparing designs within this simulator. It is not the number that a test of the
same materials would give.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.errors import ParameterError

if TYPE_CHECKING:
    from noise.screening.parts.estimate import Estimate


_ACCELERATION = 1.0, 1000.0
"""Peaks graded 1 and 10, at the accelerometer [m/s2]; decades between count alike."""

_IMPULSES = 1.0, 1000.0
"""Impulses on the way graded 1 and 10 [1/rad]; likewise."""

_RATIO = 1.0, 2.0
"""Static over kinetic friction graded 1 and 10."""

_WEIGHTS = 0.5, 0.25, 0.25
"""Of the three grades, in this order."""

_BANDS = ((3, "no risk"), (5, "conditional"), (10, "risk"))


def risk_grades(
    acceleration: ArrayLike, impulse_rate: ArrayLike, friction_ratio: ArrayLike
) -> NDArray[np.float64]:
    """Grade conditions from 1 to 10.

    Parameters
    ----------
    acceleration : array_like
        Peak magnitude [m/s2], 0 or more.
    impulse_rate : array_like
        Slips, or periods of a vibration without stick, on the way of the shaft [1/rad].
    friction_ratio : array_like
        Static over kinetic friction, 1 or more [-]. They are broadcast against each other.

    Returns
    -------
    ndarray, shape of the arguments
        From 1 to 10 [-], not rounded.

    Raises
    ------
    ParameterError
        If a value is out of its range or no number.

    Examples
    --------
    A creak, a squeal of 900 Hz at 10 rad/s, and steady sliding of the same material:

    >>> risk_grades([600.0, 30.0, 0.0], [130.0, 90.0, 0.0], 1.5).round(1)
    array([7.7, 5.8, 1.5])
    """
    given = {
        "acceleration": (acceleration, 0.0),
        "impulse rate": (impulse_rate, 0.0),
        "friction ratio": (friction_ratio, 1.0),
    }
    values = []
    for name, (value, least) in given.items():
        values.append(np.asarray(value, dtype=np.float64))
        if not (values[-1] >= least).all():
            raise ParameterError(f"risk: {name} must be {least:g} or more everywhere")
    grades = (
        _grade(np.log(np.maximum(values[0], _ACCELERATION[0])), *np.log(_ACCELERATION)),
        _grade(np.log(np.maximum(values[1], _IMPULSES[0])), *np.log(_IMPULSES)),
        _grade(values[2], *_RATIO),
    )
    mean = sum(w * np.log(grade) for w, grade in zip(_WEIGHTS, grades, strict=True))
    return np.asarray(np.exp(mean))


def design_risk(
    grades: ArrayLike, weights: ArrayLike | None = None, *, beyond: float = 0.05
) -> int:
    """Risk number of a design: the grade that little of its use exceeds.

    Parameters
    ----------
    grades : array_like
        Of conditions of use, and of parts if they scatter.
    weights : array_like, optional
        How much each counts, shaped as `grades`; by default alike.
    beyond : float
        Share of the use that may be graded worse [-]; the very worst is often a single condition
        between others that are quiet.

    Returns
    -------
    int
        From 1 to 10, a half rounded up.

    Raises
    ------
    ParameterError
        If there are no grades, a grade or weight cannot be used, or `beyond` is no share.

    Examples
    --------
    >>> design_risk([1.2] * 97 + [8.0] * 3), design_risk([1.2] * 90 + [8.0] * 10)
    (1, 8)
    """
    graded = np.asarray(grades, dtype=np.float64).ravel()
    counts = np.ones(graded.size) if weights is None else np.asarray(weights, np.float64).ravel()
    if not graded.size or not ((graded >= 1.0) & (graded <= 10.0 + 1e-9)).all():
        raise ParameterError("risk: grades must be numbers from 1 to 10, one at least")
    if counts.shape != graded.shape or not ((counts >= 0.0) & np.isfinite(counts)).all():
        raise ParameterError("risk: there must be one weight a grade, 0 or more")
    if not (0.0 <= beyond < 1.0 and counts.sum() > 0.0):
        raise ParameterError(
            f"risk: beyond = {beyond:g} must be a share below 1, and some weight be above 0"
        )
    order = np.argsort(-graded, kind="stable")
    worse = np.cumsum(counts[order])
    first = int(np.argmax(worse > beyond * counts.sum() * (1.0 + 1e-12)))
    return math.floor(float(graded[order][first]) + 0.5)


def risk_band(number: int) -> str:
    """Return how specifications read a risk number.

    Raises
    ------
    ParameterError
        If it is not from 1 to 10.

    Examples
    --------
    >>> [risk_band(number) for number in (1, 4, 6)]
    ['no risk', 'conditional', 'risk']
    """
    if not 1 <= number <= 10:
        raise ParameterError(f"risk number {number} must be from 1 to 10")
    return next(band for last, band in _BANDS if number <= last)


@dataclass(frozen=True)
class Candidate:
    """A design as the ranking sees it.

    Parameters
    ----------
    name : str
    risk : int
        From 1 to 10.
    noise : Estimate
        Probability of any noise among parts [-].
    margin : float
        Of the use to what vibrates [rad/s]; NaN if it is not known.
    """

    name: str
    risk: int
    noise: Estimate
    margin: float


def ranked(candidates: Sequence[Candidate]) -> dict[str, int]:
    """Rank designs by risk, then by probability of noise, then by margin.

    Probabilities are tied with the least of their group if they exceed it by no more than the
    half-width of the wider interval: what the samples cannot tell decides nothing. Whose margin is
    not known comes after those whose is.

    Parameters
    ----------
    candidates : sequence of Candidate

    Returns
    -------
    dict of str to int
        Ranks by name, 1 being the quietest, who comes first; who cannot be told apart share one,
        and stand by their names.

    Examples
    --------
    >>> from noise.screening.parts.estimate import Estimate
    >>> some, few = Estimate(0.4, 0.35, 0.45), Estimate(0.38, 0.33, 0.43)
    >>> ranked([Candidate("soft", 4, few, -2.0), Candidate("stiff", 4, some, 1.0)])
    {'stiff': 1, 'soft': 2}
    """
    keys: list[tuple[tuple[int, float], str]] = []
    group, least = 0, None
    for candidate in sorted(candidates, key=lambda one: (one.risk, one.noise.value)):
        if least is None or candidate.risk != least.risk or _noisier(candidate, least):
            group, least = group + 1, candidate
        margin = -math.inf if math.isnan(candidate.margin) else candidate.margin
        keys.append(((group, -margin), candidate.name))
    keys.sort()
    order = [key for key, _ in keys]
    return {name: 1 + order.index(key) for key, name in keys}


def _noisier(one: Candidate, other: Candidate) -> bool:
    width = max(one.noise.half_width, other.noise.half_width)
    return one.noise.value - other.noise.value > width


def _grade(value: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
    return np.asarray(1.0 + 9.0 * np.clip((value - low) / (high - low), 0.0, 1.0))
