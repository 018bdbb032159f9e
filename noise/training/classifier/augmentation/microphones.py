"""Microphones and what recorders do behind them: a band, a gain that follows, a limit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq
from scipy.signal import lfilter

from noise.training.draws import log_uniform

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["clipped", "levelled", "through_a_microphone"]


def through_a_microphone(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator, *, phone: bool = False
) -> NDArray[np.float64]:
    """Colour by slopes at both ends of the band and a gentle ripple between.

    A phone's band is narrower, 100 Hz to 8 kHz or so, and steeper, of second order; its ripple
    larger.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    rate : float
        [Hz]
    rng : numpy.random.Generator
    phone : bool

    Returns
    -------
    ndarray, shape (n,)
        [unit of `sound`]

    Examples
    --------
    >>> through_a_microphone(np.ones(480), 48e3, np.random.default_rng(0)).shape
    (480,)
    """
    m = next_fast_len(sound.size, real=True)
    frequency = rfftfreq(m, 1.0 / rate)
    if phone:
        low, high = rng.uniform(80.0, 250.0), rng.uniform(6.5e3, 12e3)
        order, most = 4, 7.0
    else:
        low = log_uniform(15.0, 250.0, rng)
        high = log_uniform(5e3, 20e3, rng)
        order, most = 2, 4.0
    gain = 1.0 / np.sqrt(
        (1.0 + (low / np.maximum(frequency, 1.0)) ** order) * (1.0 + (frequency / high) ** order)
    )
    octaves = np.log2(np.maximum(frequency, 20.0) / 1e3)
    ripple = np.sin(rng.uniform(1.0, 4.0) * octaves + rng.uniform(0.0, 6.3))
    gain *= 10.0 ** (rng.uniform(0.0, most) / 20.0 * ripple)
    return np.asarray(irfft(rfft(sound, m) * gain, m)[: sound.size])


def levelled(
    sound: NDArray[np.float64], rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Compress as an automatic gain does: the gain falls as the smoothed level rises.

    The level of the output rises by 1 dB where that of the input rises by 1.3 to 4 dB.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    rate : float
        [Hz]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [-]

    Examples
    --------
    >>> quiet_then_loud = np.repeat([0.01, 1.0], 48_000) * np.sin(np.arange(96_000))
    >>> even = levelled(quiet_then_loud, 48e3, np.random.default_rng(0))
    >>> bool(np.std(even[60_000:]) < 60.0 * np.std(even[:40_000]))
    True
    """
    time = rng.uniform(0.02, 0.4)
    pole = math.exp(-1.0 / (time * rate))
    power = lfilter([1.0 - pole], [1.0, -pole], sound**2)
    floor = 1e-4 * float(np.mean(sound**2)) + 1e-300
    exponent = 0.5 * (1.0 - 1.0 / rng.uniform(1.3, 4.0))
    return np.asarray(sound * (power + floor) ** -exponent)


def clipped(sound: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """Limit to 30-90 % of the peak, hard or softly.

    Parameters
    ----------
    sound : ndarray, shape (n,)
        [any unit]
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (n,)
        [unit of `sound`]

    Examples
    --------
    >>> wave = np.sin(np.arange(100.0))
    >>> bool(np.abs(clipped(wave, np.random.default_rng(0))).max() < 0.95)
    True
    """
    limit = rng.uniform(0.3, 0.9) * float(np.abs(sound).max())
    if not limit > 0.0:
        return sound
    if rng.random() < 0.5:
        return np.clip(sound, -limit, limit)
    return np.asarray(limit * np.tanh(sound / limit))
