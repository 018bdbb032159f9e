"""How evenly the shaft turns, in numbers, and its speed, from its angle."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from noise.diagnosis.evidence.channel_summary import hanning

_SPEED_LIMIT = 60.0
"""The shaft's speed follows its angle up to so many hertz, half as much again fading."""


def angle_summary(angle: NDArray[np.float64], speed: float, rate: float) -> dict[str, float]:
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
    power = np.abs(rfft(v * hanning(v.size))) ** 2
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
