r"""Static tests: torque over angle at slow motion below any slip (3.3.3, Figures 5.25 and 5.26).

While the contact holds, angle and torque go together by the compliance of elastomer and beams,
1/k_EFF. A contact that yields before it slides adds to it: loading and unloading then part, the
angle running ahead by

.. math:: -(s S / K) \ln(1 - s T / S), \qquad s = \pm 1

for shear stiffness K and strength S of the contact (Dahl 1968). So one regression of the angle
gives the compliance at zero torque and shows whether loading and unloading part. If they do, the
likelihood-weighted average over strengths gives the contact's share of the compliance.

With the shaft held the clamp rings on beams and elastomer together,
J_C x'' + (c_E + c_B) x' + (k_E + k_B) x = 0, and the torque of the cell with it (5.3 to 5.7).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.optimize import least_squares

from models.condition import Condition
from models.errors import ParameterError
from models.show import short_repr
from noise.base.arrays import Array

_BAND = 60.0, 2000.0
"""Frequency band of ring-downs [Hz]; assumed."""

_STILL = 3e-3
"""Largest movement of a held shaft, over the range of the angle [-]; assumed."""

_LEAST_RATE = 4e3
_LEAST, _LOOKED_AT = 0.02, 0.06
"""Shortest and longest part of a ring-down that is used [s]; assumed."""

_SETTLED = 1e-3
"""Time after the shaft stops that is left out [s]; assumed."""

_CLEAR = 0.1
"""Least share of the power that a ring-down explains; assumed."""


@short_repr
@dataclass(frozen=True, eq=False)
class RingDown:
    """Free decay of the torque while the shaft is held.

    Parameters
    ----------
    frequency : float
        Frequency of the undamped mode [Hz].
    decay : float
        Decay rate of the amplitude [1/s].
    frequency_error, decay_error : float
        Relative standard errors [-].
    time, torque, fitted : ndarray, shape (n,)
        Time [s]; torque without its trend, and as fitted [Nm].
    """

    frequency: float
    decay: float
    frequency_error: float
    decay_error: float
    time: Array
    torque: Array
    fitted: Array


def find_ring_down(torque: Array, angle: Array, rate: float) -> RingDown | None:
    """Fit the ring-down after the shaft's last motion.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        [Nm]
    angle : ndarray, shape (n,)
        [rad]
    rate : float
        [Hz]

    Returns
    -------
    RingDown or None
        None if the shaft is not held at the end, or nothing rings.

    Examples
    --------
    >>> t = np.arange(6000) / 20e3
    >>> angle = np.minimum(t, 0.1) * 0.1
    >>> ring = np.where(t > 0.1, np.exp(-60.0 * (t - 0.1)) * np.sin(1800.0 * (t - 0.1)), 0.0)
    >>> ring_down = find_ring_down(500.0 * angle + 0.1 * ring, angle, 20e3)
    >>> round(ring_down.decay), round(2.0 * np.pi * ring_down.frequency)
    (60, 1801)
    """
    if rate < _LEAST_RATE:
        return None
    rest = float(np.median(angle[-max(10, angle.size // 100) :]))
    away = np.abs(uniform_filter1d(angle - rest, max(1, round(_SETTLED * rate))))
    # steps of an encoder's noise are smaller than those of a moving shaft
    noise = 1.4826 * float(np.median(np.abs(np.diff(angle)))) * 4.0
    moving = np.flatnonzero(away > max(_STILL * float(np.ptp(angle)), noise))
    begin = (int(moving[-1]) + 1 if moving.size else 0) + round(_SETTLED * rate)
    stop = min(angle.size, begin + round(_LOOKED_AT * rate))
    if moving.size == 0 or stop - begin < _LEAST * rate:
        return None
    time = np.arange(stop - begin) / rate
    slow = np.polynomial.Polynomial.fit(time, torque[begin:stop], 2)
    ring = torque[begin:stop] - slow(time)
    frequency = np.fft.rfftfreq(4 * ring.size, 1.0 / rate)
    power = np.abs(np.fft.rfft(ring, 4 * ring.size)) ** 2
    band = (frequency > _BAND[0]) & (frequency < min(_BAND[1], 0.4 * rate))
    top = float(frequency[band][np.argmax(power[band])])

    def fitted_to(x: Array) -> Array:
        turn, fall = 2.0 * np.pi * np.exp(x[0]) * time, np.exp(-np.exp(x[1]) * time)
        columns = np.column_stack(
            [fall * np.cos(turn), fall * np.sin(turn), np.ones_like(time), time]
        )
        amplitude, *_ = np.linalg.lstsq(columns, ring, rcond=None)
        return np.asarray(columns @ amplitude)

    fits = [
        least_squares(lambda x: fitted_to(x) - ring, np.log([top, decay]), method="lm")
        for decay in (15.0, 60.0, 200.0)
    ]
    fit = min(fits, key=lambda one: float(one.cost))
    fitted = fitted_to(fit.x)
    damped, decay = 2.0 * math.pi * math.exp(fit.x[0]), math.exp(fit.x[1])
    inside = _BAND[0] < damped / (2.0 * math.pi) < _BAND[1] and decay < 0.3 * damped
    explained = 1.0 - float(np.sum((ring - fitted) ** 2)) / max(float(ring @ ring), 1e-300)
    if not inside or decay * time[-1] < 1.0 or explained < _CLEAR:
        return None
    errors = np.sqrt(np.diag(np.linalg.pinv(fit.jac.T @ fit.jac)) * 2.0 * fit.cost / ring.size)
    return RingDown(
        math.hypot(damped, decay) / (2.0 * math.pi), decay, float(errors[0]), float(errors[1]),
        time, ring, fitted,
    )  # fmt: skip


_POINTS = 4000
"""Most points that are used, each an average of neighbouring samples."""

_SMOOTH = 200
"""Ratio of the record to the width over which the angle is smoothed; assumed."""

_RESTING = 0.08
"""Share of the fastest motion below which the shaft is at rest and samples are left out."""

_FEWEST = 30
_EXPLAINED = 0.98
"""Least explained share of the angle's variance; slips leave more; assumed."""

_STRENGTHS = np.geomspace(1.03, 12.0, 40)
"""Grid of strengths of the contact, over the highest torque."""

_SURE = 10.0
"""Twice the gain of log-likelihood above which loading and unloading part: a chi-square of one
degree exceeds it once in 640; assumed."""

_LEAST_PARTING = 0.004
"""Least parting, over the range of the angle [-]; less counts as elastic; assumed."""

_LEAST_ERROR = 0.002
"""Relative standard error by the encoder [-]; assumed."""


@short_repr
@dataclass(frozen=True, eq=False)
class StaticTest:
    """Result of a static test.

    Parameters
    ----------
    name : str
        Of the file.
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    effective_stiffness : float
        At zero torque: elastomer, beams and yielding contact in series [Nm/rad].
    error : float
        Its relative standard error [-].
    elastic : bool
        Whether loading and unloading are one line.
    parting : float
        Share of the angle that the yielding contact adds at the highest torque [-].
    held_stiffness, held_error : float
        Stiffness without the yielding contact [Nm/rad], and its relative standard error [-].
    branches : int
        Number of runs in one direction.
    angle, torque, fitted_angle : ndarray, shape (n,)
        Points used [rad], [Nm], and the angle of the regression [rad].
    ring_down : RingDown, optional
        Ring-down after the shaft stops.
    """

    name: str
    interference: float
    support_stiffness: float
    effective_stiffness: float
    error: float
    elastic: bool
    parting: float
    held_stiffness: float
    held_error: float
    branches: int
    angle: Array
    torque: Array
    fitted_angle: Array
    ring_down: RingDown | None = None


def static_test(
    torque: Array, angle: Array, rate: float, condition: Condition,
    name: str,
) -> StaticTest | None:  # fmt: skip
    """Evaluate a recording as a static test.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        Of the cell [Nm].
    angle : ndarray, shape (n,)
        Of the shaft [rad].
    rate : float
        [Hz]
    condition : Condition
    name : str
        Of the file.

    Returns
    -------
    StaticTest or None
        None if torque and angle are not proportional: something slips, or nothing moves.

    Raises
    ------
    ParameterError
        It is a static test but states no interference or support.

    Examples
    --------
    >>> from models.condition import Condition
    >>> angle = 5e-3 * np.sin(2 * np.pi * np.arange(4000) / 1000.0)
    >>> test = static_test(500.0 * angle, angle, 1000.0, Condition(None, 0.279e-3, 2214.0), "slow")
    >>> round(test.effective_stiffness), test.elastic, test.branches
    (500, True, 9)
    """
    if angle.size < 4 * _FEWEST:
        return None
    block = max(1, math.ceil(angle.size / _POINTS))
    n = angle.size // block
    t, a = (x[: n * block].reshape(n, block).mean(axis=1) for x in (torque, angle))
    width = max(3, n // _SMOOTH)
    speed = np.gradient(np.convolve(np.pad(a, width, "edge"), np.ones(width) / width, "same"))
    speed = speed[width:-width]
    moving = np.abs(speed) > _RESTING * float(np.quantile(np.abs(speed), 0.98))
    way = np.where(moving, np.sign(speed), 0.0)
    branch = np.cumsum(np.diff(way, prepend=way[0]) != 0.0)
    counts = np.bincount(branch)
    used = moving & (counts[branch] >= max(_FEWEST, n // 200))
    if used.sum() < 2 * _FEWEST or float(np.ptp(t[used])) == 0.0:
        return None
    _, branch = np.unique(branch[used], return_inverse=True)
    t, a, way = t[used], a[used], way[used]
    if np.corrcoef(t, a)[0, 1] < 0.0:  # cell and encoder have opposite signs
        t = -t
    regression = _regression(t, a, way, branch)
    if regression is None:
        return None
    if condition.interference is None or condition.support_stiffness is None:
        what = "interference_mm" if condition.interference is None else "support_stiffness_Nm_rad"
        raise ParameterError(f"states no {what}; give it under conditions of the sidecar")
    parting, slope, held, fitted = regression
    return StaticTest(
        name, condition.interference, condition.support_stiffness, 1.0 / slope[0],
        math.hypot(slope[1], _LEAST_ERROR), held is None, parting, 1.0 / (held or slope)[0],
        math.hypot((held or slope)[1], _LEAST_ERROR), int(branch.max()) + 1, a, t, fitted,
        find_ring_down(torque, angle, rate),
    )  # fmt: skip


class _Fit(NamedTuple):
    """Regression of the angle: coefficients, squared residuals, covariance, fitted angle, reach."""

    x: Array
    left: float
    covariance: Array
    fitted: Array
    reach: float


def _regression(
    t: Array, a: Array, way: Array, branch: NDArray[np.intp]
) -> tuple[float, tuple[float, float], tuple[float, float] | None, Array] | None:
    """Regress the angle on the torque and on the yielding of a contact.

    Returns
    -------
    parting, slope, held, fitted
        Share of the angle that the contact adds [-]; compliance [rad/Nm] and its relative error,
        with the contact and without it (None if all is elastic); fitted angle [rad]. None if torque
        and angle are not proportional.
    """
    # each run has an offset of its own, from drift and earlier yielding
    own = np.eye(int(branch.max()) + 1)[branch]
    rest, highest = a - a.mean(), float(np.abs(t).max())

    def solved(*columns: Array) -> _Fit:
        matrix = np.column_stack([*columns, own])
        scale = np.abs(matrix).max(axis=0)
        x, *_ = np.linalg.lstsq(matrix / scale, a, rcond=None)
        fitted = matrix @ (x / scale)
        covariance = np.linalg.pinv((matrix / scale).T @ (matrix / scale)) / np.outer(scale, scale)
        reach = float(np.ptp(columns[-1]))
        return _Fit(x / scale, float(np.sum((a - fitted) ** 2)), covariance, fitted, reach)

    plain = solved(t)
    runs_ahead = (-way * s * np.log1p(-way * t / s) - t for s in _STRENGTHS * highest)
    yielding = [fit for fit in (solved(t, ahead) for ahead in runs_ahead)
                if fit.x[1] >= 0.0 and fit.x[0] > fit.x[1]]  # fmt: skip
    best = min(yielding, key=lambda fit: fit.left, default=plain)
    least = best.left
    if plain.x[0] <= 0.0 or min(plain.left, least) > (1.0 - _EXPLAINED) * float(rest @ rest):
        return None
    residual = a - best.fitted
    ahead_of = float(residual[1:] @ residual[:-1]) / max(float(residual @ residual), 1e-300)
    n = max(t.size * (1.0 - min(ahead_of, 0.99)) / (1.0 + max(ahead_of, 0.0)), 10.0)
    parting = best.x[1] * best.reach / float(np.ptp(a)) if yielding else 0.0
    gained = n * math.log(plain.left / max(least, 1e-300)) if plain.left > least else 0.0
    if gained < _SURE or parting < _LEAST_PARTING:
        error = math.sqrt(plain.left / n * plain.covariance[0, 0]) / plain.x[0]
        return max(parting, 0.0), (plain.x[0], error), None, plain.fitted
    weight = np.array([
        math.exp(-0.5 * n * math.log(max(fit.left, 1e-300) / max(least, 1e-300)))
        for fit in yielding
    ])  # fmt: skip
    weight /= weight.sum()

    def averaged(direction: Array) -> tuple[float, float]:
        values = np.array([fit.x[:2] @ direction for fit in yielding])
        own_error = np.array([
            direction @ fit.covariance[:2, :2] @ direction * fit.left / n for fit in yielding
        ])  # fmt: skip
        mean = float(weight @ values)
        variance = float(weight @ (own_error + (values - mean) ** 2))
        return mean, math.sqrt(max(variance, 0.0)) / mean

    with_contact, without = np.array([1.0, 0.0]), np.array([1.0, -1.0])
    return parting, averaged(with_contact), averaged(without), best.fitted
