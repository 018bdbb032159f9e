# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Rhythm of blows in a window, which distinguishes a creak from rain and from tones.

It is computed from the power of the sound above 2 kHz, and of all of it, every 0.25 ms. A creak is
a series of blows that stand out and recur; those of rain do not recur.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import fft

from features.windows.arithmetic import OCTAVES, power_of, prominent_maxima
from features.windows.blocks import RATE
from models.compilation import COMPILED

_STEP = 4
ENVELOPE_RATE = RATE // _STEP
"""Sampling rate of the envelope [Hz]."""

_LENGTH = 4096
_LAGS = (6, 900)
"""Range of the period of blows in samples: 4.4 to 667 per second."""

_LEAST_SAMPLES = 32
"""Minimum number of samples of a window."""

_SILENCE = 1e-20
"""Mean power below which a window is silent."""

_PROMINENCE_DB = 6.0
"""Prominence of a blow [dB]."""

_PULSE_RANGE_DB = 20.0
"""Range of blows below the strongest [dB]."""

_NO_BLOWS = -4.0
"""Rate without blows [octave re 10 per second]."""

_BETTER = 1.1
"""Minimum ratio of the strength of a longer period to shorter ones [-]."""

_MODULATION = (4, 12, 31, 82, 205, 410, 820, 1640)
"""Edges of the bands of modulation, in bins of about 1 Hz."""


def envelope(signal: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the mean power of a signal every 0.25 ms; rows are concatenated.

    Examples
    --------
    >>> envelope(np.ones(8, dtype=np.float32)).tolist()
    [1.0, 1.0]
    """
    power = np.zeros(max(1, signal.size // _STEP), dtype=np.float32)
    _mean_squares(np.ravel(signal), power)
    return power


@njit(fastmath={"contract"}, cache=True, **COMPILED)
def _mean_squares(signal, power) -> None:
    for i in range(signal.size // _STEP):
        total = np.float32(0.0)
        for k in range(_STEP):
            total += signal[_STEP * i + k] * signal[_STEP * i + k]
        power[i] = total / np.float32(_STEP)


def rhythm_of(power: NDArray[np.float32]) -> dict[str, NDArray[np.floating]]:
    """Return rhythm features of windows of equal length.

    Parameters
    ----------
    power : ndarray of float32, shape (n_windows, n)
        Envelopes from `envelope`, of at most 2000 samples.

    Returns
    -------
    dict of str to ndarray, shape (n_windows,)
        Features by name, as in `features.table`, in their units [dB, octave or -]; most are
        NaN for less than 32 samples and for silence.

    Examples
    --------
    >>> blows = np.zeros((1, 2000), dtype=np.float32)
    >>> blows[0, ::80] = 1.0
    >>> round(10.0 * 2.0 ** float(rhythm_of(blows)["period_rate"][0]))
    50
    """
    windows, n = power.shape
    varying = np.zeros((windows, _LENGTH), dtype=np.float32)
    amplitude = np.sqrt(power)
    varying[:, :n] = amplitude - amplitude.mean(axis=1, keepdims=True)
    modulation = power_of(fft.rfft(varying, axis=1))
    correlation = fft.irfft(modulation, axis=1)[:, : _LAGS[1] + 1]
    shares = np.add.reduceat(modulation, _MODULATION, axis=1)[:, :-1]
    shares /= np.maximum(shares.sum(axis=1, keepdims=True), 1e-30)
    smooth = power.copy()  # power of the last millisecond
    for k in range(1, _STEP):
        smooth[:, k:] += power[:, :-k]
    average = smooth.mean(axis=1)
    described = (average > _SILENCE) & (n >= _LEAST_SAMPLES)
    smooth, average = smooth[described], average[described]
    peak = smooth.max(axis=1, initial=0.0)
    strength, period = _strongest_lags(correlation[described], n)
    features = {
        "crest": 10.0 * np.log10(peak / average),
        "blow_rate": _blow_rate(smooth, peak),
        "period_strength": strength,
        "period_rate": OCTAVES * np.log(ENVELOPE_RATE / (10.0 * period)),
    }
    return {
        **{name: _spread(values, described) for name, values in features.items()},
        **{f"modulation_{i}": share for i, share in enumerate(shares.T, start=1)},
    }


def _spread(values: NDArray[Any], chosen: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return an array with values where chosen, NaN elsewhere."""
    out = np.full(chosen.size, np.nan)
    out[chosen] = values
    return out


def _strongest_lags(
    correlation: NDArray[np.float32], n: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return strength and period of the envelope [samples]: the shortest of nearly equal lags."""
    strength, period = np.zeros(len(correlation)), np.full(len(correlation), np.nan)
    _search_lags(correlation, n, strength, period)
    return np.where(correlation[:, 0] > 0.0, strength, np.nan), period


@njit(cache=True, **COMPILED)
def _search_lags(correlation, n, best, period) -> None:
    least, most = _LAGS
    for w in range(correlation.shape[0]):
        c, power = correlation[w], correlation[w, 0]
        if not power > 0.0:
            continue
        # The peak at lag zero ends at the first value up to a tenth.
        begin = 1
        while begin < most and c[begin] > 0.1 * np.float64(power):
            begin += 1
        for lag in range(max(least, begin), min(most, n // 2)):
            if c[lag] > c[lag - 1] and c[lag] >= c[lag + 1]:
                # Fewer samples overlap at a longer lag.
                strength = (c[lag] / power) * (n / (n - lag))
                if strength > _BETTER * best[w]:
                    best[w], period[w] = strength, lag


def _blow_rate(smooth: NDArray[np.float32], peak: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the rate of prominent maxima of the power [octave re 10 per second]."""
    windows, n = smooth.shape
    level = 10.0 * np.log10(np.maximum(smooth / peak[:, None], np.float32(1e-8)))
    row, at = prominent_maxima(level, 0, n, _PROMINENCE_DB)
    count = np.bincount(row[level[row, at] >= -_PULSE_RANGE_DB], minlength=windows)
    some = np.where(count > 0, count, np.nan)
    rate = OCTAVES * np.log(some / n * (ENVELOPE_RATE / 10.0))
    return np.where(count > 0, rate, _NO_BLOWS)
