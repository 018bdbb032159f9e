"""Pulses of a long sound, found while its envelopes come piece by piece."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from features.kernels.slip_pulses import (
    LEAST_HIGH_SHARE,
    NO_PULSES,
    PULSE_PROMINENCE_DB,
    PULSE_RANGE_DB,
    SMOOTHING,
    Pulses,
    rhythm,
)
from features.long.turning_points import Smoother, TurningPoints

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from features.long.sums import Moments

__all__ = ["LongPulses", "envelope_kurtosis"]

_BIN_DB = 0.01
_LOWEST_DB, _HIGHEST_DB = -200.0, 100.0
"""Of the counts from which the loudest tenth of the time is taken [dB]."""

_LOUDEST = 10
_NEGLIGIBLE = 1e-300


class LongPulses:
    """Pulses of a signal whose squared envelope above 2 kHz comes piece by piece.

    Parameters
    ----------
    rate : float
        Sampling rate of the envelope [Hz].

    Examples
    --------
    >>> LongPulses(8e3).add(np.ones(8000))
    """

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self._smoother = Smoother.gaussian(SMOOTHING * rate, 3.0)
        self._points = TurningPoints(PULSE_PROMINENCE_DB)
        self._n = 0
        self._top = -math.inf
        n_bins = round((_HIGHEST_DB - _LOWEST_DB) / _BIN_DB)
        self._counts, self._sums = np.zeros(n_bins), np.zeros(n_bins)

    def add(self, power: NDArray[np.float64]) -> None:
        """Take the next samples.

        Parameters
        ----------
        power : ndarray, shape (n,)
            Squared envelope [unit^2].
        """
        self._take(self._smoother.add(power))

    def pulses(self, whole: Moments, high: Moments, start: float) -> Pulses:
        """Return the pulses, when all samples have come.

        Parameters
        ----------
        whole, high : Moments
            Of the squared envelope of all that counts [unit^2], and of this.
        start : float
            Time of the first sample [s].

        Returns
        -------
        Pulses
        """
        self._take(self._smoother.finish())
        if not whole.mean > 0.0:
            return NO_PULSES
        crest_factor = math.sqrt(2.0 * whole.highest / whole.mean)
        kurtosis = envelope_kurtosis(whole)
        if high.mean < LEAST_HIGH_SHARE * whole.mean:
            nan = math.nan
            return Pulses(np.empty(0), 0.0, nan, nan, crest_factor, kurtosis, nan, nan)
        self._points.keep_above(self._top - PULSE_RANGE_DB)
        times = np.asarray(self._points.peaks / self._rate)
        irregularity, glide = rhythm(times)
        return Pulses(
            times=start + times,
            rate=times.size / (self._n / self._rate) if times.size > 1 else 0.0,
            irregularity=irregularity,
            glide=glide,
            crest_factor=crest_factor,
            kurtosis=kurtosis,
            high_kurtosis=envelope_kurtosis(high),
            concentration=self._concentration(),
        )

    def _take(self, smooth: NDArray[np.float64]) -> None:
        if not smooth.size:
            return
        self._n += smooth.size
        level = 10.0 * np.log10(np.maximum(smooth, _NEGLIGIBLE))
        self._top = max(self._top, float(level.max()))
        self._points.add(level)
        self._points.keep_above(self._top - PULSE_RANGE_DB)
        place = ((np.clip(level, _LOWEST_DB, _HIGHEST_DB - 1.0) - _LOWEST_DB) / _BIN_DB).astype(
            np.intp
        )
        self._counts += np.bincount(place, minlength=self._counts.size)
        self._sums += np.bincount(place, smooth, self._counts.size)

    def _concentration(self) -> float:
        """Share of the energy in the loudest tenth of the time."""
        left = float(max(1, self._n // _LOUDEST))
        counts, sums = self._counts[::-1], self._sums[::-1]
        full = np.cumsum(counts)
        last = int(np.searchsorted(full, left))
        inside = float(sums[:last].sum())
        left -= float(full[last - 1]) if last else 0.0
        if left > 0.0 and counts[last] > 0.0:
            inside += left * float(sums[last] / counts[last])
        return inside / float(sums.sum())


def envelope_kurtosis(power: Moments) -> float:
    """`features.kernels.slip_pulses.envelope_kurtosis` of a squared envelope summed up.

    Parameters
    ----------
    power : Moments
        [unit^2]

    Returns
    -------
    float
        [-]

    Examples
    --------
    >>> from features.long.sums import Moments
    >>> flat = Moments()
    >>> flat.add(np.ones(8))
    >>> envelope_kurtosis(flat)
    1.5
    """
    return 1.5 * power.mean_square / power.mean**2 if power.mean > 0.0 else math.nan
