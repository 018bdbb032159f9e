"""The period of a vibration from its autocorrelation, at any pitch and with any fundamental.

A friction vibration may repeat five times a second or seven thousand times, and the line at its
fundamental may be the weakest of all: in stick-slip with feedback from the beams the third or
fourth harmonic of the slip frequency leads (thesis, 5.2.1), and pulses that excite resonances
radiate little at their own rate. The autocorrelation sees the period in any of these, where the
strongest line or the distance of lines is misled. It is taken of the signal whitened by half (in
decibels) in one-third octaves, so that one strong resonance does not hide the period, and divided
by the energy it is taken over, so that a burst is not mistaken for an aperiodic signal. Of the
maxima nearly as high as the highest the one at the shortest lag is the period, as its multiples
are as high.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy import fft

from features.kernels.lines import interpolated

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "OVERSAMPLING",
    "Period",
    "lags_of",
    "period_of",
    "strongest_period",
    "track_periods",
    "whitening_gain",
]

_NEARLY = 0.9
"""A maximum this high relative to the highest is the period if its lag is shorter."""

_PERIODS = 2.0
"""Periods that a signal must hold."""

_WHITENING = 0.5
"""Share of the level differences between one-third octaves that whitening removes."""

_SIXTH_OCTAVE = 2.0 ** (1.0 / 6.0) - 1.0

_LEAST_REACH = 20.0
"""Half the width over which whitening averages where one-third octaves are narrower [Hz]."""

OVERSAMPLING = 2
"""Values of an autocorrelation a lag."""

_TRACK_OVERSAMPLING = 4


class Period(NamedTuple):
    """Repetition of a signal.

    Parameters
    ----------
    frequency : float
        Repetitions in a second [Hz]; NaN if there are none.
    strength : float
        Normalised autocorrelation at the period [-]: 1 where every period is like the one before, 0
        where there is none.
    """

    frequency: float
    strength: float


_NONE = Period(math.nan, 0.0)


def strongest_period(
    x: NDArray[np.float64], rate: float, *, lowest: float, highest: float, whiten: bool = True
) -> Period:
    """Period of a whole signal.

    Parameters
    ----------
    x : ndarray, shape (n_samples,)
        Mean removed, in any [unit].
    rate : float
        Sampling rate [Hz].
    lowest, highest : float
        Limits of the search [Hz]. The signal must hold two periods, which may raise `lowest`.
    whiten : bool
        Whether to whiten, as an envelope need not be.

    Returns
    -------
    Period

    Notes
    -----
    Normalisation: P. McLeod and G. Wyvill, A smarter way to find pitch, Proc. ICMC (2005).
    Compressing the spectrum before the autocorrelation: T. Tolonen and M. Karjalainen, IEEE Trans.
    Speech Audio Process. 8 (2000) 708-716.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(8000) / 16e3
    >>> missing = np.sin(2 * np.pi * 400 * t) + np.sin(2 * np.pi * 600 * t)
    >>> round(strongest_period(missing, 16e3, lowest=5.0, highest=7e3).frequency)
    200
    """
    n = x.size
    n_lags = lags_of(n, rate, lowest)
    length = int(fft.next_fast_len(n + n_lags, real=True))
    bins = fft.rfft(x, length)
    if whiten:
        bins *= whitening_gain(bins.real**2 + bins.imag**2, rate / length)
        x = fft.irfft(bins, length)[:n]
    power = bins.real**2 + bins.imag**2
    correlation = fft.irfft(power, OVERSAMPLING * length)[: OVERSAMPLING * n_lags]
    energy = np.append(0.0, np.cumsum(x**2))
    if not energy[-1] > 0.0:
        return _NONE
    shared = 0.5 * (energy[n - n_lags :][::-1] + energy[-1] - energy[: n_lags + 1]) / energy[-1]
    return period_of(correlation, shared, rate, highest=highest)


def lags_of(n_samples: int, rate: float, lowest: float) -> int:
    """Lags at which a period is sought.

    Parameters
    ----------
    n_samples : int
        Of the signal, which must hold two periods.
    rate : float
        Sampling rate [Hz].
    lowest : float
        Lower limit of the search [Hz].

    Returns
    -------
    int

    Examples
    --------
    >>> lags_of(16_000, 16e3, 5.0), lags_of(1_000, 16e3, 5.0)
    (3201, 500)
    """
    return min(int(n_samples / _PERIODS), math.ceil(rate / lowest) + 1)


def period_of(
    correlation: NDArray[np.float64], shared: NDArray[np.float64], rate: float, *, highest: float
) -> Period:
    """Period of a signal whose autocorrelation is at hand.

    Parameters
    ----------
    correlation : ndarray, shape (2 n_lags,)
        At every half lag from 0 on [unit^2].
    shared : ndarray, shape (n_lags + 1,)
        Share of the signal's energy that each is taken over [-].
    rate : float
        Sampling rate [Hz].
    highest : float
        Upper limit of the search [Hz].

    Returns
    -------
    Period

    Examples
    --------
    >>> lags = np.arange(400) / 2
    >>> round(period_of(np.cos(2 * np.pi * lags / 40), np.ones(201), 16e3, highest=7e3).frequency)
    400
    """
    if not correlation[0] > 0.0:
        return _NONE
    n_lags = shared.size - 1
    lags = np.arange(correlation.size) / OVERSAMPLING
    overlap = np.interp(lags, np.arange(n_lags + 1), shared)
    normalised = correlation / (correlation[0] * np.maximum(overlap, 1e-3))
    crossing = np.flatnonzero(normalised < 0.0)
    if crossing.size == 0:
        return _NONE
    first = max(int(crossing[0]), math.floor(OVERSAMPLING * rate / highest))
    peaks = _maxima(normalised, first)
    if peaks.size == 0:
        return _NONE
    heights = _heights(normalised, peaks)
    highest_peak = float(heights.max())
    if not highest_peak > 0.0:
        return _NONE
    best = int(np.argmax(heights >= _NEARLY * highest_peak))
    lag = float(interpolated(normalised, peaks[best : best + 1])[0]) / OVERSAMPLING
    return Period(rate / lag, min(1.0, float(heights[best])))


def track_periods(
    power: NDArray[np.float64], spacing: float, *, lowest: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Period of each of many short segments, from their power spectra.

    Parameters
    ----------
    power : ndarray, shape (n_segments, n_bins)
        In any [unit^2], of Hann-windowed segments, from 0 Hz; bins that shall not count are 0.
    spacing : float
        Distance between the bins [Hz].
    lowest : float
        Lower limit of the search [Hz], at least 3 times `spacing`.

    Returns
    -------
    frequency : ndarray, shape (n_segments,)
        [Hz]; NaN where a segment has no period.
    strength : ndarray, shape (n_segments,)
        Autocorrelation at the period over that of the window [-] (P. Boersma, Proc. Inst. Phonetic
        Sci. 17 (1993) 97-110).

    Examples
    --------
    >>> import numpy as np
    >>> from features.kernels.segments import segment_powers
    >>> tone = np.sin(2 * np.pi * 400 * np.arange(4096) / 16e3)
    >>> power, _ = segment_powers(tone, 1024)
    >>> track_periods(power, 16e3 / 1024, lowest=60.0)[0].round().tolist()
    [400.0, 400.0, 400.0, 400.0, 400.0, 400.0, 400.0]
    """
    length = 2 * (power.shape[1] - 1)
    correlation = fft.irfft(power, _TRACK_OVERSAMPLING * length, axis=1)
    rate = _TRACK_OVERSAMPLING * length * spacing
    n_lags = math.ceil(rate / lowest) + 2
    lags = np.arange(n_lags) / (_TRACK_OVERSAMPLING * length)
    window = (1.0 - lags) * (2.0 + np.cos(2.0 * np.pi * lags)) / 3.0
    window += np.sin(2.0 * np.pi * lags) / (2.0 * np.pi)
    energy = np.maximum(correlation[:, :1], np.finfo(float).tiny)
    normalised = correlation[:, :n_lags] / (energy * window)
    negative = normalised < 0.0
    first = np.where(negative.any(axis=1), negative.argmax(axis=1), n_lags)
    beyond = np.arange(1, n_lags - 1) >= first[:, np.newaxis]
    middle = normalised[:, 1:-1]
    rising = (middle > normalised[:, :-2]) & (middle >= normalised[:, 2:])
    heights = np.where(beyond & rising, middle, 0.0)
    top = heights.max(axis=1)
    best = np.argmax(heights >= _NEARLY * np.maximum(top, 1e-9)[:, np.newaxis], axis=1) + 1
    found = top > 0.0
    rows = np.arange(power.shape[0])
    left, centre, right = (normalised[rows, best + shift] for shift in (-1, 0, 1))
    curvature = np.where(found, left - 2.0 * centre + right, -1.0)
    curvature = np.minimum(curvature, -np.finfo(float).tiny)
    lag = best + np.where(found, np.clip(0.5 * (left - right) / curvature, -0.5, 0.5), 0.0)
    frequency = np.where(found, rate / lag, np.nan)
    return frequency, np.where(found, np.minimum(centre, 1.0), 0.0)


def whitening_gain(power: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """Gain that brings neighbouring one-third octaves nearer to each other; 0 Hz is removed.

    Parameters
    ----------
    power : ndarray, shape (n_bins,)
        Of a signal by frequency, from 0 Hz [unit^2].
    spacing : float
        Distance between the bins [Hz].

    Returns
    -------
    ndarray, shape (n_bins,)
        [-]

    Examples
    --------
    >>> whitening_gain(np.full(4, 16.0), 4.0).round(3).tolist()
    [0.0, 0.5, 0.5, 0.5]
    """
    below = np.append(0.0, np.cumsum(power))
    index = np.arange(power.size)
    reach = np.maximum(index * _SIXTH_OCTAVE, _LEAST_REACH / spacing)
    start = np.maximum(index - reach, 0).astype(np.intp)
    stop = np.minimum(index + reach + 1, power.size).astype(np.intp)
    smooth = (below[stop] - below[start]) / (stop - start)
    least = max(1e-12 * float(smooth.max()), np.finfo(float).tiny)
    gain = np.asarray(np.maximum(smooth, least) ** (-0.5 * _WHITENING))
    gain[0] = 0.0
    return gain


def _maxima(values: NDArray[np.float64], first: int) -> NDArray[np.intp]:
    """Find the indices of local maxima from `first` on, the ends excluded."""
    first = max(first, 1)
    middle = values[first:-1]
    rising = (middle > values[first - 1 : -2]) & (middle >= values[first + 1 :])
    return np.flatnonzero(rising) + first


def _heights(values: NDArray[np.float64], peaks: NDArray[np.intp]) -> NDArray[np.float64]:
    """Heights of the parabolas through local maxima."""
    left, middle, right = values[peaks - 1], values[peaks], values[peaks + 1]
    curvature = left - 2.0 * middle + right
    safe = np.where(curvature < 0.0, curvature, -1.0)
    return np.asarray(middle - np.where(curvature < 0.0, (left - right) ** 2 / (8.0 * safe), 0.0))
