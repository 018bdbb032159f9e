# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-decorators
"""The rhythm of blows in a window, which tells a creak from rain, and both from a tone.

The power of the sound above 2 kHz, and of all of it, every quarter of a millisecond.
A creak is a row of blows whose intervals are alike from one to the next while their rate may glide;
rain's intervals are random, a clock's and an engine's are all the same.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import fft, special

from features.windows.arithmetic import (
    OCTAVES,
    ordered_sum,
    padded_medians,
    padded_rows,
    prominent_maxima,
)
from features.windows.blocks import RATE
from features.windows.declared import RHYTHM_FEATURES
from models.compilation import COMPILED

_STEP = 4
ENVELOPE_RATE = RATE // _STEP
"""Rate of the envelope [Hz]."""

_LENGTH = 4096
_LAGS = (6, 900)
"""Between them a period of blows is sought: 4.4 to 667 a second."""

_LONGEST = 2000
"""Samples of a whole window."""

_LEAST_SAMPLES = 32
"""Shorter windows are not described."""

_SILENCE = 1e-20
"""Mean power below which a window is silent."""

_PROMINENCE_DB = 6.0
"""What a blow stands out of what is around it [dB]."""

_PULSE_RANGE_DB = 20.0
"""Weaker ones than this below the strongest are none [dB]."""

_DECAY = 16
"""Samples after which the fall from a blow is read: 4 ms."""

_LEAST_BLOWS = 4
"""For a description of their intervals."""

_NO_BLOWS = -4.0
"""Rate where there are none [octave re 10 a second]."""

_BETTER = 1.1
"""How much stronger a longer period must be than the shorter ones [ratio]."""

_MODULATION = (4, 12, 31, 82, 205, 410, 820, 1640)
"""Edges of the bands of modulation, in bins of about 1 Hz."""

RHYTHM_NAMES = tuple(feature.name for feature in RHYTHM_FEATURES)
"""Of a window, in the order of `rhythm_features`."""


def envelope(signal: NDArray[np.float32]) -> NDArray[np.float32]:
    """Power of a signal, averaged over a quarter of a millisecond; rows follow one another.

    Examples
    --------
    >>> envelope(np.ones(8, dtype=np.float32)).tolist()
    [1.0, 1.0]
    """
    power = np.empty(signal.size // _STEP, dtype=np.float32)
    _mean_squares(np.ravel(signal), power)
    return power


@njit(fastmath={"contract"}, cache=True, **COMPILED)
def _mean_squares(signal, power) -> None:
    for i in range(power.size):
        total = np.float32(0.0)
        for k in range(_STEP):
            total += signal[_STEP * i + k] * signal[_STEP * i + k]
        power[i] = total / np.float32(_STEP)


def rhythm_features(
    power: NDArray[np.float32], first: NDArray[np.int64], last: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Describe the rhythm of windows.

    Parameters
    ----------
    power : ndarray of float32, shape (n,)
        As `envelope` gives it.
    first, last : ndarray of int, shape (n_windows,)
        Each window reaches from `first` up to `last`, no farther than 2000.

    Returns
    -------
    ndarray of float32, shape (n_windows, n_names)
        By `RHYTHM_NAMES`, each in its declared [unit].

    Examples
    --------
    >>> blows = np.zeros(2000, dtype=np.float32)
    >>> blows[::80] = 1.0
    >>> found = rhythm_features(blows, np.array([0]), np.array([2000]))[0]
    >>> named = dict(zip(RHYTHM_NAMES, found.tolist()))
    >>> round(10.0 * 2.0 ** named["period_rate"])
    50
    """
    rows = np.zeros((len(first), max(1, min(power.size, _LONGEST))), dtype=np.float32)
    varying = np.zeros((len(first), _LENGTH), dtype=np.float32)
    n, mean, spread = (last - first).astype(np.int64), np.empty(len(rows)), np.empty(len(rows))
    _gather(power, first, rows, n, varying, mean, spread)
    spectrum = fft.rfft(varying, axis=1)
    modulation = spectrum.real**2 + spectrum.imag**2
    correlation = fft.irfft(modulation, axis=1)[:, : 2 * _LAGS[1] + 2]
    shares = np.add.reduceat(modulation, _MODULATION, axis=1)[:, :-1]
    whole = np.maximum(shares.sum(axis=1, keepdims=True), 1e-30)
    smooth, average, fourth = np.zeros_like(rows), np.empty(len(rows)), np.empty(len(rows))
    _smooth(rows, n, smooth, average, fourth)
    described = (n >= _LEAST_SAMPLES) & (average > _SILENCE)
    smooth, n = smooth[described], n[described]
    average, fourth = average[described], fourth[described]
    peak = smooth.max(axis=1, initial=0.0)
    level = _level(smooth, peak)
    found = {
        "crest": 10.0 * np.log10(peak / average),
        "kurtosis": 10.0 * np.log10(fourth / n),
        "concentration": _loudest_tenth(smooth, n) / (average * n),
        **_blows(level, n),
        **_period(correlation[described], n),
    }
    out = np.full((len(first), len(RHYTHM_NAMES)), np.nan, dtype=np.float32)
    for name, values in found.items():
        out[described, RHYTHM_NAMES.index(name)] = values
    out[:, -len(_MODULATION) : -1] = shares / whole
    out[:, -1] = spread / np.maximum(mean, 1e-20)
    return out


@njit(fastmath={"reassoc", "contract"}, cache=True, **COMPILED)
def _gather(power, first, rows, n, varying, mean, spread) -> None:
    """Fill in each window's power, its amplitude about the mean, that mean, and the deviation."""
    for w in range(rows.shape[0]):
        part, amplitude = power[first[w] : first[w] + n[w]], varying[w]
        total = np.float32(0.0)
        for i in range(part.size):
            rows[w, i] = part[i]
            amplitude[i] = np.sqrt(part[i])
            total += amplitude[i]
        middle = np.float32(total / n[w])
        squares = np.float32(0.0)
        for i in range(part.size):
            amplitude[i] -= middle
            squares += amplitude[i] * amplitude[i]
        mean[w], spread[w] = middle, np.sqrt(squares / rows.shape[1])


@njit(cache=True, **COMPILED)
def _smooth(rows, n, smooth, average, fourth) -> None:
    """Fill in the power of the last millisecond, its mean, and the sum of its squares re that."""
    for w in range(rows.shape[0]):
        power = 0.0  # in double precision, so that rounding does not creep
        whole = np.float32(0.0)
        for i in range(n[w]):
            power += rows[w, i]
            if i >= _STEP:
                power -= rows[w, i - _STEP]
            smooth[w, i] = power if power > 0.0 else 0.0
            whole += smooth[w, i]
        mean = whole / n[w]
        squares = 0.0
        for i in range(n[w]):
            share = smooth[w, i] / mean
            squares += share * share
        average[w], fourth[w] = mean, squares


def _level(smooth: NDArray[np.float32], peak: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return levels re the peak, no lower than -80 dB."""
    share = np.maximum(smooth / peak[:, None], np.float32(1e-8))
    np.log(share, out=share)
    share *= np.float32(10.0 / np.log(10.0))
    return share


def _loudest_tenth(smooth: NDArray[np.float32], n: NDArray[np.int64]) -> NDArray[np.float32]:
    """Return the sum over the loudest tenth, from the least of it to the most."""
    tenth = np.maximum(1, n // 10)
    most = int(tenth.max(initial=1))
    kept = smooth.shape[1] - most
    loud = np.sort(np.partition(smooth, kept, axis=1)[:, kept:], axis=1)
    return ordered_sum(np.where(np.arange(most) >= (most - tenth)[:, None], loud, 0), axis=1)


def _period(
    correlation: NDArray[np.float32], n: NDArray[np.int64]
) -> dict[str, NDArray[np.float64]]:
    """Find the period of the envelope: the shortest lag nearly as good as any."""
    power = correlation[:, 0]
    best, second = np.zeros(n.size), np.full(n.size, np.nan)
    period = np.zeros(n.size, dtype=np.int64)
    _strongest_lags(correlation, n, best, period, second)
    found, rate = period > 0, np.full(n.size, np.nan)
    rate[found] = OCTAVES * np.log(ENVELOPE_RATE / (10.0 * period[found]))
    return {
        "period_strength": np.where(power > 0.0, best, np.nan),
        "period_rate": rate,
        "second_period": second,
    }


@njit(cache=True, **COMPILED)
def _strongest_lags(correlation, n, best, period, second) -> None:
    """Fill in the best lag of each row, how strong it is, and how strong twice the lag is."""
    least, most = _LAGS
    for w in range(n.size):
        c, power = correlation[w], correlation[w, 0]
        if not power > 0.0:
            continue
        # The first fall below zero or to a tenth ends the peak at no lag.
        begin = 1
        while begin < most and c[begin] > 0.1 * np.float64(power):
            begin += 1
        highest = 0.0
        for lag in range(max(least, begin), min(most, n[w] // 2)):
            if c[lag] > c[lag - 1] and c[lag] >= c[lag + 1]:
                # Fewer samples overlap at a longer lag.
                strength = (c[lag] / power) * (n[w] / (n[w] - lag))
                if strength > highest:
                    highest = strength
                    if highest > _BETTER * best[w]:
                        best[w], period[w] = highest, lag
        twice = 2 * period[w]
        if period[w] > 0 and twice + 1 < min(n[w], c.size):
            far = max(c[twice - 1], c[twice], c[twice + 1])
            second[w] = (far / power) * (n[w] / (n[w] - twice))


def _blows(level: NDArray[np.float32], n: NDArray[np.int64]) -> dict[str, NDArray[np.floating]]:
    """Describe times and heights of the maxima that stand out of what surrounds them."""
    row, at = prominent_maxima(level, 0, n, _PROMINENCE_DB)
    kept = level[row, at] >= -_PULSE_RANGE_DB
    row, at = row[kept], at[kept]
    count = np.bincount(row, minlength=n.size)
    some = np.where(count > 0, count, np.nan)
    height = level[row, at]
    fall = height - level[row, np.minimum(at + _DECAY, n[row] - 1)]
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
    """Describe how the intervals between blows change, where there are at least four blows."""
    several = count >= _LEAST_BLOWS
    at, n = at[several], count[several] - 1
    inside = np.arange(at.shape[1] - 1) < n[:, None]
    gap = np.where(inside, np.diff(at, axis=1), 1).astype(np.float32)
    # The C library's logarithm in single precision; NumPy's own differs in the last digit.
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
    found = {
        "blow_irregularity": padded_medians(change, n - 1),
        "blow_glide": -slope,
        "blow_spread": np.sqrt(np.maximum(sum_yy / n - (sum_y / n) ** 2, 0.0)),
    }
    out = {name: np.full(count.size, np.nan) for name in found}
    for name, values in found.items():
        out[name][several] = values
    return out
