"""Numbers of the rig, each with its 90 % interval, and the recordings read by them.

Levels of the torque in a recording are what breaks the contact, and what it slides at.
"""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from noise.base import SURE_90
from noise.base.arrays import Array
from noise.identification.bushing_fit import BushingFit, phases_of
from noise.identification.law_fit import LawFit
from noise.identification.law_model import LOCAL, fitted_evidence
from noise.identification.outcome import Forecast, Number, Seen

_FAST = 0.6
"""Share of the fastest sliding from which the contact counts as sliding fast; assumed."""

_SLOW = 0.6
"""Sliding speed over the shaft's below which it has been slow; assumed."""

_LEAST_SAMPLES = 20


@dataclass(frozen=True)
class Levels:
    """Torque levels of one recording.

    Parameters
    ----------
    mean : float
        Of the torque [Nm].
    critical, kinetic : float
        Median of the highest torque of each cycle, and torque of the contact in fast sliding [Nm].
    slips : int
        Cycles that were seen.
    fastest : float
        Sliding speed that 1 in 200 samples exceeds [rad/s].
    """

    mean: float
    critical: float
    kinetic: float
    slips: int
    fastest: float


def torque_levels(fit: BushingFit) -> Levels:
    """Read the levels off a recording that has been fitted.

    Parameters
    ----------
    fit : BushingFit

    Returns
    -------
    Levels
        Where nothing sticks, critical and kinetic torque are the mean torque of the contact.
    """
    torque, contact = fit.spectrum.torque, fit.contact
    v = contact.sliding_speed
    mean = float(np.mean(torque))
    fastest = float(np.quantile(v, 0.995))
    fast = v > max(_FAST * fastest, 1.1 * float(np.mean(fit.spectrum.shaft_speed)))
    begins = _slips(v, fit.spectrum.shaft_speed)
    if begins.size < 2 or fast.sum() < _LEAST_SAMPLES:
        return Levels(mean, mean, mean, 0, fastest)
    peaks = np.array([
        np.max(torque[a:b]) for a, b in itertools.pairwise(begins)
    ])  # fmt: skip
    return Levels(
        mean, float(np.median(peaks)), float(np.mean(contact.torque[fast])), int(begins.size),
        fastest,
    )  # fmt: skip


def _slips(v: Array, shaft_speed: Array) -> NDArray[np.int64]:
    """Find the samples at which the contact begins to slide, having been slow before."""
    state = np.where(v > shaft_speed, 1, np.where(v < _SLOW * shaft_speed, -1, 0))
    told = np.flatnonzero(state)
    return np.asarray(told[1:][(state[told[1:]] == 1) & (state[told[:-1]] == -1)])


_KINDS = (
    ("elastomer_stiffness", "Nm/rad"), ("damping", "Nm s/rad"), ("elastomer_inertia", "kg m2"),
    ("clamp_inertia", "kg m2"), ("elastomer_damping_share", ""),
)  # fmt: skip

_OF_THE_LAW = {
    True: dict(zip((name for name, _ in _KINDS), (0.01, 0.055, 0.02, 0.01, 0.1), strict=True)),
    False: dict(zip((name for name, _ in _KINDS), (0.015, 0.13, 0.03, 0.02, 0.2), strict=True)),
}
"""Relative standard error that all recordings share, from a law that is never quite the real one,
by whether it truly sticks [-]; from 26 development rigs of `tests.blind.identify`, seed 1."""

_TORQUE_SCATTER, _TORQUE_SHARED = 0.018, 0.003
"""Of a level: from recording to recording at one speed, and by the band limit [-]; from the same
26 rigs."""


def read_again(seen: Sequence[Seen], fit: LawFit) -> list[Seen]:
    """Read recordings once more, with the bushing that the law's fit gave each.

    Parameters
    ----------
    seen : sequence of Seen
    fit : LawFit

    Returns
    -------
    list of Seen
        Those that the law was not fitted to are left as they are.
    """
    model, own = fit.model, {}
    for subject, numbers, torque in zip(
        model.subjects, np.exp(model.local(fit.vector)).tolist(), model.foretell(fit.vector),
        strict=True,
    ):  # fmt: skip
        e = subject.excerpts
        middle = e.starts.size // 2
        forecast = None if torque is None else Forecast(e.rate, e.torque[middle], torque[middle])
        own[id(subject.measured)] = model.bushing(numbers, subject), forecast
    again = []
    for one in seen:
        if id(one.measured) not in own:
            again.append(one)
            continue
        bushing, forecast = own[id(one.measured)]
        spectrum = one.fit.spectrum
        contact = spectrum.contact(bushing)
        phases = phases_of(contact, spectrum.shaft_speed, spectrum.rate)
        read = replace(
            one.fit, bushing=bushing, contact=contact, phases=phases,
            stuck_share=float(np.mean(phases.stuck)),
        )  # fmt: skip
        again.append(replace(one, fit=read, levels=torque_levels(read), forecast=forecast))
    return again


def bushing_numbers(seen: Sequence[Seen], fit: LawFit) -> list[Number]:
    """Tell the rig's numbers.

    Parameters
    ----------
    seen : sequence of Seen
        As of `read_again`.
    fit : LawFit
        To all recordings that slip.

    Returns
    -------
    list of Number
        Stiffness and torques by interference, damping by interference and support, inertias.
    """
    numbers = [*_of_fit(fit, *_KINDS[0]), *_levels(seen)]
    for name, unit in _KINDS[1:]:
        numbers += _of_fit(fit, name, unit)
    return numbers


def _of_fit(fit: LawFit, name: str, unit: str) -> list[Number]:
    model, place = fit.model, LOCAL.index(name)
    means, spread = model.means(fit.vector), np.sqrt(np.diag(fit.covariance))
    shared = _OF_THE_LAW[model.candidate.sticks][name]
    said = list(fitted_evidence(model).values())
    numbers = []
    for g, (i, key) in enumerate(model.groups):
        if i != place:
            continue
        at = key if isinstance(key, tuple) else (key, None)
        value = math.exp(means[g])
        away = math.exp(SURE_90 * math.hypot(float(spread[model.n_local + g]), shared))
        n = int(np.sum(model.group_of[:, i] == g)) + said.count(g)
        numbers.append(Number(name, unit, value, value / away, value * away, n, *at))
    return sorted(numbers, key=lambda n: (n.interference or 0.0, n.support_stiffness or 0.0))


def _levels(seen: Sequence[Seen]) -> list[Number]:
    """Levels of the torque in these recordings, their mean."""
    numbers = []
    for name in ("critical_torque", "kinetic_torque"):
        groups: dict[float, list[float]] = defaultdict(list)
        for one in seen:
            if one.levels.slips:
                level = getattr(one.levels, name.removesuffix("_torque"))
                groups[one.measured.condition.interference].append(level)
        for at, values in sorted(groups.items()):
            # levels that change with speed do so for a reason: their mean is no less sure
            value = float(np.exp(np.mean(np.log(values))))
            away = math.hypot(_TORQUE_SCATTER / math.sqrt(len(values)), _TORQUE_SHARED)
            away = math.exp(SURE_90 * away)
            numbers.append(Number(name, "Nm", value, value / away, value * away, len(values), at))
    return numbers
