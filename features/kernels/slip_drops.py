"""Slips in the torque: it rises with time, then suddenly drops.

That is how Section 5.1.1 of the thesis tells stick-slip from the other oscillations, and it is
taken literally: a drop is a fall by a fair share of the torque's range, and it is sudden if it took
less than half of the time of the rise after it. A harmonic or triangular oscillation falls as
slowly as it rises and so has no slips; if most falls of a signal are not sudden, none counts, since
noise has a few that are. The torque is smoothed to 2 kHz by a Gaussian, which does not overshoot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import gaussian_filter1d, uniform_filter1d

from features.kernels.conditioning import NOTHING, checked_signal
from features.kernels.lines import interpolated
from models.show import short_repr

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "TorqueSlips",
    "alternates",
    "described_slips",
    "no_slips",
    "slope_ends",
    "sudden_falls",
    "torque_slips",
    "upright_sign",
]

SMOOTHING = math.sqrt(math.log(2.0) / 2.0) / math.pi / 2_000.0
"""Standard deviation of a Gaussian that halves 2 kHz [s]: the torque has little above (5.2.3)."""

DROP_SHARE = 0.3
"""A drop is at least this share of the torque's range from its 5th to its 95th percentile."""

FALLEN = 0.9
"""A fall has ended when this share of the drop is done; what rings on is not part of it."""

SUDDEN = 0.5
"""Longest fall in a slip, as a share of the rise."""

SLOW = 0.1
"""Length of the running mean that shows which way the shaft turns [s]."""

_MIDDLE = (0.2, 0.8)
"""Part of a rise over which its slope is taken."""

LEAST_SLIPS = 2

_LEAST_FOR_GLIDE = 5


@short_repr
@dataclass(frozen=True, eq=False)
class TorqueSlips:
    """Slips in a torque: it rises, then suddenly drops. NaN where there are fewer than two.

    Parameters
    ----------
    times : ndarray, shape (n_slips,)
        When each drop begins, from the start of the signal [s].
    rate : float
        Slips in a second [1/s], 0 for fewer than two.
    mean_drop : float
        Mean fall [N m].
    drop_variation : float
        Coefficient of variation of the falls [-].
    mean_interval : float
        [s]
    interval_variation : float
        Coefficient of variation of the intervals [-].
    glide : float
        Trend of the slip rate [octave/s]: 1 doubles it in a second. Median slope of its logarithm,
        which a slip missed or made up does not move; NaN for fewer than five slips.
    stick_slope : float
        Median slope of the torque in the middle of the rises [N m/s]. Its quotient with k_EFF times
        the shaft's speed tells true stick from mere oscillation (thesis, (5.1)).
    stick_curvature : float
        Slope in the later over that in the earlier half of a rise, median [-]: below 1 where the
        torque rises ever more slowly (thesis, 5.1.1).
    stick_fraction : float
        Share of the time between slips in which the torque is on its way up.
    asymmetry : float
        Skewness of the torque's slope away from zero [-]: strongly negative where it rises slowly
        and drops, 0 for a harmonic oscillation. Given for any torque that is not constant.
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
        [N m]; of either sign, also alternating as a shaft that oscillates makes it.
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    TorqueSlips

    Raises
    ------
    ParameterError
        A signal that can't be analysed.

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
        return no_slips(math.nan)
    smooth = gaussian_filter1d(x, SMOOTHING * rate, mode="nearest", truncate=4.0)
    smooth = _upright(smooth, rate)
    asymmetry = _skewness(np.diff(smooth))
    low, high = np.percentile(smooth, [5.0, 95.0])
    peaks, _ = find_peaks(smooth, prominence=max(DROP_SHARE * float(high - low), 1e-300))
    if peaks.size < LEAST_SLIPS:
        return no_slips(asymmetry)
    sudden = _is_sudden(smooth, peaks, _troughs(smooth, peaks))
    if np.count_nonzero(sudden) < max(LEAST_SLIPS, 0.5 * sudden.size):
        return no_slips(asymmetry)
    peaks = peaks[sudden]
    troughs = _troughs(smooth, peaks)
    drops = smooth[peaks] - smooth[troughs]
    # A fall that the end of the signal cuts off is an event, but its size is not known.
    drops = drops[:-1] if troughs[-1] == x.size - 1 else drops
    start, middle, late = slope_ends(peaks, troughs)
    return described_slips(
        peaks,
        interpolated(smooth, peaks),
        troughs,
        drops,
        [_slopes(smooth, *ends) for ends in ((start, middle), (middle, late), (start, late))],
        n_samples=x.size,
        rate=rate,
        asymmetry=asymmetry,
    )


def slope_ends(
    peaks: NDArray[np.intp], troughs: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Begin, middle and end of the part of each rise over which slopes are taken.

    Parameters
    ----------
    peaks, troughs : ndarray of int, shape (n,)
        Where each slip begins and ends [sample].

    Returns
    -------
    start, middle, late : ndarray of int, shape (n - 1,)
        [sample]
    """
    rises = peaks[1:] - troughs[:-1]
    start, middle, late = (
        troughs[:-1] + np.rint(share * rises).astype(np.intp)
        for share in (_MIDDLE[0], 0.5, _MIDDLE[1])
    )
    return start, middle, late


def described_slips(
    peaks: NDArray[np.intp],
    exact: NDArray[np.float64],
    troughs: NDArray[np.intp],
    drops: NDArray[np.float64],
    slopes: Sequence[NDArray[np.float64]],
    *,
    n_samples: int,
    rate: float,
    asymmetry: float,
) -> TorqueSlips:
    """`torque_slips` of a torque whose slips are known one by one.

    Parameters
    ----------
    peaks, troughs : ndarray of int, shape (n,)
        Where each slip begins and ends [sample].
    exact : ndarray, shape (n,)
        Where it begins, between samples [sample].
    drops : ndarray, shape (n,)
        How far the torque falls [N m]; of the last, where that is known.
    slopes : sequence of ndarray, shape (n - 1,)
        In the earlier half of each rise, in the later, and in both [N m/sample].
    n_samples : int
        Of the torque.
    rate : float
        Sampling rate [Hz].
    asymmetry : float
        As in `TorqueSlips`.

    Returns
    -------
    TorqueSlips
    """
    first_half, second_half, whole = (slope * rate for slope in slopes)
    intervals = np.diff(peaks) / rate
    rises = peaks[1:] - troughs[:-1]
    rising = first_half > 0.0
    return TorqueSlips(
        times=peaks / rate,
        rate=peaks.size / (n_samples / rate),
        mean_drop=float(drops.mean()),
        drop_variation=float(drops.std() / drops.mean()),
        mean_interval=float(intervals.mean()),
        interval_variation=float(intervals.std() / intervals.mean()),
        glide=_glide(exact / rate),
        stick_slope=_median(whole),
        stick_curvature=_median(second_half[rising] / first_half[rising]),
        stick_fraction=float(rises.sum() / rate / intervals.sum()),
        asymmetry=asymmetry,
    )


def no_slips(asymmetry: float) -> TorqueSlips:
    """Return what is known of a torque without slips; `asymmetry` as in `TorqueSlips`."""
    nan = math.nan
    return TorqueSlips(np.empty(0), 0.0, nan, nan, nan, nan, nan, nan, nan, nan, asymmetry)


def _upright(torque: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Turn a torque so that friction is positive and a slip is a fall."""
    slow = uniform_filter1d(torque, min(round(SLOW * rate), torque.size), mode="nearest")
    if alternates(float(slow.min()), float(slow.max()), float((torque - slow).std())):
        return np.asarray(torque * np.sign(slow))
    mean, deviation = float(torque.mean()), float(torque.std())
    return torque * upright_sign(mean, deviation, _skewness(np.diff(torque)))


def alternates(lowest: float, highest: float, fast: float) -> bool:
    """Whether a torque goes to and fro, as a shaft that oscillates makes it.

    Parameters
    ----------
    lowest, highest : float
        Of the torque's running mean [N m].
    fast : float
        Standard deviation about that [N m].

    Returns
    -------
    bool

    Examples
    --------
    >>> alternates(-8.0, 8.0, 1.0), alternates(7.0, 8.0, 1.0)
    (True, False)
    """
    return min(highest, -lowest) > 2.0 * fast


def upright_sign(mean: float, deviation: float, skewness: float) -> float:
    """Return the sign that makes friction positive and a slip a fall, of a torque that stays.

    Parameters
    ----------
    mean, deviation : float
        Of the torque [N m].
    skewness : float
        Of its steps [-].

    Returns
    -------
    float
        1 or -1 [-].

    Examples
    --------
    >>> upright_sign(-8.0, 1.0, -0.5), upright_sign(0.0, 1.0, -0.5)
    (-1.0, 1.0)
    """
    if abs(mean) > deviation:
        return math.copysign(1.0, mean)
    return 1.0 if skewness < 0.0 else -1.0


def _troughs(torque: NDArray[np.float64], peaks: NDArray[np.intp]) -> NDArray[np.intp]:
    """Index of the minimum between each peak and the next, or the end."""
    ends = np.append(peaks[1:], torque.size)
    return np.array([p + int(torque[p:e].argmin()) for p, e in zip(peaks, ends, strict=True)])


def _is_sudden(
    torque: NDArray[np.float64], peaks: NDArray[np.intp], troughs: NDArray[np.intp]
) -> NDArray[np.bool_]:
    """Whether the fall after each peak is short beside the rise that follows it."""
    falls = np.empty(peaks.size)
    for i, (peak, trough) in enumerate(zip(peaks, troughs, strict=True)):
        level = torque[peak] - FALLEN * (torque[peak] - torque[trough])
        falls[i] = int((torque[peak : trough + 1] <= level).argmax())
    return sudden_falls(falls, peaks, troughs)


def sudden_falls(
    falls: NDArray[np.float64], peaks: NDArray[np.intp], troughs: NDArray[np.intp]
) -> NDArray[np.bool_]:
    """Whether falls are short beside the rises that follow them.

    Parameters
    ----------
    falls : ndarray, shape (n,)
        How long each takes [sample].
    peaks, troughs : ndarray of int, shape (n,)
        Where each begins and ends [sample]; two at least.

    Returns
    -------
    ndarray of bool, shape (n,)

    Examples
    --------
    >>> sudden_falls(np.array([2.0, 2.0]), np.array([10, 20]), np.array([13, 23])).tolist()
    [True, True]
    """
    rises = np.append(peaks[1:] - troughs[:-1], peaks[-1] - troughs[-2])
    return np.asarray(falls < SUDDEN * rises)


def _glide(times: NDArray[np.float64]) -> float:
    """Slope of the slip rate's logarithm [octave/s].

    H. Theil, A rank-invariant method of linear and polynomial regression analysis, Proc. Kon. Ned.
    Akad. v. Wetensch. A 53 (1950) 386-392: his incomplete method, whose pairs are as many as slips.
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
    """Least-squares slope from each first to each last sample [N m/sample]; NaN below three."""
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
    # Not centred**3: a power other than the second takes twenty times as long as a product.
    return float((centred * centred * centred).mean())


def _median(values: NDArray[np.float64]) -> float:
    values = values[np.isfinite(values)]
    return float(np.median(values)) if values.size else math.nan
