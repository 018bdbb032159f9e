r"""A static test: torque over angle at slow motion below any slip (3.3.3, Figures 5.25 and 5.26).

While the contact holds, angle and torque go together by the compliance of elastomer and beams,
1/k_EFF. A contact that yields before it slides adds to it: loading and unloading then part, the
angle running ahead by

.. math:: -(s S / K) \ln(1 - s T / S), \qquad s = \pm 1

for shear stiffness K and strength S of the contact (Dahl 1968). So one regression of the angle
tells the compliance at no torque, and whether loading and unloading part; where they do, the
average over strengths, each by how well it fits, tells how much of the compliance is the contact's.

With the shaft held the clamp rings on beams and elastomer together,
J_C x'' + (c_E + c_B) x' + (k_E + k_B) x = 0, and the torque of the cell with it (5.3 to 5.7).

What these tell of the rig joins what stick-slip said, each weighted by how sure it is (inverse
variances of logarithms).
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.optimize import least_squares

from models.condition import Condition
from models.errors import ParameterError
from models.show import short_repr
from noise.base import SURE_90
from noise.base.arrays import Array
from noise.identification.bushing_fit import Known
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


_BAND = 60.0, 2000.0
"""In which it is sought [Hz]; assumed."""

_STILL = 3e-3
"""Angle by which a held shaft may move, over the range of the recording [-]; assumed."""

_LEAST_RATE = 4e3
_LEAST, _LOOKED_AT = 0.02, 0.06
"""Of a held stretch [s]; assumed."""

_SETTLED = 1e-3
"""Left out after the shaft stops [s]; assumed."""

_CLEAR = 0.1
"""Share of the band's power that a ring-down explains; assumed."""


@short_repr
@dataclass(frozen=True, eq=False)
class RingDown:
    """Free decay of the torque.

    Parameters
    ----------
    frequency : float
        Of the undamped mode [Hz].
    decay : float
        Rate at which the amplitude falls [1/s].
    frequency_error, decay_error : float
        Relative standard errors [-].
    time, torque, fitted : ndarray, shape (n,)
        [s], and what is left of the torque without its slow part [Nm].
    """

    frequency: float
    decay: float
    frequency_error: float
    decay_error: float
    time: Array
    torque: Array
    fitted: Array


def find_ring_down(torque: Array, angle: Array, rate: float) -> RingDown | None:
    """Find and fit the ring-down after the shaft's last motion.

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
        None where the shaft is not held at the end, or nothing rings.

    Examples
    --------
    >>> t = np.arange(6000) / 20e3
    >>> angle = np.minimum(t, 0.1) * 0.1
    >>> ring = np.where(t > 0.1, np.exp(-60.0 * (t - 0.1)) * np.sin(1800.0 * (t - 0.1)), 0.0)
    >>> found = find_ring_down(500.0 * angle + 0.1 * ring, angle, 20e3)
    >>> round(found.decay), round(2.0 * np.pi * found.frequency)
    (60, 1801)
    """
    if rate < _LEAST_RATE:
        return None
    rest = float(np.median(angle[-max(10, angle.size // 100) :]))
    away = np.abs(uniform_filter1d(angle - rest, max(1, round(_SETTLED * rate))))
    # an encoder's noise is less than what a shaft that still moves goes
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

    def parts(x: Array) -> tuple[Array, Array]:
        turn, fall = 2.0 * np.pi * np.exp(x[0]) * time, np.exp(-np.exp(x[1]) * time)
        columns = np.column_stack(
            [fall * np.cos(turn), fall * np.sin(turn), np.ones_like(time), time]
        )
        amplitude, *_ = np.linalg.lstsq(columns, ring, rcond=None)
        return columns @ amplitude, ring

    def residuals(x: Array) -> Array:
        fitted, measured = parts(x)
        return np.asarray(fitted - measured)

    tried = [
        least_squares(residuals, np.log([top, decay]), method="lm") for decay in (15.0, 60.0, 200.0)
    ]
    fit = min(tried, key=lambda one: float(one.cost))
    fitted, _ = parts(fit.x)
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


def ring_evidence(
    ring: RingDown, name: str, interference: float, support_stiffness: float, known: Known,
    stiffness: float, error: float, *, yields: float = 1.0,
) -> tuple[Evidence, ...]:  # fmt: skip
    """Return what a ring-down says of damping and clamp.

    Parameters
    ----------
    ring : RingDown
    name : str
        Of the file.
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    known : Known
        The clamp's inertia as it is known, and how the damping is shared.
    stiffness, error : float
        Of the elastomer [Nm/rad], and its relative standard error [-].
    yields : float
        Stiffness of elastomer and contact in series over that of the elastomer [-].

    Returns
    -------
    tuple of Evidence
        None with the clamp fixed, where nothing rings.
    """
    if math.isinf(support_stiffness):
        return ()
    both = support_stiffness + yields * stiffness
    by_ring = both / (2.0 * math.pi * ring.frequency) ** 2
    share = yields * stiffness / both
    error = math.hypot(2.0 * ring.frequency_error, share * error, _SUPPORT_ERROR)
    weights = error**-2, known.inertia_error**-2
    inertia = math.exp(
        (weights[0] * math.log(by_ring) + weights[1] * math.log(known.clamp_inertia)) / sum(weights)
    )
    of_inertia = math.sqrt(1.0 / sum(weights))
    # the elastomer twists by less than the clamp turns where the contact yields
    acting = 1.0 - known.damping_share + known.damping_share * yields**2
    return (
        Evidence("clamp_inertia", by_ring, error, None, None, name),
        Evidence(
            "damping", 2.0 * inertia * ring.decay / acting,
            math.hypot(ring.decay_error, of_inertia), interference, support_stiffness, name,
        ),
    )  # fmt: skip


_SUPPORT_ERROR = 0.01
"""Relative standard error of a support's stiffness as stated [-]; assumed."""


_POINTS = 4000
"""Averages of neighbouring samples that are looked at, at most."""

_SMOOTH = 200
"""Over so many a record the angle is smoothed to tell which way it goes; assumed."""

_RESTING = 0.08
"""Of the fastest motion; slower counts as rest, at which nothing is learned."""

_FEWEST = 30
_EXPLAINED = 0.98
"""Share of the angle's variance that a static test explains; slips leave more; assumed."""

_STRENGTHS = np.geomspace(1.03, 12.0, 40)
"""Strengths of the contact that are tried, over the highest torque."""

_SURE = 10.0
"""Fall of the log-likelihood, doubled, from which loading and unloading are said to part; a
chi-square of one degree is above it once in 640; assumed."""

_LEAST_PARTING = 0.004
"""Of the angle's range [-]; less is called elastic whatever the statistics; assumed."""

_LEAST_ERROR = 0.002
"""Relative standard error that no regression goes below: nobody's encoder is better [-];
assumed."""


@short_repr
@dataclass(frozen=True, eq=False)
class StaticTest:
    """What a static test says.

    Parameters
    ----------
    name : str
        Of the file.
    interference : float
        [m]
    support_stiffness : float
        [Nm/rad]
    effective_stiffness : float
        At no torque: elastomer, beams and what yields of the contact in series [Nm/rad].
    error : float
        Its relative standard error [-].
    elastic : bool
        Whether loading and unloading are one line.
    parting : float
        By how much they are not: share of the angle that the contact adds at the highest torque
        [-].
    held_stiffness, held_error : float
        The same without what yields of the contact [Nm/rad], and its relative standard error [-].
    branches : int
        Runs in one direction.
    angle, torque, fitted_angle : ndarray, shape (n,)
        What was looked at [rad], [Nm], and the angle as regressed [rad].
    ring_down : RingDown, optional
        What rings after the shaft is held.
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
    """Read a recording as a static test.

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
        None where torque and angle do not go together: something slips, or nothing moves.

    Raises
    ------
    ParameterError
        It is one, but states no interference or support.

    Examples
    --------
    >>> from models.condition import Condition
    >>> angle = 5e-3 * np.sin(2 * np.pi * np.arange(4000) / 1000.0)
    >>> found = static_test(500.0 * angle, angle, 1000.0, Condition(None, 0.279e-3, 2214.0), "slow")
    >>> round(found.effective_stiffness), found.elastic, found.branches
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
    kept = moving & (counts[branch] >= max(_FEWEST, n // 200))
    if kept.sum() < 2 * _FEWEST or float(np.ptp(t[kept])) == 0.0:
        return None
    _, branch = np.unique(branch[kept], return_inverse=True)
    t, a, way = t[kept], a[kept], way[kept]
    if np.corrcoef(t, a)[0, 1] < 0.0:  # the cell counts against the encoder
        t = -t
    fit = _regression(t, a, way, branch)
    if fit is None:
        return None
    if condition.interference is None or condition.support_stiffness is None:
        what = "interference_mm" if condition.interference is None else "support_stiffness_Nm_rad"
        raise ParameterError(f"states no {what}; give it under conditions of the sidecar")
    elastic, parting, compliance, error, held, held_error, fitted = fit
    return StaticTest(
        name, condition.interference, condition.support_stiffness, 1.0 / compliance,
        math.hypot(error, _LEAST_ERROR), elastic, parting, 1.0 / held,
        math.hypot(held_error, _LEAST_ERROR), int(branch.max()) + 1, a, t, fitted,
        find_ring_down(torque, angle, rate),
    )  # fmt: skip


def _regression(
    t: Array, a: Array, way: Array,
    branch: NDArray[np.intp],
) -> tuple[bool, float, float, float, float, float, Array] | None:  # fmt: skip
    """Regress the angle: elastic, parting, both compliances with errors, fitted angle."""
    # each run begins at an angle of its own, which drift and what yielded before decide
    own = np.eye(int(branch.max()) + 1)[branch]
    rest, highest = a - a.mean(), float(np.abs(t).max())

    def solved(columns: list[Array]) -> tuple[Array, Array, float, Array]:
        matrix = np.column_stack([*columns, own])
        scale = np.abs(matrix).max(axis=0)
        x, *_ = np.linalg.lstsq(matrix / scale, a, rcond=None)
        fitted = matrix @ (x / scale)
        covariance = np.linalg.pinv((matrix / scale).T @ (matrix / scale)) / np.outer(scale, scale)
        return x / scale, fitted, float(np.sum((a - fitted) ** 2)), covariance

    plain, line, left, spread = solved([t])
    found = []
    for strength in _STRENGTHS * highest:
        ahead = -way * strength * np.log1p(-way * t / strength) - t
        x, fitted, rest_left, covariance = solved([t, ahead])
        if x[1] >= 0.0 and x[0] > x[1]:
            found.append((rest_left, x, fitted, covariance, float(np.ptp(ahead))))
    best = min(found, key=lambda one: one[0]) if found else None
    least = best[0] if best else left
    if plain[0] <= 0.0 or min(left, least) > (1.0 - _EXPLAINED) * float(rest @ rest):
        return None
    fitted = best[2] if best else line
    residual = a - fitted
    ahead_of = float(residual[1:] @ residual[:-1]) / max(float(residual @ residual), 1e-300)
    n = max(t.size * (1.0 - min(ahead_of, 0.99)) / (1.0 + max(ahead_of, 0.0)), 10.0)
    parting = best[1][1] * best[4] / float(np.ptp(a)) if best else 0.0
    gained = n * math.log(left / max(least, 1e-300)) if left > least else 0.0
    if best is None or gained < _SURE or parting < _LEAST_PARTING:
        error = math.sqrt(left / n * spread[0, 0]) / plain[0]
        return True, max(parting, 0.0), plain[0], error, plain[0], error, line
    weight = np.array([math.exp(-0.5 * n * math.log(max(one[0], 1e-300) / max(least, 1e-300)))
                       for one in found])  # fmt: skip
    weight /= weight.sum()

    def averaged(direction: Array) -> tuple[float, float]:
        values = np.array([one[1][:2] @ direction for one in found])
        own_error = np.array([direction @ one[3][:2, :2] @ direction * one[0] / n for one in found])
        mean = float(weight @ values)
        variance = float(weight @ (own_error + (values - mean) ** 2))
        return mean, math.sqrt(max(variance, 0.0)) / mean

    compliance, error = averaged(np.array([1.0, 0.0]))
    held, held_error = averaged(np.array([1.0, -1.0]))
    return False, parting, compliance, error, held, held_error, fitted


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
    stiffness, yields = [], {}
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
        stiffness.append(
            Evidence("elastomer_stiffness", value, error, one.interference, None, one.name)
        )
        series, _ = elastomer_stiffness(one.effective_stiffness, one.support_stiffness)
        yields[one.interference] = 1.0 if own else min(series / value, 1.0)
    found = list(stiffness)
    for one in tests:
        if one.ring_down is None:
            continue
        said = [(e.value, e.error) for e in stiffness if e.interference == one.interference]
        if said:
            value = math.exp(float(np.mean(np.log([k for k, _ in said]))))
            found += ring_evidence(
                one.ring_down, one.name, one.interference, one.support_stiffness, known, value,
                max(error for _, error in said), yields=yields[one.interference],
            )  # fmt: skip
    return tuple(found)


def static_notes(tests: Sequence[StaticTest]) -> list[str]:
    """Say of static tests what to know: whether they are elastic, and what was taken off.

    Returns
    -------
    list of str
    """
    parted = [one for one in tests if not one.elastic]
    return [
        f"{one.name}: loading and unloading part, by {100.0 * one.parting:.1f} % of the angle, so "
        f"not all is elastic; with what yields in the contact the slope is "
        f"{one.effective_stiffness:.4g} Nm/rad, without it {one.held_stiffness:.4g} "
        f"(+-{100.0 * one.held_error:.1f} %)"
        for one in parted
    ]
