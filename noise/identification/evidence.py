"""Numbers of a rig from static tests and ring-downs, combined with those of stick-slip.

Static tests give the stiffness of the elastomer, ring-downs the damping and the inertia of the
clamp. They are combined with weights that are inverse variances of the logarithms.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from noise.base import SURE_90
from noise.identification.bushing_fit import Known
from noise.identification.outcome import UNITS, Number
from noise.identification.static_test import StaticTest

_USUAL_SCATTER = 0.02
"""Relative standard deviation of a bushing's numbers from run to run; assumed, as for simulated
repeats."""

_DEGREES = 4.0
"""Degrees of freedom of the usual scatter; assumed."""

_SUPPORT_ERROR = 0.01
"""Relative standard error of a stated support stiffness [-]; assumed."""

_Place = tuple[str, float | None, float | None]


@dataclass(frozen=True)
class Evidence:
    """Number of the rig from one source.

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
    """Return the elastomer's stiffness from that of elastomer and support in series, (3.1).

    Parameters
    ----------
    effective, support_stiffness : float
        [Nm/rad]

    Returns
    -------
    stiffness : float
        [Nm/rad]; infinite if the support alone is softer than both.
    gain : float
        Factor from the relative error of the effective stiffness to its own [-].

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
    """Combine numbers with evidence of the same name and place, and append the other evidence.

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
    groups: dict[_Place, list[Evidence]] = defaultdict(list)
    for one in evidence:
        groups[one.name, one.interference, one.support_stiffness].append(one)
    alone = {place: _alone(place, group) for place, group in groups.items()}
    joined = []
    for number in numbers:
        other = alone.pop((number.name, number.interference, number.support_stiffness), None)
        joined.append(number if other is None else _joined(number, other))
    return [*joined, *alone.values()]


def _alone(place: _Place, group: Sequence[Evidence]) -> Number:
    """Return the weighted mean of evidence, with Student's interval of its scatter."""
    from scipy.stats import t as student

    x, error = np.log([one.value for one in group]), np.array([one.error for one in group])
    weight = 1.0 / (_USUAL_SCATTER**2 + error**2)
    centre = float(weight @ x / weight.sum())
    degrees = _DEGREES + x.size - 1
    squares = _DEGREES * _USUAL_SCATTER**2 + float(weight @ (x - centre) ** 2 / weight.mean())
    scatter = math.sqrt(squares / degrees * float(weight @ weight)) / float(weight.sum())
    stated = math.sqrt(1.0 / float(np.sum(error**-2.0)))
    half = float(student.ppf(0.95, degrees)) * math.hypot(scatter, stated)
    low, value, high = (math.exp(centre + side * half) for side in (-1.0, 0.0, 1.0))
    name, interference, support = place
    return Number(name, UNITS[name], value, low, high, x.size, interference, support)


def _joined(one: Number, other: Number) -> Number:
    weights = [(0.5 * math.log(n.high / n.low) / SURE_90) ** -2 for n in (one, other)]
    centre = sum(
        w * math.log(n.value) for w, n in zip(weights, (one, other), strict=True)
    ) / sum(weights)  # fmt: skip
    error = math.sqrt(1.0 / sum(weights))
    # a contradiction widens the interval
    apart = math.log(one.value / other.value)
    error *= max(1.0, abs(apart) / (SURE_90 * math.sqrt(1.0 / weights[0] + 1.0 / weights[1])))
    low, high = (math.exp(centre + side * SURE_90 * error) for side in (-1.0, 1.0))
    return replace(
        one, value=math.exp(centre), low=low, high=high,
        n_recordings=one.n_recordings + other.n_recordings,
    )  # fmt: skip


def static_evidence(
    tests: Sequence[StaticTest], known: Known, *, sticks: bool = False
) -> tuple[Evidence, ...]:
    """Return the numbers of the rig that static tests and ring-downs give.

    Parameters
    ----------
    tests : sequence of StaticTest
    known : Known
        Prior inertia of the clamp, and how the damping is shared.
    sticks : bool
        Whether the contact is known to stick; otherwise hysteresis is taken to be its yielding.

    Returns
    -------
    tuple of Evidence
        Stiffness of the elastomer by interference; damping and inertia of the clamp of ring-downs.
    """
    evidence, yields = [], {}
    parted = {one.interference for one in tests if not one.elastic}
    for one in tests:
        own = sticks or one.elastic
        if one.elastic and one.branches == 1 and one.interference in parted and not sticks:
            continue  # without unloading, hysteresis does not show
        effective = one.effective_stiffness if own else one.held_stiffness
        value, gain = elastomer_stiffness(effective, one.support_stiffness)
        if math.isinf(value):
            continue
        error = gain * (one.error if own else one.held_error)
        evidence.append(
            Evidence("elastomer_stiffness", value, error, one.interference, None, one.name)
        )
        series, _ = elastomer_stiffness(one.effective_stiffness, one.support_stiffness)
        yields[one.interference] = 1.0 if own else min(series / value, 1.0)
    for one in tests:
        of_fit = [
            e
            for e in evidence
            if e.interference == one.interference and e.name == "elastomer_stiffness"
        ]
        if one.ring_down is not None and of_fit and math.isfinite(one.support_stiffness):
            evidence += _of_ring_down(one, of_fit, yields[one.interference], known)
    return tuple(evidence)


def _of_ring_down(
    test: StaticTest, stiffness: Sequence[Evidence], yields: float, known: Known
) -> tuple[Evidence, Evidence]:
    """Return the clamp's inertia and the damping from a ring-down.

    `yields` is the stiffness of elastomer and contact in series over that of the elastomer [-].
    """
    ring, support = test.ring_down, test.support_stiffness
    assert ring is not None
    elastomer = yields * math.exp(float(np.mean(np.log([one.value for one in stiffness]))))
    both = support + elastomer
    by_ring = both / (2.0 * math.pi * ring.frequency) ** 2
    of_stiffness = elastomer / both * max(one.error for one in stiffness)
    error = math.hypot(2.0 * ring.frequency_error, of_stiffness, _SUPPORT_ERROR)
    weights = error**-2, known.inertia_error**-2
    inertia = math.exp(
        (weights[0] * math.log(by_ring) + weights[1] * math.log(known.clamp_inertia)) / sum(weights)
    )
    # the elastomer twists by less than the clamp turns if the contact yields
    acting = 1.0 - known.damping_share + known.damping_share * yields**2
    damping_error = math.hypot(ring.decay_error, math.sqrt(1.0 / sum(weights)))
    damping = 2.0 * inertia * ring.decay / acting
    return (
        Evidence("clamp_inertia", by_ring, error, None, None, test.name),
        Evidence("damping", damping, damping_error, test.interference, support, test.name),
    )
