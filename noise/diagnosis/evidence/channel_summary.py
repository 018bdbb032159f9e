"""Health of a channel in numbers: clipping, offset, hum, noise floor; and of the shaft's angle.

None needs a model: a sensor that fails shows it in its own signal.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from features.kernels.segments import segment_spectra
from noise.diagnosis.evidence.channel_kernel import (
    band_power_sums,
    describe_distribution,
    detrend_and_window,
    line_ratios,
    power_quantiles,
    thin_out,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "BAND_EDGES",
    "USABLE",
    "Bands",
    "angle_summary",
    "band_bins",
    "band_levels",
    "bins_between",
    "channel_summary",
    "hum_summary",
    "quantile",
    "segment_frequency",
    "shaft_speed",
]

BAND_EDGES = np.array([
    30.0, 60.0, 120.0, 180.0, 260.0, 350.0, 500.0, 700.0, 1000.0, 1400.0, 2000.0, 2800.0, 4000.0,
    5600.0, 8000.0, 10000.0,
])  # fmt: skip
"""[Hz]; band 1 lies between the first two."""

USABLE = 0.42
"""Share of the sampling rate up to which a band counts [-]."""

Numbers = dict[str, float]

_FLOOR_BANDS = ((100.0, 700.0), (700.0, 2500.0), (2500.0, 6000.0), (6000.0, 10000.0))
"""[Hz]"""

_FLOOR_LENGTH = 1024
"""Of the segments whose quietest tenth is the floor [samples]."""

_QUIET = 0.1
"""Of the segments."""

_MAINS = (50, 60)
"""[Hz]"""

_HUM_RATE = 4e3
"""Sampling rate at which their harmonics are looked for, at least [Hz]."""

_SPEED_LIMIT = 60.0
"""The shaft's speed follows its angle up to so many hertz, half as much again fading."""


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
    detrend_and_window(slow, _hanning(n), windowed)
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
def _hanning(n: int) -> NDArray[np.float64]:
    window = np.hanning(n)
    window.setflags(write=False)
    return window


def band_levels(x: NDArray[np.float64], rate: float) -> Numbers:
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
    sums = np.empty((len(spectra), len(bands.numbers)))
    band_power_sums(spectra, bands.first, bands.last, sums)
    power = sums.mean(axis=0) / (bands.last - bands.first)
    return {
        f"band_{i}": level
        for i, level in zip(bands.numbers, (0.5 * np.log(power + 1e-14)).tolist(), strict=True)
    }


def angle_summary(angle: NDArray[np.float64], speed: float, rate: float) -> Numbers:
    """Summarise how evenly the shaft turns.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        [rad], rising.
    speed : float
        As set [rad/s].
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    dict of str to float
        Speeds as logarithms of their ratio to `speed` [-], ``unevenness`` that of an angle in
        radian, ``speed_line_at`` that of a frequency in hertz.

    Examples
    --------
    >>> time = np.arange(30_000) / 30e3
    >>> shaking = 2.0 * time + 0.001 * np.sin(2 * np.pi * 10.0 * time)
    >>> round(np.exp(angle_summary(shaking, 2.0, 30e3)["speed_line_at"]))
    10
    """
    n = angle.size
    mean_speed, left = _about_line(angle, rate)
    block = max(1, int(2.5e-3 * rate))
    means = left[: n // block * block].reshape(-1, block).mean(axis=1)
    v = np.diff(means) * rate / block / abs(speed)
    v -= v.mean()
    spread = float(v.std()) + 1e-9
    power = np.abs(rfft(v * _hanning(v.size))) ** 2
    power[0] = 0.0
    best = int(np.argmax(power))
    return {
        "speed": math.log(max(abs(mean_speed), 1e-3) / abs(speed)),
        "unevenness": math.log(float(left.std()) + 1e-6),
        "speed_spread": math.log(spread),
        "speed_most": math.log(float(np.abs(v).max()) + 1e-6),
        "speed_kurtosis": float(np.mean(v**4)) / spread**4,
        "speed_skewness": float(np.mean(v**3)) / spread**3,
        "speed_line": float(power[best] / (power.sum() + 1e-30)),
        "speed_line_at": math.log(max(best, 1) * rate / block / v.size),
    }


def shaft_speed(angle: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Speed of the shaft from its angle, below 60 Hz.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        [rad]
    rate : float
        Sampling rate [Hz].

    Returns
    -------
    ndarray, shape (n,)
        [rad/s]

    Examples
    --------
    >>> time = np.arange(3000) / 10e3
    >>> turning = 2.0 * time + 0.01 * np.sin(2 * np.pi * 10.0 * time)
    >>> round(float(shaft_speed(turning, 10e3)[1000]), 2)  # 2 + 0.2 pi
    2.63
    """
    n = angle.size
    mean_speed, left = _about_line(angle, rate)
    # Turned about its ends, so that neither its value nor its slope jumps there.
    m = min(round(0.05 * rate), n - 1)
    before, after = 2.0 * left[0] - left[m:0:-1], 2.0 * left[-1] - left[-2 : -m - 2 : -1]
    extended = np.concatenate([before, left, after])
    length = next_fast_len(extended.size, real=True)
    filtered = rfft(extended, length)
    derivative = _slow_derivative(length, rate)
    filtered[: derivative.size] *= derivative
    filtered[derivative.size :] = 0.0
    return np.asarray(mean_speed + irfft(filtered, length)[m : m + n])


@lru_cache(maxsize=8)
def _slow_derivative(length: int, rate: float) -> NDArray[np.complex128]:
    """Transfer function of a derivative that fades out above `_SPEED_LIMIT`, up to its end."""
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    frequency = frequency[frequency < 2.0 * _SPEED_LIMIT]
    x = np.clip((frequency - _SPEED_LIMIT) / _SPEED_LIMIT, 0.0, 1.0)
    found = 2j * np.pi * frequency * (0.5 + 0.5 * np.cos(np.pi * x))
    found.setflags(write=False)
    return np.asarray(found)


def _about_line(angle: NDArray[np.float64], rate: float) -> tuple[float, NDArray[np.float64]]:
    """Mean speed [rad/s], and what the angle has besides [rad]."""
    time = _centred_time(angle.size, rate)
    left = angle - angle.mean()
    speed = float(time @ left) / float(time @ time)
    left -= speed * time
    return speed, left


@lru_cache(maxsize=8)
def _centred_time(n: int, rate: float) -> NDArray[np.float64]:
    time = (np.arange(n, dtype=np.float64) - 0.5 * (n - 1)) / rate
    time.setflags(write=False)
    return time


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


@lru_cache(maxsize=8)
def segment_frequency(rate: float) -> tuple[int, NDArray[np.float64]]:
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


def bins_between(frequency: NDArray[np.float64], band: tuple[float, float]) -> slice:
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
