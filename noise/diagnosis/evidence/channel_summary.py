"""Health of a channel in numbers: clipping, offset, hum, noise floor.

None needs a model: a sensor that fails shows it in its own signal.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft

from features.kernels.spectra import segment_spectra
from noise.base.arrays import Array

BAND_EDGES = np.array([
    30.0, 60.0, 120.0, 180.0, 260.0, 350.0, 500.0, 700.0, 1000.0, 1400.0, 2000.0, 2800.0, 4000.0,
    5600.0, 8000.0, 10000.0,
])  # fmt: skip
"""[Hz]; band 1 lies between the first two."""

USABLE = 0.42
"""Share of the sampling rate up to which a band counts [-], below what filters fade; assumed."""


def band_levels(x: Array, rate: float) -> dict[str, float]:
    """Summarise how loud a signal is in each band.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [unit of the channel]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    dict of str to float
        Logarithms of amplitudes in the channel's unit.

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 440 * np.arange(30_000) / 30e3)
    >>> levels = band_levels(tone, 30e3)
    >>> max(levels, key=levels.get)  # from 350 to 500 Hz
    'band_6'
    """
    spectra, bands = segment_spectra(x, segment_frequency(rate)[0]), band_bins(rate)
    sums = band_sums(powers(spectra).mean(axis=0), bands.first, bands.last)
    power = sums / (bands.last - bands.first)
    return {
        f"band_{i}": level
        for i, level in zip(bands.numbers, (0.5 * np.log(power + 1e-14)).tolist(), strict=True)
    }


@lru_cache(maxsize=8)
def segment_frequency(rate: float) -> tuple[int, Array]:
    """Length of the segments in which bands are resolved, and the frequency of their bins.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    length : int
        Samples of a segment.
    frequency : ndarray, shape (length // 2 + 1,)
        [Hz]

    Examples
    --------
    >>> segment_frequency(30e3)[0], segment_frequency(48e3)[0]
    (2048, 4096)
    """
    length = 2048 if rate < 40e3 else 4096
    return length, np.asarray(np.fft.rfftfreq(length, 1.0 / rate), np.float64)


def powers(spectra: NDArray[np.complex128]) -> Array:
    """Power of each line of spectra.

    Parameters
    ----------
    spectra : ndarray of complex, shape (...)
        [any unit]

    Returns
    -------
    ndarray, shape (...)
        [unit^2]

    Examples
    --------
    >>> powers(np.array([3.0 + 4.0j]))
    array([25.])
    """
    return np.asarray(spectra.real**2 + spectra.imag**2)


def band_sums(values: Array, first: NDArray[np.int64], last: NDArray[np.int64]) -> Array:
    """Sum the last axis over bands.

    Parameters
    ----------
    values : ndarray, shape (..., n_bins)
        [any unit]
    first, last : ndarray of int, shape (n_bands,)
        First bin of each band, and first after it.

    Returns
    -------
    ndarray, shape (..., n_bands)
        [unit of the values]

    Examples
    --------
    >>> band_sums(np.arange(5.0), np.array([0, 2]), np.array([2, 5]))
    array([1., 9.])
    """
    return np.stack(
        [values[..., a:b].sum(axis=-1) for a, b in zip(first, last, strict=True)], axis=-1
    )


class Bands(NamedTuple):
    """Bands that a rate reaches.

    Parameters
    ----------
    numbers : tuple of int
        From 1.
    first, last : ndarray of int, shape (n_bands,)
        First bin of `segment_frequency` that lies in each, and first after it.
    """

    numbers: tuple[int, ...]
    first: NDArray[np.int64]
    last: NDArray[np.int64]


@lru_cache(maxsize=8)
def band_bins(rate: float) -> Bands:
    """Find which bins lie in each of the bands that a rate reaches.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    Bands

    Examples
    --------
    >>> band_bins(10e3).numbers[-1]
    12
    """
    edges = np.searchsorted(segment_frequency(rate)[1], BAND_EDGES)
    reached = (BAND_EDGES[1:] < USABLE * rate) & (np.diff(edges) > 0)
    numbers = tuple((np.flatnonzero(reached) + 1).tolist())
    return Bands(numbers, edges[:-1][reached], edges[1:][reached])


def bins_between(frequency: Array, band: tuple[float, float]) -> slice:
    """Find the bins between two frequencies.

    Parameters
    ----------
    frequency : ndarray, shape (n_bins,)
        Rising [Hz].
    band : tuple of float
        The two, which are not in it [Hz].

    Returns
    -------
    slice

    Examples
    --------
    >>> bins_between(np.array([0.0, 10.0, 20.0, 30.0]), (5.0, 30.0))
    slice(1, 3, None)
    """
    first = int(np.searchsorted(frequency, band[0], "right"))
    return slice(first, max(first, int(np.searchsorted(frequency, band[1]))))


Numbers = dict[str, float]

_FLOOR_BANDS = ((100.0, 700.0), (700.0, 2500.0), (2500.0, 6000.0), (6000.0, 10000.0))
"""[Hz]"""

_FLOOR_LENGTH = 1024
"""Of the segments whose quietest tenth is the floor [samples]; assumed."""

_QUIET = 0.1
"""Of the segments; assumed."""

_MAINS = (50, 60)
"""[Hz]"""

_HUM_RATE = 4e3
"""Sampling rate at which their harmonics are looked for, at least [Hz]."""


def channel_summary(x: Array, rate: float) -> Numbers:
    """Summarise a signal's distribution and its noise floor.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [unit of the channel]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    dict of str to float
        [-], but ``floor_*``: logarithms of amplitudes in the channel's unit.

    Examples
    --------
    >>> sound = np.sin(2 * np.pi * 440 * np.arange(30_000) / 30e3)
    >>> clipped = channel_summary(np.clip(sound, -0.5, 0.5), 30e3)
    >>> clipped["top"] > channel_summary(sound, 30e3)["top"]
    True
    """
    top, bottom, mean = float(x.max()), float(x.min()), float(x.mean())
    median = float(quantile(x, 0.5))
    away, span = x - mean, top - bottom + 1e-12
    spread = math.sqrt(float(away @ away) / x.size) + 1e-12
    numbers = {
        "top": _log_share(x > top - 0.02 * span),
        "bottom": _log_share(x < bottom + 0.02 * span),
        "crest": math.log(max(top - mean, mean - bottom, 1e-12) / spread),
        "asymmetry": math.log((top - median + 1e-12) / (median - bottom + 1e-12)),
        "skewness": float(np.mean(away**3)) / spread**3,
        "flat": _log_share(np.abs(np.diff(x)) < 1e-3 * span),
        "dwell_top": _dwell(x > top - 0.05 * span),
        "dwell_bottom": _dwell(x < bottom + 0.05 * span),
        "offset": mean / spread,
    }
    spectra = segment_spectra(x, _FLOOR_LENGTH)
    inside, *bands = _floor_bins(rate)
    quiet = quantile(powers(spectra[:, inside]), _QUIET)
    for i, band in enumerate(bands):
        numbers[f"floor_{i}"] = 0.5 * math.log(float(quiet[band].mean()) + 1e-16)
    return numbers


@lru_cache(maxsize=8)
def _floor_bins(rate: float) -> tuple[slice, ...]:
    """Bins from the lowest to the highest floor, and which of them lie in each."""
    frequency = np.asarray(np.fft.rfftfreq(_FLOOR_LENGTH, 1.0 / rate), np.float64)
    whole = bins_between(frequency, (_FLOOR_BANDS[0][0], _FLOOR_BANDS[-1][1]))
    return whole, *(bins_between(frequency[whole], band) for band in _FLOOR_BANDS)


def hum_summary(x: Array, rate: float) -> Numbers:
    """Summarise how far the mains' harmonics stand out of what lies beside them.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [unit of the channel]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    dict of str to float
        Logarithms of ratios of power [-]; ``hum_level`` that of an amplitude in the channel's unit.

    Examples
    --------
    >>> hum = 0.01 * np.sin(2 * np.pi * 50 * np.arange(30_000) / 30e3)
    >>> hum = hum_summary(hum + np.random.default_rng(0).normal(size=30_000), 30e3)
    >>> hum["hum_50"] > hum["hum_60"]
    True
    """
    # Harmonics lie in the lowest bins; of the others no power is asked.
    every = max(1, int(rate / _HUM_RATE))
    slow = _thinned(x, every)
    n = slow.size
    lines, first, last = _hum_lines(rate / every / n)
    power = powers(rfft(_detrended(slow) * hanning(n))[: int(lines.max()) + 13])
    best = first + int(np.argmax(power[first : last + 1]))
    logarithms = np.log([_line_ratio(power, line) for line in [*lines.tolist(), best]])
    numbers: Numbers = {}
    for mains, of_mains in zip(_MAINS, logarithms[:-1].reshape(len(_MAINS), -1), strict=True):
        numbers[f"hum_{mains}"] = float(of_mains[0])
        numbers[f"hum_odd_{mains}"] = float(of_mains[2::2].mean())
        numbers[f"hum_even_{mains}"] = float(of_mains[1::2].mean())
    numbers["hum_best"] = float(logarithms[-1])
    numbers["hum_level"] = 0.5 * math.log(16.0 * float(power[best]) / n**2 + 1e-14)
    return numbers


def _thinned(x: Array, every: int) -> Array:
    """Average a signal over triangles that overlap by half."""
    blocks = x[: x.size // every * every].reshape(-1, every)
    rise = (np.arange(every) + 0.5) / every**2
    return np.asarray((blocks @ rise)[:-1] + (blocks @ rise[::-1])[1:])


def _detrended(x: Array) -> Array:
    away = np.arange(x.size) - 0.5 * (x.size - 1)
    centred = x - x.mean()
    return np.asarray(centred - away * float(away @ centred) / max(float(away @ away), 1e-300))


def _line_ratio(power: Array, line: int) -> float:
    """Power of a line over the median of what lies 5 to 12 bins beside it [-].

    The line is the largest of five; 1 where the spectrum ends before.
    """
    if line + 13 > power.size:
        return 1.0
    below = power[max(line - 12, 1) : max(line - 4, 1)]
    beside = np.concatenate([below, power[line + 5 : line + 13]])
    most = float(power[max(line - 2, 0) : line + 3].max())
    return (most + 1e-30) / (float(quantile(beside, 0.5)) + 1e-30)


@lru_cache(maxsize=16)
def _hum_lines(spacing: float) -> tuple[NDArray[np.int64], int, int]:
    """Bins of the harmonics of each mains, and between which the strongest hum is looked for."""
    lines = [round(k * mains / spacing) for mains in _MAINS for k in range(1, 8)]
    return np.array(lines), math.ceil(44.0 / spacing), math.floor(66.0 / spacing)


@lru_cache(maxsize=16)
def hanning(n: int) -> Array:
    """Hann window of a length, made once.

    Parameters
    ----------
    n : int
        Samples.

    Returns
    -------
    ndarray, shape (n,)
        [-], not to be written to.

    Examples
    --------
    >>> hanning(3).tolist()
    [0.0, 1.0, 0.0]
    """
    window = np.hanning(n)
    window.setflags(write=False)
    return window


def _log_share(those: NDArray[np.bool_]) -> float:
    return math.log(np.count_nonzero(those) / max(those.size, 1) + 1e-4)


def _dwell(there: NDArray[np.bool_]) -> float:
    """Logarithm of the mean length of a stay in samples [-]."""
    entries = int(np.count_nonzero(there[1:] & ~there[:-1]))
    return math.log(max(int(np.count_nonzero(there)), 1) / max(entries, 1))


def quantile(x: Array, share: float) -> Array:
    """Quantile along the first axis, as of `numpy.quantile` without its checks.

    Parameters
    ----------
    x : ndarray, shape (n, ...)
        [any unit], no NaN.
    share : float
        From 0 to 1 [-].

    Returns
    -------
    ndarray, shape (...)
        Linear between values [unit of the values].

    Examples
    --------
    >>> float(quantile(np.array([3.0, 1.0, 2.0, 9.0]), 0.5))
    2.5
    """
    place = share * (len(x) - 1)
    low = int(place)
    high = min(low + 1, len(x) - 1)
    parted = np.partition(x, (low, high), axis=0)
    return np.asarray(parted[low] + (place - low) * (parted[high] - parted[low]))
