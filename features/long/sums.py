"""What is summed up of a signal that comes piece by piece: moments, spectra, autocorrelation."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

from features.kernels.periodicity import (
    OVERSAMPLING,
    Period,
    lags_of,
    period_of,
    whitening_gain,
)
from features.kernels.segments import hann, segment_count, windowed_transforms
from features.kernels.spectra import Spectrum, density_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

__all__ = ["Correlation", "Moments", "SegmentPowers", "WelchSum"]

_AT_ONCE = 1 << 18
"""Samples of segments that are transformed together."""

_BLOCK = 16
_REACH = 4
"""Length of what is correlated at once, and what is looked at beyond it, in largest lags."""


class Moments:
    """Sums of a signal's powers, and its extremes.

    Examples
    --------
    >>> moments = Moments()
    >>> moments.add(np.array([1.0, 3.0]))
    >>> moments.mean, moments.variance, moments.highest
    (2.0, 1.0, 3.0)
    """

    def __init__(self) -> None:
        self.n = 0
        self.lowest, self.highest = math.inf, -math.inf
        self._about = 0.0
        self._sums = np.zeros(4)

    def add(self, x: NDArray[np.float64]) -> None:
        """Take the next samples.

        Parameters
        ----------
        x : ndarray, shape (n,)
            In any [unit].
        """
        if not x.size:
            return
        if not self.n:
            self._about = float(x.mean())
        self.n += x.size
        self.lowest = min(self.lowest, float(x.min()))
        self.highest = max(self.highest, float(x.max()))
        off = x - self._about
        power = off * off
        self._sums += off.sum(), power.sum(), (power * off).sum(), (power * power).sum()

    @property
    def mean(self) -> float:
        """Mean [unit]."""
        return self._about + float(self._sums[0]) / self.n

    @property
    def variance(self) -> float:
        """Mean square about the mean [unit^2]."""
        return max(0.0, self._central(2))

    @property
    def mean_square(self) -> float:
        """Mean square [unit^2]."""
        return self.variance + self.mean**2

    @property
    def skewness(self) -> float:
        """Third moment over the deviation's third power [-]; NaN where nothing varies."""
        return self._central(3) / self.variance**1.5 if self.variance > 0.0 else math.nan

    @property
    def raw_kurtosis(self) -> float:
        """Mean fourth power over the squared variance [-]; NaN where nothing varies."""
        if not self.variance > 0.0:
            return math.nan
        about, (s1, s2, s3, s4) = self._about, (self._sums / self.n).tolist()
        fourth = s4 + 4.0 * about * s3 + 6.0 * about**2 * s2 + 4.0 * about**3 * s1 + about**4
        return float(fourth) / self.variance**2

    def _central(self, order: int) -> float:
        s1, s2, s3, _ = (self._sums / self.n).tolist()
        return float(s2 - s1**2 if order == 2 else s3 - 3.0 * s1 * s2 + 2.0 * s1**3)


class SegmentPowers:
    """`features.kernels.segments.segment_powers` of a signal that comes piece by piece.

    Parameters
    ----------
    n_samples : int
        Of the signal.
    length : int
        Samples of a segment, at most `n_samples`.

    Examples
    --------
    >>> powers = SegmentPowers(1000, 256)
    >>> [part.shape for part in powers.add(np.zeros(1000))]
    [(7, 129)]
    """

    def __init__(self, n_samples: int, length: int) -> None:
        self.count = segment_count(n_samples, length)
        self._step = (n_samples - length) / max(self.count - 1, 1)
        self._n, self._length = n_samples, length
        self._held = np.empty(0)
        self._first = 0
        self._next = 0

    def add(self, piece: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
        """Take the next samples; yield the powers of the segments that they complete.

        Parameters
        ----------
        piece : ndarray, shape (n,)
            In any [unit].

        Yields
        ------
        ndarray, shape (n_segments, n_bins)
            [unit^2]
        """
        self._held = np.concatenate([self._held, piece])
        end = self._first + self._held.size
        at_once = max(1, _AT_ONCE // self._length)
        while True:
            number = np.arange(self._next, min(self._next + at_once, self.count))
            starts = np.rint(number * self._step).astype(np.intp)
            starts = starts[starts + self._length <= end]
            if not starts.size:
                break
            view = np.lib.stride_tricks.sliding_window_view(self._held, self._length)
            bins = windowed_transforms(view[starts - self._first], hann(self._length), self._length)
            power = bins.real**2
            power += bins.imag**2
            self._next += starts.size
            yield power
        done = min(round(self._next * self._step), end)
        self._held = self._held[max(0, done - self._first) :].copy()
        self._first = max(self._first, done)


class WelchSum:
    """`features.kernels.spectra.welch` of a signal that comes piece by piece.

    Parameters
    ----------
    n_samples : int
        Of the signal.
    rate : float
        Sampling rate [Hz].
    resolution : float
        Spacing of the bins wanted [Hz].

    Examples
    --------
    >>> total = WelchSum(100, 100.0, 4.0)
    >>> total.add(np.ones(60))
    >>> total.add(np.ones(40))
    >>> total.spectrum().n_segments
    7
    """

    def __init__(self, n_samples: int, rate: float, resolution: float) -> None:
        self._rate = rate
        self._length = min(n_samples, max(16, round(rate / resolution)))
        self._powers = SegmentPowers(n_samples, self._length)
        self._sum = np.zeros(self._length // 2 + 1)

    def add(self, piece: NDArray[np.float64]) -> None:
        """Take the next samples.

        Parameters
        ----------
        piece : ndarray, shape (n,)
            In any [unit].
        """
        for power in self._powers.add(piece):
            self._sum += power.sum(axis=0)

    def spectrum(self) -> Spectrum:
        """Return the spectrum, when all samples have come."""
        mean = self._sum / self._powers.count
        return density_of(mean, hann(self._length), self._rate, self._powers.count)


class Correlation:
    """Autocorrelation of a signal that comes piece by piece, for its period.

    Parameters
    ----------
    n_samples : int
        Of the signal.
    rate : float
        Sampling rate [Hz].
    lowest : float
        Lower limit of the fundamental [Hz].

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 400 * np.arange(32_000) / 16e3)
    >>> found = Correlation(32_000, 16e3, 5.0)
    >>> found.add(tone)
    >>> round(found.period(highest=7e3).frequency, 3)
    400.0
    """

    def __init__(self, n_samples: int, rate: float, lowest: float) -> None:
        self._rate, self._n_lags = rate, lags_of(n_samples, rate, lowest)
        self._n = n_samples
        self._reach = _REACH * self._n_lags
        self._block = _BLOCK * self._n_lags
        self._length = int(fft.next_fast_len(self._block + 2 * self._reach, real=True))
        self._bins = np.zeros(self._length // 2 + 1, dtype=np.complex128)
        self._held = np.zeros(self._reach)
        self._come = 0
        self._energy = 0.0
        self._ends = np.zeros((2, self._n_lags))

    def add(self, piece: NDArray[np.float64]) -> None:
        """Take the next samples.

        Parameters
        ----------
        piece : ndarray, shape (n,)
            In any [unit].
        """
        power = piece**2
        self._energy += float(power.sum())
        n, first = self._n_lags, self._come
        self._come += piece.size
        if first < n:
            part = power[: n - first]
            self._ends[0, first : first + part.size] = part
        begin = self._n - n
        if self._come > begin:
            part = power[max(0, begin - first) :]
            at = max(0, first - begin)
            self._ends[1, at : at + part.size] = part
        self._held = np.concatenate([self._held, piece])
        self._correlate()

    def period(self, *, highest: float, whiten: bool = False) -> Period:
        """Return the period, when all samples have come.

        Parameters
        ----------
        highest : float
            Upper limit of the fundamental [Hz].
        whiten : bool
            As for `features.kernels.periodicity.strongest_period`.

        Returns
        -------
        Period
        """
        rest = self._held.size - self._reach
        self._held = np.concatenate([self._held, np.zeros(self._block + self._reach - rest)])
        self._correlate()
        if not self._energy > 0.0:
            return Period(math.nan, 0.0)
        bins = self._power_spectrum()
        if whiten:
            # The fade leaves a little beside lines that is below nothing.
            bins *= whitening_gain(np.maximum(bins, 0.0), self._rate / self._length) ** 2
        correlation = fft.irfft(bins, OVERSAMPLING * self._length)[: OVERSAMPLING * self._n_lags]
        first, last = np.cumsum(self._ends[0]), np.cumsum(self._ends[1][::-1])
        lost = np.append(0.0, 0.5 * (first + last)) / self._energy
        return period_of(correlation, 1.0 - lost, self._rate, highest=highest)

    def _power_spectrum(self) -> NDArray[np.float64]:
        """Transform of the autocorrelation, faded out beyond the largest lag."""
        held = fft.irfft(self._bins, self._length)[: self._reach]
        fading = (np.arange(self._reach) - self._n_lags) / (self._reach - self._n_lags)
        held *= np.cos(0.5 * np.pi * np.maximum(fading, 0.0)) ** 2
        even = np.zeros(self._length)
        even[: held.size] = held
        even[self._length - held.size + 1 :] = held[:0:-1]
        return np.asarray(fft.rfft(even).real)

    def _correlate(self) -> None:
        size = self._block + 2 * self._reach
        while self._held.size >= size:
            part = self._held[:size]
            middle = part.copy()
            middle[: self._reach] = 0.0
            middle[size - self._reach :] = 0.0
            bins = fft.rfft(middle, self._length)
            self._bins += bins.conj() * fft.rfft(part, self._length)
            self._held = self._held[self._block :].copy()
