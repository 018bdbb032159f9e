"""Health of a channel in numbers: clipping, offset, hum, noise floor.

None needs a model: a sensor that fails shows it in its own signal.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import rfft

from features.kernels.spectra import segment_spectra
from noise.diagnosis.evidence.bands import bins_between
from noise.diagnosis.evidence.channel_kernel import (
    describe_distribution,
    detrend_and_window,
    line_ratios,
    power_quantiles,
    thin_out,
)

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


def channel_summary(x: NDArray[np.float64], rate: float) -> Numbers:
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
    found = np.empty(12)
    describe_distribution(x, found)
    top, bottom, mean, deviation, third, n_top, n_bottom, n_flat, *stays = found.tolist()
    spread, median = deviation + 1e-12, quantile(x, 0.5)
    numbers = {
        "top": _log_share(n_top),
        "bottom": _log_share(n_bottom),
        "crest": math.log(max(top - mean, mean - bottom, 1e-12) / spread),
        "asymmetry": math.log((top - median + 1e-12) / (median - bottom + 1e-12)),
        "skewness": third / spread**3,
        "flat": _log_share(n_flat),
        "dwell_top": _dwell(*stays[:2]),
        "dwell_bottom": _dwell(*stays[2:]),
        "offset": mean / spread,
    }
    spectra = segment_spectra(x, _FLOOR_LENGTH)
    inside, *bands = _floor_bins(rate)
    quiet = np.empty(inside.stop - inside.start)
    power_quantiles(spectra, inside.start, _QUIET, np.empty(len(spectra)), quiet)
    for i, band in enumerate(bands):
        numbers[f"floor_{i}"] = 0.5 * math.log(float(quiet[band].mean()) + 1e-16)
    return numbers


@lru_cache(maxsize=8)
def _floor_bins(rate: float) -> tuple[slice, ...]:
    """Bins from the lowest to the highest floor, and which of them lie in each."""
    frequency = np.asarray(np.fft.rfftfreq(_FLOOR_LENGTH, 1.0 / rate), np.float64)
    whole = bins_between(frequency, (_FLOOR_BANDS[0][0], _FLOOR_BANDS[-1][1]))
    return whole, *(bins_between(frequency[whole], band) for band in _FLOOR_BANDS)


def hum_summary(x: NDArray[np.float64], rate: float) -> Numbers:
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
    >>> found = hum_summary(hum + np.random.default_rng(0).normal(size=30_000), 30e3)
    >>> found["hum_50"] > found["hum_60"]
    True
    """
    # Harmonics lie in the lowest bins; of the others no power is asked.
    every = max(1, int(rate / _HUM_RATE))
    n = x.size // every - 1
    slow, windowed = np.empty(n), np.empty(n)
    thin_out(x, every, slow)
    detrend_and_window(slow, hanning(n), windowed)
    lines, first, last = _hum_lines(rate / every / n)
    spectrum = rfft(windowed)[: int(lines.max()) + 13]
    power = spectrum.real**2 + spectrum.imag**2
    best = first + int(np.argmax(power[first : last + 1]))
    ratios = np.empty(lines.size + 1)
    line_ratios(power, np.append(lines, best), ratios, np.empty(16))
    logarithms = np.log(ratios)
    numbers: Numbers = {}
    for mains, of_mains in zip(_MAINS, logarithms[:-1].reshape(len(_MAINS), -1), strict=True):
        numbers[f"hum_{mains}"] = float(of_mains[0])
        numbers[f"hum_odd_{mains}"] = float(of_mains[2::2].mean())
        numbers[f"hum_even_{mains}"] = float(of_mains[1::2].mean())
    numbers["hum_best"] = float(logarithms[-1])
    numbers["hum_level"] = 0.5 * math.log(16.0 * float(power[best]) / n**2 + 1e-14)
    return numbers


@lru_cache(maxsize=16)
def _hum_lines(spacing: float) -> tuple[NDArray[np.int64], int, int]:
    """Bins of the harmonics of each mains, and between which the strongest hum is looked for."""
    lines = [round(k * mains / spacing) for mains in _MAINS for k in range(1, 8)]
    return np.array(lines), math.ceil(44.0 / spacing), math.floor(66.0 / spacing)


@lru_cache(maxsize=16)
def hanning(n: int) -> NDArray[np.float64]:
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


def _log_share(share: float) -> float:
    return math.log(share + 1e-4)


def _dwell(samples: float, stays: float) -> float:
    """Logarithm of the mean length of a stay in samples [-]."""
    return math.log(max(samples, 1.0) / max(stays, 1.0))


def quantile(x: NDArray[np.float64], share: float) -> float:
    """Quantile, linear between values, as of `numpy.quantile` without its checks.

    Parameters
    ----------
    x : ndarray, shape (n,)
        [any unit], no NaN.
    share : float
        From 0 to 1 [-].

    Returns
    -------
    float
        [unit of the values]

    Examples
    --------
    >>> quantile(np.array([3.0, 1.0, 2.0, 9.0]), 0.5)
    2.5
    """
    place = share * (x.size - 1)
    low = int(place)
    high = min(low + 1, x.size - 1)
    parted = np.partition(x, (low, high))
    below, above = float(parted[low]), float(parted[high])
    return below + (place - low) * (above - below)
