"""Numbers that come from elsewhere than stick-slip: a static test, a ring-down.

They join what the recordings of stick-slip said, each weighted by how sure it is (inverse
variances of logarithms).
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from noise.base import SURE_90
from noise.identification.outcome import Number

UNITS = {
    "elastomer_stiffness": "Nm/rad",
    "damping": "Nm s/rad",
    "critical_torque": "Nm",
    "kinetic_torque": "Nm",
    "elastomer_inertia": "kg m2",
    "clamp_inertia": "kg m2",
}
"""Of the numbers that there may be evidence of."""

_USUAL_SCATTER = 0.02
"""Relative standard deviation of a bushing's numbers from run to run; assumed, as wherever repeats
are simulated."""

_DEGREES = 4.0
"""So many differences the usual scatter counts as; assumed."""


@dataclass(frozen=True)
class Evidence:
    """A number of the rig from one source.

    Parameters
    ----------
    name : str
        Of `UNITS`.
    value : float
        [as `UNITS` says]
    error : float
        Relative standard error [-].
    interference : float, optional
        [m]
    support_stiffness : float, optional
        [Nm/rad]
    source : str
        File.
    """

    name: str
    value: float
    error: float
    interference: float | None = None
    support_stiffness: float | None = None
    source: str = ""


def elastomer_stiffness(effective: float, support_stiffness: float) -> tuple[float, float]:
    """Stiffness of the elastomer behind an effective one, (3.1) with its sign put right.

    Parameters
    ----------
    effective, support_stiffness : float
        [Nm/rad]

    Returns
    -------
    stiffness : float
        [Nm/rad]; infinite where the supports alone are softer.
    gain : float
        By which a relative error of the effective stiffness grows [-].

    Examples
    --------
    >>> [round(x, 2) for x in elastomer_stiffness(511.4, 2214.0)]
    [665.01, 1.3]
    """
    flexible = 1.0 / effective - 1.0 / support_stiffness
    if flexible <= 0.0:
        return math.inf, math.inf
    return 1.0 / flexible, 1.0 / (flexible * effective)


def with_evidence(numbers: Sequence[Number], evidence: Iterable[Evidence]) -> list[Number]:
    """Let evidence join numbers of the same name and place, and add those that are new.

    Parameters
    ----------
    numbers : sequence of Number
    evidence : iterable of Evidence

    Returns
    -------
    list of Number

    Examples
    --------
    >>> slips = Number("elastomer_stiffness", "Nm/rad", 600.0, 540.0, 666.0, 6, 0.279e-3)
    >>> (both,) = with_evidence(
    ...     [slips], [Evidence("elastomer_stiffness", 660.0, 0.005, 0.279e-3)])
    >>> round(both.value), both.n_recordings
    (651, 7)
    """
    groups: dict[tuple[str, float | None, float | None], list[tuple[float, float]]]
    groups = defaultdict(list)
    for one in evidence:
        key = one.name, one.interference, one.support_stiffness
        groups[key].append((one.value, one.error))
    joined = []
    for number in numbers:
        key = number.name, number.interference, number.support_stiffness
        said = groups.pop(key, None)
        joined.append(number if said is None else _joined(number, _alone(key, said)))
    return joined + [_alone(key, said) for key, said in groups.items()]


def _alone(
    key: tuple[str, float | None, float | None], said: list[tuple[float, float]]
) -> Number:  # fmt: skip
    """Put together what was said of one number; runs scatter as usual, and as these do."""
    from scipy.stats import t as student

    name, interference, support = key
    x, error = np.log([value for value, _ in said]), np.array([error for _, error in said])
    weight = 1.0 / (_USUAL_SCATTER**2 + error**2)
    centre = float(weight @ x / weight.sum())
    degrees = _DEGREES + x.size - 1
    squares = _DEGREES * _USUAL_SCATTER**2 + float(weight @ (x - centre) ** 2 / weight.mean())
    scatter = math.sqrt(squares / degrees * float(weight @ weight)) / float(weight.sum())
    stated = math.sqrt(1.0 / float(np.sum(error**-2.0)))
    half = float(student.ppf(0.95, degrees)) * math.hypot(scatter, stated)
    low, value, high = (math.exp(centre + side * half) for side in (-1.0, 0.0, 1.0))
    return Number(name, UNITS[name], value, low, high, x.size, interference, support)


def _joined(one: Number, other: Number) -> Number:
    weights = [(0.5 * math.log(n.high / n.low) / SURE_90) ** -2 for n in (one, other)]
    centre = sum(
        w * math.log(n.value) for w, n in zip(weights, (one, other), strict=True)
    ) / sum(weights)  # fmt: skip
    error = math.sqrt(1.0 / sum(weights))
    # two that contradict each other are less sure than either says
    apart = math.log(one.value / other.value)
    error *= max(1.0, abs(apart) / (SURE_90 * math.sqrt(1.0 / weights[0] + 1.0 / weights[1])))
    low, high = (math.exp(centre + side * SURE_90 * error) for side in (-1.0, 1.0))
    return replace(
        one, value=math.exp(centre), low=low, high=high,
        n_recordings=one.n_recordings + other.n_recordings,
    )  # fmt: skip
