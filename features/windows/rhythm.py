# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""Rhythm of blows in a window, which distinguishes a creak from rain and from tones.

It is computed from the power of the sound above 2 kHz, and of all of it, every 0.25 ms. A creak is
a series of blows with similar consecutive intervals and a gliding rate; intervals of rain are
random, and those of a clock or an engine are constant.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import fft, special

from features.windows.arithmetic import (
    OCTAVES,
    ordered_sum,
    padded_medians,
    padded_rows,
    power_of,
    prominent_maxima,
)
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

_DECAY = 16
"""Delay of the decay after a blow in samples: 4 ms."""

_LEAST_BLOWS = 4
"""Minimum number of blows to describe intervals."""

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


def rhythm_of(power: NDArray[np.float32], size: int) -> dict[str, NDArray[np.floating]]:
    """Return rhythm features of windows of equal length.

    Parameters
    ----------
    power : ndarray of float32, shape (n_windows, n)
        Envelopes from `envelope`, of at most 2000 samples; they are changed.
    size : int
        Number of samples for the deviation.

    Returns
    -------
    dict of str to ndarray, shape (n_windows,)
        Features by name, as in `features.table`, in their units [dB, octave, 1/s or -]; most are
        NaN for less than 32 samples and for silence.

    Examples
    --------
    >>> blows = np.zeros((1, 2000), dtype=np.float32)
    >>> blows[0, ::80] = 1.0
    >>> round(10.0 * 2.0 ** float(rhythm_of(blows, 2000)["period_rate"][0]))
    50
    """
    windows, n = power.shape
    varying = np.zeros((windows, _LENGTH), dtype=np.float32)
    mean, spread = np.empty(windows), np.empty(windows)
    _amplitudes(power, size, varying, mean, spread)
    modulation = power_of(fft.rfft(varying, axis=1))
    correlation = fft.irfft(modulation, axis=1)[:, : 2 * _LAGS[1] + 2]
    shares = np.add.reduceat(modulation, _MODULATION, axis=1)[:, :-1]
    shares /= np.maximum(shares.sum(axis=1, keepdims=True), 1e-30)
    smooth, average, fourth = np.zeros_like(power), np.empty(windows), np.empty(windows)
    _smooth(power, smooth, average, fourth)
    described = (average > _SILENCE) & (n >= _LEAST_SAMPLES)
    smooth, average = smooth[described], average[described]
    peak = smooth.max(axis=1, initial=0.0)
    features = {
        "crest": 10.0 * np.log10(peak / average),
        "kurtosis": 10.0 * np.log10(fourth[described] / n),
        "concentration": _loudest_tenth(smooth) / (average * n),
        **_blows(_level(smooth, peak)),
        **_period(correlation[described], n),
    }
    return {
        **{name: _spread(values, described) for name, values in features.items()},
        **{f"modulation_{i}": share for i, share in enumerate(shares.T, start=1)},
        "modulation_depth": spread / np.maximum(mean, 1e-20),
    }


@njit(fastmath={"reassoc", "contract"}, cache=True, **COMPILED)
def _amplitudes(power, size, varying, mean, spread) -> None:
    """Fill in the amplitude of each window without its mean, the mean and the deviation."""
    for w in range(power.shape[0]):
        amplitude = varying[w]
        n = power.shape[1]
        total = np.float32(0.0)
        for i in range(n):
            amplitude[i] = np.sqrt(power[w, i])
            total += amplitude[i]
        middle = np.float32(total / n)
        squares = np.float32(0.0)
        for i in range(n):
            amplitude[i] -= middle
            squares += amplitude[i] * amplitude[i]
        mean[w], spread[w] = middle, np.sqrt(squares / size)


@njit(cache=True, **COMPILED)
def _smooth(rows, smooth, average, fourth) -> None:
    """Fill in the power of the last millisecond, its mean, and its relative sum of squares."""
    n = rows.shape[1]
    for w in range(rows.shape[0]):
        power = 0.0  # double precision, against accumulated rounding
        whole = np.float32(0.0)
        for i in range(n):
            power += rows[w, i]
            if i >= _STEP:
                power -= rows[w, i - _STEP]
            smooth[w, i] = power if power > 0.0 else 0.0
            whole += smooth[w, i]
        mean = whole / n
        squares = 0.0
        for i in range(n):
            share = smooth[w, i] / mean
            squares += share * share
        average[w], fourth[w] = mean, squares


def _spread(values: NDArray[Any], chosen: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return an array with values where chosen, NaN elsewhere."""
    out = np.full(chosen.size, np.nan)
    out[chosen] = values
    return out


def _level(smooth: NDArray[np.float32], peak: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return levels re the peak, at least -80 dB."""
    share: NDArray[np.float32] = np.maximum(smooth / peak[:, None], np.float32(1e-8))
    np.log(share, out=share)
    share *= np.float32(10.0 / np.log(10.0))
    return share


def _loudest_tenth(smooth: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the sum over the loudest tenth, in increasing order."""
    rest = smooth.shape[1] - max(1, smooth.shape[1] // 10)
    return ordered_sum(np.sort(np.partition(smooth, rest, axis=1)[:, rest:], axis=1), axis=1)


def _period(correlation: NDArray[np.float32], n: int) -> dict[str, NDArray[np.float64]]:
    """Return the features of the period of the envelope: the shortest of nearly equal lags."""
    strength, second = np.zeros(len(correlation)), np.full(len(correlation), np.nan)
    period = np.zeros(len(correlation), dtype=np.int64)
    _strongest_lags(correlation, n, strength, period, second)
    rate = OCTAVES * np.log(ENVELOPE_RATE / (10.0 * period[period > 0]))
    return {
        "period_strength": np.where(correlation[:, 0] > 0.0, strength, np.nan),
        "period_rate": _spread(rate, period > 0),
        "second_period": second,
    }


@njit(cache=True, **COMPILED)
def _strongest_lags(correlation, n, best, period, second) -> None:
    """Fill in the best lag of each row, its strength, and the strength of twice the lag."""
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
        twice = 2 * period[w]
        if period[w] > 0 and twice + 1 < min(n, c.size):
            far = max(c[twice - 1], c[twice], c[twice + 1])
            second[w] = (far / power) * (n / (n - twice))


def _blows(level: NDArray[np.float32]) -> dict[str, NDArray[np.floating]]:
    """Return the features of the blows, which are prominent maxima."""
    windows, n = level.shape
    row, at = prominent_maxima(level, 0, n, _PROMINENCE_DB)
    high = level[row, at] >= -_PULSE_RANGE_DB
    row, at = row[high], at[high]
    count = np.bincount(row, minlength=windows)
    some = np.where(count > 0, count, np.nan)
    height = level[row, at]
    fall = height - level[row, np.minimum(at + _DECAY, n - 1)]
    mean, square = (
        ordered_sum(padded_rows(values.astype(np.float64), row, count, 0.0), axis=1) / some
        for values in (height, height * height)
    )
    return {
        "blow_rate": np.where(
            count > 0, OCTAVES * np.log(some / n * (ENVELOPE_RATE / 10.0)), _NO_BLOWS
        ),
        "blow_heights": np.sqrt(np.maximum(square - mean**2, 0.0)),
        "decay": padded_medians(padded_rows(fall, row, count, np.inf), count),
        **_intervals(padded_rows(at, row, count, 0), count),
    }


def _intervals(at: NDArray[np.int64], count: NDArray[np.int64]) -> dict[str, NDArray[np.floating]]:
    """Return the features of the intervals between at least four blows."""
    several = count >= _LEAST_BLOWS
    at, n = at[several], count[several] - 1
    inside = np.arange(at.shape[1] - 1) < n[:, None]
    gap = np.where(inside, np.diff(at, axis=1), 1).astype(np.float32)
    # Logarithm of the C library in single precision; that of NumPy differs in the last digit.
    logarithm = special.xlogy(np.float32(1.0), gap).astype(np.float64)
    interval = (OCTAVES * logarithm).astype(np.float32)
    last = np.take_along_axis(at, n[:, None], axis=1)
    x = 0.5 * (at[:, 1:] + at[:, :-1] - at[:, :1] - last) / ENVELOPE_RATE
    x = np.where(inside, x, 0.0)
    square = (interval * interval).astype(np.float64)
    sum_x, sum_y, sum_xx, sum_xy, sum_yy = (
        ordered_sum(terms, axis=1)
        for terms in (x, interval.astype(np.float64), x * x, x * interval, square)
    )
    change = np.where(inside[:, 1:], np.abs(np.diff(interval, axis=1)), np.float32(np.inf))
    slope = (n * sum_xy - sum_x * sum_y) / np.maximum(n * sum_xx - sum_x * sum_x, 1e-12)
    features = {
        "blow_irregularity": padded_medians(change, n - 1),
        "blow_glide": -slope,
        "blow_spread": np.sqrt(np.maximum(sum_yy / n - (sum_y / n) ** 2, 0.0)),
    }
    return {name: _spread(values, several) for name, values in features.items()}
