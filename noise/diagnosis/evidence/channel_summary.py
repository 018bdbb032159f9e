"""Health of a channel in numbers: clipping, offset, hum, noise floor; and of the shaft's angle.

None needs a model: a sensor that fails shows it in its own signal.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from features.kernels.segments import segment_spectra

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

__all__ = [
    "BAND_EDGES",
    "USABLE",
    "angle_summary",
    "band_bins",
    "channel_summary",
    "hum_summary",
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

_MAINS = (50, 60)
"""[Hz]"""

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
    top, bottom = float(x.max()), float(x.min())
    span = top - bottom + 1e-12
    mean, spread, median = float(x.mean()), float(x.std()) + 1e-12, float(np.median(x))
    away = x - mean
    high, low = x > top - 0.05 * span, x < bottom + 0.05 * span
    numbers = {
        "top": _log_share(x > top - 0.02 * span),
        "bottom": _log_share(x < bottom + 0.02 * span),
        "crest": math.log(max(top - mean, mean - bottom, 1e-12) / spread),
        "asymmetry": math.log((top - median + 1e-12) / (median - bottom + 1e-12)),
        "skewness": float(away @ (away * away)) / x.size / spread**3,
        "flat": _log_share(np.abs(np.diff(x)) < 1e-3 * span),
        "dwell_top": _dwell(high),
        "dwell_bottom": _dwell(low),
        "offset": mean / spread,
    }
    power = np.percentile(np.abs(segment_spectra(x, 1024)) ** 2, 10, axis=0)
    frequency = np.fft.rfftfreq(1024, 1.0 / rate)
    for i, (first, last) in enumerate(_FLOOR_BANDS):
        inside = (frequency > first) & (frequency < last)
        numbers[f"floor_{i}"] = 0.5 * math.log(float(power[inside].mean()) + 1e-16)
    return numbers


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
    n = x.size
    power = np.abs(rfft(_detrended(x) * np.hanning(n))) ** 2
    spacing = rate / n
    numbers: Numbers = {}
    for mains in _MAINS:
        lines = [_line(power, k * mains / spacing) for k in range(1, 8)]
        numbers[f"hum_{mains}"] = lines[0]
        numbers[f"hum_odd_{mains}"] = float(np.mean(lines[2::2]))
        numbers[f"hum_even_{mains}"] = float(np.mean(lines[1::2]))
    first, last = math.ceil(44.0 / spacing), math.floor(66.0 / spacing)
    best = first + int(np.argmax(power[first : last + 1]))
    numbers["hum_best"] = _line(power, best)
    numbers["hum_level"] = 0.5 * math.log(16.0 * float(power[best]) / n**2 + 1e-14)
    return numbers


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
    power = np.abs(rfft(v * np.hanning(v.size))) ** 2
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
    s = 2j * np.pi * np.fft.rfftfreq(length, 1.0 / rate)
    x = np.clip((np.abs(s) / (2.0 * np.pi) - _SPEED_LIMIT) / _SPEED_LIMIT, 0.0, 1.0)
    gain = 0.5 + 0.5 * np.cos(np.pi * x)
    return np.asarray(mean_speed + irfft(rfft(extended, length) * s * gain, length)[m : m + n])


def _about_line(angle: NDArray[np.float64], rate: float) -> tuple[float, NDArray[np.float64]]:
    """Mean speed [rad/s], and what the angle has besides [rad]."""
    time = np.arange(angle.size, dtype=np.float64) / rate
    speed = _slope(time, angle)
    return speed, angle - angle.mean() - speed * (time - time.mean())


def _line(power: NDArray[np.float64], bin_number: float) -> float:
    """Logarithm of the power of a line over the median of what lies beside it [-]."""
    k = round(bin_number)
    if k + 13 > power.size:
        return 0.0
    beside = np.concatenate([power[max(k - 12, 1) : max(k - 4, 1)], power[k + 5 : k + 13]])
    return math.log(
        (float(power[max(k - 2, 0) : k + 3].max()) + 1e-30) / (float(np.median(beside)) + 1e-30)
    )


def _detrended(x: NDArray[np.float64]) -> NDArray[np.float64]:
    time = np.arange(x.size, dtype=np.float64) - 0.5 * (x.size - 1)
    return np.asarray(x - x.mean() - _slope(time, x) * time)


def _slope(x: NDArray[np.float64], y: NDArray[np.float64]) -> float:
    away = x - x.mean()
    return float(away @ (y - y.mean())) / float(away @ away)


def _log_share(chosen: NDArray[np.bool_]) -> float:
    return math.log(float(chosen.mean()) + 1e-4)


def _dwell(chosen: NDArray[np.bool_]) -> float:
    """Logarithm of the mean length of a stay in samples [-]."""
    stays = max(int(np.count_nonzero(chosen[1:] & ~chosen[:-1])), 1)
    return math.log(max(float(chosen.sum()), 1.0) / stays)


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


def band_bins(rate: float) -> Iterator[tuple[int, NDArray[np.bool_]]]:
    """Yield the number of each band that a rate reaches, from 1, and which bins lie in it.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].

    Yields
    ------
    number : int
    inside : ndarray of bool, shape (n_bins,)
        Of the bins of `segment_frequency`.

    Examples
    --------
    >>> [number for number, _ in band_bins(10e3)][-1]
    12
    """
    place = np.digitize(segment_frequency(rate)[1], BAND_EDGES)
    for number in range(1, BAND_EDGES.size):
        inside = place == number
        if BAND_EDGES[number] < USABLE * rate and inside.any():
            yield number, inside
