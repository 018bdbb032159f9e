"""Evidence of a rig's numbers from elsewhere than stick-slip, and how it joins them.

Static tests state the elastomer's stiffness, ring-downs damping and the clamp's inertia. Each is
weighted by how sure it is (inverse variances of logarithms).
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
"""Relative standard deviation of a bushing's numbers from run to run; assumed, as wherever repeats
are simulated."""

_DEGREES = 4.0
"""So many differences the usual scatter counts as; assumed."""

_SUPPORT_ERROR = 0.01
"""Relative standard error of a support's stiffness as stated [-]; assumed."""

_Place = tuple[str, float | None, float | None]


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
    """Put together the evidence of one number; runs scatter as usual, and as these do."""
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
    # two that contradict each other are less sure than either says
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
    """Return what static tests and ring-downs say of the rig.

    Parameters
    ----------
    tests : sequence of StaticTest
    known : Known
        The clamp's inertia as it is known, and how the damping is shared.
    sticks : bool
        Whether the contact is known to stick truly; otherwise what yields is taken to be its.

    Returns
    -------
    tuple of Evidence
        Stiffness of the elastomer by interference; damping and the clamp's inertia where it rings.
    """
    evidence, yields = [], {}
    parted = {one.interference for one in tests if not one.elastic}
    for one in tests:
        own = sticks or one.elastic
        if one.elastic and one.branches == 1 and one.interference in parted and not sticks:
            continue  # without unloading it could not tell
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
    """Return what a ring-down says of the clamp's inertia and of the damping.

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
    # the elastomer twists by less than the clamp turns where the contact yields
    acting = 1.0 - known.damping_share + known.damping_share * yields**2
    damping_error = math.hypot(ring.decay_error, math.sqrt(1.0 / sum(weights)))
    damping = 2.0 * inertia * ring.decay / acting
    return (
        Evidence("clamp_inertia", by_ring, error, None, None, test.name),
        Evidence("damping", damping, damping_error, test.interference, support, test.name),
    )
