# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Compiled loops over a reconstructed contact: what it does in stick, in slip and by cycle.

Each gathers sums, or the rows of a least-squares problem, in one pass over the samples; what is
made of them stands in `noise.diagnosis.evidence.contact_summary` and `slip_summary`.
"""

from __future__ import annotations

from numba import njit

from models.compilation import COMPILED, PART
from noise.diagnosis.evidence.channel_kernel import quantile_in_place


@njit(**PART)
def _class_of(value, edges):
    """Which class a value lies in, from 0; -1 outside of all."""
    place = -1
    for edge in edges:
        if value < edge:
            break
        place += 1
    return place if place < edges.size - 1 else -1


@njit(cache=True, **COMPILED)
def gather_sticking(motion, disturbances, near, scales, edges, rows, target, classes, winding):
    """Gather what a contact does while it sticks.

    Parameters
    ----------
    motion : tuple of ndarray, shape (n,)
        Torque, friction torque [Nm], torque rate [Nm/s], speed of the shaft, sliding speed, speed
        of the clamp [rad/s].
    disturbances : tuple of ndarray, shape (n,)
        `by_stiffness`, `by_damping`, `by_clamp` of a `Reconstruction` [rad/s].
    near : ndarray of bool, shape (n,)
        Within or about a slip.
    scales : tuple of float
        Speed of the shaft and sliding speed below which it sticks [rad/s], critical and kinetic
        torque [Nm].
    edges : ndarray, shape (n_classes + 1,)
        Of classes of the friction torque over the critical one [-].
    rows : ndarray, shape (n, 6), filled in as far as it sticks
        What its sliding speed seems to be made of: speed, stiffness, softening, damping, clamp,
        release [rad/s].
    target : ndarray, shape (n,), filled in alike
        Sliding speed [rad/s].
    classes : ndarray, shape (2, n_classes, 2), filled in
        As the torque rises and as it falls: samples in each class and the sum of sliding speed over
        that of the shaft [-].
    winding : ndarray, shape (3, 3), filled in
        All in stick, late and early in a rise: samples, sums of torque rate times the speed at
        which the elastomer is wound, and of that speed squared.

    Returns
    -------
    int
        Samples in stick.
    """
    torque, friction, torque_rate, shaft, sliding, clamp = motion
    by_stiffness, by_damping, by_clamp = disturbances
    speed, slow, critical, kinetic = scales
    classes[:] = 0.0
    winding[:] = 0.0
    m = 0
    for i in range(torque.size):
        if near[i] or not abs(sliding[i]) < slow:
            continue
        ratio, rising = friction[i] / critical, torque_rate[i] > 0.0
        place = _class_of(ratio, edges)
        if place >= 0:
            classes[0 if rising else 1, place, 0] += 1.0
            classes[0 if rising else 1, place, 1] += sliding[i] / speed
        squared = min(max(ratio, 0.0), 1.2) ** 2
        rows[m, 0] = shaft[i]
        rows[m, 1] = by_stiffness[i]
        rows[m, 2] = by_stiffness[i] * ((torque[i] - kinetic) / kinetic)
        rows[m, 3] = by_damping[i]
        rows[m, 4] = by_clamp[i]
        rows[m, 5] = shaft[i] * squared * squared * squared
        target[m] = sliding[i]
        m += 1
        wound = shaft[i] - clamp[i]
        late, early = rising and ratio > 0.85, rising and ratio < 0.7
        for which, chosen in enumerate((True, late, early)):
            if chosen:
                winding[which, 0] += 1.0
                winding[which, 1] += torque_rate[i] * wound
                winding[which, 2] += wound * wound
    return m


@njit(cache=True, **COMPILED)
def gather_slipping(sliding, friction, slipping, limits, edges, rows, target, classes):
    """Gather the friction torque of a slipping contact over its sliding speed.

    Parameters
    ----------
    sliding, friction : ndarray, shape (n,)
        Sliding speed [rad/s], friction torque over the kinetic one [-].
    slipping : ndarray of bool, shape (n,)
    limits : tuple of float
        Sliding speeds between which a law is fitted [rad/s].
    edges : ndarray, shape (n_classes + 1,)
        Of classes of the sliding speed [rad/s].
    rows : ndarray, shape (n, 4), filled in as far as there is something to fit
        Level, slope, bend and loop of the law [-].
    target : ndarray, shape (n,), filled in alike
        Friction torque over the kinetic one [-].
    classes : ndarray, shape (2, n_classes, 3), filled in
        As the speed rises and as it falls: samples, sum and sum of squares about the mean of the
        friction torque over the kinetic one [-].

    Returns
    -------
    int
        Samples to fit.
    """
    classes[:] = 0.0
    n, m = sliding.size, 0
    for again in range(2):
        for i in range(n):
            if not slipping[i]:
                continue
            faster = sliding[min(i + 1, n - 1)] > sliding[max(i - 1, 0)]
            place, way = _class_of(sliding[i], edges), 0 if faster else 1
            if place >= 0 and again == 0:
                classes[way, place, 0] += 1.0
                classes[way, place, 1] += friction[i]
            elif place >= 0:
                away = friction[i] - classes[way, place, 1] / classes[way, place, 0]
                classes[way, place, 2] += away * away
            if again == 0 and limits[0] < sliding[i] < limits[1]:
                v = sliding[i] / limits[1] - 0.5
                rows[m, 0] = 1.0
                rows[m, 1] = v
                rows[m, 2] = v * v - 1.0 / 12.0
                rows[m, 3] = 0.5 if faster else -0.5
                target[m] = friction[i]
                m += 1
    return m


@njit(cache=True, **COMPILED)
def describe_slips(torque, friction, sliding, starts, ends, near, scratch, found) -> None:
    """Describe each slip.

    Parameters
    ----------
    torque, friction, sliding : ndarray, shape (n,)
        Torque and friction torque [Nm], sliding speed [rad/s].
    starts, ends : ndarray of int, shape (n_slips,)
        First sample of each slip, and first after it.
    near : int
        Samples before a slip in which its peak is looked for, and after it for its trough.
    scratch : ndarray, shape (n,)
        [Nm]
    found : ndarray, shape (4, n_slips), filled in
        Peak of the friction torque, trough of the torque [Nm], fastest sliding speed [rad/s],
        median friction torque [Nm].
    """
    n = torque.size
    for k in range(starts.size):
        a, b = starts[k], ends[k]
        peak, trough, fastest = friction[a], torque[a], sliding[a]
        for i in range(max(a - near, 0), min(a + 2, n)):
            peak = max(peak, friction[i])
        for i in range(a, min(b + near, n)):
            trough = min(trough, torque[i])
        for i in range(a, b):
            fastest = max(fastest, sliding[i])
            scratch[i - a] = friction[i]
        found[0, k], found[1, k], found[2, k] = peak, trough, fastest
        found[3, k] = quantile_in_place(scratch, b - a, 0.5)


@njit(cache=True, **COMPILED)
def mean_cycle(torque, sliding, shaft, starts, ends, before, after, found) -> None:
    """Average over cycles at fixed times before slips and after them.

    Parameters
    ----------
    torque, sliding, shaft : ndarray, shape (n,)
        Torque [Nm], sliding speed and that of the shaft [rad/s].
    starts, ends : ndarray of int, shape (n_slips,)
        First sample of each slip, and first after it.
    before, after : ndarray of int, shape (n_times,)
        Samples before its start, and after its end; where another slip is, it does not count.
    found : ndarray, shape (n_before + n_after, 3), filled in
        Cycles that reach it, sums of the torque [Nm] and of the sliding speed over the shaft's [-].
    """
    found[:] = 0.0
    n_slips, n_before = starts.size, before.size
    for k in range(n_slips):
        earlier = ends[k - 1] if k > 0 else 0
        later = starts[k + 1] if k + 1 < n_slips else torque.size
        for j in range(n_before + after.size):
            at = starts[k] - before[j] if j < n_before else ends[k] + after[j - n_before]
            if (j < n_before and at > earlier) or (j >= n_before and at < later):
                found[j, 0] += 1.0
                found[j, 1] += torque[at]
                found[j, 2] += sliding[at] / max(abs(shaft[at]), 0.05)


@njit(cache=True, **COMPILED)
def gather_rings(signals, first, last, rows, sums):
    """Gather what signals do about their own mean in each stick.

    Parameters
    ----------
    signals : tuple of 4 ndarray, shape (n,)
        [one unit]
    first, last : ndarray of int, shape (n_sticks,)
        First sample of each stick, and first after it.
    rows : ndarray, shape (4, n), filled in stick after stick
        Signals less their mean in the stick [their unit].
    sums : ndarray, shape (4,), filled in
        Of each signal over all sticks [their unit].

    Returns
    -------
    int
        Samples in sticks.
    """
    sums[:] = 0.0
    n = 0
    for k in range(first.size):
        begin, m = n, last[k] - first[k]
        for j, signal in enumerate(signals):
            total = 0.0
            for i in range(first[k], last[k]):
                total += signal[i]
            sums[j] += total
            for i in range(m):
                rows[j, begin + i] = signal[first[k] + i] - total / m
        n += m
    return n


@njit(cache=True, **COMPILED)
def describe_rows(rows, scratch, found) -> None:
    """Describe how the values of each row are distributed.

    Parameters
    ----------
    rows : ndarray, shape (n_rows, n)
        [any units]
    scratch : ndarray, shape (n,)
        [any unit]
    found : ndarray, shape (n_rows, 6), filled in
        Mean, standard deviation, least value, tenth, middle and ninetieth percentile [units of the
        rows].
    """
    n = rows.shape[1]
    for j in range(rows.shape[0]):
        total, second, least = 0.0, 0.0, rows[j, 0]
        for i in range(n):
            scratch[i] = rows[j, i]
            total += rows[j, i]
            least = min(least, rows[j, i])
        mean = total / n
        for i in range(n):
            second += (rows[j, i] - mean) ** 2
        found[j, 0], found[j, 1], found[j, 2] = mean, (second / n) ** 0.5, least
        found[j, 3] = quantile_in_place(scratch, n, 0.1)
        found[j, 4] = quantile_in_place(scratch, n, 0.5)
        found[j, 5] = quantile_in_place(scratch, n, 0.9)
