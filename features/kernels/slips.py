"""Slips: drops in the torque, pulses in the sound, intervals of sliding.

A drop is a fall by a minimum share of the torque's range, and it is sudden if it takes less than
half of the time of the rise after it (thesis, 5.1.1). A harmonic or triangular oscillation falls as
slowly as it rises and so has no slips; if most falls of a signal are not sudden, none counts, since
noise has a few sudden ones. The torque is smoothed to 2 kHz by a Gaussian, which does not
overshoot.

A creak is a sequence of impulses, one at each slip (5.2.3). Their rhythm distinguishes it from rain
or a crackling fire: rate, regularity about a rate that may glide, and height. Pulses are maxima of
the envelope above 2 kHz, smoothed over 1 ms: pulses that ring for 5 ms are resolved up to about 200
per second, and white noise shows about 14 irregular ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import gaussian_filter1d, uniform_filter1d

from features.kernels.conditioning import NOTHING, checked_signal
from features.kernels.spectra import parabola_tops
from models.show import short_repr

_TORQUE_SMOOTHING = math.sqrt(math.log(2.0) / 2.0) / math.pi / 2_000.0
"""Standard deviation of a Gaussian that halves 2 kHz [s]; the torque has little above (5.2.3)."""

_DROP_SHARE = 0.3
"""Smallest drop over the torque's range from its 5th to its 95th percentile."""

_FALLEN = 0.9
"""Share of the drop at which a fall has ended; the ringing after it does not count."""

_SUDDEN = 0.5
"""Longest fall in a slip, as a share of the rise."""

_SLOW = 0.1
"""Length of the running mean whose sign is the direction of the shaft [s]."""

_MIDDLE = (0.2, 0.8)
"""Part of a rise over which its slope is taken."""

_LEAST_SLIPS = 2

_LEAST_FOR_GLIDE = 5


@short_repr
@dataclass(frozen=True, eq=False)
class TorqueSlips:
    """Slips in a torque: rises followed by sudden drops. NaN for fewer than two.

    Parameters
    ----------
    times : ndarray, shape (n_slips,)
        Start of each drop, from the start of the signal [s].
    rate : float
        Slips per second [1/s]; 0 for fewer than two.
    mean_drop : float
        Mean drop [N m].
    drop_variation : float
        Coefficient of variation of the drops [-].
    mean_interval : float
        Mean interval of the slips [s].
    interval_variation : float
        Coefficient of variation of the intervals [-].
    glide : float
        Trend of the slip rate [octave/s]: 1 doubles it in a second. It is the median slope of the
        logarithm, which is robust against missing or spurious slips; NaN for fewer than five slips.
    stick_slope : float
        Median slope of the torque in the middle of the rises [N m/s]. Its ratio to k_EFF times the
        shaft's speed distinguishes true stick from oscillation (thesis, (5.1)).
    stick_curvature : float
        Median ratio of the slopes in the later and earlier half of a rise [-]: below 1 if the
        torque rises ever more slowly (thesis, 5.1.1).
    stick_fraction : float
        Share of the time between slips in which the torque rises.
    asymmetry : float
        Skewness of the slope of the torque's magnitude [-]: strongly negative for slow rises and
        sudden drops, 0 for a harmonic oscillation. Defined for any torque that is not constant.
    """

    times: NDArray[np.float64]
    rate: float
    mean_drop: float
    drop_variation: float
    mean_interval: float
    interval_variation: float
    glide: float
    stick_slope: float
    stick_curvature: float
    stick_fraction: float
    asymmetry: float


def torque_slips(torque: ArrayLike, rate: float) -> TorqueSlips:
    """Find the slips in a torque.

    Parameters
    ----------
    torque : array_like, shape (n_samples,)
        [N m]; signed, also alternating as for an oscillating shaft.
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    TorqueSlips

    Raises
    ------
    ParameterError
        The signal cannot be analysed.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(30000) / 30e3
    >>> slips = torque_slips(8.0 + 2.7 * ((150.0 * t) % 1.0), 30e3)
    >>> round(slips.rate), round(slips.mean_drop, 1), round(slips.stick_slope)
    (149, 2.5, 405)
    """
    from scipy.signal import find_peaks

    x = checked_signal(torque, rate)
    if float(np.ptp(x)) <= NOTHING * float(np.abs(x).max()):
        return _no_slips(math.nan)
    smooth = gaussian_filter1d(x, _TORQUE_SMOOTHING * rate, mode="nearest", truncate=4.0)
    smooth = _upright(smooth, rate)
    asymmetry = _skewness(np.diff(smooth))
    low, high = np.percentile(smooth, [5.0, 95.0])
    peaks, _ = find_peaks(smooth, prominence=max(_DROP_SHARE * float(high - low), 1e-300))
    if peaks.size < _LEAST_SLIPS:
        return _no_slips(asymmetry)
    sudden = _is_sudden(smooth, peaks, _troughs(smooth, peaks))
    if np.count_nonzero(sudden) < max(_LEAST_SLIPS, 0.5 * sudden.size):
        return _no_slips(asymmetry)
    peaks = peaks[sudden]
    troughs = _troughs(smooth, peaks)
    drops = smooth[peaks] - smooth[troughs]
    # A drop that the end of the signal cuts off counts as a slip, but its size is unknown.
    drops = drops[:-1] if troughs[-1] == x.size - 1 else drops
    rises = peaks[1:] - troughs[:-1]
    start, middle, late = (
        troughs[:-1] + np.rint(share * rises).astype(np.intp)
        for share in (_MIDDLE[0], 0.5, _MIDDLE[1])
    )
    first_half, second_half, whole = (
        rate * _slopes(smooth, *ends) for ends in ((start, middle), (middle, late), (start, late))
    )
    intervals = np.diff(peaks) / rate
    rising = first_half > 0.0
    return TorqueSlips(
        times=peaks / rate,
        rate=peaks.size / (x.size / rate),
        mean_drop=float(drops.mean()),
        drop_variation=float(drops.std() / drops.mean()),
        mean_interval=float(intervals.mean()),
        interval_variation=float(intervals.std() / intervals.mean()),
        glide=_glide(parabola_tops(smooth, peaks)[0] / rate),
        stick_slope=_median(whole),
        stick_curvature=_median(second_half[rising] / first_half[rising]),
        stick_fraction=float(rises.sum() / rate / intervals.sum()),
        asymmetry=asymmetry,
    )


def _no_slips(asymmetry: float) -> TorqueSlips:
    """Return the result for a torque without slips; `asymmetry` as in `TorqueSlips`."""
    nan = math.nan
    return TorqueSlips(np.empty(0), 0.0, nan, nan, nan, nan, nan, nan, nan, nan, asymmetry)


def _upright(torque: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Return a torque with the sign that makes friction positive and a slip a fall."""
    slow = uniform_filter1d(torque, min(round(_SLOW * rate), torque.size), mode="nearest")
    fast = float((torque - slow).std())
    if min(float(slow.max()), -float(slow.min())) > 2.0 * fast:  # an oscillating shaft
        return np.asarray(torque * np.sign(slow))
    mean, deviation = float(torque.mean()), float(torque.std())
    if abs(mean) > deviation:
        return torque * math.copysign(1.0, mean)
    return torque if _skewness(np.diff(torque)) < 0.0 else -torque


def _troughs(torque: NDArray[np.float64], peaks: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the index of the minimum between each peak and the next, or the end."""
    ends = np.append(peaks[1:], torque.size)
    return np.array([p + int(torque[p:e].argmin()) for p, e in zip(peaks, ends, strict=True)])


def _is_sudden(
    torque: NDArray[np.float64], peaks: NDArray[np.intp], troughs: NDArray[np.intp]
) -> NDArray[np.bool_]:
    """Return whether the fall after each peak is short compared with the rise after it."""
    falls = np.empty(peaks.size)
    for i, (peak, trough) in enumerate(zip(peaks, troughs, strict=True)):
        level = torque[peak] - _FALLEN * (torque[peak] - torque[trough])
        falls[i] = int((torque[peak : trough + 1] <= level).argmax())
    rises = np.append(peaks[1:] - troughs[:-1], peaks[-1] - troughs[-2])
    return np.asarray(falls < _SUDDEN * rises)


def _glide(times: NDArray[np.float64]) -> float:
    """Return the slope of the slip rate's logarithm [octave/s].

    H. Theil, A rank-invariant method of linear and polynomial regression analysis, Proc. Kon. Ned.
    Akad. v. Wetensch. A 53 (1950) 386-392: the incomplete method, with as many pairs as slips.
    """
    if times.size < _LEAST_FOR_GLIDE:
        return math.nan
    rate = -np.log2(np.diff(times))
    middle = 0.5 * (times[1:] + times[:-1])
    half = rate.size // 2
    return _median((rate[half:] - rate[:-half]) / (middle[half:] - middle[:-half]))


def _slopes(
    torque: NDArray[np.float64], first: NDArray[np.intp], last: NDArray[np.intp]
) -> NDArray[np.float64]:
    """Return the least-squares slope of each interval [N m/sample]; NaN below three samples."""
    centred = torque - torque.mean()
    index = np.arange(torque.size, dtype=np.float64)
    zeroth = np.append(0.0, np.cumsum(centred))
    moment = np.append(0.0, np.cumsum(centred * index))
    n = (last - first + 1).astype(np.float64)
    sums = zeroth[last + 1] - zeroth[first]
    moments = moment[last + 1] - moment[first]
    spread = np.where(n > 2, n * (n**2 - 1.0) / 12.0, np.nan)
    return np.asarray((moments - 0.5 * (first + last) * sums) / spread)


def _skewness(values: NDArray[np.float64]) -> float:
    centred = values - values.mean()
    deviation = float(centred.std())
    if not deviation > 0.0:
        return math.nan
    centred /= deviation
    # Not centred**3, which takes twenty times as long as the product.
    return float((centred * centred * centred).mean())


def _median(values: NDArray[np.float64]) -> float:
    values = values[np.isfinite(values)]
    return float(np.median(values)) if values.size else math.nan


PULSE_BAND_FROM = 2_000.0
"""Lower limit of the band of pulses [Hz]; lower for a rate below 16 kHz."""

_PULSE_SMOOTHING = 0.0005
"""Standard deviation of the Gaussian that smooths the squared envelope [s]."""

_PULSE_PROMINENCE_DB = 6.0
"""Least rise and fall of a pulse [dB]."""

_LEAST_PULSES = 4

_LEAST_HIGH_SHARE = 1e-6
"""Relative power of the high band below which it contains leakage only."""

_PULSE_RANGE_DB = 25.0
"""Largest distance of a pulse below the strongest [dB]."""


@short_repr
@dataclass(frozen=True, eq=False)
class Pulses:
    """Pulses in a sound or an acceleration, as at each slip of a creak.

    Parameters
    ----------
    rate : float
        Pulses per second [1/s]; 0 for fewer than two. The fades at the signal's ends do not count.
    irregularity : float
        Median magnitude of the logarithm of the ratio of successive intervals: 0 for a clock, even
        if its rate glides or a pulse is missing, 1.1 (the logarithm of 3) for a Poisson process.
        NaN for fewer than four pulses.
    glide : float
        Trend of the rate's logarithm [1/s]: 0.7 doubles the rate in a second. NaN for fewer than
        four pulses.
    crest_factor : float
        Peak of the envelope over the rms value of the signal [-]; 1.41 for a tone.
    kurtosis : float
        Kurtosis of the signal below 7 kHz [-]: 1.5 for a tone, 3 for noise, more for pulses.
    high_kurtosis : float
        Kurtosis of the band of pulses [-]; NaN if that has less than a millionth of the power.
    concentration : float
        Share of that band's energy in the loudest tenth of the time, 0.1 to 1; NaN as before.
    """

    rate: float
    irregularity: float
    glide: float
    crest_factor: float
    kurtosis: float
    high_kurtosis: float
    concentration: float


_NO_PULSES = Pulses(0.0, *[math.nan] * 6)
"""Result for a signal without content."""


def pulses_of(
    whole: NDArray[np.complex128], high: NDArray[np.complex128], high_rate: float
) -> Pulses:
    """Find the pulses in a sound or an acceleration from its analytic signals.

    Parameters
    ----------
    whole, high : ndarray of complex, shape (n,)
        Analytic signals of the described band, and of the band of pulses.
    high_rate : float
        Sampling rate of the latter [Hz].

    Returns
    -------
    Pulses

    Examples
    --------
    >>> import numpy as np
    >>> pulses_of(np.ones(100, complex), np.ones(100, complex), 1e3).rate
    0.0
    """
    power = squared(whole)
    high_power = squared(high)
    mean = float(power.mean())
    if not mean > 0.0:
        return _NO_PULSES
    crest_factor = math.sqrt(2.0 * float(power.max()) / mean)
    if float(high_power.mean()) < _LEAST_HIGH_SHARE * mean:
        return replace(_NO_PULSES, crest_factor=crest_factor, kurtosis=envelope_kurtosis(power))
    smooth = gaussian_filter1d(
        high_power, _PULSE_SMOOTHING * high_rate, mode="nearest", truncate=3.0
    )
    times = _pulse_times(smooth, high_rate)
    irregularity, glide = _rhythm(times)
    tenth = max(1, smooth.size // 10)
    loudest = np.partition(smooth, -tenth)[-tenth:]
    return Pulses(
        rate=times.size / (high.size / high_rate) if times.size > 1 else 0.0,
        irregularity=irregularity,
        glide=glide,
        crest_factor=crest_factor,
        kurtosis=envelope_kurtosis(power),
        high_kurtosis=envelope_kurtosis(high_power),
        concentration=float(loudest.sum()) / float(smooth.sum()),
    )


def envelope_kurtosis(power: NDArray[np.float64]) -> float:
    """Return the kurtosis of a band-limited signal from its squared envelope; NaN if that is zero.

    It is 1.5 times the normalised second moment of the squared envelope, which equals the kurtosis
    of the samples for a uniformly distributed phase, but needs only the band's own rate.

    Parameters
    ----------
    power : ndarray, shape (n,)
        Squared envelope [unit^2].

    Returns
    -------
    float
        [-]

    Examples
    --------
    >>> import numpy as np
    >>> envelope_kurtosis(np.ones(8))
    1.5
    """
    mean = float(power.mean())
    # Not power @ power: starting BLAS threads for a long dot product costs more than it saves.
    return 1.5 * float(np.mean(power**2)) / mean**2 if mean > 0.0 else math.nan


def squared(analytic: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return the squared envelope of an analytic signal.

    Parameters
    ----------
    analytic : ndarray of complex, shape (n,)
        In any unit.

    Returns
    -------
    ndarray, shape (n,)
        [unit^2]

    Examples
    --------
    >>> import numpy as np
    >>> squared(np.array([3.0 + 4.0j])).tolist()
    [25.0]
    """
    return np.asarray(analytic.real**2 + analytic.imag**2)


def _pulse_times(smooth: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Return the times of the maxima of a smoothed squared envelope [s]."""
    from scipy.signal import find_peaks

    top = float(smooth.max())
    if not top > 0.0:
        return np.empty(0)
    level = 10.0 * np.log10(np.maximum(smooth / top, 1e-12))
    peaks, _ = find_peaks(level, height=-_PULSE_RANGE_DB, prominence=_PULSE_PROMINENCE_DB)
    return np.asarray(peaks / rate)


def _rhythm(times: NDArray[np.float64]) -> tuple[float, float]:
    """Return irregularity and glide of pulses, from the logarithms of their intervals."""
    if times.size < _LEAST_PULSES:
        return math.nan, math.nan
    interval = np.log(np.diff(times))
    middle = 0.5 * (times[1:] + times[:-1])
    middle = middle - middle.mean()
    slope = float(middle @ interval / (middle @ middle))
    return float(np.median(np.abs(np.diff(interval)))), -slope


def slip_intervals(
    speed: NDArray[np.float64], *, above: float, below: float, apart: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Find the intervals of slip in a sliding speed.

    Parameters
    ----------
    speed : ndarray, shape (n_samples,)
        Sliding speed [rad/s].
    above, below : float
        Speed above which a slip begins, and lower speed below which it ends [rad/s].
    apart : int
        Slips with fewer samples between them are merged [-].

    Returns
    -------
    starts, ends : ndarray of int, shape (n_slips,)
        First sample of each slip, and first sample after it. A slip without an end is left out.

    Examples
    --------
    >>> speed = np.array([0.0, 5.0, 2.0, 5.0, 0.0, 0.0, 0.0, 4.0, 0.0, 6.0])
    >>> starts, ends = slip_intervals(speed, above=3.0, below=1.0, apart=2)
    >>> starts.tolist(), ends.tolist()
    ([1, 7], [4, 8])
    """
    decided = np.flatnonzero((speed > above) | (speed < below))
    slipping = speed[decided] > above
    turns = decided[slipping != np.append(False, slipping[:-1])]
    first, last = turns[: turns.size // 2 * 2].reshape(-1, 2).T
    edge = np.ones(first.size + 1, np.bool_)
    edge[1:-1] = first[1:] - last[:-1] >= apart
    return first[edge[:-1]], last[edge[1:]]


def in_intervals(
    starts: NDArray[np.int64], ends: NDArray[np.int64], n_samples: int, *, margin: int = 0
) -> NDArray[np.bool_]:
    """Return whether each sample lies in one of several intervals, or close to one.

    Parameters
    ----------
    starts, ends : ndarray of int, shape (n_intervals,)
        First sample of each interval, and first sample after it.
    n_samples : int
    margin : int
        Samples added on either side [-].

    Returns
    -------
    ndarray of bool, shape (n_samples,)

    Examples
    --------
    >>> in_intervals(np.array([1]), np.array([3]), 5).tolist()
    [False, True, True, False, False]
    """
    step = np.zeros(n_samples + 1, np.int64)
    np.add.at(step, np.maximum(starts - margin, 0), 1)
    np.add.at(step, np.minimum(ends + margin, n_samples), -1)
    return np.asarray(np.cumsum(step)[:n_samples] > 0)
