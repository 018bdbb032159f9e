"""Numbers of the rig with 90 % intervals, and torque levels of its recordings."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from models.rig import Rig
from noise.base import SURE_90
from noise.base.arrays import Array
from noise.identification.bushing_fit import BushingFit
from noise.identification.law_fit import LawFit
from noise.identification.law_model import LOCAL
from noise.identification.outcome import UNITS, Forecast, Number, RecordingFit
from sim.effects import EFFECTS
from sim.friction import friction_law

_FAST = 0.6
"""Share of the fastest sliding speed above which the contact slides fast; assumed."""

_SLOW = 0.6
"""Sliding speed over the shaft's speed below which the contact is slow; assumed."""

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
        Number of slips.
    """

    mean: float
    critical: float
    kinetic: float
    slips: int


def torque_levels(fit: BushingFit) -> Levels:
    """Return the torque levels of a fitted recording.

    Parameters
    ----------
    fit : BushingFit

    Returns
    -------
    Levels
        If nothing sticks, critical and kinetic torque are the mean torque of the contact.
    """
    torque, contact = fit.spectrum.torque, fit.contact
    v = contact.sliding_speed
    mean = float(np.mean(torque))
    fastest = float(np.quantile(v, 0.995))
    fast = v > max(_FAST * fastest, 1.1 * float(np.mean(fit.spectrum.shaft_speed)))
    begins = _slips(v, fit.spectrum.shaft_speed)
    if begins.size < 2 or fast.sum() < _LEAST_SAMPLES:
        return Levels(mean, mean, mean, 0)
    peaks = np.array([
        np.max(torque[a:b]) for a, b in itertools.pairwise(begins)
    ])  # fmt: skip
    sliding = float(np.mean(contact.torque[fast]))
    return Levels(mean, float(np.median(peaks)), sliding, int(begins.size))


def _slips(v: Array, shaft_speed: Array) -> NDArray[np.int64]:
    """Return the samples at which the contact begins to slide, having been slow before."""
    state = np.where(v > shaft_speed, 1, np.where(v < _SLOW * shaft_speed, -1, 0))
    clear = np.flatnonzero(state)
    return np.asarray(clear[1:][(state[clear[1:]] == 1) & (state[clear[:-1]] == -1)])


_OF_THE_LAW = {
    "elastomer_stiffness": (0.015, 0.01),
    "damping": (0.13, 0.055),
    "elastomer_inertia": (0.03, 0.02),
    "clamp_inertia": (0.02, 0.01),
    "elastomer_damping_share": (0.2, 0.1),
}
"""Relative systematic error, because no law is exact, of a law whose contact creeps and of one that
truly sticks [-]; from 26 development rigs of `tests.blind.identify`, seed 1."""

_TORQUE_SCATTER, _TORQUE_SHARED = 0.018, 0.003
"""Relative scatter of a level between recordings at one speed, and its systematic error by the
low-pass filter [-]; from the same 26 rigs."""


def read_again(recordings: Sequence[RecordingFit], fit: LawFit) -> list[RecordingFit]:
    """Return the recordings with the bushings that the fit of the law gave them.

    Parameters
    ----------
    recordings : sequence of RecordingFit
    fit : LawFit

    Returns
    -------
    list of RecordingFit
        Recordings that the law was not fitted to are unchanged.
    """
    model, own = fit.model, {}
    for subject, numbers, torque in zip(
        model.subjects, np.exp(model.local(fit.vector)).tolist(), model.predicted(fit.vector),
        strict=True,
    ):  # fmt: skip
        e = subject.excerpts
        middle = e.starts.size // 2
        forecast = None if torque is None else Forecast(e.rate, e.torque[middle], torque[middle])
        own[id(subject.measured)] = model.bushing(numbers, subject), forecast
    again = []
    for one in recordings:
        bushing, forecast = own.get(id(one.measured), (None, None))
        if bushing is not None:
            refitted = replace(one.fit, bushing=bushing)
            one = RecordingFit(one.measured, refitted, torque_levels(refitted), forecast)
        again.append(one)
    return again


def bushing_numbers(recordings: Sequence[RecordingFit], fit: LawFit) -> list[Number]:
    """Return the rig's numbers.

    Parameters
    ----------
    recordings : sequence of RecordingFit
        As of `read_again`.
    fit : LawFit
        To all recordings that slip.

    Returns
    -------
    list of Number
        Stiffness and torques by interference, damping by interference and support, inertias.
    """
    stiffness, *others = (_of_fit(fit, name) for name in _OF_THE_LAW)
    return [*stiffness, *_levels(recordings), *itertools.chain(*others)]


def _of_fit(fit: LawFit, name: str) -> list[Number]:
    model, place = fit.model, LOCAL.index(name)
    means, spread = model.means(fit.vector), np.sqrt(np.diag(fit.covariance))
    shared = _OF_THE_LAW[name][model.candidate.sticks]
    numbers = []
    for g, (i, key) in enumerate(model.groups):
        if i == place:
            at = key if isinstance(key, tuple) else (key, None)
            error = math.hypot(float(spread[model.n_local + g]), shared)
            n = int(np.sum(model.group_of[:, i] == g))
            numbers.append(_number(name, UNITS[name], math.exp(means[g]), error, n, *at))
    return sorted(numbers, key=lambda n: (n.interference or 0.0, n.support_stiffness or 0.0))


def _number(name: str, unit: str, value: float, error: float, n: int, *at: float | None) -> Number:
    """Return a number with the 90 % interval of its relative standard error."""
    away = math.exp(SURE_90 * error)
    return Number(name, unit, value, value / away, value * away, n, *at)


def _levels(recordings: Sequence[RecordingFit]) -> list[Number]:
    """Return the mean torque levels of the recordings by interference."""
    numbers = []
    for name in ("critical_torque", "kinetic_torque"):
        groups: dict[float, list[float]] = defaultdict(list)
        for one in recordings:
            if one.levels.slips:
                level = getattr(one.levels, name.removesuffix("_torque"))
                groups[one.measured.condition.interference].append(level)
        for at, values in sorted(groups.items()):
            # levels that change with speed make their mean no less certain
            value, n = float(np.exp(np.mean(np.log(values)))), len(values)
            error = math.hypot(_TORQUE_SCATTER / math.sqrt(n), _TORQUE_SHARED)
            numbers.append(_number(name, UNITS[name], value, error, n, at))
    return numbers


def law_numbers(fit: LawFit, rig: Rig) -> list[Number]:
    """Return the torques and parameters of the friction law.

    Parameters
    ----------
    fit : LawFit
        To all recordings.
    rig : Rig
        Rig identified by the fit.
    """
    model, spread = fit.model, np.sqrt(np.diag(fit.covariance))
    error = {group: float(spread[model.n_local + g]) for g, group in enumerate(model.groups)}
    numbers = []
    for one in rig.fits:
        g = model.groups.index((LOCAL.index("kinetic_torque"), one.interference))
        n = int(np.sum(model.group_of[:, LOCAL.index("kinetic_torque")] == g))
        kinetic, drop = (
            error[LOCAL.index(name), one.interference] for name in ("kinetic_torque", "drop")
        )
        critical = math.hypot(kinetic, (1.0 - one.kinetic_torque / one.critical_torque) * drop)
        for name, value, of in (
            ("law_kinetic_torque", one.kinetic_torque, kinetic),
            ("law_critical_torque", one.critical_torque, critical),
        ):
            numbers.append(_number(name, "Nm", value, min(of, _UNKNOWN), n, one.interference))
    candidate = model.candidate
    own = EFFECTS[candidate.effect].parameters if candidate.effect else None
    units = own or friction_law(candidate.law).parameters
    for i, name in enumerate(candidate.free, start=model.n_common):
        unit, error_of = units[name].unit, min(float(spread[i]), _UNKNOWN)
        value, n = math.exp(fit.vector[i]), len(model.subjects)
        numbers.append(_number(f"friction.{name}", unit, value, error_of, n))
    return numbers


_UNKNOWN = 2.0
"""Largest relative standard error that is stated for a number of the law [-]."""
