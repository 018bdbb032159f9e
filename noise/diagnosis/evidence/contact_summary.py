"""Numbers of the contact that do not depend on phase: stick, slip, mean cycle, torque.

All are computed from a `Reconstruction` and are relative to the values of the rig file, so that a
rig as its file describes it has about the same numbers at every interference and speed:

- stick: creep speed as a function of the torque over the critical torque, and the part of it that
  another stiffness, damping or inertia would explain;
- slip: friction torque as a function of sliding speed, separately while the speed rises and falls,
  since a contact with memory has two branches; level, slope and bend fitted to all samples scatter
  less than the classes of speed;
- cycles: peak, drop, duration and interval; their scatter, memory and drift; the dependence of the
  peak on the time in stick;
- mean cycle: averages at fixed times from the start of a slip or from the catch, in which noise and
  scatter cancel. Ringing in stick gives the elastomer's stiffness at some hundred hertz, the torque
  over a whole stick that at a few hertz. A wrong parameter changes both alike, a stiffness that
  depends on frequency does not;
- torque: mean, spread, drift and extremes.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from features.kernels.slips import in_intervals, slip_intervals
from models.rig import Fit
from noise.base.arrays import Array
from noise.diagnosis.evidence.channel_summary import quantile
from noise.diagnosis.evidence.reconstruction import Reconstruction

_BEFORE = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)
"""Times before the start of a slip [s]."""

_AFTER = (3e-4, 6e-4, 9e-4, 1.2e-3, 1.6e-3, 2e-3, 2.5e-3, 3e-3, 3.5e-3, 4.2e-3, 5e-3, 6e-3, 8e-3)
"""Times after the surface sticks again [s]."""

_MARGIN = 6e-4
"""Left out at both ends of a stick, since the band limit smears the slip [s]; assumed."""

_SLIP_SUMMARY_FEWEST = 4
"""Fewest cycles of a mean; assumed."""


def cycle_shape(
    motion: Reconstruction, fit: Fit, starts: NDArray[np.int64], ends: NDArray[np.int64]
) -> dict[str, float]:
    """Summarise the mean cycle.

    Parameters
    ----------
    motion : Reconstruction
    fit : Fit
        Values of the rig file.
    starts, ends : ndarray of int, shape (n_slips,)
        Samples at which the surface begins to slip, and at which it sticks again.

    Returns
    -------
    dict of str to float
        Torques over the critical torque, speeds over that of the shaft, relative changes of
        stiffness, damping and inertia [-]. Times that fewer than four cycles reach are left out.
    """
    if starts.size < _SLIP_SUMMARY_FEWEST:
        return {}
    rate = motion.rate
    before, after = (np.array([round(t * rate) for t in times]) for times in (_BEFORE, _AFTER))
    # Times that fall into another slip do not count.
    earlier, later = np.append(0, ends[:-1]), np.append(starts[1:], motion.torque.size)
    places = {f"before_{i}": (starts - by)[starts - by > earlier] for i, by in enumerate(before)}
    places |= {f"after_{i}": (ends + by)[ends + by < later] for i, by in enumerate(after)}
    numbers: dict[str, float] = {}
    for name, at in places.items():
        if at.size >= _SLIP_SUMMARY_FEWEST:
            crept = motion.sliding_speed[at] / np.maximum(np.abs(motion.shaft_speed[at]), 0.05)
            numbers[f"{name}_torque"] = float(motion.torque[at].mean()) / fit.critical_torque
            numbers[f"{name}_creep"] = float(crept.mean())
    return numbers | _ringing(motion, starts, ends)


def _ringing(
    motion: Reconstruction, starts: NDArray[np.int64], ends: NDArray[np.int64]
) -> dict[str, float]:
    """Fit errors of stiffness, damping and inertia to the apparent sliding within sticks.

    In stick the surface moves with the shaft. Apparent sliding is linear in these errors.
    """
    margin = round(_MARGIN * motion.rate)
    first, last = ends[:-1] + margin, starts[1:] - margin
    long = last - first > 3 * margin
    first, last = first[long], last[long]
    if first.size < _SLIP_SUMMARY_FEWEST:
        return {}
    signals = np.stack([
        motion.sliding_speed, motion.by_stiffness, motion.by_damping, motion.by_clamp
    ])  # fmt: skip
    sticks = [signals[:, a:b] for a, b in zip(first.tolist(), last.tolist(), strict=True)]
    sums = np.sum([x.sum(axis=1) for x in sticks], axis=0)
    rings = np.concatenate([x - x.mean(axis=1, keepdims=True) for x in sticks], axis=1)
    products = rings @ rings.T
    spreads = np.sqrt(np.diag(products) / rings.shape[1])  # the means are 0
    numbers = {
        "slow_stiffness": float(sums[0] / (sums[1] + 1e-9)),
        "ring": math.log(float(spreads[1]) + 1e-3),
    }
    known = [k for k in (1, 2, 3) if spreads[k] > 1e-6]
    gram = products[np.ix_(known, known)]
    gram += 1e-4 * np.diag(np.diag(gram))
    x = np.linalg.solve(gram, products[known, 0])
    names = {1: "ring_stiffness", 2: "ring_damping", 3: "ring_clamp"}
    numbers |= {names[k]: float(value) for k, value in zip(known, x, strict=True)}
    left = float(np.var(rings[0] - x @ rings[known]))
    numbers["ring_left"] = 0.5 * math.log(left / (float(spreads[0]) ** 2 + 1e-12) + 1e-6)
    if "ring_stiffness" in numbers:
        numbers["ring_unlike"] = numbers["ring_stiffness"] - numbers["slow_stiffness"]
    return numbers


_SPEED_EDGES = np.array([2.0, 5.0, 9.0, 14.0, 20.0, 28.0, 40.0])
"""Limits of the classes of sliding speed [rad/s]."""

_FITTED = (3.0, 40.0)
"""Range of sliding speed of the fitted law [rad/s]; assumed."""

_FEWEST_SAMPLES = 8
"""Fewest samples of a mean; assumed."""

_ENOUGH = 60
"""Fewest samples of a fitted law; assumed."""


def torque_by_speed(
    motion: Reconstruction, fit: Fit, slipping: NDArray[np.bool_]
) -> dict[str, float]:
    """Summarise the friction torque of a slipping contact.

    Parameters
    ----------
    motion : Reconstruction
    fit : Fit
        Values of the rig file.
    slipping : ndarray of bool, shape (n,)
        Whether the contact slips.

    Returns
    -------
    dict of str to float
        Torques over the kinetic torque of the rig file [-].
    """
    sliding = motion.sliding_speed
    faster = (np.append(sliding[1:], sliding[-1]) > np.append(sliding[0], sliding[:-1]))[slipping]
    speed, torque = sliding[slipping], motion.friction_torque[slipping] / fit.kinetic_torque
    numbers: dict[str, float] = {}
    for name, way in (("up", faster), ("down", ~faster)):
        for i, here in enumerate(_classed(torque[way], speed[way], _SPEED_EDGES), start=1):
            enough = here.size >= _FEWEST_SAMPLES
            numbers[f"law_{name}_{i}"] = float(here.mean()) if enough else math.nan
            if name == "down":
                numbers[f"law_spread_{i}"] = float(here.std()) if here.size > 20 else math.nan
    inside = (speed > _FITTED[0]) & (speed < _FITTED[1])
    m = np.count_nonzero(inside)
    if m > _ENOUGH:
        b, v = torque[inside], speed[inside] / _FITTED[1] - 0.5
        a = np.stack([np.ones(m), v, v * v - 1.0 / 12.0, faster[inside] - 0.5], axis=1)
        x = np.linalg.solve(a.T @ a + 1e-6 * m * np.eye(4), a.T @ b)
        names = ("law_level", "law_slope", "law_bend", "law_loop")
        numbers |= dict(zip(names, x.tolist(), strict=True))
        numbers["law_left"] = float(np.std(b - a @ x))
    return numbers


def _classed(values: Array, by: Array, edges: Array) -> list[Array]:
    """Return the values whose `by` lies between each two edges."""
    place = np.searchsorted(edges, by, side="right")
    return [values[place == i] for i in range(1, edges.size)]


Numbers = dict[str, float]

_TORQUE_EDGES = np.array([0.0, 0.5, 0.65, 0.8, 0.92, 1.1])
"""Limits of the classes of friction torque over critical torque [-]."""

_EXPLANATIONS: tuple[str, ...] = ("speed", "stiffness", "softening", "damping", "clamp", "release")
"""Explanations of apparent sliding in stick: another speed, stiffness, damping or inertia, a
stiffness that changes with torque, or a contact that yields before it breaks."""

_FEWEST = 8
"""Fewest samples of a mean; assumed."""

_APART = 2e-4
"""Slips closer than this are merged [s]; assumed."""

_AROUND = 4e-4
"""Length by which the band limit smears a slip on either side [s]; assumed."""

_NEAR_PEAK = 6e-4
"""Range in which the peak before and the trough after a slip are searched [s]; assumed."""


def slip_starts(
    motion: Reconstruction, speed: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Find the slips of a contact.

    Parameters
    ----------
    motion : Reconstruction
    speed : float
        Set speed of the shaft [rad/s].

    Returns
    -------
    starts, ends : ndarray of int, shape (n_slips,)
        Samples of the reconstruction at which the surface begins to slip, and at which it sticks
        again.
    """
    wanted = abs(speed)
    return slip_intervals(
        motion.sliding_speed,
        above=max(3.0, 1.3 * wanted + 2.0),
        below=0.5 * wanted + 0.8,
        apart=int(_APART * motion.rate),
    )


def contact_summary(motion: Reconstruction, fit: Fit, speed: float) -> Numbers:
    """Summarise the motion and the torque of the contact.

    Parameters
    ----------
    motion : Reconstruction
    fit : Fit
        Values of the rig file.
    speed : float
        Set speed of the shaft [rad/s].

    Returns
    -------
    dict of str to float
        Torques over the critical or kinetic torque of the rig file and speeds over that of the
        shaft [-], speeds within a slip [rad/s]; times and rates as logarithms of seconds and 1/s.
        NaN, or left out, where a recording does not show it.
    """
    starts, ends = slip_starts(motion, speed)
    n = motion.torque.size
    near = in_intervals(starts, ends, n, margin=int(_AROUND * motion.rate))
    wanted = max(abs(speed), 0.05)
    calm = motion.sliding_speed[~near]
    stick, of_stick = _stick(motion, fit, near, wanted)
    numbers = {
        "slip_rate": math.log(max(starts.size * motion.rate / n, 0.5)),
        "stick_share": stick / n,
        "slip_share": float(near.mean()),
        "calm_speed": _mean(calm) / wanted,
        "calm_spread": float(calm.std()) / wanted if calm.size else math.nan,
    }
    numbers |= of_stick
    numbers |= torque_by_speed(motion, fit, in_intervals(starts, ends, n))
    numbers |= _cycles(motion, fit, starts, ends)
    numbers |= cycle_shape(motion, fit, starts, ends)
    numbers |= _torque(motion, fit)
    return numbers


def _stick(
    motion: Reconstruction, fit: Fit, near: NDArray[np.bool_], speed: float
) -> tuple[int, Numbers]:
    """Count the samples in stick, and summarise them."""
    stick = ~near & (np.abs(motion.sliding_speed) < 0.7 * speed + 1.2)
    m, b, shaft = (
        int(np.count_nonzero(stick)),
        motion.sliding_speed[stick],
        motion.shaft_speed[stick],
    )
    ratio = motion.friction_torque[stick] / fit.critical_torque
    rate = motion.torque_rate[stick]
    rising = rate > 0.0
    numbers: Numbers = {}
    for name, way in (("up", rising), ("down", ~rising)):
        for i, here in enumerate(_classed(b[way], ratio[way], _TORQUE_EDGES), start=1):
            enough = here.size >= _FEWEST
            numbers[f"creep_{name}_{i}"] = float(here.mean()) / speed if enough else math.nan
    if m < 200:
        return m, numbers
    by_stiffness, names = motion.by_stiffness[stick], _EXPLANATIONS
    a = np.stack([
        shaft, by_stiffness, by_stiffness * (motion.torque[stick] / fit.kinetic_torque - 1.0),
        motion.by_damping[stick], motion.by_clamp[stick], shaft * np.clip(ratio, 0.0, 1.2) ** 6,
    ], axis=1)  # fmt: skip
    if not motion.by_clamp.any():
        # All of the shaft's speed winds the elastomer: another speed is another stiffness.
        columns = [i for i, name in enumerate(names) if name not in ("speed", "clamp")]
        a, names = a[:, columns], tuple(names[i] for i in columns)
    gram = a.T @ a
    gram += 1e-6 * np.trace(gram) / len(gram) * np.eye(len(gram))
    x = np.linalg.solve(gram, a.T @ b)
    numbers |= {f"stick_{name}": value for name, value in zip(names, x.tolist(), strict=True)}
    left = b - a @ x
    numbers["stick_left"] = float(left.std()) / speed
    numbers["stick_explained"] = 1.0 - float(left.var()) / max(float(b.var()), 1e-12)
    wound = shaft - motion.clamp_speed[stick]
    late, early = rising & (ratio > 0.85), rising & (ratio < 0.7)
    for name, those in (("all", np.ones(m, bool)), ("late", late), ("early", early)):
        if np.count_nonzero(those) > 60:
            u = wound[those]
            numbers[f"stiffness_{name}"] = float(rate[those] @ u) / (
                float(u @ u) * fit.elastomer_stiffness
            )
    return m, numbers


def _cycles(
    motion: Reconstruction, fit: Fit, starts: NDArray[np.int64], ends: NDArray[np.int64]
) -> Numbers:
    n_slips = starts.size
    if n_slips < 4:
        return {}
    rate, near = motion.rate, int(_NEAR_PEAK * motion.rate)
    critical, kinetic = fit.critical_torque, fit.kinetic_torque
    friction = motion.friction_torque
    slips = np.array([
        (
            friction[max(a - near, 0) : a + 2].max() / critical,
            motion.torque[a : b + near].min() / kinetic,
            motion.sliding_speed[a:b].max(),
            float(quantile(friction[a:b], 0.5)) / kinetic,
        )
        for a, b in zip(starts.tolist(), ends.tolist(), strict=True)
    ]).T  # fmt: skip
    peak, trough, fastest, sliding = slips
    time = starts / rate
    interval, duration = np.diff(time), (ends - starts) / rate
    stuck = np.maximum(starts[1:] - ends[:-1], 1) / rate
    each = {"peak": peak, "trough": trough, "fastest": fastest, "kinetic": sliding}
    numbers = {name: _middle(x) for name, x in each.items()}
    numbers |= {f"{name}_spread": float(x.std()) for name, x in each.items()}
    numbers |= {
        "peak_range": float(quantile(peak, 0.9) - quantile(peak, 0.1)),
        "peak_least": float(peak.min()),
        "interval": math.log(_middle(interval)),
        "interval_spread": float(interval.std() / interval.mean()),
        "duration": math.log(_middle(duration)),
        "time_stuck": math.log(_middle(stuck)),
        "fastest_drift": _slope(time, fastest) * float(time.std()),
    }
    if n_slips >= 8:
        age, when = np.log(stuck), time[1:] - time[1:].mean()
        a = np.stack([np.ones_like(age), age - age.mean(), when], axis=1)
        of_both = np.linalg.lstsq(a, np.stack([peak[1:], sliding[1:]], axis=1), rcond=1e-6)[0]
        on_age, drift = of_both[:, 0], float(of_both[2, 1])
        spread_in_time = 2.0 * float(when.std())
        numbers |= {
            "peak_memory": _correlation(peak[1:], peak[:-1]),
            "peak_by_age": float(on_age[1]) * min(float(age.std()), 1.0),
            "peak_drift": float(on_age[2]) * spread_in_time,
            "peak_left": float(np.std(peak[1:] - a @ on_age)),
            "kinetic_drift": drift * spread_in_time,
            "peak_with_kinetic": _correlation(peak, sliding),
        }
    return numbers


def _torque(motion: Reconstruction, fit: Fit) -> Numbers:
    torque = motion.torque
    kinetic, critical = fit.kinetic_torque, fit.critical_torque
    quarter = torque.size // 4
    q = torque[: 4 * quarter].reshape(4, quarter).mean(axis=1) / kinetic
    block = int(0.02 * motion.rate)
    passed = np.cumsum(torque)
    slow = (passed[block:] - passed[:-block]) / block
    mean, spread = float(torque.mean()), float(torque.std())
    third = float(np.mean((torque - mean) ** 3))
    return {
        "mean": mean / kinetic,
        "spread": spread / kinetic,
        "drift": float(q[3] - q[0]),
        "bend": float(q[0] + q[3] - q[1] - q[2]),
        "early_drift": float(q[1] - q[0]),
        "quarters": float(q.std()),
        "slow": float(slow.std()) / kinetic,
        "highest": float(torque.max()) / critical,
        "lowest": float(torque.min()) / kinetic,
        "friction_highest": float(motion.friction_torque.max()) / critical,
        "skewness": third / (spread**3 + 1e-9),
    }


def _mean(x: Array) -> float:
    return float(x.mean()) if x.size >= _FEWEST else math.nan


def _middle(x: Array) -> float:
    return float(quantile(x, 0.5))


def _slope(x: Array, y: Array) -> float:
    away = x - x.mean()
    return float(away @ y) / max(float(away @ away), 1e-12)


def _correlation(x: Array, y: Array) -> float:
    spread = float(x.std() * y.std())
    return float(np.mean((x - x.mean()) * (y - y.mean()))) / spread if spread > 1e-12 else 0.0
