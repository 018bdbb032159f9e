"""Blows and their rhythm: what tells a creak from rain, and both from a tone.

The power of the sound above 2 kHz, and of all of it, every quarter of a millisecond.
A creak is a row of blows whose intervals are alike from one to the next while their rate may glide;
rain's intervals are random, a clock's and an engine's are all the same.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy import fft

from features.windows.working import RATE

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["ENVELOPE_RATE", "RHYTHM_NAMES", "envelope", "rhythms_of"]

_STEP = 4
ENVELOPE_RATE = RATE // _STEP
"""Rate of the envelope [Hz]."""

_LENGTH = 4096
_LAGS = (6, 900)
"""Between them a period of blows is sought: 4.4 to 667 a second."""

_PROMINENCE_DB = 6.0
_PULSE_RANGE_DB = 20.0
_MODULATION = (4, 12, 31, 82, 205, 410, 820, 1640)
"""Edges of the bands of modulation, in bins of about 1 Hz."""

RHYTHM_NAMES = (
    "blow_rate", "blow_irregularity", "blow_glide", "blow_spread", "blow_heights", "crest",
    "kurtosis", "concentration", "period_strength", "period_rate", "second_period", "decay",
    *(f"modulation_{i + 1}" for i in range(len(_MODULATION) - 1)), "modulation_depth",
)  # fmt: skip
"""Of a window, in the order of `rhythms_of`.

Blows in a second [octave re 10]; median change from one interval to the next [octave]; the rate's
trend [octave a second]; deviation of the intervals' logarithm [octave] and of the blows' levels
[dB]; peak, fourth moment and loudest tenth of the envelope; the highest
autocorrelation of its square root, the rate that belongs to it [octave re 10 Hz], and what is left
of it at twice the lag; median fall within 4 ms after a blow [dB]; shares of the modulation from 4
to 1600 Hz in bands of an octave or more, and its depth.
"""


def envelope(signal: NDArray[np.float32]) -> NDArray[np.float32]:
    """Power of a signal, averaged over a quarter of a millisecond.

    Examples
    --------
    >>> envelope(np.ones(8, dtype=np.float32)).tolist()
    [1.0, 1.0]
    """
    whole = signal[: signal.size // _STEP * _STEP].reshape(-1, _STEP)
    return np.asarray(np.einsum("ij,ij->i", whole, whole) / np.float32(_STEP))


def rhythms_of(
    power: NDArray[np.float32], first: NDArray[np.int64], last: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Describe the rhythm of windows.

    Parameters
    ----------
    power : ndarray of float32, shape (n,)
        As `envelope` gives it.
    first, last : ndarray of int, shape (n_windows,)
        Each window reaches from `first` up to `last`, no farther than 2048.

    Returns
    -------
    ndarray of float32, shape (n_windows, n_names)
        By `RHYTHM_NAMES`.

    Examples
    --------
    >>> blows = np.zeros(2000, dtype=np.float32)
    >>> blows[::80] = 1.0
    >>> found = rhythms_of(blows, np.array([0]), np.array([2000]))[0]
    >>> named = dict(zip(RHYTHM_NAMES, found.tolist()))
    >>> round(10.0 * 2.0 ** named["period_rate"])
    50
    """
    size = int((last - first).max(initial=0))
    rows = np.zeros((len(first), max(size, 1)), dtype=np.float32)
    for row, start, end in zip(rows, first, last, strict=True):
        row[: end - start] = power[start:end]
    n = (last - first).astype(np.int64)
    amplitude = np.sqrt(rows)
    inside = np.arange(rows.shape[1]) < n[:, None]
    mean = amplitude.sum(axis=1) / n
    varying = np.where(inside, amplitude - mean[:, None], np.float32(0.0)).astype(np.float32)
    spectrum = fft.rfft(varying, n=_LENGTH, axis=1)
    modulation = spectrum.real**2 + spectrum.imag**2
    correlation = fft.irfft(modulation, axis=1)[:, : 2 * _LAGS[1] + 2]
    out = np.full((len(first), len(RHYTHM_NAMES)), np.nan, dtype=np.float32)
    shares = np.add.reduceat(modulation, _MODULATION, axis=1)[:, :-1]
    whole = np.maximum(shares.sum(axis=1, keepdims=True), 1e-30)
    out[:, 12:-1] = shares / whole
    out[:, -1] = varying.std(axis=1) / np.maximum(mean, 1e-20)
    _rhythms(rows, n, correlation, out)
    return out


_OCTAVES = 1.0 / np.log(2.0)
"""What makes a natural logarithm one of base two."""


@njit(cache=True, error_model="numpy")
def _rhythms(rows, n, correlation, out):
    smooth = np.empty(rows.shape[1], dtype=np.float32)
    level = np.empty(rows.shape[1], dtype=np.float32)
    at = np.empty(rows.shape[1], dtype=np.float32)
    for w in range(rows.shape[0]):
        m = n[w]
        if m < 32:
            continue
        e = rows[w]
        mean = np.float32(0.0)
        peak = np.float32(0.0)
        sums = 0.0  # of the last millisecond; in double precision, so that it does not creep
        for i in range(m):
            sums += e[i]
            if i >= 4:
                sums -= e[i - 4]
            smooth[i] = max(sums, np.float32(0.0))
            mean += smooth[i]
            peak = max(peak, smooth[i])
        mean /= m
        if mean <= 1e-20:
            continue
        fourth = np.float32(0.0)
        for i in range(m):
            fourth += (smooth[i] / mean) ** 2
            level[i] = 10.0 * np.log10(max(smooth[i] / peak, 1e-8))
        out[w, 5] = 10.0 * np.log10(peak / mean)
        out[w, 6] = 10.0 * np.log10(fourth / m)
        tenth = max(1, m // 10)
        loud = np.sort(np.partition(smooth[:m], m - tenth)[m - tenth :])
        out[w, 7] = loud.sum() / (mean * m)
        _blows(level, m, at, out[w])
        r = correlation[w]
        if r[0] <= 0.0:
            continue
        # The first fall below zero or to a tenth ends the peak at no lag.
        lag = 1
        while lag < min(_LAGS[1], m // 2) and r[lag] > 0.1 * r[0]:
            lag += 1
        best, period = np.float32(0.0), 0
        for k in range(max(lag, _LAGS[0]), min(_LAGS[1], m // 2)):
            c = r[k] / r[0] * (m / (m - k))
            if r[k] > r[k - 1] and r[k] >= r[k + 1] and c > 1.1 * best:
                best, period = c, k
        out[w, 8] = best
        if period > 0:
            out[w, 9] = _OCTAVES * np.log(ENVELOPE_RATE / (10.0 * period))
            if 2 * period + 1 < min(m, len(r)):
                far = max(r[2 * period - 1], r[2 * period], r[2 * period + 1])
                out[w, 10] = far / r[0] * (m / (m - 2 * period))


@njit(cache=True, error_model="numpy")
def _blows(level, m, at, out):
    """Find the maxima that stand out of what surrounds them, and describe their times."""
    count = 0
    lowest = level[0]
    candidate = -1
    heights = 0.0
    squares = 0.0
    falls = np.empty(m, dtype=np.float32)
    for i in range(m):
        v = level[i]
        if candidate < 0:
            lowest = min(lowest, v)
            if v >= lowest + _PROMINENCE_DB:
                candidate = i
        elif v > level[candidate]:
            candidate = i
        elif v < level[candidate] - _PROMINENCE_DB:
            if level[candidate] >= -_PULSE_RANGE_DB:
                at[count] = candidate
                heights += level[candidate]
                squares += level[candidate] ** 2
                falls[count] = level[candidate] - level[min(candidate + 16, m - 1)]
                count += 1
            candidate = -1
            lowest = v
    if count == 0:
        out[0] = -4.0
        return
    out[0] = _OCTAVES * np.log(count / m * (ENVELOPE_RATE / 10.0))
    out[11] = np.median(falls[:count])
    out[4] = np.sqrt(max(squares / count - (heights / count) ** 2, 0.0))
    if count < 4:
        return
    interval = np.empty(count - 1, dtype=np.float32)
    sx, sy, sxx, sxy, syy = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(count - 1):
        interval[i] = _OCTAVES * np.log(at[i + 1] - at[i])
        x = 0.5 * (at[i + 1] + at[i] - at[0] - at[count - 1]) / ENVELOPE_RATE
        sx += x
        sy += interval[i]
        sxx += x * x
        sxy += x * interval[i]
        syy += interval[i] ** 2
    k = count - 1
    out[1] = np.median(np.abs(np.diff(interval)))
    out[2] = -(k * sxy - sx * sy) / max(k * sxx - sx * sx, 1e-12)
    out[3] = np.sqrt(max(syy / k - (sy / k) ** 2, 0.0))
